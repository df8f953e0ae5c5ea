#pragma once

#include <vector>

#include "impact/soft_contacts.h"

namespace cradle {

/// Who of a heap lies still. A body falls asleep when it and all that it touches have been slow for a while, and is as
/// good as fixed then. What moves beside it wakes it, and what strikes it wakes as many of those around it as the blow
/// can move: one body that rolls over a heap leaves the rest asleep.
class SoftSleep {
 public:
  /// All are awake. `masses` in kg; `stillTime` (s): bodies fall asleep when they have been slow for so long.
  SoftSleep(std::vector<double> masses, double stillTime);

  /// Of each body: whether it is asleep, and for how long (s) it has been slow.
  struct Record {
    std::vector<char> isAsleep;
    std::vector<double> stillTimes;
  };
  Record record() const { return {isAsleep_, stillTimes_}; }
  void goOnFrom(const Record& record);

  bool isAsleep(std::size_t body) const { return isAsleep_[body] != 0; }
  std::size_t awake() const { return awake_; }

  /// Wakes sleepers that something restless touches in `contacts`, and appends them to `woken`. `slow` (m/s): the speed
  /// below which a body counts as still. O(active contacts), and O(pairs) if something wakes.
  void wakeTouched(const SoftContacts& contacts, const std::vector<MovingPose>& poses, double slow,
                   std::vector<int>& woken);

  /// Wakes a sleeper that begins to move by itself: it wakes what it touches.
  void wakeRestless(int body);

  /// A step of `timeStep` (s) has passed, at whose end the bodies have these speeds (m/s; infinite if it touches
  /// nothing). Appends those that fall asleep.
  void letSleep(const SoftContacts& contacts, const std::vector<double>& speeds, double slow, double timeStep,
                std::vector<int>& fallenAsleep);

 private:
  void wake(int body, std::vector<int>& woken);
  void wakeAround(int struck, double leastMass, std::vector<int>& woken);
  void listNeighbors(const SoftContacts& contacts);

  std::vector<double> masses_;      // kg
  double stillTime_;                // s
  std::vector<double> stillTimes_;  // s, for which each body has been slow
  std::vector<char> isAsleep_, hasMovingNeighbor_;
  std::size_t awake_;
  std::vector<int> neighbors_;               // in contact, of each body
  std::vector<std::size_t> firstNeighbors_;  // of each body in `neighbors_`, and the end
};

}  // namespace cradle
