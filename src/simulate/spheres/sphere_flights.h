#pragma once

#include <array>
#include <vector>

#include "simulate/spheres/sphere_cells.h"
#include "simulate/spheres/sphere_world.h"

namespace cradle {

/// What a sphere collides with: another sphere by its index >= 0, or an obstacle k as ~k.
constexpr int kNoPartner = std::numeric_limits<int>::min();

/// A contact of a sphere with another sphere or an obstacle.
struct SphereContact {
  int sphere = 0, other = kNoPartner;
  double gap = 0;              // m
  Vec3 normal = Vec3::Zero();  // unit, world, from the sphere to the other
  Vec3 point = Vec3::Zero();   // m, world: middle between the two surfaces
};

/// The next contact of a sphere, as long as neither it nor the other is struck before.
struct PredictedCollision {
  double time = kNever;  // s
  int other = kNoPartner;
  long othersHits = 0;  // of the other, when this was predicted
};

/// A sphere's way out of its cell.
struct CellCrossing {
  double time = kNever;  // s
  int axis = 0, step = 0;
};

/// Spheres in flight, each on a parabola of its own since it was last struck: clocks differ, so that what strikes one
/// costs nothing for the others and a sphere's time since then stays short, with all its digits. Finds what they touch
/// and what they will.
class SphereFlights {
 public:
  /// Keeps a reference to `world`. Times beyond `duration` (s) are of no interest.
  SphereFlights(const SphereWorld& world, double duration);

  /// How each sphere moves, and what carries it, since it was last struck.
  struct Record {
    UniformMotion motion;
    double since = 0;  // s: the motion's time 0
    std::array<int, 3> supports = {-1, -1, -1};
  };
  std::vector<Record> record() const;

  /// Goes on from a record at `now` (s), before anything is predicted; `duration` (s) is on the same clock.
  void goOnFrom(const std::vector<Record>& records, double now, double duration);

  /// The centre's motion as it goes on from `time` (s).
  UniformMotion motionAt(int sphere, double time) const;

  /// A new parabola from `time` on; counts as a hit. `supports`: planes that carry the sphere, -1 for none.
  void strike(int sphere, double time, const UniformMotion& motion, const std::array<int, 3>& supports);
  /// The planes that carry a sphere, -1 for none.
  const std::array<int, 3>& supports(int sphere) const { return flights_[static_cast<std::size_t>(sphere)].supports; }
  long hits(int sphere) const { return flights_[static_cast<std::size_t>(sphere)].hits; }

  /// When a sphere leaves its cell.
  CellCrossing nextCrossing(int sphere, double now) const;

  /// The first contact of a sphere after `now` (s), those with boxes only before it leaves its cell at `crossing` (s).
  /// Cost: the spheres and boxes near its cell, and all planes.
  PredictedCollision nextCollision(int sphere, double now, double crossing) const;

  /// Moves a sphere to the next cell.
  void cross(int sphere, const CellCrossing& crossing) { cells_.move(sphere, crossing.axis, crossing.step); }

  /// The first contact with what came near by that; `next` (s) is when the sphere leaves the new cell.
  PredictedCollision nextCollisionAhead(int sphere, const CellCrossing& crossing, double next) const;

  /// Sorts the spheres into cells anew if their places now ask for cells of another size; then all that was predicted
  /// is void. O(spheres).
  bool renewCells(double now);

  /// Makes `origin` (s) the new time 0.
  void shiftTime(double origin);

  /// Whether a collision still comes about as predicted: its partner has not been struck since.
  bool holds(const PredictedCollision& collision) const;

  /// Appends all contacts of a sphere at `now`.
  void appendTouching(int sphere, double now, std::vector<SphereContact>& contacts) const;
  SphereContact contactOf(int sphere, int other, double now) const;

 private:
  struct Flight : Record {
    long hits = 0;
  };
  void predictAgainstSphere(const UniformMotion& motion, int sphere, int other, double now,
                            PredictedCollision& best) const;
  void predictAgainstBoxes(const UniformMotion& motion, int sphere, double now, double until,
                           PredictedCollision& best) const;
  SphereCells cellsAt(double now) const;
  void predictAgainstPlanes(const UniformMotion& motion, int sphere, double now, PredictedCollision& best) const;
  double radiusOf(int sphere) const { return world_.radii[static_cast<std::size_t>(sphere)]; }
  Vec3 positionAt(int sphere, double time) const {
    const Flight& flight = flights_[static_cast<std::size_t>(sphere)];
    return flight.motion.positionAfter(time - flight.since);
  }
  double touchingGap(int sphere, int other) const;

  const SphereWorld& world_;
  double duration_;  // s: the end, on the clock of now
  std::vector<Flight> flights_;
  double largestRadius_;  // m
  SphereCells cells_;
};

}  // namespace cradle
