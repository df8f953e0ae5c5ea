#pragma once

#include <algorithm>
#include <cmath>

#include "simulate/island_state.h"

namespace cradle {

/// What the tolerances of an island at events are made from.
struct EventScales {
  double accuracy = 0;  // A, asked; m, where it is that of a place
  double duration = 0;  // T, s: of the run
  double size = 0;      // L, m: of the smallest body
  double gravity = 0;   // g, m/s^2
};
EventScales eventScalesOf(const IslandState& island);

/// The tolerances of the event-driven solver: what it takes to touch, to be still, to carry nothing or to be the same.
/// Those that scales decide are members and functions, with their formulas; the constants are relative. At a contact, l
/// is the size of the smaller body.
struct EventTolerances {
  EventScales scales;

  // Gaps.

  // Nearer is touching: hardly more than rounding, whatever the accuracy, as a small gap and none may have entirely
  // different consequences. Visual accuracies take more together.
  static constexpr double kTouchRatio = 1e-11, kVisualTouchRatio = 1e-8;  // of L
  double touch = 0;                                                       // m

  // A contact without load may sink so far before that counts as a new impact.
  static constexpr double kDeadBandRatio = 1e-12;  // of L
  double deadBand = 0;                             // m

  // Contacts no farther apart may take part in a sequence of impacts, in which bodies move while normals stay as they
  // are: a tenth of the accuracy, but no more than these. Farther at visual accuracies, as events are counted there.
  static constexpr double kReachRatio = 0.1;                                   // of A
  static constexpr double kMaxReachRatio = 1e-8, kMaxVisualReachRatio = 1e-5;  // of L
  double reach = 0;                                                            // m

  // The gap that the pair of an event may seem to have: so well two ways to find a gap agree.
  static constexpr double kClosingPairRatio = 1e-6;  // of L
  double closingPairGap = 0;                         // m

  // A step that ends at an impact is taken anew with another length if it leaves a larger gap.
  static constexpr double kClosedGapRatio = 1e-3;  // of `touch`
  double closedGap = 0;                            // m

  // A contact so far beyond the border of its face has left it.
  static constexpr double kLeavingRatio = 0.5;  // of `touch`
  double leaving = 0;                           // m

  // Beyond the dead band, a gap is one, unless the places around it, coordinates x, are rounded that coarsely. The gap
  // of a sphere is a difference of two lengths.
  static constexpr double kGapRoundingRatio = 4e-12, kSphereGapRoundingRatio = 2e-13;  // of L
  static constexpr double kCoordinateRounding = 4e-15;                                 // of x
  double gapRounding(double x) const {                                                 // m
    return std::max(kGapRoundingRatio * scales.size, kCoordinateRounding * x);
  }
  double sphereGapRounding(double x) const {  // m
    return std::max(kSphereGapRoundingRatio * scales.size, kCoordinateRounding * x);
  }
  static constexpr double kGapGrowthError = 1e-9;  // of the distance by which the fastest contact closes meanwhile

  // Places and directions.

  static constexpr double kSameCorner = 1e-6;          // of l: a contact so near to a corner is at it
  static constexpr double kSameContactPoint = 1e-4;    // of l: the contact after an event is that of before ...
  static constexpr double kSameContactNormal = 0.999;  // ... if it is so near, and this the cosine between the normals

  // Moment arms about a joint, of l. Rows do not serve a contact with a shorter one: hinges of flaps are a thousandth
  // inside their edges. Where forces grow without bound, longer ones are why.
  static constexpr double kShortMomentArm = 3e-4, kUnboundedMomentArm = 3e-3;

  // Instants.

  // To these a change of contacts is found: its instant on the interpolant of a step, and its event function.
  static constexpr double kChangeInstant = 1e-11;  // of the step
  static constexpr double kEventFunction = 1e-12;  // of the contact's force, or m/s

  // A sequence of impacts may last while forces do not count: a body falls by half of r^2 L in r sqrt(L / a), a the
  // largest acceleration at its contacts, and r L is its reach. So long as r is this, it may last at any accuracy.
  static constexpr double kMinSequenceRatio = 1e-9;
  double maxSequenceTime(double acceleration) const {  // s
    return std::max(kMinSequenceRatio, reach / scales.size) * std::sqrt(scales.size / acceleration);
  }
  static constexpr double kCollapseRatio = 1e-12;  // of the time elapsed: so little the impacts of a collapse take

  // Steps that are so short are given up: at once, or after some in a row, as nobody waits for so many. In runs that
  // are longer than kLongRun, steps are short that would be in this one.
  static constexpr double kShortTimeStepRatio = 1e-9;  // of T
  static constexpr double kLongRun = 1000;             // s
  double shortTimeStep = 0, shortestTimeStep = 0;      // s

  // Speeds.

  static constexpr double kStandstillRatio = 1e-12;  // of the fastest at an impact: slower closing is rounding
  static constexpr double kTakesNoPartRatio = 1e-6;  // of the fastest closing: a contact that opens faster is no part

  // A contact that opens more slowly does not open: it would rise by 5e-15 l.
  static constexpr double kOpeningRatio = 1e-7;  // of sqrt(g l)
  double minOpeningSpeed(double l) const;        // m/s

  // A slower rebound is left out, with all that would follow it. With a the acceleration of closing it is as high as
  // 5e-5 A^2 l, or 5e3 A^4 l, if that is more: 5e-5 l at the coarsest accuracy. 5e-15 l are left out at any.
  static constexpr double kBounceOfAccuracy = 1e-2, kBounceOfSquare = 100;  // of A and A^2, of sqrt(a l)
  double reboundRatio = 0;                                                  // of sqrt(a l)
  double minReboundSpeed(double acceleration, double l) const {             // m/s
    return reboundRatio * std::sqrt(acceleration * l);
  }

  // A body of the size l, or a contact that opens, is still below this.
  static constexpr double kMaxRestRatio = 1e-7;  // of sqrt(g l), unless A is less
  double restRatio = 0;                          // of sqrt(g l)
  double maxRestSpeed(double l) const;           // m/s

  // Below T sqrt(mu g A) / 20 errors of velocities, which turn the friction mu g (m/s^2), cost the way more than A
  // (slow_sliding.cpp). m/s.
  double minSlidingSpeed(double friction) const { return scales.duration * std::sqrt(friction * scales.accuracy) / 20; }

  // Accelerations.

  // A contact that starts to slide with less creeps (slow_sliding.cpp).
  static constexpr double kCreepRatio = 0.02;            // of mu g
  static constexpr double kCreepOfAccuracy = 50;         // 1/(m s^2), of mu g T^2 A: the same at fine accuracies
  double minSlidingAcceleration(double friction) const;  // m/s^2

  // What is accelerated by less is still: it comes no farther than a twentieth of A in the whole run. But rounding and
  // the solution of `residual` (m/s^2) leave as much of accelerations as large as `largest`, too. m/s^2.
  double stillAcceleration(double largest, double residual) const;
  static constexpr double kResidualFactor = 10;                        // of `residual`
  static constexpr double kMinStillRatio = 1e-11, kStillRatio = 1e-7;  // of `largest`

  // Bodies come to rest if forces leave them less, a part of gravity as of the speed above. m/s^2.
  double maxRestAcceleration(double residual) const {
    return std::min(restRatio * scales.gravity, stillAcceleration(scales.gravity, residual));
  }

  // Free accelerations that close contacts by less do not.
  static constexpr double kClosingRounding = 1e-14;  // of gravity

  // A contact whose force gives less carries nothing. Where another one is released, more is nothing: symmetric
  // contacts would otherwise be released one after the other.
  static constexpr double kUnloadedRatio = 1e-9, kReleasedRatio = 1e-6;  // of the largest acceleration

  // Forces that leave more do not keep contacts. They leave more than at the classification, or a contact would fail at
  // once.
  static constexpr double kInfeasibleRatio = 10 * kStillRatio;  // of the largest acceleration

  static constexpr double kFrictionConverged = 1e-10;  // of the largest normal force: friction fits the normal forces
  static constexpr double kRankRatio = 1e-9;           // of the largest pivot: less is none, and rows are dependent

  // States and constraints.

  // Anchors may be so far apart: at least this, for projection leaves 1e-15; a tenth of A where motion could take two
  // ways, which lasts a few steps.
  static constexpr double kMinConstraintError = 1e-9;   // m (a m of coordinates) or rad
  static constexpr double kConstraintErrorRatio = 0.1;  // of A
  double constraintError = 0;                           // m (a m of coordinates) or rad

  static constexpr double kStateRounding = 1e-14;  // of a state: projection that moves it less leaves its derivative
  static constexpr double kUnitLength = 1e-9;      // |q|^2 of an orientation may be so far from 1 before it is made 1

  // Orientations of bodies that rotate farther in the run have a part of the tolerance of steps, as errors add up.
  static constexpr double kLargeRotation = 100;  // rad
  static constexpr double kTurningRatio = 0.1;   // of the tolerance
};

/// The tolerances of an island.
EventTolerances eventTolerancesOf(const EventScales& scales);

}  // namespace cradle
