#include "constraints/limit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "constraints/moving_ends.h"
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
  double lengthIn(double time) const { return rope.maxLength - motionOf(Limit(rope), stateIn(time)).slackLength; }

  VectorX state, rates;
  RopeLimit rope{{0, Vec3(0.3, -0.2, 0.1)}, {1, Vec3(0.1, 0.4, -0.2)}, 4, 0};
};

TEST(Rope, IsSlackByWhatItsEndsAreNearer) {
  const RopedBodies at;
  const Vec3 a = Vec3(1, 2, 3) + rotationAbout(Vec3(1, 2, 3), 0.9) * Vec3(0.3, -0.2, 0.1);
  const Vec3 b = Vec3(-1, 0.5, 2) + rotationAbout(Vec3(-2, 1, 0.5), 2.1) * Vec3(0.1, 0.4, -0.2);
  const LimitMotion motion = motionOf(Limit(at.rope), at.state);
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
    EXPECT_NEAR(motionOf(Limit(at.rope), at.state).lengthening, (after - before) / (2 * time), 1e-6);
    EXPECT_NEAR(lengtheningAcceleration(Limit(at.rope), at.state, at.rates), (after - 2 * now + before) / (time * time),
                1e-5);
  }
}

// The row times the velocities is the lengthening, of each body alone as well.
TEST(Rope, HasARowOfItsLengthening) {
  const RopedBodies at;
  const LimitMotion motion = motionOf(Limit(at.rope), at.state);
  const ConstraintRow row = rowOf(lengtheningRow(Limit(at.rope), motion), 0);
  EXPECT_EQ(row.bodyA, 0);
  EXPECT_EQ(row.bodyB, 1);
  for (const int still : {-1, 0, 1}) {
    VectorX moving = at.state;
    if (still >= 0) linearVelocity(moving, still).setZero(), angularVelocity(moving, still).setZero();
    const double rate = row.linearA.dot(linearVelocity(moving, 0)) + row.angularA.dot(angularVelocity(moving, 0)) +
                        row.linearB.dot(linearVelocity(moving, 1)) + row.angularB.dot(angularVelocity(moving, 1));
    EXPECT_NEAR(rate, motionOf(Limit(at.rope), moving).lengthening, kRopeRounding) << still;
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

/// Two bodies that a hinge or a slider joins, at rates that it allows: B moves as it likes, and A with it, turned on by
/// 0.4 rad about the axis, at 1.3 rad/s, or shifted along it by 0.4 m, at 1.3 m/s.
struct StoppedBodies {
  explicit StoppedBodies(bool turns) {
    const std::array<MovingEnd, 2> ends = someMovingEnds();
    const Vec3 axis = Vec3(1, 2, 2) / 3, across = Vec3(2, 1, -2) / 3;  // of B
    const Quat bFromA = rotationAbout(Vec3(1, -2, 0.5), 0.7);
    stop.anchorA = {0, ends[0].point}, stop.anchorB = {1, ends[1].point};
    stop.bound = {turns, axis, bFromA.conjugate() * across, across, 1};
    stop.size = 0.7;
    state.setZero(stateSize(2));
    const MovingEnd& b = ends[1];
    centerOfMass(state, 1) = b.center, setOrientation(state, 1, b.start);
    linearVelocity(state, 1) = b.velocity, angularVelocity(state, 1) = b.angularVelocity;
    const Vec3 world = b.start * axis, armB = b.start * b.point;
    const Quat turnA = turns ? b.start * rotationAbout(axis, kValue) * bFromA : b.start * bFromA;
    const Vec3 spinA = b.angularVelocity + (turns ? Vec3(kRate * world) : Vec3(Vec3::Zero()));
    const Vec3 way = turns ? Vec3(Vec3::Zero()) : Vec3(kValue * world), armA = turnA * ends[0].point;
    const Vec3 velocity = b.velocity + b.angularVelocity.cross(armB + way) +
                          (turns ? Vec3(Vec3::Zero()) : Vec3(kRate * world));  // of A's anchor
    setOrientation(state, 0, turnA);
    centerOfMass(state, 0) = b.center + armB + way - armA;
    linearVelocity(state, 0) = velocity - spinA.cross(armA), angularVelocity(state, 0) = spinA;
  }
  static constexpr double kValue = 0.4, kRate = 1.3;
  JointLimit stop;
  VectorX state;
};

TEST(JointLimit, IsSlackByWhatIsLeftToItsBound) {
  for (const bool turns : {false, true})
    for (const double side : {1.0, -1.0}) {
      StoppedBodies at(turns);
      at.stop.side = side;
      const double unit = turns ? 0.7 : 1;
      const LimitMotion motion = motionOf(Limit(at.stop), at.state);
      EXPECT_NEAR(motion.slackLength, side * unit * (1 - 0.4), 1e-14) << turns << side;
      EXPECT_NEAR(motion.lengthening, side * unit * 1.3, 1e-14) << turns << side;
      EXPECT_NEAR(motion.direction.norm(), 1, 1e-15);
      EXPECT_NEAR(rateOf(lengtheningRow(Limit(at.stop), motion), 0, at.state), motion.lengthening, 1e-13);
    }
}

// With the accelerations that keep the joint and its rate: those of B, and of A by the rigid motion with it. Then the
// rate stays, and the lengthening has no rate.
TEST(JointLimit, DoesNotAccelerateWhatKeepsItsRate) {
  for (const bool turns : {false, true}) {
    const StoppedBodies at(turns);
    VectorX rates = VectorX::Zero(at.state.size());
    const Vec3 spinB = angularVelocity(at.state, 1), spinA = angularVelocity(at.state, 0);
    const Vec3 axis = orientation(at.state, 1) * at.stop.bound.axisB;
    const Vec3 armA = orientation(at.state, 0) * at.stop.anchorA.point,
               armB = orientation(at.state, 1) * at.stop.anchorB.point;
    const Vec3 way = turns ? Vec3(Vec3::Zero()) : Vec3(0.4 * axis),
               wayRate = turns ? Vec3(Vec3::Zero()) : Vec3(1.3 * axis);
    angularVelocity(rates, 0) = turns ? Vec3(1.3 * spinB.cross(axis)) : Vec3(Vec3::Zero());
    const Vec3 ofAnchor =
        spinB.cross(spinB.cross(armB + way)) + 2 * spinB.cross(wayRate);  // B's centre goes straight on
    linearVelocity(rates, 0) = ofAnchor - Vec3(angularVelocity(rates, 0)).cross(armA) - spinA.cross(spinA.cross(armA));
    EXPECT_NEAR(lengtheningAcceleration(Limit(at.stop), at.state, rates), 0, 1e-13) << turns;
    linearVelocity(rates, 0) += 2 * axis, angularVelocity(rates, 0) += 3 * axis;
    const double expected = turns ? 3 * 0.7 : 2 + 3 * axis.dot(axis.cross(armA));
    EXPECT_NEAR(lengtheningAcceleration(Limit(at.stop), at.state, rates), expected, 1e-13) << turns;
  }
}

TEST(JointLimit, CountsWholeTurnsFromWhereItWasFollowedLast) {
  StoppedBodies at(true);
  for (const int turns : {-3, 0, 2}) {
    at.stop.turned = 0.4 + 2 * std::numbers::pi * turns + 2.9;
    followTurn(at.stop, 0, at.state);
    EXPECT_NEAR(at.stop.turned, 0.4 + 2 * std::numbers::pi * turns, 1e-14);
    at.stop.bound.value = 20;
    EXPECT_NEAR(motionOf(Limit(at.stop), at.state).slackLength, 0.7 * (20 - 0.4 - 2 * std::numbers::pi * turns), 1e-13);
    at.stop.bound.value = 1;
  }
}

// A step may turn a hinge by more than half a turn: with rates r_0 and r_1 at its ends by (r_0 + r_1) t / 2, about.
TEST(JointLimit, CountsWholeTurnsOfLongSteps) {
  for (const double turned : {-9.0, 2.5, 4.0, 30.0}) {  // rad, in 2 s
    StoppedBodies at(true);
    at.stop.turned = at.kValue - turned, at.stop.rate = turned - at.kRate;
    EXPECT_NEAR(turningTo(at.stop, 2, at.state), turned, 1e-13);
    followTurn(at.stop, 2, at.state);
    EXPECT_NEAR(at.stop.turned, at.kValue, 1e-13) << turned;
    EXPECT_NEAR(at.stop.rate, at.kRate, 1e-13) << turned;
  }
}

// The multiplier of a stop's row is a force along the axis, or a torque about it, on A: it pushes back from the bound.
TEST(JointLimit, PushesBackFromItsBound) {
  JointLimit stop;
  stop.size = 0.5, stop.side = -1;
  EXPECT_EQ(tensionOf(Limit(stop), 3), 3);
  stop.bound.turns = true;
  EXPECT_EQ(tensionOf(Limit(stop), 3), 6);
  stop.side = 1;
  EXPECT_EQ(tensionOf(Limit(stop), -3), 6);
  EXPECT_EQ(tensionOf(Limit(RopeLimit{{}, {}, 2, 0}), -3), 6);
}

}  // namespace
}  // namespace cradle
