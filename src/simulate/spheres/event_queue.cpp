#include "simulate/spheres/event_queue.h"

#include <limits>

namespace cradle {

EventQueue::EventQueue(int parts) {
  while (leaves_ < static_cast<std::size_t>(parts) || leaves_ < 2) leaves_ *= 2;
  times_.assign(leaves_, std::numeric_limits<double>::infinity());
  winners_.resize(2 * leaves_);
  for (std::size_t leaf = 0; leaf < leaves_; ++leaf) winners_[leaves_ + leaf] = static_cast<int>(leaf);
  for (std::size_t node = leaves_ - 1; node > 0; --node) winners_[node] = winners_[2 * node];
}

void EventQueue::set(int part, double time) {
  times_[static_cast<std::size_t>(part)] = time;
  for (std::size_t node = (leaves_ + static_cast<std::size_t>(part)) / 2; node > 0; node /= 2) {
    const int left = winners_[2 * node], right = winners_[2 * node + 1];
    winners_[node] = times_[static_cast<std::size_t>(right)] < times_[static_cast<std::size_t>(left)] ? right : left;
  }
}

}  // namespace cradle
