#include "impact/impact_energy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/invariants.h"
#include "dynamics/driven_body.h"
#include "impact/contact_impulse.h"

namespace cradle {
namespace {

// A ball of 2 kg and one of 3 kg meet off centre with (1, 2, 0) and (-1, 0, 0.5) m/s.
struct Meeting {
  std::vector<RigidBody> bodies = {makeRigidBody({2, Vec3::Zero(), Vec3(0.1, 0.2, 0.3).asDiagonal()}),
                                   makeRigidBody({3, Vec3::Zero(), Vec3(0.4, 0.2, 0.5).asDiagonal()})};
  VectorX state = VectorX::Zero(stateSize(2));
  Contact contact;
  Constraints constraints = {};
  ConstraintSolver solver{constraints, bodies};

  Meeting() {
    centerOfMass(state, 1) = Vec3(1, 0, 0);
    for (Eigen::Index body : {0, 1}) setOrientation(state, body, Quat(1, 0, 0, 0));
    linearVelocity(state, 0) = Vec3(1, 2, 0), linearVelocity(state, 1) = Vec3(-1, 0, 0.5);
    angularVelocity(state, 0) = Vec3(0.3, -0.2, 0.1);
    contact.bodyA = 0, contact.bodyB = 1;
    contact.point = Vec3(0.5, 0.2, -0.1), contact.normal = Vec3(1, 0, 0);
  }
};

// An impulse changes the kinetic energy by its work with the mean of the velocities, whatever law it comes from: one of
// the wrong sign is booked as a gain, not as what was lost.
TEST(ImpactEnergy, IsTheKineticEnergyThatAnImpulseTakesWhicheverWayItPoints) {
  for (const Vec3& impulse : {Vec3(1.5, -0.4, 0.2), Vec3(-1.5, 0.4, -0.2)}) {
    Meeting meeting;
    const VectorX before = meeting.state;
    ImpulseResponse(meeting.bodies).apply(meeting.contact, impulse, meeting.state);
    bookImpact({{meeting.contact, {}, 0, impulse}}, meeting.bodies, meeting.solver, before, meeting.state);
    const double taken = kineticEnergy(meeting.bodies, before) - kineticEnergy(meeting.bodies, meeting.state);
    EXPECT_NEAR(impactEnergy(meeting.state), taken, 1e-14);
    EXPECT_EQ(impactEnergy(meeting.state) > 0, impulse.x() > 0);
    EXPECT_EQ(frictionEnergy(meeting.state), 0);
    EXPECT_EQ(numericalEnergy(meeting.state), 0);
  }
}

// Ties that take nearly all of an impulse p leave velocities that are rounded by 1e-16 p / m, and work by p times that:
// what bodies lost is known better. An error that is larger is one, and is not booked as the impact's.
TEST(ImpactEnergy, IsWhatBodiesLostWhereWorkIsRounded) {
  const Vec3 impulse(1e7, 0, 0);
  for (const double error : {1e-15, 1e-12}) {
    Meeting meeting;
    const VectorX before = meeting.state;
    ImpulseResponse(meeting.bodies).apply(meeting.contact, impulse, meeting.state);
    linearVelocity(meeting.state, 0).x() += error * impulse.x() / 2;
    const double lost = kineticEnergy(meeting.bodies, before) - kineticEnergy(meeting.bodies, meeting.state);
    bookImpact({{meeting.contact, {}, 0, impulse}}, meeting.bodies, meeting.solver, before, meeting.state);
    EXPECT_EQ(impactEnergy(meeting.state) == lost, error < 1e-14);
  }
}

/// A body of 2 kg on a rod and a ball joint from a driven body that goes with (1, 2, 3) m/s and (0.4, 0.5, -0.6) rad/s,
/// and a body of 3 kg that meets it.
struct LedBody {
  std::vector<RigidBody> bodies = {makeRigidBody({2, Vec3::Zero(), Vec3(0.1, 0.2, 0.25).asDiagonal()}),
                                   makeRigidBody({3, Vec3::Zero(), Vec3(0.4, 0.2, 0.5).asDiagonal()}),
                                   drivenRigidBody()};
  VectorX state = VectorX::Zero(stateSize(3));
  Constraints constraints;
  ConstraintSolver solver{constraints, bodies};

  explicit LedBody(bool isJoined) {
    for (Eigen::Index body : {0, 1, 2}) setOrientation(state, body, Quat(1, 0, 0, 0));
    centerOfMass(state, 1) = Vec3(1, 0, 0), centerOfMass(state, 2) = Vec3(0, 2, 0);
    linearVelocity(state, 2) = Vec3(1, 2, 3), angularVelocity(state, 2) = Vec3(0.4, 0.5, -0.6);
    linearVelocity(state, 0) = Vec3(2, 1, 0), linearVelocity(state, 1) = Vec3(-1, 0, 0.5);
    constraints.push_back({{0, Vec3(0.1, 0.5, 0)}, {2, Vec3(0.1, 0, 0.3)}, RodConstraint{std::hypot(1.5, 0.3)}});
    if (isJoined) constraints.push_back({{0, Vec3(0, 1, 0.2)}, {2, Vec3(0, -1, 0.2)}, BallJointConstraint{}});
    solver.factorize(state);
    solver.constrainVelocities(state);
  }
};

// Of a ball on a rod, what the end of the rod does along it: (v . d) d.
TEST(ImpactEnergy, LeadsABallAlongItsRod) {
  LedBody led(false);
  led.constraints[0] = {{0, Vec3::Zero()}, {2, Vec3::Zero()}, RodConstraint{2}};
  led.solver.factorize(led.state);
  const VectorX velocities = ledVelocities(led.bodies, led.solver, led.state);
  EXPECT_LT((linearVelocity(velocities, 0) - Vec3(0, 2, 0)).norm(), 1e-15);
  EXPECT_EQ(linearVelocity(velocities, 2), Vec3(1, 2, 3));
  EXPECT_EQ(linearVelocity(velocities, 1), Vec3(0, 0, 0));
}

// What bodies gain is what driven ones give through contacts and ties, less what the impact takes, whatever the impulse
// is: of a body that is tied to a driven one with another, and of one with the driven body itself. What constraints
// answer is known to 1e-14 of it, and works 10 J at most: ten times that.
TEST(ImpactEnergy, HasTheWorkOfWhatDrivesBodiesThroughTheirTies) {
  for (const bool isJoined : {false, true})
    for (const auto& [a, b] : {std::pair(0, 1), {1, 2}, {2, 0}}) {
      LedBody led(isJoined);
      const VectorX before = led.state;
      Contact contact;
      contact.bodyA = a, contact.bodyB = b;
      contact.point = Vec3(0.5, 0.2, -0.1), contact.normal = Vec3(1, 0, 0);
      const Vec3 impulse(1.5, -0.4, 0.2);
      ImpulseResponse(led.bodies, led.solver).apply(contact, impulse, led.state);
      bookImpact({{contact, {}, 0, impulse}}, led.bodies, led.solver, before, led.state);
      const double gained = kineticEnergy(led.bodies, led.state) - kineticEnergy(led.bodies, before);
      EXPECT_GT(std::abs(pushWork(led.state)), 0.1);
      EXPECT_NEAR(gained, pushWork(led.state) - impactEnergy(led.state), 1e-12) << a << ' ' << b;
      const Vec3 mean = (relativeVelocity(contact, before) + relativeVelocity(contact, led.state)) / 2;
      EXPECT_NEAR(impactEnergy(led.state), -impulse.dot(mean), 1e-12);
    }
}

}  // namespace
}  // namespace cradle
