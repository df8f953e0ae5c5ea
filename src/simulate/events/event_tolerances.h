#pragma once

#include <algorithm>
#include <cmath>

#include "simulate/island_state.h"

namespace cradle {

/// What the tolerances of an island at events are made from.
struct EventScales {
  double accuracy = 0;  // A, asked; m, where it is that of a place
  double duration = 0;  // T, s: of the run
  double size = 0;      // L, m: of the smallest body that may ever be in the island
  double gravity = 0;   // g, m/s^2
};
EventScales eventScalesOf(const IslandState& island);

/// The tolerances of the event-driven solver: what it takes to touch, to be still, to carry nothing or to be the same.
/// Those that scales decide are members and functions, with their formulas; the constants are relative. At a contact, l
/// is the size of the smaller body.
///
/// Where no formula gives a number, [a, b] is a window that was measured: with a or b in its place, and all others as
/// they are, the tests of the solver pass and a dozen scenes of contact keep their bits for a second. Behind it stands
/// what goes wrong farther out, if that was found.
struct EventTolerances {
  EventScales scales;

  // Gaps.

  // Nearer is touching: hardly more than rounding, whatever the accuracy, as a small gap and none may have entirely
  // different consequences. Visual accuracies take more together.
  static constexpr double kTouchRatio = 1e-11, kVisualTouchRatio = 1e-8;  // of L
  double touch = 0;                                                       // m

  // A contact without load may sink so far before that counts as a new impact. [1e-13, 1e-11]; with 0, runs crash, and
  // with 1e-10 a break of billiard balls has other bits.
  static constexpr double kDeadBandRatio = 1e-12;  // of L
  double deadBand = 0;                             // m

  // Contacts no farther apart may take part in a sequence of impacts, in which bodies move while normals stay as they
  // are: a tenth of the accuracy, but no more than these. Farther at visual accuracies, as events are counted there.
  static constexpr double kReachRatio = 0.1;                                   // of A
  static constexpr double kMaxReachRatio = 1e-8, kMaxVisualReachRatio = 1e-5;  // of L
  double reach = 0;                                                            // m

  // The gap that the pair of an event may seem to have: so well two ways to find a gap agree. [0, 1e-4]
  static constexpr double kClosingPairRatio = 1e-6;  // of L
  double closingPairGap = 0;                         // m

  // A step that ends at an impact is taken anew with another length if it leaves a larger gap. With 1, a fifth of
  // `touch` may be left; less is rounding.
  static constexpr double kClosedGapRatio = 1e-3;  // of `touch`
  double closedGap = 0;                            // m

  // A contact so far beyond the border of its face has left it. [0.05, 500]
  static constexpr double kLeavingRatio = 0.5;  // of `touch`
  double leaving = 0;                           // m

  // Beyond the dead band, a gap is one, unless the places around it, coordinates x, are rounded that coarsely. The gap
  // of a sphere is a difference of two lengths. Of L [4e-12, 4e-7], of spheres [0, 2e-12]; with 2e-8, gaps through
  // which bodies could be followed are none. Of x [4e-17, 4e-13].
  static constexpr double kGapRoundingRatio = 4e-12, kSphereGapRoundingRatio = 2e-13;  // of L
  static constexpr double kCoordinateRounding = 4e-15;                                 // of x
  double gapRounding(double x) const {                                                 // m
    return std::max(kGapRoundingRatio * scales.size, kCoordinateRounding * x);
  }
  double sphereGapRounding(double x) const {  // m
    return std::max(kSphereGapRoundingRatio * scales.size, kCoordinateRounding * x);
  }

  // Times its rounding: a smaller gap may be none, where it is measured.
  static constexpr double kHiddenGapRatio = 2;

  // So well gaps are known that grow in a sequence of impacts. [1e-12, 1e-3]; with 0, a sphere between a wall and a
  // heavy one does not have the number of impacts that it should.
  static constexpr double kGapGrowthError = 1e-9;  // of the distance by which the fastest contact closes meanwhile

  // Places and directions.

  // A contact so near to a rim, or to an edge, is at it. [1e-10, 1e-3]
  static constexpr double kSameCorner = 1e-6;  // of l

  // A contact so near to a corner, or to the end of a line, is there: nearer than what has left one is to it.
  static constexpr double kAtCorner = 0.2;  // of `leaving`

  // The contact after an event is that of before if it is so near, [1e-7, 1e-2], and this the cosine between normals.
  static constexpr double kSameContactPoint = 1e-4;    // of l
  static constexpr double kSameContactNormal = 0.999;  // 2.6 degrees

  // Moment arms about a joint, of l. Rows do not serve a contact with a shorter one: hinges of flaps are a thousandth
  // inside their edges. Where forces grow without bound, longer ones are why.
  static constexpr double kShortMomentArm = 3e-4, kUnboundedMomentArm = 3e-3;

  // Sliding that is no faster than ten times the error that steps allow a velocity tells no direction. m/s, of A.
  static constexpr double kSlowSlidingRatio = 1;
  double slowSliding = 0;

  // Instants.

  // To these a change of contacts is found: its instant on the interpolant of a step, [1e-14, 1e-9], and its event
  // function, [1e-14, 1e-8]. With 1e-7, or 1e-5, the release of a contact is not found where it is.
  static constexpr double kChangeInstant = 1e-11;  // of the step
  static constexpr double kEventFunction = 1e-12;  // of the contact's force, or m/s

  // A sequence of impacts may last while forces do not count: a body falls by half of r^2 L in r sqrt(L / a), a the
  // largest acceleration at its contacts, and r L is its reach. So long as r is this, it may last at any accuracy.
  // [1e-12, 1e-6]
  static constexpr double kMinSequenceRatio = 1e-9;
  double maxSequenceTime(double acceleration) const {  // s
    return std::max(kMinSequenceRatio, reach / scales.size) * std::sqrt(scales.size / acceleration);
  }

  // Of the time: two instants so near are one.
  static constexpr double kInstantRatio = 1e-15;

  // A gap that is this many times its error is known well enough for the instant at which it closes.
  static constexpr double kKnownGapRatio = 100;

  // So little time the last impacts of a collapse take. [1e-16, 1e-8]
  static constexpr double kCollapseRatio = 1e-12;  // of the time elapsed

  // Steps that are so short are given up: at once, or after some in a row, as nobody waits for so many. In runs that
  // are longer than kLongRun, steps are short that would be in this one.
  static constexpr double kShortTimeStepRatio = 1e-9;  // of T
  static constexpr double kLongRun = 1000;             // s
  double shortTimeStep = 0, shortestTimeStep = 0;      // s

  // Where a joint leaves a contact a short moment arm, forces are large, and their rounding alone may ask for steps of
  // this: of the time in which a size is fallen through, or of the run, if that is shorter. [1e-6, 1e-4]
  static constexpr double kSlowTimeStepRatio = 1e-5;
  double slowTimeStep = 0;  // s

  // Speeds.

  // Slower closing is rounding. [1e-14, 1e-9]; with 0 or 1e-4, rows of balls have other bits.
  static constexpr double kStandstillRatio = 1e-12;  // of the fastest body at an impact

  // A contact that opens faster takes no part in an impact. [1e-9, 1e-4]; with 0, rows of balls have other bits, and
  // with 1e-3 a contact that opens takes part.
  static constexpr double kTakesNoPartRatio = 1e-6;  // of the fastest closing

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

  // Over so little time the rate of accelerations is taken: of the time in which a size is fallen through, or of the
  // run, if that is shorter. Accelerations known to 1e-11 g give a rate to 1e-6 g / sqrt(L / g).
  static constexpr double kRateTimeRatio = 1e-5;
  double rateTime = 0;  // s

  // What is accelerated by less is still: it comes no farther than a twentieth of A in the whole run. That is no less
  // than what rounding leaves, [1e-14, 1e-8] of `largest`, and ten times, [1, 100], what a solution leaves, `residual`;
  // and no more than kStillRatio of `largest`. All are m/s^2.
  double stillAcceleration(double largest, double residual) const;
  static constexpr double kResidualFactor = 10;                        // of `residual`
  static constexpr double kMinStillRatio = 1e-11, kStillRatio = 1e-7;  // of `largest`

  // Bodies come to rest if forces leave them less, a part of gravity as of the speed above. m/s^2.
  double maxRestAcceleration(double residual) const {
    return std::min(restRatio * scales.gravity, stillAcceleration(scales.gravity, residual));
  }

  // Free accelerations that close contacts by less do not. [1e-16, 1e-11]
  static constexpr double kClosingRounding = 1e-14;  // of gravity

  // A contact whose force gives less carries nothing. Where another one is released, more is nothing: symmetric
  // contacts would otherwise be released one after the other. [0, 1e-3], [0, 0.1]
  static constexpr double kUnloadedRatio = 1e-9, kReleasedRatio = 1e-6;  // of the largest acceleration

  // What was idle carries more: so much that it does when it is classified anew.
  static constexpr double kLoadedRatio = 100 * kUnloadedRatio;

  // Forces that leave more do not keep contacts: more than at the classification, or a contact would fail at once.
  // [0, 0.01]
  static constexpr double kInfeasibleRatio = 10 * kStillRatio;  // of the largest acceleration

  // Less is none, and rows depend on each other. [0, 1e-4]; with 0.1, too many contacts at once are served.
  static constexpr double kRankRatio = 1e-9;  // of the largest pivot

  // States and constraints.

  // Anchors may be so far apart: at least this, [1e-12, 1e-6], for projection leaves 1e-15; a tenth of A, [1e-4, 0.1],
  // where motion could take two ways, which lasts a few steps.
  static constexpr double kMinConstraintError = 1e-9;   // m (a m of coordinates) or rad
  static constexpr double kConstraintErrorRatio = 0.1;  // of A
  double constraintError = 0;                           // m (a m of coordinates) or rad

  // A projection that moves a state less leaves its derivative, and |q|^2 of an orientation may be so far from 1 before
  // it is made 1. Factors of 100 and 1000, of 1e-4 and 1e4, change last bits of runs, but no test.
  static constexpr double kStateRounding = 1e-14;  // of a state
  static constexpr double kUnitLength = 1e-9;

  // Orientations of bodies that rotate farther in the run have a part of the tolerance of steps, as errors add up.
  static constexpr double kLargeRotation = 100;  // rad
  static constexpr double kTurningRatio = 0.1;   // of the tolerance
};

/// The tolerances of an island.
EventTolerances eventTolerancesOf(const EventScales& scales);

}  // namespace cradle
