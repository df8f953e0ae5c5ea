#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/error.h"
#include "scene/text_place.h"

namespace cradle {

/// Everything that is wrong with a scene file, so that its writer hears of it in one go.
class FaultList {
 public:
  explicit FaultList(std::string file) : file_(std::move(file)) {}

  /// `what` reads "what was found; what is allowed; hint"; `pointer` is a JSON pointer, empty for the whole text.
  void add(const TextPlace& place, const std::string& pointer, const std::string& what);

  /// All faults, those that are counted but no longer kept included.
  std::size_t count() const { return count_; }
  /// True if further faults are only counted: their texts need not be thought out.
  bool isFull() const;

  /// "FILE:LINE:COLUMN /json/pointer"
  std::string where(const TextPlace& place, const std::string& pointer) const;

  /// Throws one Error with a line for each fault in the order of the file, and how many more there were.
  void throwIfAny(ErrorKind kind) const;

 private:
  struct Fault {
    TextPlace place;
    std::string line;
  };
  std::string file_;
  std::vector<Fault> faults_;
  std::size_t count_ = 0;
};

/// `text` in double quotes for a message: control characters and bytes that are no UTF-8 escaped, the end of a long one
/// cut off.
std::string inQuotes(const std::string& text);

}  // namespace cradle
