#include "commands/warnings.h"

#include <algorithm>
#include <cstddef>

#include "core/console.h"
#include "core/printable.h"

namespace cradle {

namespace {

bool isSilent = false;                          // of the process, as stderr is
std::vector<std::string>* collected = nullptr;  // the same

}  // namespace

void warn(const std::string& warning) {
  if (collected)
    collected->push_back(warning);
  else if (!isSilent)
    show(stderr, "warning: {}\n", printableLine(warning));
}

void warnOfAll(const std::vector<std::string>& warnings) {
  constexpr std::size_t kMaxTold = 50;  // as of faults
  for (std::size_t i = 0; i < std::min(warnings.size(), kMaxTold); ++i) warn(warnings[i]);
  if (warnings.size() > kMaxTold) warn(fmt::format("and {} more warnings", warnings.size() - kMaxTold));
}

CollectedWarnings::CollectedWarnings() {
  collected = &texts_;
}

CollectedWarnings::~CollectedWarnings() {
  collected = nullptr;
}

void silenceWarnings() {
  isSilent = true;
}

}  // namespace cradle
