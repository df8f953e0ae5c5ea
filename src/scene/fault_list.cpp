#include "scene/fault_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "core/printable.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxFaults = 50;         // more than anyone reads at once
constexpr std::size_t kMaxCounted = 1000;      // a file with as many is not read to its end
constexpr std::size_t kLongestQuotation = 60;  // bytes of the user's text in a message
constexpr std::size_t kLongestWhat = 10'000;   // bytes
constexpr std::size_t kLongestPointer = 200;   // bytes

}  // namespace

std::string FaultList::lineOf(const TextFault& fault) const {
  return where(fault.place, fault.pointer) + ": " + printableLine(fault.what, kLongestWhat);
}

std::size_t FaultList::add(const TextPlace& place, const std::string& pointer, const std::string& what) {
  if (!isFull()) faults_.push_back({place, pointer, what});
  if (++count_ == kMaxCounted) throwIfAny();
  return count_ - 1;
}

void FaultList::replace(std::size_t number, const TextPlace& place, const std::string& pointer,
                        const std::string& what) {
  if (number < faults_.size()) faults_[number] = {place, pointer, what};
}

void FaultList::warn(const TextPlace& place, const std::string& pointer, const std::string& what) {
  warnings_.push_back(lineOf({place, pointer, what}));
}

bool FaultList::isFull() const {
  return faults_.size() == kMaxFaults;
}

std::string FaultList::where(const TextPlace& place, const std::string& pointer) const {
  const std::string position = fmt::format("{}:{}:{}", printableLine(file_), place.line, place.column);
  return pointer.empty() ? position : position + " " + printableLine(pointer, kLongestPointer);
}

void FaultList::throwIfAny() const {
  if (count_ == 0) return;
  std::vector<TextFault> sorted = faults_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const TextFault& a, const TextFault& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
  });
  std::string text;
  for (const TextFault& fault : sorted) {
    if (!text.empty()) text += '\n';
    text += lineOf(fault);
  }
  if (count_ > sorted.size())
    text += fmt::format("\nand {}{} more", count_ == kMaxCounted ? "at least " : "", count_ - sorted.size());
  throw TextError(Error::ofLines(kind_, text), std::move(sorted));
}

std::string inQuotes(const std::string& text) {
  return '"' + printableLine(text, kLongestQuotation) + '"';
}

}  // namespace cradle
