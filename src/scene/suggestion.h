#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace cradle {

/// Smallest number of characters to insert, delete, replace, or swap with their neighbour, to turn `a` into `b`; upper
/// and lower case count as equal. O(length of a x length of b).
std::size_t editDistance(const std::string& a, const std::string& b);

/// The candidate that other programs call `name`, or that is most like it; null if none is.
const std::string* mostLike(const std::string& name, const std::vector<std::string>& candidates);

/// "; did you mean "gravity"?" for the candidate that is most like `name`, or nothing if none is like it.
std::string didYouMean(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace cradle
