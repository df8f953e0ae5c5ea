#pragma once

#include <vector>

namespace cradle {

/// The earliest of one time for each of n parts; of equal times that of the smallest index. A tournament: each node of
/// a binary tree holds the winner of the two below it.
class EventQueue {
 public:
  /// All times are infinite.
  explicit EventQueue(int parts);

  /// O(log n).
  void set(int part, double time);

  int first() const { return winners_[1]; }
  double firstTime() const { return times_[static_cast<std::size_t>(first())]; }

 private:
  std::size_t leaves_ = 1;     // a power of two
  std::vector<double> times_;  // s, by leaf; infinite beyond the parts
  std::vector<int> winners_;   // by node; the root is 1, the children of k are 2 k and 2 k + 1
};

}  // namespace cradle
