#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/error.h"
#include "scene/text_place.h"

namespace cradle {

/// What is wrong with a scene file, so that its writer hears of it in one go; of a file of millions of faults the first
/// thousand. And its warnings: what is allowed, and may not be what its writer means.
class FaultList {
 public:
  /// `kind` is that of the Error.
  FaultList(std::string file, ErrorKind kind) : file_(std::move(file)), kind_(kind) {}

  /// `what` reads "what was found; what is allowed; hint"; `pointer` is a JSON pointer, empty for the whole text.
  /// Returns its number. Throws, as throwIfAny does, if there are more than anyone counts.
  std::size_t add(const TextPlace& place, const std::string& pointer, const std::string& what);
  /// Puts a fault that tells more of the same mistake in the place of another.
  void replace(std::size_t number, const TextPlace& place, const std::string& pointer, const std::string& what);

  /// `what` reads as that of a fault.
  void warn(const TextPlace& place, const std::string& pointer, const std::string& what);
  /// Each with its place, in the order in which they came.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// All faults, those that are counted but no longer kept included.
  std::size_t count() const { return count_; }
  /// True if further faults are only counted: their texts need not be thought out.
  bool isFull() const;

  /// "FILE:LINE:COLUMN /json/pointer"
  std::string where(const TextPlace& place, const std::string& pointer) const;

  /// Throws one Error with a line for each fault in the order of the file, and how many more there were.
  void throwIfAny() const;

 private:
  struct Fault {
    TextPlace place;
    std::string line;
  };
  Fault faultOf(const TextPlace& place, const std::string& pointer, const std::string& what) const;

  std::string file_;
  ErrorKind kind_;
  std::vector<Fault> faults_;
  std::vector<std::string> warnings_;
  std::size_t count_ = 0;
};

/// `text` in double quotes for a message: control characters and bytes that are no UTF-8 escaped, the end of a long one
/// cut off.
std::string inQuotes(const std::string& text);

}  // namespace cradle
