#include "scene/named_accuracy.h"

namespace cradle {

const char* const kAccuracyWords = R"("visual" (1e-3), "default" (1e-6) or "reference" (1e-10))";

std::optional<double> accuracyNamed(const std::string& word) {
  if (word == "visual") return 1e-3;
  if (word == "default") return 1e-6;
  if (word == "reference") return 1e-10;
  return std::nullopt;
}

}  // namespace cradle
