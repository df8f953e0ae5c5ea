#include <gtest/gtest.h>

#include <cmath>

#include "collision/time_of_impact.h"
#include "dynamics/equations_of_motion.h"
#include "dynamics/integrators/rk4.h"
#include "math/rotation.h"

// Impacts of long, thin and fast bodies inside one step, at times that follow from sizes and speeds.

namespace cradle {
namespace {

constexpr double kTolerance = 1e-12;  // m

struct Flying {
  Collider collider;
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(), spin = Vec3::Zero();
  Quat turn = Quat::Identity();
};

/// One step of free bodies without gravity, with spins about principal axes: straight lines, turned evenly.
std::optional<ImpactTime> impactOf(const std::vector<Flying>& bodies, double timeStep, bool overGround = false) {
  Mechanism mechanism;
  mechanism.gravity = Vec3::Zero();
  ContactGeometry geometry;
  VectorX state = VectorX::Zero(stateSize(std::ssize(bodies)));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    mechanism.bodies.push_back(makeRigidBody({1, Vec3::Zero(), 0.01 * Mat3::Identity()}));
    geometry.colliders.push_back(bodies[i].collider);
    geometry.colliders.back().body = static_cast<int>(i);
    const auto body = static_cast<Eigen::Index>(i);
    centerOfMass(state, body) = bodies[i].position, setOrientation(state, body, bodies[i].turn);
    linearVelocity(state, body) = bodies[i].velocity, angularVelocity(state, body) = bodies[i].spin;
  }
  geometry.planes = {{Vec3::Zero(), Vec3::UnitY()}};
  geometry.pairs = {overGround ? ColliderPair{0, 0, true, {}} : ColliderPair{0, 1, false, {}}};
  EquationsOfMotion equations(mechanism);
  const RightHandSide rightHandSide = equations.rightHandSide();
  Step step;
  rk4(rightHandSide, state, 0, timeStep, step);
  prepareInterpolant(rightHandSide, step);
  return ImpactSearch(geometry).first(step, {kTolerance});
}

// 10 m of way in the step, 21 mm of it inside the plate.
TEST(ImpactOfShapes, ABallAtAThousandMetresASecondDoesNotPassAPlateOfAMillimetre) {
  const Flying plate{colliderOf(Box{Vec3(1, 1, 0.001)}, {})};
  const Flying disc{
      colliderOf(Cylinder{0.5, 0.001}, RigidTransform{rotationAbout(Vec3::UnitX(), M_PI / 2), Vec3::Zero()})};
  for (const Collider& bullet : {colliderOf(Sphere{0.01}, {}), colliderOf(Box{Vec3::Constant(0.02)}, {}),
                                 colliderOf(Capsule{0.01, 0.05}, {}), colliderOf(Cylinder{0.01, 0.05}, {})})
    for (const Flying& target : {plate, disc})
      for (const double start : {3.0, 3.1234567, 9.0}) {
        const auto impact = impactOf({{bullet, Vec3(0.1, 0.2, -start), Vec3(0, 0, 1000)}, target}, 0.01);
        ASSERT_TRUE(impact);
        EXPECT_NEAR(impact->fraction * 0.01, (start - 0.0105) / 1000, 2e-14);
      }
}

// Parallel rods that pass each other at an offset of nearly their radii's sum touch for 9 % of it.
TEST(ImpactOfShapes, GlancingHitsAndMissesOfRodsAreToldApart) {
  const double radius = 0.05;
  for (const Collider& rod : {colliderOf(Cylinder{radius, 1}, {}), colliderOf(Capsule{radius, 1}, {})})
    for (const double part : {0.9, 0.999, 1.001, 1.1}) {
      const double offset = part * 2 * radius;
      const auto impact =
          impactOf({{rod, Vec3(-0.5, 0, offset), Vec3(1, 0, 0)}, {rod, Vec3(0.5, 0.1, 0), Vec3(-1, 0, 0)}}, 1);
      EXPECT_EQ(impact.has_value(), part < 1) << part;
      if (impact) {
        EXPECT_NEAR(impact->fraction, (1 - std::sqrt(4 * radius * radius - offset * offset)) / 2, 1e-10) << part;
      }
    }
}

// A rod of 2 m that turns evenly about z meets a ball at distance d from its centre when the ball's centre is as far
// from its line as both radii: sin(angle between) = (r + R) / d. The interpolant of the orientation has an error of
// order (w h)^4 / 384: 2e-5 rad for the 0.3 rad of the step.
TEST(ImpactOfShapes, ALongSpinningRodMeetsABallWithItsSide) {
  const double distance = 0.8, radius = 0.02, ballRadius = 0.03, spin = 30, start = 0.25;
  const Flying ball{colliderOf(Sphere{ballRadius}, {}), distance * Vec3(-std::sin(start), std::cos(start), 0)};
  for (const Collider& rod : {colliderOf(Cylinder{radius, 2}, {}), colliderOf(Capsule{radius, 2}, {})}) {
    const auto impact = impactOf({{rod, Vec3::Zero(), Vec3::Zero(), Vec3(0, 0, spin)}, ball}, 0.01);
    ASSERT_TRUE(impact);
    EXPECT_NEAR(impact->fraction * 0.01, (start - std::asin((radius + ballRadius) / distance)) / spin, 2e-5 / spin);
  }
}

// A cylinder that comes down tilted: its rim's lowest point is h cos + r sin below its centre.
TEST(ImpactOfShapes, ATiltedCylinderMeetsTheGroundWithItsRim) {
  for (const double tilt : {0.0, 1e-9, 0.3, M_PI / 2, 2.0}) {
    const Flying drum{colliderOf(Cylinder{0.5, 2}, {}), Vec3(0, 3, 0), Vec3(0, -2, 0), Vec3::Zero(),
                      rotationAbout(Vec3(1, 0, 2).normalized(), tilt)};
    const auto impact = impactOf({drum}, 1.5, true);
    ASSERT_TRUE(impact);
    const double lowest = std::abs(std::cos(tilt)) + 0.5 * std::sin(tilt);
    EXPECT_NEAR(impact->fraction * 1.5, (3 - lowest) / 2, 2e-12);
  }
}

// Turned about its own axis a cylinder stays what it is: nothing to meet.
TEST(ImpactOfShapes, ASpinningDiscBesideAWallDoesNotMeetIt) {
  const Flying disc{colliderOf(Cylinder{0.5, 0.1}, {}), Vec3(0.6, 0, 0), Vec3::Zero(), Vec3(0, 100, 0)};
  EXPECT_FALSE(impactOf({disc, {colliderOf(Box{Vec3(0.19, 1, 1)}, {})}}, 0.003));
}

}  // namespace
}  // namespace cradle
