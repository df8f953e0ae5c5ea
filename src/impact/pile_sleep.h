#pragma once

#include <vector>

#include "impact/pile_contacts.h"

namespace cradle {

/// Who of a pile lies still. A body falls asleep when it and all that it touches have been slow for a while, and is as
/// good as fixed then. What moves beside it wakes it, and what strikes it wakes as many of those around it as the blow
/// can move: one body that rolls over a pile leaves the rest asleep.
class PileSleep {
 public:
  /// All are awake. `masses` in kg.
  explicit PileSleep(std::vector<double> masses);

  bool isAsleep(std::size_t body) const { return isAsleep_[body] != 0; }
  std::size_t awake() const { return awake_; }

  /// Wakes sleepers that something restless touches in `contacts`, and appends them to `woken`. `slow` (m/s): the speed
  /// below which a body counts as still. O(active contacts), and O(pairs) if something wakes.
  void wakeTouched(const PileContacts& contacts, const std::vector<MovingPose>& poses, double slow,
                   std::vector<int>& woken);

  /// A step of `timeStep` (s) has passed, at whose end the bodies have these speeds (m/s; infinite if it touches
  /// nothing). Appends those that fall asleep.
  void letSleep(const PileContacts& contacts, const std::vector<double>& speeds, double slow, double timeStep,
                std::vector<int>& fallenAsleep);

 private:
  void wake(int body, std::vector<int>& woken);
  void wakeAround(int struck, double leastMass, std::vector<int>& woken);
  void listNeighbors(const PileContacts& contacts);

  std::vector<double> masses_;     // kg
  std::vector<double> calmTimes_;  // s, for which each body has been slow
  std::vector<char> isAsleep_, hasRestlessNeighbor_;
  std::size_t awake_;
  std::vector<int> neighbors_;               // in contact, of each body
  std::vector<std::size_t> firstNeighbors_;  // of each body in `neighbors_`, and the end
};

}  // namespace cradle
