#include "simulate/steps/contact_energy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

// Sums of a hundred products of numbers below 100, each rounded to 1e-16: momenta and energies come out to 1e-12.
constexpr double kSumRounding = 1e-12;

/// Two boxes without symmetry that move in all ways, at y = 1 and 3, and a third that is none of the moved bodies.
struct MovingBoxes : OneIsland {
  MovingBoxes()
      : OneIsland(R"("duration": 1, "gravity": [0.5, -9.81, 0.3], "bodies": [
          {"name": "one", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 3, "position": [0.3, 1, -0.2],
           "linearVelocity": [1, -2, 0.5], "angularVelocity": [0.7, -3, 2]},
          {"name": "other", "shape": {"box": {"size": [0.1, 0.5, 0.3]}}, "mass": 2, "position": [-1, 3, 0.4],
           "linearVelocity": [-0.4, 1, 3], "angularVelocity": [-5, 1, 1.5]},
          {"name": "third", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 7, "position": [9, 9, 9],
           "linearVelocity": [8, 7, 6], "angularVelocity": [1, 2, 3]}],
          "springs": [{"bodyA": "one", "bodyB": "other", "stiffness": 20, "restLength": 1.5}])") {
    setOrientation(state(), 0, rotationAbout(Vec3(1, 2, 3), 0.9));
    setOrientation(state(), 1, rotationAbout(Vec3(-2, 1, 0.5), 2.1));
  }

  Vec3 center() { return (3 * centerOfMass(state(), 0) + 2 * centerOfMass(state(), 1)) / 5; }
  Vec3 momentum() { return 3 * linearVelocity(state(), 0) + 2 * linearVelocity(state(), 1); }
  /// kg m^2/s: of the first two about a point.
  Vec3 angularMomentumAbout(const Vec3& point) {
    Vec3 sum = Vec3::Zero();
    for (int body = 0; body < 2; ++body) {
      const RigidBody& inertia = mechanism().bodies[static_cast<std::size_t>(body)];
      sum += worldInertia(inertia, body, state()) * Vec3(angularVelocity(state(), body)) +
             inertia.mass * (Vec3(centerOfMass(state(), body)) - point).cross(Vec3(linearVelocity(state(), body)));
    }
    return sum;
  }
  /// J: of the rigid motion with these momenta, p^2 / 2 m + L.I^-1 L / 2 about the centre.
  double energyOfRigidMotion() {
    Mat3 inertiaTensor = Mat3::Zero();
    for (int body = 0; body < 2; ++body) {
      const RigidBody& inertia = mechanism().bodies[static_cast<std::size_t>(body)];
      const Vec3 arm = Vec3(centerOfMass(state(), body)) - center();
      inertiaTensor += worldInertia(inertia, body, state()) +
                       inertia.mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    }
    const Vec3 spin = angularMomentumAbout(center());
    return momentum().squaredNorm() / 10 + spin.dot(inertiaTensor.inverse() * spin) / 2;
  }
  double energy() { return energyOf({0, 1}, mechanism(), state()); }
  /// J: of the first two, body by body.
  double kinetic() {
    double sum = 0;
    for (int body = 0; body < 2; ++body) {
      const RigidBody& inertia = mechanism().bodies[static_cast<std::size_t>(body)];
      const Vec3 spin = angularVelocity(state(), body);
      sum += inertia.mass * linearVelocity(state(), body).squaredNorm() / 2 +
             spin.dot(worldInertia(inertia, body, state()) * spin) / 2;
    }
    return sum;
  }
};

MovedBodies bothBoxes(const std::vector<Vec3>& planes = {}) {
  MovedBodies moved{{0, 1}};
  for (const Vec3& normal : planes) hinderByPlane(normal, moved.kept);
  return moved;
}

// The third body takes no part; the spring does: k (L - 1.5)^2 / 2.
TEST(ContactEnergy, IsThatOfTheMovedBodiesAndOfTheSprings) {
  MovingBoxes at;
  const double length = (Vec3(0.3, 1, -0.2) - Vec3(-1, 3, 0.4)).norm();
  const double heights =
      3 * Vec3(0.5, -9.81, 0.3).dot(Vec3(0.3, 1, -0.2)) + 2 * Vec3(0.5, -9.81, 0.3).dot(Vec3(-1, 3, 0.4));
  EXPECT_NEAR(at.energy(), at.kinetic() - heights + 10 * std::pow(length - 1.5, 2), kSumRounding);
}

TEST(ContactEnergy, IsGainedBeyondRounding) {
  for (const double most : {2.0, -2.0}) {
    EXPECT_FALSE(isGain(most, most));
    EXPECT_FALSE(isGain(most + 1e-13, most));
    EXPECT_TRUE(isGain(most + 3e-13, most));
    EXPECT_FALSE(isGain(most - 1, most));
  }
}

// Energy goes to what is asked, and both momenta stay.
TEST(ClampedEnergy, KeepsTheMomentaOfFreeBodies) {
  MovingBoxes at;
  const Vec3 momentum = at.momentum(), angularMomentum = at.angularMomentumAbout(Vec3::Zero());
  const Vec3 third = linearVelocity(at.state(), 2);
  const double before = at.energy(), most = before - 0.4 * (at.kinetic() - at.energyOfRigidMotion());
  EXPECT_NEAR(clampEnergy(bothBoxes(), most, at.mechanism(), at.state()), before - most, kSumRounding);
  EXPECT_NEAR(at.energy(), most, kSumRounding);
  EXPECT_LT((at.momentum() - momentum).norm(), kSumRounding);
  EXPECT_LT((at.angularMomentumAbout(Vec3::Zero()) - angularMomentum).norm(), kSumRounding);
  EXPECT_EQ(Vec3(linearVelocity(at.state(), 2)), third);
}

// Velocities relative to the common motion get one factor: that of the difference of spins, of which the common motion
// has none, is the root of the part of the relative energy that is left.
TEST(ClampedEnergy, ScalesRelativeVelocitiesByOneFactor) {
  MovingBoxes at;
  const auto difference = [&] { return Vec3(angularVelocity(at.state(), 0) - angularVelocity(at.state(), 1)); };
  const Vec3 spins = difference();
  const double most = at.energy() - 0.75 * (at.kinetic() - at.energyOfRigidMotion());
  clampEnergy(bothBoxes(), most, at.mechanism(), at.state());
  EXPECT_LT((difference() - 0.5 * spins).norm(), kSumRounding);
}

// Less than the energy of the common motion cannot be had without a change of momenta: the bodies are as one then.
TEST(ClampedEnergy, GoesNoFartherThanTheCommonMotion) {
  MovingBoxes at;
  const double rigid = at.energyOfRigidMotion(), before = at.energy(), relative = at.kinetic() - rigid;
  EXPECT_NEAR(clampEnergy(bothBoxes(), before - 1.5 * relative, at.mechanism(), at.state()), relative, kSumRounding);
  EXPECT_NEAR(at.kinetic(), rigid, kSumRounding);
  EXPECT_LT((angularVelocity(at.state(), 0) - angularVelocity(at.state(), 1)).norm(), kSumRounding);
}

TEST(ClampedEnergy, LeavesAStateWithoutGainAsItIs) {
  MovingBoxes at;
  const VectorX before = at.state();
  EXPECT_EQ(clampEnergy(bothBoxes(), at.energy(), at.mechanism(), at.state()), 0);
  EXPECT_EQ(at.state(), before);
}

// On a plane the momentum along it and the angular momentum about its normal stay; those of the other motions shrink
// by the factor of all velocities.
TEST(ClampedEnergy, KeepsTheMomentaAlongAPlane) {
  MovingBoxes at;
  const Vec3 normal = Vec3(0.3, 1, -0.2).normalized();
  const Vec3 momentum = at.momentum();
  const double turning = at.angularMomentumAbout(at.center()).dot(normal), most = at.energy() - 2;
  clampEnergy(bothBoxes({normal}), most, at.mechanism(), at.state());
  EXPECT_NEAR(at.energy(), most, kSumRounding);
  EXPECT_LT((at.momentum() - momentum).cross(normal).norm(), kSumRounding);
  EXPECT_NEAR(at.angularMomentumAbout(at.center()).dot(normal), turning, kSumRounding);
  EXPECT_LT(at.momentum().dot(normal) / momentum.dot(normal), 0.99);
}

// Between two walls nothing common is free: all velocities have the factor sqrt(1 - lost / kinetic).
TEST(ClampedEnergy, ScalesAllVelocitiesBetweenWalls) {
  MovingBoxes at;
  const VectorX before = at.state();
  const double factor = std::sqrt(1 - 3 / at.kinetic()), most = at.energy() - 3;
  clampEnergy(bothBoxes({Vec3::UnitX(), Vec3::UnitY()}), most, at.mechanism(), at.state());
  for (int body = 0; body < 2; ++body) {
    EXPECT_LT((linearVelocity(at.state(), body) - factor * linearVelocity(before, body)).norm(), kSumRounding);
    EXPECT_LT((angularVelocity(at.state(), body) - factor * angularVelocity(before, body)).norm(), kSumRounding);
  }
}

// The same plane again, from either side, leaves what it left before.
TEST(KeptMotions, AreHinderedByEachDirectionOfPlanes) {
  const Vec3 normal = Vec3(0.3, 1, -0.2).normalized();
  RigidMotions kept = RigidMotions::Identity(6, 6);
  hinderByPlane(normal, kept);
  ASSERT_EQ(kept.cols(), 3);
  EXPECT_LT((kept.transpose() * kept - Mat3::Identity()).norm(), 1e-15);
  // Neither moves along the normal, nor turns about anything else.
  EXPECT_LT((normal.transpose() * kept.topRows<3>()).norm(), 1e-15);
  EXPECT_LT((kept.bottomRows<3>() - normal * normal.transpose() * kept.bottomRows<3>()).norm(), 1e-15);
  hinderByPlane(-normal, kept);
  EXPECT_EQ(kept.cols(), 3);
  hinderByPlane((normal + 1e-6 * normal.unitOrthogonal()).normalized(), kept);
  EXPECT_EQ(kept.cols(), 0);
  hinderByPlane(normal, kept);
  EXPECT_EQ(kept.cols(), 0);
}

// Impulses in other places than the bodies are: the centre of mass and both momenta go back to those of the free
// motion, and the bodies do not move against each other.
TEST(KeptMomenta, AreThoseOfTheFreeMotion) {
  MovingBoxes at, free;
  centerOfMass(at.state(), 0) += Vec3(1e-3, 2e-3, -1e-3);
  centerOfMass(at.state(), 1) += Vec3(3e-3, -2e-3, 1e-3);
  linearVelocity(at.state(), 0) += Vec3(0.1, 0.2, -0.1);
  angularVelocity(at.state(), 1) += Vec3(0.4, -0.1, 0.3);
  const Vec3 apart = centerOfMass(at.state(), 0) - centerOfMass(at.state(), 1);
  const Vec3 spins = angularVelocity(at.state(), 0) - angularVelocity(at.state(), 1);
  keepMomenta(bothBoxes(), free.state(), at.mechanism(), at.state());
  EXPECT_LT((at.center() - free.center()).norm(), kSumRounding);
  EXPECT_LT((at.momentum() - free.momentum()).norm(), kSumRounding);
  EXPECT_LT((at.angularMomentumAbout(at.center()) - free.angularMomentumAbout(free.center())).norm(), kSumRounding);
  EXPECT_LT((centerOfMass(at.state(), 0) - centerOfMass(at.state(), 1) - apart).norm(), kSumRounding);
  EXPECT_LT((angularVelocity(at.state(), 0) - angularVelocity(at.state(), 1) - spins).norm(), kSumRounding);
}

// Across a plane the impulse of the plane counts: neither place nor momentum are those of the free motion.
TEST(KeptMomenta, AreNotThoseAcrossAPlane) {
  MovingBoxes at, free;
  for (int body = 0; body < 2; ++body) {
    centerOfMass(at.state(), body) += Vec3(1e-3, 2e-3, -1e-3);
    linearVelocity(at.state(), body) += Vec3(0.1, 0.2, -0.1);
  }
  keepMomenta(bothBoxes({Vec3::UnitY()}), free.state(), at.mechanism(), at.state());
  EXPECT_LT((at.center() - free.center() - Vec3(0, 2e-3, 0)).norm(), kSumRounding);
  EXPECT_LT((at.momentum() - free.momentum() - 5 * Vec3(0, 0.2, 0)).norm(), kSumRounding);
}

// Restitution e of an impact loses 1 - 2 e + 0.5 e^2: nothing at e = 2 - sqrt(2). A fraction a little less gains none.
TEST(FractionWithoutGain, IsTheRootOfTheLoss) {
  const auto lossWith = [](double e) { return 1 - 2 * e + 0.5 * e * e; };
  const double fraction = fractionWithoutGain(lossWith, lossWith(1));
  EXPECT_NEAR(fraction, 2 - std::sqrt(2), 1e-6);
  EXPECT_GE(lossWith(fraction), 0);
  EXPECT_EQ(fractionWithoutGain([](double e) { return -1 - e; }, -2), 0);  // even without restitution
}

}  // namespace
}  // namespace cradle
