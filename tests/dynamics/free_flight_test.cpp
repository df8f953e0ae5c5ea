#include "dynamics/free_flight.h"

#include <gtest/gtest.h>

#include "math/rotation.h"

namespace cradle {
namespace {

TEST(FreeFlight, IsAParabolaAndAFreeRotationAndLeavesOthersAlone) {
  const RigidBody body = makeRigidBody({3, Vec3::Zero(), Vec3(1, 2, 3).asDiagonal()});
  const Vec3 position(1, 2, 3), velocity(-4, 5, 0.5), spin(0.3, -1, 2), gravity(0, -9.81, 0);
  const Quat attitude = rotationAbout({1, -2, 0.5}, 0.7);
  VectorX state = VectorX::Constant(stateSize(2), 7);
  centerOfMass(state, 1) = position;
  linearVelocity(state, 1) = velocity;
  angularVelocity(state, 1) = spin;
  setOrientation(state, 1, attitude);
  const VectorX start = state;

  const double time = 2.5;
  FreeFlight(body, start, 1, gravity).moveTo(time, state);

  // Numbers up to 40, a few roundings each.
  const Vec3 expected(1 - 4 * time, 2 + 5 * time - 9.81 / 2 * time * time, 3 + 0.5 * time);
  EXPECT_LE((centerOfMass(state, 1) - expected).norm(), 2e-14);
  EXPECT_LE((linearVelocity(state, 1) - Vec3(-4, 5 - 9.81 * time, 0.5)).norm(), 2e-14);
  const RotationState turned = FreeRotation(body.inertiaTensor, {attitude, spin}).at(time);
  EXPECT_EQ(orientation(state, 1).coeffs(), turned.worldFromBody.coeffs());
  EXPECT_EQ(angularVelocity(state, 1), turned.angularVelocity);

  state.segment<kPoseSize>(kPoseSize) = start.segment<kPoseSize>(kPoseSize);
  state.segment<kVelocitySize>(velocityOffset(state, 1)) = start.segment<kVelocitySize>(velocityOffset(state, 1));
  EXPECT_EQ(state, start);
}

}  // namespace
}  // namespace cradle
