#include "collision/separating_axis_cache.h"

#include <gtest/gtest.h>

#include "collision/core_separation.h"
#include "collision/sample_cores.h"

namespace cradle {
namespace {

constexpr GapBounds kNoBounds{INFINITY};  // of the gap itself: the axis alone tells

/// A body's motion over a step of 1 s: as far as a body at rest, plus these.
struct StepMotion {
  RigidTransform from = {};
  Vec3 shift = Vec3::Zero();           // m
  Vec3 turn = Vec3::Zero();            // rad, about the centre of mass, at a constant rate
  Vec3 velocityChange = Vec3::Zero();  // m/s, between the ends: half of it less at the start, half more at the end
};

/// Cubic interpolants go through both ends with the velocities there. (Of a turn by less than 1 rad they are as far
/// from it as 1e-3 rad.)
Step stepOf(const std::array<StepMotion, 2>& motions) {
  Step step;
  step.timeStep = 1;
  for (VectorX* vector : {&step.startState, &step.state, &step.startDerivative, &step.endDerivative})
    *vector = VectorX::Zero(stateSize(2));
  for (Eigen::Index body = 0; body < 2; ++body) {
    const StepMotion& motion = motions[static_cast<std::size_t>(body)];
    const Quat after = motion.turn.norm() > 0
                           ? Quat(rotationAbout(motion.turn, motion.turn.norm()) * motion.from.rotation)
                           : motion.from.rotation;
    centerOfMass(step.startState, body) = motion.from.translation;
    centerOfMass(step.state, body) = motion.from.translation + motion.shift;
    centerOfMass(step.startDerivative, body) = motion.shift - motion.velocityChange / 2;
    centerOfMass(step.endDerivative, body) = motion.shift + motion.velocityChange / 2;
    setOrientation(step.startState, body, motion.from.rotation), setOrientation(step.state, body, after);
    setOrientation(step.startDerivative, body, orientationRate(motion.from.rotation, motion.turn));
    setOrientation(step.endDerivative, body, orientationRate(after, motion.turn));
  }
  step.hasEndDerivative = true;
  return step;
}

/// Two colliders over a step, with true bounds on their accelerations.
struct MovingPair {
  Step step;
  Collider a, b;
  DirectionAccelerations accelerations;

  MovingPair(const SampleCore& coreA, const SampleCore& coreB, const std::array<StepMotion, 2>& motions)
      : step(stepOf(motions)), a(coreA.collider), b(coreB.collider) {
    a.body = 0, b.body = 1;
    // Points of a body at r turn with w^2 r. Those of B, seen from A's turning frame at a distance of at most D, have
    // the acceleration of their own and of the shift, 2 w v of Coriolis and w^2 D; a little more for the interpolants.
    const double turnA = motions[0].turn.norm(), turnB = motions[1].turn.norm();
    const double ownA = turnA * turnA * a.boundingRadius, ownB = turnB * turnB * b.boundingRadius;
    const Vec3 shift = motions[1].shift - motions[0].shift;
    const double change = (motions[1].velocityChange - motions[0].velocityChange).norm();
    const double speed = shift.norm() + change + turnA * a.boundingRadius + turnB * b.boundingRadius;
    const double distance = (motions[1].from.translation - motions[0].from.translation).norm() + speed +
                            a.boundingRadius + b.boundingRadius;
    const auto inFrame = [&](double turn) { return 2 * turn * speed + turn * turn * distance; };
    accelerations = {1.2 * (ownA + ownB), 1.2 * (change + ownA + ownB + inFrame(turnA)),
                     1.2 * (change + ownA + ownB + inFrame(turnB))};
  }
  double gapAt(double fraction) const {
    return separationOf(Core(a, poseAt(step, 0, fraction)), Core(b, poseAt(step, 1, fraction))).separation;
  }
  Bracket between(double before, double after, double threshold) const {
    return {before, gapAt(before) - threshold, after, gapAt(after) - threshold};
  }
};

// What it tells is true of 17 instants of the interval; and it tells it often enough to be of use: of intervals at
// whose ends the gap is large beside the motion inside, nearly always.
TEST(SeparatingAxisCache, NeverSaysApartOfWhatComesNearer) {
  const std::vector<SampleCore> cores{boxCore("box", Vec3(1, 0.6, 1.4)), tetrahedronCore(1),
                                      boxCore("plate", Vec3(1, 0.01, 0.7)), cylinderCore("drum", 0.5, 0.8)};
  RandomPoses random(1);
  int told = 0, untold = 0;
  for (int i = 0; i < 60; ++i) {
    const auto some = [&] { return static_cast<std::size_t>(random.number(0, 3.99)); };
    const std::size_t first = some(), second = some();
    const auto motion = [&](const Vec3& place) {
      const Quat turn = random.turn();
      const Vec3 shift = random.vector(0.8), rotation = random.vector(0.5), change = random.vector(1);
      return StepMotion{{turn, place}, shift, rotation, change};
    };
    const StepMotion ofA = motion(Vec3::Zero()), ofB = motion(1.5 * random.direction());
    const MovingPair pair(cores[first], cores[second], {ofA, ofB});
    SeparatingAxisCache cache(pair.step, pair.a, pair.b, pair.accelerations);
    const double threshold = random.number(0, 0.05);
    for (const double length : {1.0, 0.25, 0.125})
      for (double before = 0; before < 1; before += length) {
        const Bracket ends = pair.between(before, before + length, threshold);
        if (ends.gapBefore <= 0 || ends.gapAfter <= 0) continue;
        if (!cache.during(ends, threshold, kNoBounds)) {
          ++untold;
          continue;
        }
        ++told;
        for (int k = 0; k <= 16; ++k) EXPECT_GT(pair.gapAt(before + length * k / 16), threshold - 1e-12) << i;
      }
  }
  EXPECT_GT(told, 2 * untold);
}

// Two boxes that turn together by half a radian, 5 mm apart: the gap is constant along a face's normal that turns with
// them, and along none that stays. A turning body alone has its own frame's.
TEST(SeparatingAxisCache, KeepsANormalThatTurnsWithABody) {
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4));
  const Vec3 turn(0, 0, 0.5);
  const Vec3 from(0, 0.605, 0), to = rotationAbout(turn, 0.5) * from;
  const StepMotion lower{{}, Vec3::Zero(), turn, Vec3::Zero()};
  const Vec3 velocityBefore = turn.cross(from), velocityAfter = turn.cross(to);
  MovingPair pair(box, box, {lower, StepMotion{{Quat::Identity(), from}, to - from, turn, Vec3::Zero()}});
  centerOfMass(pair.step.startDerivative, 1) = velocityBefore, centerOfMass(pair.step.endDerivative, 1) = velocityAfter;
  const Bracket ends = pair.between(0, 1, 0);
  constexpr double kNone = INFINITY;
  // As seen from either body the other stays but for the interpolants' error; in the world its points turn.
  for (const auto& [ofA, ofB] : {std::pair(1e-2, kNone), std::pair(kNone, 1e-2)}) {
    SeparatingAxisCache cache(pair.step, pair.a, pair.b, {0.5, ofA, ofB});
    EXPECT_TRUE(cache.during(ends, 0, kNoBounds));
    EXPECT_TRUE(cache.during(pair.between(0, 0.5, 0), 0, kNoBounds));
    EXPECT_EQ(cache.queries(), 1);  // the direction served again
  }
  SeparatingAxisCache world(pair.step, pair.a, pair.b, {0.5, kNone, kNone});
  EXPECT_FALSE(world.during(ends, 0, kNoBounds));
}

// A box over another sinks and rises again: the gap is 0.2 - 0.15 4 t (1 - t), and least, 0.05, in the middle.
TEST(SeparatingAxisCache, FollowsTheParabolaOfAShift) {
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4));
  StepMotion sinking{{Quat::Identity(), Vec3(0.1, 0.8, 0)}, Vec3::Zero(), Vec3::Zero(), Vec3(0, 1.2, 0)};
  const MovingPair pair(box, box, {StepMotion(), sinking});
  EXPECT_NEAR(pair.gapAt(0.5), 0.05, 1e-15);
  const auto isApart = [&](double threshold, double graze) {
    SeparatingAxisCache cache(pair.step, pair.a, pair.b, {0, 1.2, 1.2});  // m: the acceleration itself
    GapBounds bounds = kNoBounds;
    bounds.graze = graze;
    return cache.during(pair.between(0, 1, threshold), threshold, bounds);
  };
  EXPECT_TRUE(isApart(0.0499, 0));
  EXPECT_FALSE(isApart(0.0501, 0));
  EXPECT_TRUE(isApart(0.0501, 1e-3));
  // In the world alone, what turning adds counts: the parabola sinks by an eighth of it.
  SeparatingAxisCache world(pair.step, pair.a, pair.b, {0.1, INFINITY, INFINITY});
  EXPECT_TRUE(world.during(pair.between(0, 1, 0.0374), 0.0374, kNoBounds));
  EXPECT_FALSE(world.during(pair.between(0, 1, 0.0376), 0.0376, kNoBounds));
  EXPECT_FALSE(isApart(0.21, 1e-3));  // nearer than that at the ends
}

}  // namespace
}  // namespace cradle
