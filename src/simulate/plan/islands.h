#pragma once

#include <vector>

namespace cradle {

/// Bodies that depend on each other, found by joining them two by two. Fixed bodies join nothing.
class Islands {
 public:
  explicit Islands(std::size_t bodies);

  /// Either may be kFixed.
  void join(int bodyA, int bodyB);

  /// The first body of a body's island: the same for all that are joined.
  int islandOf(int body) const;

 private:
  std::vector<int> parents_;  // each at most its own index
};

}  // namespace cradle
