#pragma once

#include <optional>
#include <string>

namespace cradle {

// What may be asked for.
constexpr double kFinestAccuracy = 1e-12, kCoarsestAccuracy = 1e-2;

/// The accuracy that a word stands for, and all words for messages; nothing for a word that is none.
std::optional<double> accuracyNamed(const std::string& word);
extern const char* const kAccuracyWords;

}  // namespace cradle
