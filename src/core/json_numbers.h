#pragma once

#include <nlohmann/json.hpp>

namespace cradle {

/// The numbers of a vector, or of a row, as an array.
template <class Vector>
nlohmann::ordered_json numbersOf(const Vector& vector) {
  nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
  for (const auto number : vector) numbers.push_back(number);
  return numbers;
}

}  // namespace cradle
