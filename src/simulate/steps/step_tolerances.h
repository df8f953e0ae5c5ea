#pragma once

#include <algorithm>
#include <cmath>

#include "simulate/assembly.h"

namespace cradle {

/// What the tolerances of contact stepping are made from.
struct StepScales {
  double size = 0;     // L, m: of the smallest body
  double gravity = 0;  // g, m/s^2
};
StepScales stepScalesOf(const Assembly& assembly);

/// The tolerances of contact stepping, and of the rest of bodies under it. They do not depend on the accuracy, as steps
/// promise none. Those that scales decide are members and functions, with their formulas; the constants are relative.
/// h (s) is the length of a step, g h the speed that gravity gives in it; l (m) the size of the smaller body at a
/// contact, or of a body. Windows [a, b] were measured as those of EventTolerances.
struct StepTolerances {
  StepScales scales;

  // Gaps.

  static constexpr double kStepTouchRatio = 1e-9;  // of L
  double touch = 0;                                // m: nearer is touching

  static constexpr double kOverlapRatio = 1e-9;  // of L
  double overlap = 0;                            // m: deeper overlaps are taken out, as others are rounding

  static constexpr double kSupportRatio = 1e-6;  // of L
  double support = 0;                            // m: so far a point may hover and still carry a body at rest

  // Contacts that are farther apart take no part in an impact or rest.
  double margin() const { return std::max(touch, support); }  // m

  // Overlaps at the end of a step that are shallower are left to the next one. [1e-3, 0.9]
  static constexpr double kLetBeRatio = 0.1;               // of the margin
  double letBe() const { return kLetBeRatio * margin(); }  // m

  // So well overlaps are taken out, of which the deepest is this one. [1e-3, 0.1]; a hundredth or a hundred times as
  // much of the deepest change last bits of a stack, but no test.
  static constexpr double kSeparatedRatio = 0.1;   // of `overlap` ...
  static constexpr double kSeparatedError = 1e-3;  // ... or of the deepest
  double separationError(double deepest) const {   // m
    return std::max(kSeparatedRatio * overlap, kSeparatedError * deepest);
  }

  // The gap that is left where a step ends at an impact. [1e-6, 1]
  static constexpr double kClosedGapRatio = 1e-3;  // of `touch`
  double closedGap = 0;                            // m

  // Of a step: touches that come and go within less are passed over. A search for shorter ones takes up to nine tenths
  // of the time of rims that roll over edges, and finds none in 40 scenes of such.
  static constexpr double kFinestTouch = 1.0 / 16;

  // Contacts that touch within this part of a step touch at one instant. `fastest`: of their closing speeds, m/s.
  static constexpr double kTogetherRatio = 1e-3;            // of h
  double simultaneousGap(double fastest, double h) const {  // m
    return std::max(touch, kTogetherRatio * fastest * h);
  }

  // A contact between the sides of two capsules is followed through a step in which they move farther along each other:
  // over a shorter way, errors of gaps hide accelerations. [100, 1e7]
  static constexpr double kSeenWayRatio = 1e5;                       // of `overlap`
  double minFollowedWay() const { return kSeenWayRatio * overlap; }  // m

  // Shorter moment arms about a joint leave hardly any rotation, [3e-4, 0.03], and contacts there may overlap by so
  // much, [1e-9, 1e-4].
  static constexpr double kLooseMomentArm = 3e-3, kLoosened = 1e-6;  // of l

  // Directions.

  // Normals that rotate farther in half a step are another contact's. [0.89, 0.99]
  static constexpr double kSameFeature = 0.99;  // cosine

  // Planes whose normals are as near hinder the same motions. [1e-16, 1e-6]
  static constexpr double kParallelNormals = 1e-12;  // sine

  // Speeds (m/s). Slower does not close, [1e-9, 1e-6], with 1e-4 a stack has other bits; slower is no impact; a step
  // does not end at a slower impact inside it: with 0.01 or 1, a stack has other bits, but no test fails.

  static constexpr double kMinClosingRatio = 1e-6;    // of g h
  static constexpr double kMinImpactRatio = 0.01;     // of g h
  static constexpr double kMinNextImpactRatio = 0.1;  // of g h
  double minClosingSpeed(double h) const { return speedOf(kMinClosingRatio, h); }
  double minImpactSpeed(double h) const { return speedOf(kMinImpactRatio, h); }
  double minNextImpactSpeed(double h) const { return speedOf(kMinNextImpactRatio, h); }

  // A contact that closes more slowly does not rebound: its rebound would end within kRestSteps steps, in each of which
  // forces add `pressing` to the closing speed.
  static constexpr double kRestSteps = 2;
  double maxRestSpeed(double pressing, double h) const;

  // A body is slow if its kinetic energy could lift it by less than a part of its size: its speed squared.
  static constexpr double kLiftableRatio = 1e-7;                                            // of l
  double maxSlowSquare(double l) const { return 2 * scales.gravity * kLiftableRatio * l; }  // m^2/s^2

  // What slides faster without friction does not rest, as nothing stops it.
  static constexpr double kSmoothSlipRatio = 1e-7;  // of sqrt(g l)
  double maxSmoothSlip(double l) const { return kSmoothSlipRatio * std::sqrt(scales.gravity * l); }

  // A body that was woken stays awake so long, as one that rattles is not put to rest again and again.
  static constexpr double kStillSteps = 20;                        // of h
  double minAwakeTime(double h) const { return kStillSteps * h; }  // s

  // Forces.

  // Forces at supports may leave bodies at rest such accelerations; forces of many supports are found to a part of it.
  // [1e-9, 1e-3], [1e-5, 1]
  static constexpr double kRestResidualRatio = 1e-6;  // of g
  static constexpr double kForcesSolvedRatio = 1e-2;  // of that
  double residualAcceleration = 0, forceError = 0;    // m/s^2

  // So well contacts of a step are solved. 1e-10 and 1e-4 change last bits of a stack, but no test.
  static constexpr double kSolvedRatio = 1e-7;  // of the fastest velocity

  // So well that part of restitutions is found which gains no energy: impulses are found no better. [1e-9, 0.01]
  static constexpr double kRestitutionError = 1e-6;

  static constexpr double kEnergyRounding = 1e-13;  // of the energy: a gain is more

  // Of the inverse mass without constraints. Where a joint is nearer to a contact than 1e-3 of the size, an overlap is
  // let be: taking it out would lift the body by more than a thousand times as much, against all forces. [1e-8, 1e-4]
  static constexpr double kMinMobility = 1e-6;

  // Constraint errors that contacts may leave: a thousandth of what is seen, at coordinates x (m). [1e-9, 1e-5]
  static constexpr double kConstraintError = 1e-7;                               // m (a m of coordinates) or rad
  double constraintError(double x) const { return kConstraintError * (1 + x); }  // m or rad

 private:
  double speedOf(double ratio, double h) const;
};

StepTolerances stepTolerancesOf(const StepScales& scales);

}  // namespace cradle
