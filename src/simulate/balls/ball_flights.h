#pragma once

#include <array>
#include <vector>

#include "simulate/balls/ball_cells.h"
#include "simulate/balls/ball_world.h"

namespace cradle {

/// What a ball meets: another ball by its index >= 0, or an obstacle k as ~k.
constexpr int kNothing = std::numeric_limits<int>::min();

/// A contact of a ball with another ball or an obstacle.
struct BallContact {
  int ball = 0, other = kNothing;
  double gap = 0;              // m
  Vec3 normal = Vec3::Zero();  // unit, world, from the ball to the other
  Vec3 point = Vec3::Zero();   // m, world: middle between the two surfaces
};

/// The next contact of a ball, as long as neither it nor the other is struck before.
struct Meeting {
  double time = kNever;  // s
  int other = kNothing;
  long othersHits = 0;  // of the other, when this was foreseen
};

/// A ball's way out of its cell.
struct Crossing {
  double time = kNever;  // s
  int axis = 0, step = 0;
};

/// Balls in flight, each on a parabola of its own since it was last struck: clocks differ, so that what strikes one
/// costs nothing for the others and a ball's time since then stays short, with all its digits. Finds what they touch
/// and what they will.
class BallFlights {
 public:
  /// Keeps a reference to `world`. Times beyond `duration` (s) are of no interest.
  BallFlights(const BallWorld& world, double duration);

  /// The centre's motion as it goes on from `time` (s).
  UniformMotion motionAt(int ball, double time) const;

  /// A new parabola from `time` on; counts as a hit. `supports`: planes that carry the ball, -1 for none.
  void strike(int ball, double time, const UniformMotion& motion, const std::array<int, 3>& supports);
  long hits(int ball) const { return flights_[static_cast<std::size_t>(ball)].hits; }

  /// When a ball leaves its cell.
  Crossing nextCrossing(int ball, double now) const;

  /// The first contact of a ball after `now` (s), those with boxes only before it leaves its cell at `crossing` (s).
  /// Cost: the balls and boxes near its cell, and all planes.
  Meeting nextMeeting(int ball, double now, double crossing) const;

  /// Moves a ball to the next cell.
  void cross(int ball, const Crossing& crossing) { cells_.move(ball, crossing.axis, crossing.step); }

  /// The first contact with what came near by that; `next` (s) is when the ball leaves the new cell.
  Meeting nextMeetingAhead(int ball, const Crossing& crossing, double next) const;

  /// Sorts the balls into cells anew if their places now ask for cells of another size; then all that was foreseen is
  /// void. O(balls).
  bool renewCells(double now);

  /// Makes `origin` (s) the new time 0.
  void shiftTime(double origin);

  /// Whether a meeting still comes about as foreseen.
  bool holds(const Meeting& meeting) const;

  /// Appends all contacts of a ball at `now`.
  void appendTouching(int ball, double now, std::vector<BallContact>& contacts) const;
  BallContact contactOf(int ball, int other, double now) const;

 private:
  struct Flight {
    UniformMotion motion;
    double since = 0;  // s: the motion's time 0
    long hits = 0;
    std::array<int, 3> supports = {-1, -1, -1};
  };
  void meetBall(const UniformMotion& motion, int ball, int other, double now, Meeting& best) const;
  void meetBoxes(const UniformMotion& motion, int ball, double now, double until, Meeting& best) const;
  BallCells cellsAt(double now) const;
  void meetPlanes(const UniformMotion& motion, int ball, double now, Meeting& best) const;
  double radiusOf(int ball) const { return world_.radii[static_cast<std::size_t>(ball)]; }
  Vec3 positionAt(int ball, double time) const {
    const Flight& flight = flights_[static_cast<std::size_t>(ball)];
    return flight.motion.positionAfter(time - flight.since);
  }
  double touchingGap(int ball, int other) const;

  const BallWorld& world_;
  double duration_;  // s: the end, on the clock of now
  std::vector<Flight> flights_;
  double largestRadius_;  // m
  BallCells cells_;
};

}  // namespace cradle
