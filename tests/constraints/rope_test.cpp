#include "constraints/rope.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kRopeRounding = 1e-14;  // of some operations on numbers below 10

/// A rope of at most 4 m between a point of a body that moves in all ways, and one of another, or of the world.
struct RopedBodies {
  RopedBodies() : state(VectorX::Zero(stateSize(2))), rates(VectorX::Zero(stateSize(2))) {
    centerOfMass(state, 0) = Vec3(1, 2, 3), centerOfMass(state, 1) = Vec3(-1, 0.5, 2);
    setOrientation(state, 0, rotationAbout(Vec3(1, 2, 3), 0.9));
    setOrientation(state, 1, rotationAbout(Vec3(-2, 1, 0.5), 2.1));
    linearVelocity(state, 0) = Vec3(0.4, -1, 0.3), linearVelocity(state, 1) = Vec3(-0.2, 0.7, 1);
    angularVelocity(state, 0) = Vec3(2, -1, 0.5), angularVelocity(state, 1) = Vec3(0.3, 3, -1);
    linearVelocity(rates, 0) = Vec3(-3, 1, 2), linearVelocity(rates, 1) = Vec3(0.5, -9, 4);
    angularVelocity(rates, 0) = Vec3(1, 5, -2), angularVelocity(rates, 1) = Vec3(-4, 0.5, 3);
  }
  /// The state in a short time (s), to the third order of it: q' = w q / 2, w' = the rates.
  VectorX stateIn(double time) const {
    VectorX moved = state;
    for (const int body : {0, 1}) {
      const Vec3 spin = angularVelocity(state, body), change = angularVelocity(rates, body);
      centerOfMass(moved, body) += time * linearVelocity(state, body) + time * time / 2 * linearVelocity(rates, body);
      turnBody(moved, body, time * spin + time * time / 2 * change);
      linearVelocity(moved, body) += time * linearVelocity(rates, body);
      angularVelocity(moved, body) += time * change;
    }
    return moved;
  }
  double lengthIn(double time) const { return rope.maxLength - motionOf(rope, stateIn(time)).slackLength; }

  VectorX state, rates;
  RopeLimit rope{{0, Vec3(0.3, -0.2, 0.1)}, {1, Vec3(0.1, 0.4, -0.2)}, 4, 0};
};

TEST(Rope, IsSlackByWhatItsEndsAreNearer) {
  const RopedBodies at;
  const Vec3 a = Vec3(1, 2, 3) + rotationAbout(Vec3(1, 2, 3), 0.9) * Vec3(0.3, -0.2, 0.1);
  const Vec3 b = Vec3(-1, 0.5, 2) + rotationAbout(Vec3(-2, 1, 0.5), 2.1) * Vec3(0.1, 0.4, -0.2);
  const RopeMotion motion = motionOf(at.rope, at.state);
  EXPECT_NEAR(motion.slackLength, 4 - (a - b).norm(), kRopeRounding);
  EXPECT_LT((motion.direction - (a - b).normalized()).norm(), kRopeRounding);
}

// Difference quotients over 1e-4 s: their errors are its square times the rates' of some 100 m/s^3 and m/s^4, and
// rounding by it, for the second derivative by its square.
TEST(Rope, LengthensAsItsEndsPart) {
  for (const bool isFixed : {false, true}) {
    RopedBodies at;
    if (isFixed) at.rope.anchorB = {kFixed, Vec3(0.5, -1, 2)};
    const double time = 1e-4, before = at.lengthIn(-time), now = at.lengthIn(0), after = at.lengthIn(time);
    EXPECT_NEAR(motionOf(at.rope, at.state).lengthening, (after - before) / (2 * time), 1e-6);
    EXPECT_NEAR(lengtheningAcceleration(at.rope, at.state, at.rates), (after - 2 * now + before) / (time * time), 1e-5);
  }
}

// The row times the velocities is the lengthening, of each body alone as well.
TEST(Rope, HasARowOfItsLengthening) {
  const RopedBodies at;
  const RopeMotion motion = motionOf(at.rope, at.state);
  const ConstraintRow row = lengtheningRow(at.rope, motion);
  EXPECT_EQ(row.bodyA, 0);
  EXPECT_EQ(row.bodyB, 1);
  for (const int still : {-1, 0, 1}) {
    VectorX moving = at.state;
    if (still >= 0) linearVelocity(moving, still).setZero(), angularVelocity(moving, still).setZero();
    const double rate = row.linearA.dot(linearVelocity(moving, 0)) + row.angularA.dot(angularVelocity(moving, 0)) +
                        row.linearB.dot(linearVelocity(moving, 1)) + row.angularB.dot(angularVelocity(moving, 1));
    EXPECT_NEAR(rate, motionOf(at.rope, moving).lengthening, kRopeRounding) << still;
  }
}

// A ball that circles at the end of a rope with v has L'' = v^2 / L, less what pulls it in.
TEST(Rope, StretchesByCentrifugalAcceleration) {
  VectorX state = VectorX::Zero(stateSize(1)), rates = state;
  setOrientation(state, 0, Quat::Identity());
  centerOfMass(state, 0) = Vec3(0, -2, 0), linearVelocity(state, 0) = Vec3(3, 0, 4);
  const RopeLimit rope{{0, Vec3::Zero()}, {kFixed, Vec3::Zero()}, 2, 0};
  EXPECT_NEAR(lengtheningAcceleration(rope, state, rates), 25 / 2.0, kRopeRounding);
  linearVelocity(rates, 0) = Vec3(1, 12.5, 1);
  EXPECT_NEAR(lengtheningAcceleration(rope, state, rates), 0, kRopeRounding);
}

}  // namespace
}  // namespace cradle
