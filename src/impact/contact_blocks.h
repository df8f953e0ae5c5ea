#pragma once

#include <cstdint>
#include <vector>

#include "collision/persistent_manifold.h"
#include "impact/lanes.h"

// Contacts as the soft contact solver works on them: two at a time, one a lane, everything it needs side by side.
// Angular velocities are scaled: u = sqrt(I) w in a body's principal axes, so that an impulse p along n at arm r
// changes u by p t and the contact's speed is t.u, with the same t = (r x n) / sqrt(I) (the usual way needs two
// vectors).

namespace cradle {

/// A moving body as the solver sees it.
struct SolverBody {
  double inverseMass;    // 1/kg
  Mat3 scaledFromWorld;  // 1/sqrt(kg) / m: of angular impulses
  Mat3 worldFromBody;
};

/// How a contact yields: as a damped spring that stiffens with the overlap.
struct Softness {
  double turn;       // rad: of the spring's oscillation, in a sub-step
  double damping;    // twice the damping ratio
  double hardening;  // 1/m: an overlap s raises the frequency 1 + x + x^2 + x^3 times, x = hardening s
  double mostPush;   // m/s, apart
};

/// The relative speed along the normal (m/s, apart) over the contact plane, linear in the place.
struct PlaneSpeeds {
  Lanes middle;          // m/s: in the middle of the points
  Lanes slopeU, slopeV;  // 1/s: along the tangents

  Lanes at(Lanes u, Lanes v) const { return middle + u * slopeU + v * slopeV; }
};

/// A symmetric matrix: the impulse (N s, N m s) that changes the speeds over the contact plane.
struct PlaneInertia {
  Lanes xx, xy, xz, yy, yz, zz;  // kg, kg m, kg m^2
};

template <int pointCount, bool bothMove>
struct ContactBlock {
  static constexpr int kPoints = pointCount;
  static constexpr bool kBothMove = bothMove;
  static constexpr int kMovers = bothMove ? 2 : 1;

  struct Point {
    Lanes u, v;  // m, from the middle of the points along the tangents
    Lanes mass, separation, impulse;
    Lanes total;  // N s: impulses of all sub-steps
    Lanes slack;  // m/s: closing speed that is left until the next sub-step
  };
  struct Plane {
    LaneVector turns[kMovers];  // of A and B, by an impulse in the middle of the points
    LaneVector slopeTurns[2][kMovers];
    PlaneInertia inertia;
  };
  struct Friction {
    LaneVector tangents[2];
    LaneVector turns[2][kMovers];
    Lanes mass11, mass12, mass22, impulses[2], totals[2], coefficient;
  };
  struct Twist {
    LaneVector turns[kMovers];
    Lanes mass, impulse, total;
    Lanes levers[kPoints];  // m, of the points about the middle
  };

  std::int32_t bodies[kMovers][kLanes];
  std::int32_t manifolds[kLanes];  // -1: nothing in this lane
  LaneVector normal;
  Lanes inverseMasses[kMovers];
  Lanes restitution;
  Point points[kPoints];
  Plane plane;
  Friction friction;
  Twist twist;
  Lanes struck, rubbed;  // J: what all took, as impacts and as friction of lasting contacts
};

/// Bodies' motions while a step is solved. The last entry of each stands still, for lanes without a contact.
struct SolverMotions {
  std::vector<BodyMotion> velocities;     // m/s, scaled rad/s
  std::vector<BodyMotion> displacements;  // m, scaled rad: since the step began
  std::vector<BodyMotion> starts;         // velocities before the step
  std::vector<BodyMotion> fallen;         // velocities before contacts push in a sub-step
  enum class Pull : char { none, gravity, asleep };
  std::vector<Pull> pulls;  // what moves a body beside contacts; those asleep are not moved by them either

  void resize(std::size_t bodies) {
    for (auto* motions : {&velocities, &displacements, &starts, &fallen}) motions->resize(bodies + 1);
    pulls.assign(bodies, Pull::gravity);
  }
};

}  // namespace cradle
