#include "impact/rope_impulse.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "impact/row_of_balls.h"
#include "math/rotation.h"

namespace cradle {
namespace {

void applyToFree(std::vector<RopePull>& pulls, const std::vector<RigidBody>& bodies, VectorX& state) {
  const Constraints none;
  ConstraintSolver solver(none, bodies);
  solver.factorize(state);
  applyPulls(pulls, bodies, solver, state);
}

// Two balls that fly apart: the impulse ends their lengthening and gives them the rebound speed, over 1/m1 + 1/m2. A
// rope that shortens faster than that, or exactly as fast, does not pull.
TEST(RopeImpulse, OfOneRopeMatchesTheClosedForm) {
  const std::vector<RigidBody> bodies{ball(2), ball(0.5)};
  const Limit rope = RopeLimit{{0, Vec3::Zero()}, {1, Vec3::Zero()}, 1, 0};
  const Vec3 along = Vec3(0.6, 0, 0.8), across = Vec3(0.8, 1, -0.6);
  for (const double rebound : {0.0, 0.7})
    for (const double lengthening : {3.0, -0.2, -rebound, -0.9}) {
      VectorX state = statesAtRest(2);
      centerOfMass(state, 1) = along;
      linearVelocity(state, 0) = across, linearVelocity(state, 1) = across + lengthening * along;
      std::vector<RopePull> pulls{{&rope, rebound, -1}};
      applyToFree(pulls, bodies, state);
      const double impulse = std::max(0.0, lengthening + rebound) / (0.5 + 2);
      EXPECT_NEAR(pulls[0].impulse, impulse, 1e-15) << rebound << ' ' << lengthening;
      EXPECT_LT((linearVelocity(state, 0) - across - 0.5 * impulse * along).norm(), 2e-15);
      EXPECT_LT((linearVelocity(state, 1) - across - (lengthening - 2 * impulse) * along).norm(), 2e-15);
    }
}

/// Bodies without symmetry on ropes between points beside their centres, two of them to the world.
struct TangledRopes {
  std::vector<RigidBody> bodies;
  std::vector<Limit> ropes;
  VectorX state = statesAtRest(3);

  explicit TangledRopes(int seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const auto numbers = [&] {
      std::uniform_real_distribution<double> uniform(-1, 1);
      const double x = uniform(random), y = uniform(random);
      return Vec3(x, y, uniform(random));
    };
    for (int body = 0; body < 3; ++body) {
      const double mass = std::pow(4, body - 1);
      bodies.push_back(makeRigidBody({mass, Vec3::Zero(), Mat3(mass * Vec3(0.2, 0.5, 0.6).asDiagonal())}));
      centerOfMass(state, body) = 3 * numbers();
      setOrientation(state, body, rotationAbout(numbers(), 2));
      linearVelocity(state, body) = numbers(), angularVelocity(state, body) = numbers();
    }
    for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {0, 2}, {2, kFixed}, {kFixed, 0}})
      ropes.emplace_back(RopeLimit{{a, numbers()}, {b, numbers()}, 1, 0});
  }
  struct End {
    Vec3 point, velocity;
  };
  End endOf(const Attachment& anchor, const VectorX& at) const {
    if (anchor.body == kFixed) return {anchor.point, Vec3::Zero()};
    const Vec3 arm = orientation(at, anchor.body) * anchor.point;
    return {centerOfMass(at, anchor.body) + arm,
            linearVelocity(at, anchor.body) + angularVelocity(at, anchor.body).cross(arm)};
  }
  double lengthening(const Limit& limit, const VectorX& at) const {
    const RopeLimit& rope = std::get<RopeLimit>(limit);
    const End a = endOf(rope.anchorA, at), b = endOf(rope.anchorB, at);
    return (a.point - b.point).normalized().dot(a.velocity - b.velocity);
  }
  /// Newton's and Euler's laws for a pull of this impulse on both ends.
  void pull(const Limit& limit, double impulse, VectorX& at) const {
    const RopeLimit& rope = std::get<RopeLimit>(limit);
    const Vec3 toB = (endOf(rope.anchorB, state).point - endOf(rope.anchorA, state).point).normalized();
    for (const auto& [anchor, push] :
         {std::pair{rope.anchorA, Vec3(impulse * toB)}, {rope.anchorB, Vec3(-impulse * toB)}}) {
      if (anchor.body == kFixed) continue;
      const RigidBody& body = bodies[static_cast<std::size_t>(anchor.body)];
      const Vec3 arm = endOf(anchor, state).point - centerOfMass(state, anchor.body);
      linearVelocity(at, anchor.body) += body.inverseMass * push;
      angularVelocity(at, anchor.body) += worldInverseInertia(body, orientation(state, anchor.body)) * arm.cross(push);
    }
  }
};

// The complementarity problem itself, checked by Newton's and Euler's laws: no rope pushes, each that pulls shortens
// with its rebound speed, each that does not shortens faster. In some of the trials, ropes go slack since others pull.
TEST(RopeImpulse, OfManyRopesPullsOnlyWhereARopeWouldLengthen) {
  int slackened = 0, pulling = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const TangledRopes tangle(trial);
    std::vector<RopePull> pulls;
    for (const Limit& rope : tangle.ropes) pulls.push_back({&rope, 0.1 * static_cast<double>(pulls.size()), 0});
    VectorX state = tangle.state, expected = tangle.state;
    applyToFree(pulls, tangle.bodies, state);
    for (const RopePull& pull : pulls) tangle.pull(*pull.rope, pull.impulse, expected);
    EXPECT_LT((state - expected).norm(), 1e-12) << trial;
    for (const RopePull& pull : pulls) {
      EXPECT_GE(pull.impulse, 0);
      const double left = tangle.lengthening(*pull.rope, state) + pull.reboundSpeed;
      // Velocities and their changes are of some m/s, rows of order one: 1e-12 is rounding of a system of five rows.
      EXPECT_NEAR(pull.impulse > 0 ? left : std::max(0.0, left), 0, 1e-12) << trial;
      pulling += pull.impulse > 0;
      slackened += pull.impulse == 0 && tangle.lengthening(*pull.rope, tangle.state) + pull.reboundSpeed > 0.01;
    }
  }
  EXPECT_GT(pulling, 80);
  EXPECT_GE(slackened, 2);
}

// Two ropes side by side pull half each.
TEST(RopeImpulse, IsSharedByRopesBetweenTheSamePoints) {
  const std::vector<RigidBody> bodies{ball(2)};
  const Limit rope = RopeLimit{{0, Vec3::Zero()}, {kFixed, Vec3::UnitY()}, 1, 0}, other = rope;
  VectorX state = statesAtRest(1);
  linearVelocity(state, 0) = Vec3(1, -3, 0);
  std::vector<RopePull> pulls{{&rope, 0, 0}, {&other, 0, 0}};
  applyToFree(pulls, bodies, state);
  EXPECT_NEAR(pulls[0].impulse, 3, 1e-14);
  EXPECT_NEAR(pulls[1].impulse, 3, 1e-14);
  EXPECT_LT((linearVelocity(state, 0) - Vec3::UnitX()).norm(), 1e-14);
}

// Of two balls on a rod that fall, the first is stopped by a rope above it, at an angle a to the rod. As part of the
// rigid dumbbell of mass M its inverse mass is (1 + m2 cos(a)^2 / m1) / M, with a between the rod and the plane across
// the rope.
TEST(RopeImpulse, IsAnsweredByARod) {
  const double m1 = 1.3, m2 = 4, angle = 0.4, fall = 2, length = 0.7;
  const Vec3 along(std::cos(angle), std::sin(angle), 0);
  const std::vector<RigidBody> bodies{ball(m1), ball(m2)};
  const Constraints rod = {{{0, Vec3::Zero()}, {1, Vec3::Zero()}, RodConstraint{length}}};
  const Limit rope = RopeLimit{{0, Vec3::Zero()}, {kFixed, Vec3::UnitY()}, 1, 0};
  VectorX state = statesAtRest(2);
  centerOfMass(state, 1) = length * along;
  for (int body = 0; body < 2; ++body) linearVelocity(state, body).y() = -fall;
  ConstraintSolver solver(rod, bodies);
  solver.factorize(state);
  std::vector<RopePull> pulls{{&rope, 0.5, 0}};
  applyPulls(pulls, bodies, solver, state);
  EXPECT_NEAR(pulls[0].impulse, (fall + 0.5) * (m1 + m2) / (1 + m2 / m1 * along.x() * along.x()), 1e-13);
  EXPECT_NEAR(linearVelocity(state, 0).y(), 0.5, 1e-14);
  EXPECT_NEAR(along.dot(linearVelocity(state, 1) - linearVelocity(state, 0)), 0, 1e-14);
}

}  // namespace
}  // namespace cradle
