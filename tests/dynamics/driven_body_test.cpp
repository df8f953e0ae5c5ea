// Bodies that move as is prescribed, as the equations of motion see them.

#include "dynamics/driven_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace cradle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRate = 2 * std::numbers::pi * 1.5;  // rad/s

/// Three bodies: the second oscillates about (1, 2, 3) by 0.2 m along (0.6, 0, 0.8), the third goes from (0, 0, 0) at 1
/// s to (4, 0, 0) at 2 s, and turns about y by 90 degrees.
struct TwoOfThree {
  VectorX state = VectorX::Zero(stateSize(3));
  std::vector<DrivenBody> driven;

  TwoOfThree() {
    for (Eigen::Index body : {0, 1, 2}) setOrientation(state, body, Quat::Identity());
    add(1, OscillatingMotion{{Quat::Identity(), Vec3(1, 2, 3)}, Vec3(0.6, 0, 0.8), 0.2, 1.5, 0.4}, driven);
    const Quat quarter(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
    add(2, KeyFramePath({{1, {Quat::Identity(), Vec3::Zero()}}, {2, {quarter, Vec3(4, 0, 0)}}}, false), driven);
  }
};

TEST(DrivenBody, IsPlacedWithItsVelocityAndLeavesOthersAlone) {
  TwoOfThree at;
  const VectorX before = at.state;
  place(at.driven, 0.3, at.state);
  const double angle = kRate * 0.3 + 0.4;
  const Vec3 along(0.6, 0, 0.8);
  EXPECT_LT((centerOfMass(at.state, 1) - (Vec3(1, 2, 3) + 0.2 * std::sin(angle) * along)).norm(), 1e-15);
  EXPECT_LT((linearVelocity(at.state, 1) - 0.2 * kRate * std::cos(angle) * along).norm(), 1e-15);
  EXPECT_EQ(angularVelocity(at.state, 1), Vec3(0, 0, 0));
  EXPECT_EQ(centerOfMass(at.state, 2), Vec3(0, 0, 0));
  for (const auto& part : {centerOfMass(at.state, 0), linearVelocity(at.state, 0)}) EXPECT_EQ(part, Vec3(0, 0, 0));
  place(at.driven, 2.5, at.state);
  EXPECT_EQ(centerOfMass(at.state, 2), Vec3(4, 0, 0));
  EXPECT_LT((orientation(at.state, 2) * Vec3::UnitX() + Vec3::UnitZ()).norm(), 1e-15);
}

// q and -q are one orientation, but no two of a state that is interpolated.
TEST(DrivenBody, KeepsTheSignOfItsQuaternion) {
  TwoOfThree at;
  setOrientation(at.state, 2, Quat(-1, 0, 0, 0));
  place(at.driven, 1.5, at.state);
  EXPECT_LT(orientation(at.state, 2).w(), 0);
}

TEST(DrivenBody, HasThePrescribedAcceleration) {
  TwoOfThree at;
  VectorX derivative = VectorX::Constant(at.state.size(), 7);
  accelerate(at.driven, 0.3, derivative);
  const Vec3 expected = -0.2 * kRate * kRate * std::sin(kRate * 0.3 + 0.4) * Vec3(0.6, 0, 0.8);
  EXPECT_LT((linearVelocity(derivative, 1) - expected).norm(), 1e-14);
  EXPECT_EQ(angularVelocity(derivative, 1), Vec3(0, 0, 0));
  EXPECT_EQ(linearVelocity(derivative, 0), Vec3(7, 7, 7));
  // From rest to rest in 1 s: 4 m and a quarter of a turn have their largest velocities in the middle, where nothing
  // accelerates them; before and after that they do, to either side.
  accelerate(at.driven, 1.5, derivative);
  EXPECT_NEAR(linearVelocity(derivative, 2).norm(), 0, 1e-12);
  EXPECT_NEAR(angularVelocity(derivative, 2).norm(), 0, 1e-12);
  accelerate(at.driven, 1.25, derivative);
  const double faster = linearVelocity(derivative, 2).x(), turningFaster = angularVelocity(derivative, 2).y();
  EXPECT_GT(faster, 1);
  EXPECT_GT(turningFaster, 0.5);
  accelerate(at.driven, 1.75, derivative);
  EXPECT_NEAR(linearVelocity(derivative, 2).x(), -faster, 1e-12);
  EXPECT_NEAR(angularVelocity(derivative, 2).y(), -turningFaster, 1e-12);
}

// F . (v + w x r) with v = (1, 2, 3), w = (0, 0, 4), r = (0.5, 0, 1): (1, 2, 3) + (0, 2, 0).
TEST(DrivenBody, WorksByTheVelocityOfThePointThatItActsAt) {
  TwoOfThree at;
  const std::vector<RigidBody> bodies = {makeRigidBody({2, Vec3::Zero(), Mat3::Identity()}), drivenRigidBody(),
                                         drivenRigidBody()};
  EXPECT_TRUE(bodies[1].isDriven());
  EXPECT_FALSE(bodies[0].isDriven());
  for (Eigen::Index body : {0, 1}) {
    centerOfMass(at.state, body) = Vec3(1, 1, 1);
    linearVelocity(at.state, body) = Vec3(1, 2, 3), angularVelocity(at.state, body) = Vec3(0, 0, 4);
  }
  const Vec3 point(1.5, 1, 2), force(10, 100, 1000);
  EXPECT_EQ(powerOfDriven(bodies, 1, point, force, at.state), 10 + 400 + 3000);
  EXPECT_EQ(powerOfDriven(bodies, 0, point, force, at.state), 0);
  EXPECT_EQ(powerOfDriven(bodies, kFixed, point, force, at.state), 0);
}

TEST(DrivenBody, IsStillBeforeAndAfterItsKeyFrames) {
  const TwoOfThree at;
  EXPECT_TRUE(isDrivenStill(at.driven, 2, 0.5));
  EXPECT_FALSE(isDrivenStill(at.driven, 2, 1));
  EXPECT_FALSE(isDrivenStill(at.driven, 2, 1.5));
  EXPECT_TRUE(isDrivenStill(at.driven, 2, 2));
  EXPECT_FALSE(isDrivenStill(at.driven, 1, 0.5));
  EXPECT_FALSE(isDrivenStill(at.driven, 0, 0.5));  // not driven
}

TEST(DrivenBody, JumpsFirstWhereAnyOfThemDoes) {
  TwoOfThree at;
  EXPECT_EQ(nextJump(at.driven, 0), 1);
  EXPECT_EQ(nextJump(at.driven, 1), 2);
  EXPECT_EQ(nextJump(at.driven, 2), kInfinity);
  add(0, KeyFramePath({{1.25, {Quat::Identity(), Vec3::Zero()}}, {3, {Quat::Identity(), Vec3(0, 1, 0)}}}, false),
      at.driven);
  EXPECT_EQ(nextJump(at.driven, 0), 1);
  EXPECT_EQ(nextJump(at.driven, 1), 1.25);
  EXPECT_EQ(nextJump(at.driven, 2), 3);
}

}  // namespace
}  // namespace cradle
