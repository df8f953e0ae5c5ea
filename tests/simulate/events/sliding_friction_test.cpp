#include "simulate/events/sliding_friction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"

namespace cradle {
namespace {

/// A lopsided body that touches the plane y = 0 at points (m) from its centre of mass, under gravity along -y, with all
/// that a solution takes.
struct SlidingBody {
  std::vector<RigidBody> bodies{makeRigidBody({2, Vec3::Zero(), Mat3(Vec3(0.03, 0.08, 0.05).asDiagonal())})};
  VectorX state = VectorX::Zero(stateSize(1)), derivative = state;
  std::vector<BodyFrame> frames;
  std::vector<ContactRecord> records;
  std::vector<ContactRows> rows;

  SlidingBody(const std::vector<Vec3>& arms, double friction) {
    setOrientation(state, 0, rotationAbout(Vec3(1, 2, 3), 0.6));
    linearVelocity(derivative, 0) = Vec3(0.3, -10, 0.1);
    findBodyFrames(bodies, state, frames);
    for (const Vec3& arm : arms) {
      ContactRecord& record = records.emplace_back();
      record.contact = {0, 0, kFixed, arm, -Vec3::UnitY(), 0, 0, INFINITY};
      record.pair.material = {0, 1.2 * friction, friction};
      rows.push_back(rowsOf(record.contact, state, frames));
    }
  }
  void slide(std::size_t contact, const Vec3& direction) {
    records[contact].slides = true, records[contact].direction = direction;
  }
  DenseDelassus delassus() const { return {blocksOf(rows), bodies, frames, nullptr}; }
  SlidingSolution solve() const {
    std::vector<const ContactRecord*> members;
    for (const ContactRecord& record : records) members.push_back(&record);
    return solveContactForces(members, rows, delassus(), derivative, true);
  }
  /// A contact's part along the surfaces, in the world.
  Vec3 tangential(const VectorX& components, std::size_t contact) const {
    const Eigen::Index at = 3 * static_cast<Eigen::Index>(contact);
    return rows[contact].block.linear.topRows<2>().transpose() * components.segment<2>(at);
  }
  /// m/s^2: of the body's material at a contact, by Newton's and Euler's laws for forces that are its components.
  Vec3 accelerationAt(const Vec3& arm, const VectorX& forces) const {
    Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t i = 0; i < records.size(); ++i) {
      const Vec3 force = tangential(forces, i) + forces[3 * static_cast<Eigen::Index>(i) + 2] * Vec3::UnitY();
      sum += force, torque += records[i].contact.point.cross(force);
    }
    const Vec3 turning = worldInverseInertia(bodies[0], orientation(state, 0)) * torque;
    return linearVelocity(derivative, 0) + sum / bodies[0].mass + turning.cross(arm);
  }
};

// One contact: with friction -mu N d along its sliding d, the normal acceleration g_n + (W_nn - mu W_nd) N vanishes.
// Normal force and friction drive each other with the ratio mu W_nd / W_nn, up to 1, or against each other.
TEST(SlidingFriction, OfOneContactMatchesTheClosedForm) {
  const Vec3 arm(0.2, -0.3, 0.1), direction(0.6, 0, 0.8);
  for (const Vec3& sliding : {direction, Vec3(-direction)}) {
    const RigidBody body = SlidingBody({arm}, 0).bodies[0];
    const Mat3 inverse = worldInverseInertia(body, rotationAbout(Vec3(1, 2, 3), 0.6));
    const double normal = 1 / body.mass + arm.cross(Vec3::UnitY()).dot(inverse * arm.cross(Vec3::UnitY()));
    const double coupling = arm.cross(Vec3::UnitY()).dot(inverse * arm.cross(sliding));
    for (const double ratio : {0.1, 0.95, 3.0}) {  // of mu |W_nd| / W_nn
      const double friction = ratio * normal / std::abs(coupling);
      if (coupling > 0 && ratio > 1) continue;
      SlidingBody at({arm}, friction);
      at.slide(0, sliding);
      const SlidingSolution solution = at.solve();
      const double force = 10 / (normal - friction * coupling);
      // A residual of 1e-12 of the acceleration, which the feedback of friction enlarges at a ratio of 0.95.
      const double tolerance = 1e-10 * force;
      EXPECT_NEAR(solution.impulses[2], force, tolerance) << ratio;
      EXPECT_LT((at.tangential(solution.impulses, 0) + friction * force * sliding).norm(), friction * tolerance);
      EXPECT_NEAR(solution.velocities[2], 0, tolerance);
      EXPECT_EQ(solution.frictionError, 0);
    }
  }
}

// Beyond a ratio of 1 friction jams: no finite force does, and the error of friction tells that. The forces of the last
// round, however large, come with the accelerations that they give.
TEST(SlidingFriction, TellsWhereItJams) {
  const Vec3 arm(0.2, -0.3, 0.1);
  for (const Vec3& sliding : {Vec3(0.6, 0, 0.8), Vec3(-0.6, 0, -0.8)}) {
    const SlidingBody smooth({arm}, 0);
    const Mat3 inverse = worldInverseInertia(smooth.bodies[0], orientation(smooth.state, 0));
    const double coupling = arm.cross(Vec3::UnitY()).dot(inverse * arm.cross(sliding));
    if (coupling < 0) continue;
    const double normal = smooth.delassus().matrix()(2, 2);
    SlidingBody at({arm}, 1.5 * normal / coupling);
    at.slide(0, sliding);
    const SlidingSolution solution = at.solve();
    EXPECT_GT(solution.frictionError, 1);
    const Vec3 found = at.tangential(solution.velocities, 0) + solution.velocities[2] * Vec3::UnitY();
    const Vec3 given = at.accelerationAt(arm, solution.impulses);
    // Sums of some ten products of inverse masses below 3 / kg, counting moment arms.
    EXPECT_LT((found - given).norm(), 1e-14 * (1 + 3 * solution.impulses.norm()));
  }
}

// Three contacts, of which one slides and the others stick, or would have to slide: Coulomb's law for each, with the
// accelerations that Newton's and Euler's laws give.
TEST(SlidingFriction, KeepsCoulombsLawOfAllContacts) {
  const std::vector<Vec3> arms = {Vec3(0.2, -0.1, 0.1), Vec3(-0.15, -0.1, 0.12), Vec3(0.02, -0.1, -0.2)};
  for (const double friction : {0.02, 0.3, 0.8}) {
    SlidingBody at(arms, friction);
    at.slide(1, Vec3(0.8, 0, -0.6));
    const SlidingSolution solution = at.solve();
    const double tolerance = 1e-10;  // N, m/s^2: a residual of 1e-12 of 10 m/s^2, times some 20 for moment arms
    EXPECT_EQ(solution.frictionError, 0);
    for (std::size_t i = 0; i < 3; ++i) {
      const double force = solution.impulses[3 * static_cast<Eigen::Index>(i) + 2];
      const Vec3 friction3 = at.tangential(solution.impulses, i), sliding = at.tangential(solution.velocities, i);
      const double opening = solution.velocities[3 * static_cast<Eigen::Index>(i) + 2];
      const Vec3 acceleration = at.accelerationAt(arms[i], solution.impulses);
      EXPECT_LT((sliding + opening * Vec3::UnitY() - acceleration).norm(), tolerance);
      EXPECT_GE(force, -tolerance);
      EXPECT_GE(opening, -tolerance);
      EXPECT_NEAR(std::min(force, opening), 0, tolerance);
      if (i == 1) {
        EXPECT_LT((friction3 + friction * force * Vec3(0.8, 0, -0.6)).norm(), tolerance);
        continue;
      }
      const double limit = 1.2 * friction * force;  // static
      EXPECT_LE(friction3.norm(), limit + tolerance);
      if (sliding.norm() > 1e-6) {
        EXPECT_NEAR(friction3.dot(sliding), -limit * sliding.norm(), tolerance * (1 + sliding.norm())) << friction;
      }
    }
  }
}

}  // namespace
}  // namespace cradle
