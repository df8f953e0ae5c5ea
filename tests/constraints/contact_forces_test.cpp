#include "constraints/contact_forces.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "constraints/bodies_on_ground.h"
#include "constraints/constraint_row.h"
#include "dynamics/driven_body.h"

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
    equations.evaluate(0, row.state, expected);
    row.mechanism.contacts.push_back(row.mechanism.contacts[1]);
    row.mechanism.contacts.push_back(corner(0, Vec3(-0.1, -0.2, -0.3), motion));
    row.mechanism.constraints.push_back(rod);
    equations.evaluate(0, row.state, got);
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
  equations.evaluate(0, state, rate);
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
  equations.evaluate(0, state, rate);
  EXPECT_LT(rate.segment(poseComponents(state), 4 * kVelocitySize).cwiseAbs().maxCoeff(),
            1e-10);  // arms / inertia: up to 10/kg
  for (std::size_t body = 0; body < 4; ++body) {
    double weight = 0;
    for (std::size_t i = 4 * body; i < 4 * body + 4; ++i) weight += equations.contactForces()[i].normal;
    EXPECT_NEAR(weight, kGravity * (1003 - static_cast<double>(body)), 1e-8);
  }
}

// Feet that stick to two plates which are driven apart with -1 and 3 m/s^2: no motion keeps both. Without friction's
// hold the box would stay; it goes with their mean, and rows leave 2 m/s^2 of the 3 that the most of them asks for.
TEST(RedundantContacts, ThatContradictEachOtherAreHeldInTheMean) {
  Mechanism mechanism = manyOnEarth(3);
  mechanism.gravity.setZero();
  for (const int plate : {1, 2}) {
    mechanism.bodies[static_cast<std::size_t>(plate)] = drivenRigidBody();
    const double x = plate == 1 ? -0.3 : 0.3, acceleration = plate == 1 ? -1 : 3;
    OscillatingMotion motion;  // at an end of its way: at rest
    motion.direction = Vec3::UnitX(), motion.phase = -std::numbers::pi / 2;
    motion.amplitude = acceleration, motion.frequency = 1 / (2 * std::numbers::pi);
    add(plate, motion, mechanism.driven);
    for (const double z : {-0.2, 0.2})
      mechanism.contacts.push_back(ballOnFace({0, Vec3(x, 0, z)}, 0, {plate, Vec3(0, 0, 0)}, Vec3::UnitY(), kSticking));
  }
  EquationsOfMotion equations(mechanism);
  VectorX rate;
  equations.evaluate(0, restingState(3), rate);
  EXPECT_NEAR(linearVelocity(rate, 0).x(), 1, 1e-12);
  for (const ContactForce& force : equations.contactForces()) {
    EXPECT_NEAR(force.left, 2, 1e-12);
    EXPECT_NEAR(force.asked, 3, 1e-12);
  }
}

/// Accelerations (or velocities, all bodies' six numbers in turn) in the layout of a state.
VectorX velocityPart(const VectorX& state) {
  return state.segment(poseComponents(state), bodyCount(state) * kVelocitySize);
}

/// Accelerations by the dense equations J M^-1 (J^T + F) lambda = -(J a + (dJ/dt) v) of all rows, whose shortest
/// solution Eigen finds by a complete orthogonal decomposition.
VectorX denseAccelerations(const Mechanism& mechanism, const VectorX& state) {
  std::vector<BodyFrame> frames;
  findBodyFrames(mechanism.bodies, state, frames);
  std::vector<ConstraintRow> rows = rowsOf(mechanism.constraints, state, frames);
  std::vector<ConstraintRow> answers = rows;
  for (const ContactConstraint& contact : mechanism.contacts) {
    const ContactKinematics place = kinematicsOf(contact, state, frames);
    ConstraintBlock block;
    findRows(contact, place, contact.motion == kSticking, block);
    for (int i = 0; i < block.rows; ++i) rows.push_back(rowOf(block, i)), answers.push_back(rows.back());
    if (contact.motion != kSliding) continue;
    const Vec3 friction = -contact.friction * slidingDirection(contact, place, frames, 0);
    ConstraintRow& answer = answers.back();
    answer.linearA += friction, answer.angularA += place.armA.cross(friction);
    answer.linearB -= friction, answer.angularB -= place.armB.cross(friction);
  }
  Mechanism free = mechanism;
  free.constraints.clear(), free.contacts.clear();
  const VectorX derivative = rateOf(free, state);
  const Eigen::Index size = std::ssize(rows);
  MatrixX jacobian(size, bodyCount(state) * kVelocitySize), response(jacobian.cols(), size);
  VectorX side(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const std::size_t row = static_cast<std::size_t>(i);
    VectorX unit = VectorX::Zero(state.size());
    response.col(i) = velocityPart(responseTo(answers[row], mechanism.bodies, frames));
    side[i] = -(rateOf(rows[row], derivative) + rows[row].velocityProduct);
    for (Eigen::Index k = 0; k < jacobian.cols(); ++k) {
      unit[poseComponents(state) + k] = 1;
      jacobian(i, k) = rateOf(rows[row], unit);
      unit[poseComponents(state) + k] = 0;
    }
  }
  const MatrixX matrix = jacobian * response;
  return velocityPart(derivative) + response * matrix.completeOrthogonalDecomposition().solve(side);
}

// A row of bodies, each joined to the next by a ball joint, a hinge or a rod, two of them also to the one after (a
// ring), one twice by the same joint (redundant rows), on corners that stick, slide, or have no friction. Forces of 1e2
// N and condition numbers of 1e4 make 1e-10 of rounding.
TEST(ContactForces, WithConstraintsAreThoseOfADenseMatrix) {
  Row row(6);
  for (std::size_t i = 0; i < row.mechanism.contacts.size(); i += 4) row.mechanism.contacts[i].motion = kSticking;
  row.mechanism.contacts.resize(5);
  const auto join = [&](int a, int b, const Vec3& place, const auto& kind) {
    row.mechanism.constraints.push_back(
        {{a, place - centerOfMass(row.state, a)}, {b, place - centerOfMass(row.state, b)}, kind});
  };
  const HingeConstraint hinge{Vec3::UnitZ(), {Vec3::UnitX(), Vec3::UnitY()}};
  row.mechanism.constraints = {{{0, Vec3(0, 0.3, 0)}, {1, Vec3(0.1, 0, 0.1)}, RodConstraint{1.1}}};
  join(1, 2, Vec3(1.4, 0.3, -0.1), hinge);
  join(2, 3, Vec3(2.6, 0.5, 0.2), BallJointConstraint());
  join(3, 4, Vec3(3.5, 0.4, 0), hinge);
  join(3, 4, Vec3(3.5, 0.4, 0), hinge);
  join(1, 3, Vec3(2, 0.9, 0.3), BallJointConstraint());
  row.mechanism.constraints.push_back({{4, Vec3(0.1, 0, 0)}, {5, Vec3(-0.1, 0.2, 0)}, RodConstraint{0.9}});
  row.mechanism.constraints.push_back({{5, Vec3(0, 0.2, 0)}, {kFixed, Vec3(5, 2, 0.4)}, RodConstraint{1.7}});
  const VectorX expected = denseAccelerations(row.mechanism, row.state);
  EXPECT_LT((velocityPart(rateOf(row.mechanism, row.state)) - expected).norm(), 1e-10 * expected.norm());
}

// Where a ball joint holds a corner to the world, a contact can neither open nor close: it has no force, and the motion
// is that without it.
TEST(ContactForces, AreNoneWhereConstraintsLeaveAContactNoMotion) {
  Mechanism mechanism = onEarth({lopsided(2)});
  const Vec3 point(0.2, -0.2, 0.1);
  mechanism.constraints = {{{0, point}, {kFixed, Vec3(0.2, 0, 0.1)}, BallJointConstraint()}};
  for (const double angle : {0.1, 0.4, 0.9, 1.3, 2.2}) {  // rounding, of either sign
    VectorX state = restingState(1);
    setOrientation(state, 0, rotationAbout(Vec3(1, 2, -1), angle));
    centerOfMass(state, 0) = Vec3(0.2, 0, 0.1) - orientation(state, 0) * point;
    angularVelocity(state, 0) = Vec3(0.3, -0.2, 1);
    mechanism.contacts.clear();
    const VectorX expected = rateOf(mechanism, state);
    for (const ContactMotion motion : {kFrictionless, kSliding, kSticking}) {
      mechanism.contacts = {corner(0, point, motion)};
      EquationsOfMotion equations(mechanism);
      VectorX rate;
      equations.evaluate(0, state, rate);
      EXPECT_LT(largestDifference(rate, expected), 1e-12) << angle;
      EXPECT_LT(std::abs(equations.contactForces()[0].normal), 1e-12) << angle;
    }
  }
}

// ContactSolver::project:

TEST(ContactProjection, ClosesGapsAndTiesAtOnceToRounding) {
  Row row(2);
  row.mechanism.contacts.push_back(corner(1, Vec3(-0.1, -0.2, -0.3), kFrictionless));  // redundant
  row.mechanism.contacts[0].motion = kSticking;
  row.mechanism.constraints = {{{0, Vec3(0.5, 0.1, 0)}, {1, Vec3(-0.5, 0.1, 0)}, BallJointConstraint()}};
  const VectorX sound = row.state;
  centerOfMass(row.state, 0) += Vec3(1e-4, 3e-4, -2e-4);
  turnBody(row.state, 1, Vec3(2e-4, 1e-4, -3e-4));
  EquationsOfMotion equations(row.mechanism);
  EXPECT_GT(equations.project(row.state), 2e-4);
  std::vector<BodyFrame> frames;
  findBodyFrames(row.mechanism.bodies, row.state, frames);
  for (const ConstraintRow& tie : rowsOf(row.mechanism.constraints, row.state, frames)) {
    EXPECT_NEAR(tie.value, 0, 3e-15);
    EXPECT_NEAR(rateOf(tie, row.state), 0, 1e-14);
  }
  for (std::size_t i = 0; i < row.mechanism.contacts.size(); ++i) {
    const ContactKinematics place = placeIn(row.mechanism, i, row.state);
    EXPECT_NEAR(place.gap, 0, 2e-15) << i;
    EXPECT_NEAR(place.velocity.dot(place.normal), 0, 1e-14) << i;
    EXPECT_TRUE(i > 0 || place.velocity.norm() < 1e-14);  // the first one sticks
  }
  EXPECT_LT(largestDifference(row.state.head(2 * kPoseSize), sound.head(2 * kPoseSize)), 1e-3);
}

// A joint that is off while the gap of its group is closed: the ball rolls below it.
TEST(ContactProjection, BringsConstraintsTogetherUnderAClosedGap) {
  Mechanism mechanism = onEarth({solidSphere(1, 0.2)});
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.2, {}, Vec3::UnitY(), kFrictionless)};
  mechanism.constraints = {{{0, Vec3::Zero()}, {kFixed, Vec3(0.301, 0.6, 0)}, RodConstraint{0.5}}};
  VectorX state = restingState(1);
  centerOfMass(state, 0).y() = 0.2;
  EquationsOfMotion equations(mechanism);
  EXPECT_NEAR(equations.project(state), 6e-4, 1e-6);
  EXPECT_NEAR((Vec3(centerOfMass(state, 0)) - Vec3(0.301, 0.6, 0)).norm(), 0.5, 1e-15);
  EXPECT_NEAR(centerOfMass(state, 0).y(), 0.2, 1e-15);
}

// The shortest way, by mass: a free ball and one twice as heavy, 1 mm into each other, part 2:1.
TEST(ContactProjection, MovesBodiesByTheInverseOfTheirMasses) {
  Mechanism mechanism;
  mechanism.bodies = {solidSphere(1, 0.2), solidSphere(2, 0.3)};
  mechanism.contacts = {sphereOnSphere({0, Vec3::Zero()}, 0.2, {1, Vec3::Zero()}, 0.3, kFrictionless)};
  VectorX state = restingState(2);
  centerOfMass(state, 0).x() = 0.499;
  linearVelocity(state, 0) = Vec3(-3, 1, 0);
  EquationsOfMotion equations(mechanism);
  EXPECT_NEAR(equations.project(state), 1e-3, 1e-15);
  EXPECT_NEAR(centerOfMass(state, 0).x(), 0.499 + 2e-3 / 3, 1e-15);
  EXPECT_NEAR(centerOfMass(state, 1).x(), -1e-3 / 3, 1e-15);
  EXPECT_LT((Vec3(linearVelocity(state, 0)) - Vec3(-1, 1, 0)).norm(), 1e-14);  // as after an impact without rebound
  EXPECT_LT((Vec3(linearVelocity(state, 1)) - Vec3(-1, 0, 0)).norm(), 1e-14);
}

// Bodies without a contact are moved too, where their rods ask for it; the error is the largest of all.
TEST(ContactProjection, RestoresRodsOfBodiesWithoutContacts) {
  Mechanism mechanism = onEarth({solidSphere(1, 0.2), solidSphere(2, 0.3)});
  mechanism.contacts = {ballOnFace({0, Vec3::Zero()}, 0.2, {}, Vec3::UnitY(), kFrictionless)};
  mechanism.constraints = {{{1, Vec3::Zero()}, {kFixed, Vec3(5, 3, 0)}, RodConstraint{1}}};
  VectorX state = restingState(2);
  centerOfMass(state, 0).y() = 0.2 + 1e-4, centerOfMass(state, 1) = Vec3(5, 4.01, 0);
  linearVelocity(state, 1) = Vec3(1, 2, 0);
  EquationsOfMotion equations(mechanism);
  EXPECT_NEAR(equations.project(state), 0.01 + 0.01 * 0.01 / 2, 1e-14);  // C / scale of the rod
  EXPECT_NEAR(centerOfMass(state, 0).y(), 0.2, 1e-16);
  EXPECT_NEAR(centerOfMass(state, 1).y(), 4, 1e-15);
  EXPECT_LT((Vec3(linearVelocity(state, 1)) - Vec3(1, 0, 0)).norm(), 1e-15);
}

// Two rods of different lengths between the same points contradict each other: the body stays finite, and what a step
// of Newton's made worse is undone, so that projecting again changes nothing.
TEST(ContactProjection, LeavesContradictionsAsTheyAre) {
  for (const double longer : {1e-6, 1e-2}) {
    Mechanism mechanism = onEarth({lopsided(1)});
    mechanism.contacts = {corner(0, Vec3(0.1, -0.2, 0.1), kFrictionless)};
    for (const double length : {1.0, 1 + longer})
      mechanism.constraints.push_back({{0, Vec3(0, 0.2, 0.1)}, {kFixed, Vec3(0.6, 0.9, 0.5)}, RodConstraint{length}});
    VectorX state = restingState(1);
    centerOfMass(state, 0) = Vec3(0, 0.21, 0.02);
    EquationsOfMotion equations(mechanism);
    const double found = equations.project(state);
    ASSERT_TRUE(state.allFinite());
    const VectorX once = state;
    const double left = equations.project(state);
    EXPECT_LE(left, found);
    EXPECT_GT(left, longer / 4);
    EXPECT_LT(largestDifference(state, once), 1e-2 * longer) << longer;
  }
}

}  // namespace
}  // namespace cradle
