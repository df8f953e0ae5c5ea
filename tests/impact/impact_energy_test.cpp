#include "impact/impact_energy.h"

#include <gtest/gtest.h>

#include "constraints/invariants.h"

namespace cradle {
namespace {

// A ball of 2 kg and one of 3 kg meet off centre with (1, 2, 0) and (-1, 0, 0.5) m/s.
struct Meeting {
  std::vector<RigidBody> bodies = {makeRigidBody({2, Vec3::Zero(), Vec3(0.1, 0.2, 0.3).asDiagonal()}),
                                   makeRigidBody({3, Vec3::Zero(), Vec3(0.4, 0.2, 0.5).asDiagonal()})};
  VectorX state = VectorX::Zero(stateSize(2));
  Contact contact;

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
    bookImpact({{meeting.contact, {}, 0, impulse}}, meeting.bodies, before, meeting.state);
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
    bookImpact({{meeting.contact, {}, 0, impulse}}, meeting.bodies, before, meeting.state);
    EXPECT_EQ(impactEnergy(meeting.state) == lost, error < 1e-14);
  }
}

}  // namespace
}  // namespace cradle
