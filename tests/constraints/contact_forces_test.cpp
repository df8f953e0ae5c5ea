#include "constraints/contact_forces.h"

#include <gtest/gtest.h>

#include "constraints/bodies_on_ground.h"

namespace cradle {
namespace {

// The same contact twice, four corners for three, a rod twice: the motion stays.
TEST(RedundantContacts, DoWhatIndependentOnesDo) {
  for (const ContactMotion motion : {kFrictionless, kSliding, kSticking}) {
    Row row(1);
    for (ContactConstraint& contact : row.mechanism.contacts) contact.motion = motion;
    const Attachment onBody{0, Vec3(0, 0.3, 0.1)}, onWorld{kFixed, Vec3(0.3, 1, 0)};
    const double length = (motionOf(onBody, row.state).position - onWorld.point).norm();
    const Constraint rod{onBody, onWorld, RodConstraint{length}};
    row.mechanism.constraints = {rod};
    linearVelocity(row.state, 0).setZero();  // so that all corners slide the same way: friction is determined then
    EquationsOfMotion equations(row.mechanism);
    VectorX expected, got;
    equations.evaluate(row.state, expected);
    row.mechanism.contacts.push_back(row.mechanism.contacts[1]);
    row.mechanism.contacts.push_back(corner(0, Vec3(-0.1, -0.2, -0.3), motion));
    row.mechanism.constraints.push_back(rod);
    equations.evaluate(row.state, got);
    EXPECT_LT(largestDifference(got, expected), 1e-12 * (1 + expected.cwiseAbs().maxCoeff()));
    EXPECT_NEAR(equations.contactForces()[1].normal, equations.contactForces()[3].normal, 1e-11);
  }
}

// Four equal corners about the centre of mass share the weight: the shortest of all multipliers.
TEST(RedundantContacts, ShareTheWeightEqually) {
  Mechanism mechanism = manyOnEarth(1);
  mechanism.gravity = Vec3(0, -kGravity, 0);
  for (const double x : {-0.3, 0.3})
    for (const double z : {-0.2, 0.2}) mechanism.contacts.push_back(corner(0, Vec3(x, -0.2, z), kSticking));
  VectorX state = restingState(1), rate;
  centerOfMass(state, 0).y() = 0.2;
  EquationsOfMotion equations(mechanism);
  equations.evaluate(state, rate);
  for (const ContactForce& force : equations.contactForces()) {
    EXPECT_NEAR(force.normal, 2 * kGravity / 4, 1e-13);
    EXPECT_LT(force.tangential.norm(), 1e-13);
  }
}

// Three boxes of 1 kg under one of 1000: the light ones are in balance between 1e4 N above and below, rounded by 1e-12
// N; what decides about these forces is a thousandth of the matrix.
TEST(RedundantContacts, CarryAHeavyBodyOnLightOnes) {
  Mechanism mechanism = manyOnEarth(4);
  mechanism.gravity = Vec3(0, -kGravity, 0);
  VectorX state = restingState(4), rate;
  for (int body = 0; body < 4; ++body) {
    mechanism.bodies[static_cast<std::size_t>(body)] = lopsided(body < 3 ? 1 : 1000);
    centerOfMass(state, body) = Vec3(0.01 * body, 0.2 + 0.4 * body, 0);
    for (const double x : {-0.3, 0.3})
      for (const double z : {-0.2, 0.2})
        mechanism.contacts.push_back(ballOnFace({body, Vec3(x, -0.2, z)}, 0, {body - 1, Vec3(0, body > 0 ? 0.2 : 0, 0)},
                                                Vec3::UnitY(), kSticking));
  }
  EquationsOfMotion equations(mechanism);
  equations.evaluate(state, rate);
  EXPECT_LT(rate.segment(poseComponents(state), 4 * kVelocitySize).cwiseAbs().maxCoeff(),
            1e-10);  // arms / inertia: up to 10/kg
  for (std::size_t body = 0; body < 4; ++body) {
    double weight = 0;
    for (std::size_t i = 4 * body; i < 4 * body + 4; ++i) weight += equations.contactForces()[i].normal;
    EXPECT_NEAR(weight, kGravity * (1003 - static_cast<double>(body)), 1e-8);
  }
}

// Feet that stick to two plates which move apart: no motion keeps both; the box goes with their mean.
TEST(RedundantContacts, ThatContradictEachOtherAreHeldInTheMean) {
  Mechanism mechanism = manyOnEarth(3);
  mechanism.gravity.setZero();
  for (const int plate : {1, 2}) {
    mechanism.bodies[static_cast<std::size_t>(plate)] = lopsided(1e9, Quat::Identity());
    mechanism.pushes.push_back({{plate, Vec3::Zero()}, Vec3(plate == 1 ? -1e9 : 3e9, 0, 0)});
    const double x = plate == 1 ? -0.3 : 0.3;
    for (const double z : {-0.2, 0.2})
      mechanism.contacts.push_back(ballOnFace({0, Vec3(x, 0, z)}, 0, {plate, Vec3(0, 0, 0)}, Vec3::UnitY(), kSticking));
  }
  const VectorX rate = rateOf(mechanism, restingState(3));
  EXPECT_TRUE(rate.allFinite());
  EXPECT_LT(rate.cwiseAbs().maxCoeff(), 10);
}

}  // namespace
}  // namespace cradle
