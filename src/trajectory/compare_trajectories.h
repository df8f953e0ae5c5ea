#pragma once

#include <string>
#include <vector>

#include "trajectory/trajectory_file.h"

namespace cradle {

/// The largest difference of each kind that a body shows over all common frames: |x - x_ref| / (1 + |x_ref|) for each
/// number x in SI units. q and -q are the same orientation.
struct BodyDifference {
  std::string body;
  double position = 0, orientation = 0, linearVelocity = 0, angularVelocity = 0;

  double largest() const;
};

/// How far `actual` is from `expected`; the name of the body is left empty.
BodyDifference differenceOf(const BodyState& actual, const BodyState& expected);

/// Where the largest difference of all is.
struct WorstDifference {
  std::string body, quantity;  // quantity: position, orientation, linear velocity, angular velocity
  long frame = 0;              // of the expected trajectory
  double time = 0;             // s
  double difference = 0;
};

/// What a comparison of two trajectories found.
struct TrajectoryComparison {
  bool equal = false;
  bool sameStateHash = false;  // equal bit by bit; then nothing below but the tolerance is filled in
  double tolerance = 0;
  long expectedFrames = 0, actualFrames = 0, commonFrames = 0;
  std::vector<BodyDifference> bodies;                 // dynamic in both, in the expected order
  std::vector<std::string> onlyExpected, onlyActual;  // names of bodies that are dynamic in one alone
  WorstDifference worst;

  /// The result in a few lines for a person, without a newline at the end.
  std::string describe() const;
};

/// Compares `actual` with `expected`: equal if the state hashes are, or if both have the same dynamic bodies (by name),
/// frames in common (the same time), and no difference above `tolerance` (>= 0) in them. O(frames x bodies).
TrajectoryComparison compareTrajectories(const TrajectoryReader& expected, const TrajectoryReader& actual,
                                         double tolerance);

}  // namespace cradle
