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

FaultList::Fault FaultList::faultOf(const TextPlace& place, const std::string& pointer, const std::string& what) const {
  return {place, where(place, pointer) + ": " + printableLine(what, kLongestWhat)};
}

std::size_t FaultList::add(const TextPlace& place, const std::string& pointer, const std::string& what) {
  if (!isFull()) faults_.push_back(faultOf(place, pointer, what));
  if (++count_ == kMaxCounted) throwIfAny();
  return count_ - 1;
}

void FaultList::replace(std::size_t number, const TextPlace& place, const std::string& pointer,
                        const std::string& what) {
  if (number < faults_.size()) faults_[number] = faultOf(place, pointer, what);
}

void FaultList::warn(const TextPlace& place, const std::string& pointer, const std::string& what) {
  warnings_.push_back(faultOf(place, pointer, what).line);
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
  std::vector<Fault> sorted = faults_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Fault& a, const Fault& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
  });
  std::string text;
  for (const Fault& fault : sorted) text += (text.empty() ? "" : "\n") + fault.line;
  if (count_ > sorted.size())
    text += fmt::format("\nand {}{} more", count_ == kMaxCounted ? "at least " : "", count_ - sorted.size());
  throw Error::ofLines(kind_, text);
}

std::string inQuotes(const std::string& text) {
  return '"' + printableLine(text, kLongestQuotation) + '"';
}

}  // namespace cradle
