#include "constraints/invariants.h"

#include <gtest/gtest.h>

#include "dynamics/driven_body.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kInvariantRounding = 1e-12;  // of some tens of operations on numbers below 100

/// A body of point masses at the ends of three unequal axes, which moves in all ways: its sums are theirs.
struct PointMasses {
  PointMasses() : state(VectorX::Zero(stateSize(2))) {
    mechanism.gravity = Vec3(0.5, -9.81, 0.3);
    Mat3 tensor = Mat3::Zero();
    for (const Vec3& point : points)
      tensor += kPointMass * (point.squaredNorm() * Mat3::Identity() - point * point.transpose());
    const double whole = kPointMass * static_cast<double>(points.size());
    mechanism.bodies = {makeRigidBody({whole, Vec3::Zero(), tensor}), makeRigidBody({2, Vec3::Zero(), tensor})};
    setOrientation(state, 0, rotationAbout(Vec3(1, 2, 3), 0.9));
    setOrientation(state, 1, Quat::Identity());
    centerOfMass(state, 0) = Vec3(1, 2, 3), centerOfMass(state, 1) = Vec3(-4, 1, 0);
    linearVelocity(state, 0) = Vec3(0.4, -1, 0.3), linearVelocity(state, 1) = Vec3(1, 2, -1);
    angularVelocity(state, 0) = Vec3(2, -1, 0.5);
  }
  /// The second body does not turn: it is one more point.
  template <class Add>
  void forEachPoint(const Add& add) const {
    for (const Vec3& point : points) {
      const Vec3 arm = orientation(state, 0) * point;
      add(kPointMass, Vec3(centerOfMass(state, 0)) + arm,
          Vec3(linearVelocity(state, 0)) + Vec3(angularVelocity(state, 0)).cross(arm));
    }
    add(2.0, Vec3(centerOfMass(state, 1)), Vec3(linearVelocity(state, 1)));
  }

  static constexpr double kPointMass = 0.5;  // kg
  const std::vector<Vec3> points = {{0.7, 0, 0}, {-0.7, 0, 0}, {0, 0.4, 0}, {0, -0.4, 0}, {0, 0, 0.2}, {0, 0, -0.2}};
  Mechanism mechanism;
  VectorX state;
};

TEST(Invariants, AreTheSumsOfPointMasses) {
  const PointMasses at;
  Invariants expected;
  at.forEachPoint([&](double mass, const Vec3& place, const Vec3& velocity) {
    expected.kinetic += mass * velocity.squaredNorm() / 2;
    expected.potential -= mass * Vec3(0.5, -9.81, 0.3).dot(place);
    expected.momentum += mass * velocity;
    expected.angularMomentum += mass * place.cross(velocity);
  });
  const Invariants sums = invariantsOf(at.mechanism, at.state);
  EXPECT_NEAR(sums.kinetic, expected.kinetic, kInvariantRounding);
  EXPECT_NEAR(sums.potential, expected.potential, kInvariantRounding);
  EXPECT_LT((sums.momentum - expected.momentum).norm(), kInvariantRounding);
  EXPECT_LT((sums.angularMomentum - expected.angularMomentum).norm(), kInvariantRounding);
  EXPECT_NEAR(mechanicalEnergy(at.mechanism, at.state), sums.kinetic + sums.potential, kInvariantRounding);
  EXPECT_NEAR(kineticEnergy(at.mechanism.bodies[0], 0, at.state) + kineticEnergy(at.mechanism.bodies[1], 1, at.state),
              sums.kinetic, kInvariantRounding);
}

// k (L - L0)^2 / 2 between the centres, of which the distance is sqrt(35).
TEST(Invariants, CountTheEnergyOfSprings) {
  PointMasses at;
  const double before = mechanicalEnergy(at.mechanism, at.state);
  at.mechanism.springs.push_back({{0, Vec3::Zero()}, {1, Vec3::Zero()}, 30, 7, 2});
  const double stored = 15 * std::pow(std::sqrt(35.0) - 2, 2);
  EXPECT_NEAR(mechanicalEnergy(at.mechanism, at.state) - before, stored, kInvariantRounding);
  const Invariants sums = invariantsOf(at.mechanism, at.state);
  EXPECT_NEAR(sums.kinetic + sums.potential - before, stored, kInvariantRounding);
}

// What impacts, friction, dampers and errors took is still there, what pushes gave is not.
TEST(EnergyConstant, IsTheSumOfTheLedger) {
  PointMasses at;
  const double energy = mechanicalEnergy(at.mechanism, at.state);
  impactEnergy(at.state) = 1, frictionEnergy(at.state) = 2, dampingEnergy(at.state) = 4;
  numericalEnergy(at.state) = 8, pushWork(at.state) = 16;
  EXPECT_NEAR(energyConstant(at.mechanism, at.state), energy + 1 + 2 + 4 + 8 - 16, kInvariantRounding);
}

// Booking makes the constant what it was, and adds to what was booked before.
TEST(EnergyConstant, IsRestoredByBooking) {
  PointMasses at;
  numericalEnergy(at.state) = 3;
  const double constant = energyConstant(at.mechanism, at.state);
  linearVelocity(at.state, 1) *= 0.5;  // takes 3/4 of 2 x 6 / 2 J
  bookNumerical(constant, at.mechanism, at.state);
  EXPECT_NEAR(energyConstant(at.mechanism, at.state), constant, kInvariantRounding);
  EXPECT_NEAR(numericalEnergy(at.state), 3 + 4.5, kInvariantRounding);
}

TEST(EnergyConstant, IsThatOfAStepsStartAtItsEnd) {
  PointMasses at;
  Step step;
  step.startState = step.state = at.state;
  linearVelocity(step.state, 1) *= 2;  // gives 3 x 6 J
  bookStep(at.mechanism, step);
  EXPECT_NEAR(numericalEnergy(step.state), -18, kInvariantRounding);
  EXPECT_EQ(numericalEnergy(step.startState), 0);
}

// A projection by what is driven is the work m du . u + dL . w, of which m du^2 / 2 + dw . dL / 2 is lost: both are as
// stated in a frame in which all stand still at first, and the latter is the same in every frame. Without a driven body
// nothing works.
TEST(EnergyConstant, BooksTheWorkOfProjectionsBesideDrivenBodies) {
  const Vec3 change(0.3, -0.2, 0.5), turn(0.02, 0.01, -0.03);
  for (const bool isLed : {true, false})
    for (const Vec3& common : {Vec3(0, 0, 0), Vec3(30, -20, 10)}) {
      PointMasses at;
      if (isLed) {
        at.mechanism.bodies.push_back(drivenRigidBody());
        VectorX state = VectorX::Zero(stateSize(3));
        for (Eigen::Index body = 0; body < 2; ++body) setOrientation(state, body, orientation(at.state, body));
        setOrientation(state, 2, Quat::Identity());
        at.state = state;
        add(2, PrescribedMotion{}, at.mechanism.driven);
      }
      for (Eigen::Index body = 0; body < 2; ++body) linearVelocity(at.state, body) = common;
      angularVelocity(at.state, 0).setZero();
      const VectorX before = at.state;
      linearVelocity(at.state, 0) += change, angularVelocity(at.state, 0) += turn;
      const Vec3 spin = spinMomentum(at.mechanism.bodies[0], 0, at.state);
      const double mass = at.mechanism.bodies[0].mass, lost = (mass * change.squaredNorm() + turn.dot(spin)) / 2,
                   work = mass * change.dot(common + change) + turn.dot(spin);
      bookProjection(before, at.mechanism, at.state);
      EXPECT_NEAR(pushWork(at.state), isLed ? work : 0, 1e3 * kInvariantRounding);
      EXPECT_NEAR(numericalEnergy(at.state), isLed ? lost : lost - work, 1e3 * kInvariantRounding);
    }
}

}  // namespace
}  // namespace cradle
