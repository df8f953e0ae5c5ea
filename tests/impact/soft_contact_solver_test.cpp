#include "impact/soft_contact_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "impact/solver_bodies.h"

namespace cradle {
namespace {

constexpr double kSub = 1.0 / 480;  // s
constexpr double kPi = 3.14159265358979324;

/// Bodies with their contacts, for the solver alone.
class Contacting : public SolverBodies {
 public:
  static constexpr double kAnchorError = 6e-8;  // m, of anchors up to 1 m long

  int add(double mass, const Mat3& inertiaTensor, const Vec3& position, const Vec3& velocity, const Vec3& spin) {
    velocities_.push_back(velocity), spins_.push_back(spin);
    return SolverBodies::add(mass, inertiaTensor, position);
  }
  /// A contact of A with B, or with what is fixed, at points (m, world).
  PersistentManifold& touch(int a, int b, const Vec3& normal, const std::vector<Vec3>& points, double separation) {
    PersistentManifold& manifold = manifolds.emplace_back(manifoldOf(a, b, normal, points));
    manifold.material = &material, manifold.friction = material.dynamicFriction;
    for (std::size_t i = 0; i < points.size(); ++i) manifold.separations[i] = separation;
    return manifold;
  }
  void solve(int subSteps, const Vec3& gravity = Vec3::Zero(), double slowestRebound = 0.1) {
    motions.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      motions.velocities[i] = motionOf(i, velocities_[i], spins_[i]);
      motions.starts[i] = motions.velocities[i], motions.displacements[i] = {};
    }
    ContactColoring coloring;
    std::vector<ManifoldLink> links;
    for (std::size_t i = 0; i < manifolds.size(); ++i)
      links.push_back({static_cast<std::int32_t>(i), manifolds[i].bodyA, manifolds[i].bodyB, manifolds[i].count});
    solver.prepare(coloring.color(links, bodies.size()), manifolds, bodies, kSub, threads_);
    solver.solve({kSub, subSteps, slowestRebound, material.restitution > 0}, gravity, motions, threads_);
    solver.store(manifolds, threads_);
    for (std::size_t i = 0; i < bodies.size(); ++i) velocities_[i] = velocity(i), spins_[i] = spin(i);
  }

  Vec3 velocity(std::size_t body) const { return linearOf(motions.velocities[body]); }
  Vec3 displacement(std::size_t body) const { return linearOf(motions.displacements[body]); }
  Vec3 spin(std::size_t body) const { return angularOf(motions.velocities[body], body); }
  /// Opens and closes the contacts with what is fixed by what their body has moved.
  void follow() {
    for (PersistentManifold& manifold : manifolds) {
      const auto body = static_cast<std::size_t>(manifold.bodyA);
      const Vec3 turn = angularOf(motions.displacements[body], body);
      for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i)
        manifold.separations[i] -= manifold.normal.dot(displacement(body) + turn.cross(manifold.onA[i].cast<double>()));
    }
  }
  Vec3 pointVelocity(std::size_t body, const Vec3& point) const {
    return SolverBodies::pointVelocity(motions.velocities, static_cast<int>(body), point);
  }
  /// J, kg m/s, kg m^2/s about the origin, for velocities as they were given last or solved.
  double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      sum += 0.5 * (masses_[i] * velocities_[i].squaredNorm() + spins_[i].dot(inertias_[i] * spins_[i]));
    return sum;
  }
  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < masses_.size(); ++i) sum += masses_[i] * velocities_[i];
    return sum;
  }
  Vec3 angularMomentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < masses_.size(); ++i)
      sum += positions_[i].cross(masses_[i] * velocities_[i]) + inertias_[i] * spins_[i];
    return sum;
  }

  ContactMaterial material{0, 0, 0};
  std::vector<PersistentManifold> manifolds;
  SolverMotions motions;
  SoftContactSolver solver;

 private:
  WorkerThreads threads_{1};
  std::vector<Vec3> velocities_, spins_;
};

/// Two bodies without symmetry that meet at one point or at three, obliquely and spinning.
void meet(std::size_t points, Contacting& pair) {
  pair.add(2, lopsidedInertia(), Vec3(0.1, 0, 0), Vec3(0, 1, 0.3), Vec3(1, -2, 0.5));
  pair.add(3, 2 * lopsidedInertia(), Vec3(0, 0.5, 0.1), Vec3(0.2, -2, 0), Vec3(0.3, 1, 2));
  const std::vector<Vec3> all = {{0.15, 0.2, 0.05}, {-0.1, 0.21, 0.1}, {0.02, 0.22, -0.12}};
  pair.touch(0, 1, Vec3(0.1, 1, 0.05).normalized(), {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(points)},
             0);
}

// Impulses between bodies act along one line, at one place: neither momentum changes, with friction or without. What
// the solver says that contacts took is what is missing of the energy. Anchors of the two bodies are rounded apart.
TEST(SoftContactSolver, KeepsMomentaAndCountsTheEnergy) {
  for (const double friction : {0.0, 0.5})
    for (const double restitution : {0.0, 0.8})
      for (const std::size_t points : {1u, 3u}) {
        Contacting pair;
        pair.material = {restitution, friction, friction};
        meet(points, pair);
        pair.solve(8);
        SCOPED_TRACE(testing::Message() << friction << " " << restitution << " " << points);
        const Vec3 change = pair.momentum() - (2 * Vec3(0, 1, 0.3) + 3 * Vec3(0.2, -2, 0));
        EXPECT_LT(change.norm(), 1e-14);
        const Vec3 spins = lopsidedInertia() * (Vec3(1, -2, 0.5) + 2 * Vec3(0.3, 1, 2));
        const Vec3 angular =
            Vec3(0.1, 0, 0).cross(2 * Vec3(0, 1, 0.3)) + Vec3(0, 0.5, 0.1).cross(3 * Vec3(0.2, -2, 0)) + spins;
        constexpr double kMaxImpulse = 2 * 1.2 * 3 * (1 + 0.8);  // N s: reduced mass x speed, and as much by friction
        EXPECT_LT((pair.angularMomentum() - angular).norm(), 2 * kMaxImpulse * Contacting::kAnchorError);
        const double start = 0.5 * (2 * 1.09 + 3 * 4.04) +
                             0.5 * Vec3(1, -2, 0.5).dot(lopsidedInertia() * Vec3(1, -2, 0.5)) +
                             Vec3(0.3, 1, 2).dot(lopsidedInertia() * Vec3(0.3, 1, 2));
        const auto taken = pair.solver.taken();
        EXPECT_NEAR(taken.byImpact + taken.byFriction, start - pair.energy(), 1e-13);
        EXPECT_GT(taken.byImpact, 0);
        EXPECT_EQ(taken.byFriction, 0);  // of an impact friction is a part
        EXPECT_LT(pair.energy(), start);
      }
}

// One point without friction: what closes with v is stopped, or goes apart with e v, whatever levers there are. In one
// sub-step, which is the one that presses.
TEST(SoftContactSolver, EndsClosingAndReboundsAsRestitutionSays) {
  for (const double restitution : {0.0, 0.8}) {
    Contacting pair;
    pair.material = {restitution, 0, 0};
    meet(1, pair);
    const Vec3 normal = pair.manifolds[0].normal, point(0.15, 0.2, 0.05);
    const Vec3 a = Vec3(0, 1, 0.3) + Vec3(1, -2, 0.5).cross(point - Vec3(0.1, 0, 0)),
               b = Vec3(0.2, -2, 0) + Vec3(0.3, 1, 2).cross(point - Vec3(0, 0.5, 0.1));
    ASSERT_LT(normal.dot(b - a), -1);
    pair.solve(1);
    const double speed = normal.dot(pair.pointVelocity(1, point) - pair.pointVelocity(0, point));
    // Levers are known to the error of the anchors; relative to 0.2 m they are good to 1e-6.
    EXPECT_NEAR(speed, -restitution * normal.dot(b - a), 1e-6 * 5);
  }
}

// A block without levers slides on the floor: v = v0 - mu g t, and its friction takes mu m g times the way.
TEST(SoftContactSolver, RubsWithCoulombsFriction) {
  Contacting block;
  block.material = {0, 0.6, 0.4};
  block.add(2, 1e9 * Mat3::Identity(), Vec3(0, 0.1, 0), Vec3(1.2, 0, -1.6), Vec3::Zero());
  block.touch(0, kFixed, -Vec3::UnitY(), {Vec3::Zero()}, 0);
  const double gravity = 10, time = 8 * kSub, end = 2 - 0.4 * gravity * time;
  block.solve(8, Vec3(0, -gravity, 0));
  EXPECT_LT((block.velocity(0) - end * Vec3(0.6, 0, -0.8)).norm(), 1e-12);
  EXPECT_NEAR(block.manifolds[0].forces[0], 2 * gravity, 1e-10);
  EXPECT_LT((block.manifolds[0].frictionForce - 0.4 * 2 * gravity * Vec3(0.6, 0, -0.8)).norm(), 1e-10);  // on the floor
  EXPECT_NEAR(block.solver.taken().byFriction, 0.4 * 2 * gravity * time * (2 + end) / 2, 1e-11);
}

// What friction can hold it holds: mu m g is more than m a. The same for turning about the normal, with the arms of
// four points: mu m g r.
TEST(SoftContactSolver, HoldsWhatFrictionCan) {
  for (const double part : {0.98, 1.02}) {
    Contacting block;
    block.material = {0, 0.4, 0.4};
    block.add(2, 1e9 * Mat3::Identity(), Vec3(0, 0.1, 0), Vec3::Zero(), Vec3::Zero());
    block.touch(0, kFixed, -Vec3::UnitY(), {Vec3::Zero()}, 0);
    block.solve(8, Vec3(part * 4, -10, 0));
    // A lever of 0.1 m about 1e9 kg m^2 is not quite none.
    EXPECT_NEAR(block.velocity(0).x(), part < 1 ? 0 : (part - 1) * 4 * 8 * kSub, 1e-11) << part;
  }
  const double arm = std::hypot(0.2, 0.3), inertia = 0.1, time = 8 * kSub;
  for (const double part : {0.9, 1.1}) {  // of the spin that the friction stops in that time
    Contacting top;
    top.material = {0, 0.4, 0.4};
    const double spin = part * 0.4 * 2 * 10 * arm * time / inertia;
    top.add(2, Vec3(1e9, inertia, 1e9).asDiagonal(), Vec3(0, 0.1, 0), Vec3::Zero(), Vec3(0, spin, 0));
    PersistentManifold& manifold = top.touch(
        0, kFixed, -Vec3::UnitY(), {Vec3(0.2, 0, 0.3), Vec3(-0.2, 0, 0.3), Vec3(-0.2, 0, -0.3), Vec3(0.2, 0, -0.3)}, 0);
    manifold.forces.fill(5);  // as it stood before
    top.solve(8, Vec3(0, -10, 0));
    EXPECT_NEAR(top.spin(0).y(), part < 1 ? 0 : spin * (1 - 1 / part), 1e-3 * spin) << part;
  }
}

// Soft contact: a spring of frequency f (1 + x + x^2 + x^3), x = 300/m times the overlap d, and damping ratio 2,
// implicit in one sub-step: v = h w^2 d / (1 + 4 w h + (w h)^2), and what relaxes it leaves no speed. Contacts of one
// point have 240 Hz, of two 170 Hz, of more 100 Hz; points beside the middle count with the mass that they move,
// 1/(1/m + r^2/I).
TEST(SoftContactSolver, PushesOverlapsApartAsADampedSpring) {
  const double mass = 2, inertia = 0.08, depth = 1e-3;
  const std::vector<Vec3> corners = {{0.1, 0, 0.2}, {-0.1, 0, -0.2}, {-0.1, 0, 0.2}, {0.1, 0, -0.2}};
  for (const std::size_t points : {1u, 2u, 4u}) {
    Contacting body;
    body.add(mass, inertia * Mat3::Identity(), Vec3(0, 0.1, 0), Vec3::Zero(), Vec3::Zero());
    body.touch(0, kFixed, -Vec3::UnitY(),
               points == 1 ? std::vector<Vec3>{Vec3::Zero()}
                           : std::vector<Vec3>(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(points)),
               -depth);
    body.solve(1);
    const double x = 300 * depth, frequency = points == 1 ? 240 : points == 2 ? 170 : 100;
    const double turn = 2 * kPi * frequency * kSub * (1 + x + x * x + x * x * x);
    const double pointMass = points == 1 ? mass : 1 / (1 / mass + 0.05 / inertia);
    // Implicit Euler of all springs: m v = n m' (w^2 h (d - h v) - 4 w h v), each of m' w^2 and 4 m' w.
    const double sum = static_cast<double>(points) * pointMass;
    const double speed = sum * turn * turn * depth / kSub / (mass + sum * (4 * turn + turn * turn));
    EXPECT_NEAR(body.displacement(0).y(), speed * kSub, 1e-6 * speed * kSub) << points;
    if (points == 1) {
      EXPECT_NEAR(body.velocity(0).y(), 0, 1e-15);
    }
  }
}

// However deep, no faster than 4 m/s.
TEST(SoftContactSolver, PushesNoFasterThanItsLimit) {
  Contacting body;
  body.add(2, 1e9 * Mat3::Identity(), Vec3(0, 0.1, 0), Vec3::Zero(), Vec3::Zero());
  body.touch(0, kFixed, -Vec3::UnitY(), {Vec3::Zero()}, -0.1);
  body.solve(1);
  EXPECT_LE(body.displacement(0).y(), 4 * kSub);
  EXPECT_GT(body.displacement(0).y(), 3.99 * kSub);  // the spring is next to rigid
}

// What is still apart closes within the step and no more.
TEST(SoftContactSolver, LetsGapsClose) {
  for (const double gap : {1e-3, 0.02}) {
    Contacting body;
    body.add(2, 1e9 * Mat3::Identity(), Vec3(0, 0.1, 0), Vec3(0, -1, 0), Vec3::Zero());
    body.touch(0, kFixed, -Vec3::UnitY(), {Vec3::Zero()}, gap);
    body.solve(8);
    const double way = std::min(gap, 8 * kSub);
    EXPECT_NEAR(body.displacement(0).y(), -way, 1e-15);
    EXPECT_NEAR(body.velocity(0).y(), way < gap ? -1 : 0, 1e-15);
  }
}

// Three points under a body that does not move have forces that balance: their sum is the weight, and their moments
// about its centre of mass vanish. The forces of a step are where the next begins.
TEST(SoftContactSolver, FindsTheForcesOfEquilibrium) {
  Contacting body;
  const Vec3 center(0.03, 0.2, -0.02);
  body.add(2, lopsidedInertia(), center, Vec3::Zero(), Vec3::Zero());
  const std::vector<Vec3> points = {{0.2, 0, 0.1}, {-0.2, 0, 0.05}, {0.05, 0, -0.3}};
  body.touch(0, kFixed, -Vec3::UnitY(), points, 0);
  for (int step = 0; step < 100; ++step) body.solve(8, Vec3(0, -10, 0)), body.follow();
  Mat3 balance;
  for (int i = 0; i < 3; ++i) {
    const Vec3& point = points[static_cast<std::size_t>(i)];
    balance.col(i) = Vec3(1, point.x() - center.x(), point.z() - center.z());
  }
  const Vec3 expected = balance.inverse() * Vec3(20, 0, 0);
  for (std::size_t i = 0; i < 3; ++i)
    // To the error of anchors, 6e-8 m of arms of 0.2 m, of 20 N.
    EXPECT_NEAR(body.manifolds[0].forces[i], expected[static_cast<Eigen::Index>(i)], 20 * 1e-6) << i;
  EXPECT_LT(body.velocity(0).norm(), 1e-6);
}

}  // namespace
}  // namespace cradle
