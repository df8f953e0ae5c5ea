#include "impact/generalized_reflections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "constraints/invariants.h"
#include "impact/linear_complementarity.h"
#include "impact/row_of_balls.h"

namespace cradle {
namespace {

using Speeds = std::vector<double>;
using testing::DoubleNear;
using testing::Pointwise;

// Velocities of about 1 m/s after some ten impulses: 1e-15. Asked for by the references: 1e-12.
constexpr double kRounding = 1e-12;

Speeds reflected(const Speeds& speeds, double restitution, const Speeds& masses) {
  RowOfBalls row(masses, restitution);
  row.setSpeeds(speeds);
  resolveReflections(row.impacts, row.bodies, row.state);
  return row.speeds();
}

Speeds reflected(const Speeds& speeds, double restitution = 1) {
  return reflected(speeds, restitution, Speeds(speeds.size(), 1));
}

Speeds pairwise(const Speeds& speeds, double restitution = 1) {
  RowOfBalls row(Speeds(speeds.size(), 1), restitution);
  row.setSpeeds(speeds);
  resolvePairwise(row.impacts, row.bodies, row.state);
  return row.speeds();
}

/// Newton's law on all contacts at once, for balls of 1 kg: 0 <= lambda perp J v+ + e J v >= 0.
Speeds newtonLcp(const Speeds& speeds, double restitution) {
  const auto balls = static_cast<Eigen::Index>(speeds.size());
  MatrixX rows = MatrixX::Zero(balls - 1, balls);
  for (Eigen::Index i = 0; i + 1 < balls; ++i) rows(i, i) = -1, rows(i, i + 1) = 1;
  const VectorX before = Eigen::Map<const VectorX>(speeds.data(), balls);
  const VectorX after = before + rows.transpose() * solveLinearComplementarity(rows * rows.transpose(),
                                                                               (1 + restitution) * rows * before);
  return {after.begin(), after.end()};
}

auto isNear(const Speeds& expected) {
  return Pointwise(DoubleNear(kRounding), expected);
}

// Outcomes in exact rationals.
struct Outcome {
  Speeds before, reflections, newtonLcp;
};
const Outcome kOutcomes[] = {
    {{1, 0, 0}, {0, 0, 1}, {-1. / 3, 2. / 3, 2. / 3}},
    {{1, 0, 0, 0}, {0, 0, 0, 1}, {-0.5, 0.5, 0.5, 0.5}},
    {{1, 0, 0, 0, 0}, {0, 0, 0, 0, 1}, {-0.6, 0.4, 0.4, 0.4, 0.4}},
    {{1, 1, 0, 0, 0}, {0, 0, 0, 1, 1}, {-0.2, -0.2, 0.8, 0.8, 0.8}},
    {{1, 1, 1, 0, 0}, {0, 0, 1, 1, 1}, {0.2, 0.2, 0.2, 1.2, 1.2}},
    {{1, 1, 0}, {0, 1, 1}, {1. / 3, 1. / 3, 4. / 3}},
    {{1, 0, -1}, {-1, 0, 1}, {-1, 0, 1}},
    {{1, 0, 0, 0, -1}, {-1, 0, 0, 0, 1}, {-1, 0, 0, 0, 1}},
};

TEST(RowOfEqualBalls, LeavesAsManyAsComeByReflectionsAndPairByPair) {
  for (const Outcome& outcome : kOutcomes) {
    EXPECT_THAT(reflected(outcome.before), isNear(outcome.reflections));
    EXPECT_THAT(pairwise(outcome.before), isNear(outcome.reflections));
  }
}

// What the textbook's simultaneous law gets wrong: it throws the first ball back.
TEST(RowOfEqualBalls, FliesApartByNewtonsLawOnAllContactsAtOnce) {
  for (const Outcome& outcome : kOutcomes) EXPECT_THAT(newtonLcp(outcome.before, 1), isNear(outcome.newtonLcp));
  EXPECT_THAT(newtonLcp({1, 0, 0}, 0.5), isNear({0, 0.5, 0.5}));
  EXPECT_THAT(newtonLcp({1, 0, 0}, 0), isNear({1. / 3, 1. / 3, 1. / 3}));
}

// (1 - e) (1/3, 1/3, 1/3) + e (0, 0, 1).
TEST(RowOfEqualBalls, BlendsWithRestitution) {
  EXPECT_THAT(reflected({1, 0, 0}, 0.5), isNear({1. / 6, 1. / 6, 2. / 3}));
  EXPECT_THAT(reflected({1, 0, 0}, 0), isNear({1. / 3, 1. / 3, 1. / 3}));
  EXPECT_THAT(reflected({1, 0, 0}, 0.1), isNear({0.3, 0.3, 0.4}));
  EXPECT_THAT(pairwise({1, 0, 0}, 0.5), isNear({13. / 64, 15. / 64, 9. / 16}));
}

// Two-body impacts one after the other, here the only order there is: the hit ball hits the next. m1 = 1, m2 = 2,
// m3 = 3: v1 = (1 - 2) / 3, v2 = 2 / 3; then v2 = (2 - 3) / 5 x 2/3 = -2/15, v3 = 4/5 x 2/3 = 8/15. v1 < v2: done.
TEST(RowOfBallsOfUnequalMass, MatchesTheChainOfPairs) {
  EXPECT_THAT(reflected({1, 0, 0}, 1, {1, 2, 3}), isNear({-1. / 3, -2. / 15, 8. / 15}));
}

// Momentum and Newton's law of restitution, as for a pair in textbooks.
TEST(PairByReflections, MatchesTheClosedFormForAnyMassesAndRestitution) {
  for (const double m1 : {0.5, 1.0, 700.0})
    for (const double m2 : {0.03, 1.0, 20.0})
      for (const double e : {0.0, 0.37, 1.0}) {
        const double exchange = (1 + e) * 4.5 / (m1 + m2);
        EXPECT_THAT(reflected({3, -1.5}, e, {m1, m2}), isNear({3 - exchange * m2, -1.5 + exchange * m1}));
      }
}

TEST(Reflections, OfWhatSeparatesDoNothing) {
  EXPECT_EQ(reflected({-1, 0, 2}), (Speeds{-1, 0, 2}));
}

TEST(Reflections, SlowerThanTheRestSpeedDoNotRebound) {
  RowOfBalls row({1, 1}, 1);
  row.impacts[0].restSpeed = 0.01;
  row.setSpeeds({0.009, 0});
  resolveReflections(row.impacts, row.bodies, row.state);
  EXPECT_THAT(row.speeds(), isNear({0.0045, 0.0045}));
}

// A contact that lasts while another is struck: closing slowly before, it is fast when its turn comes, and rebounds.
TEST(Reflections, ReboundWhereALastingContactIsStruck) {
  RowOfBalls row({1, 1, 1}, 1);
  for (ImpactContact& impact : row.impacts) impact.restSpeed = 0.01;
  row.setSpeeds({1, 0, 0});
  resolveReflections(row.impacts, row.bodies, row.state);
  EXPECT_THAT(row.speeds(), isNear({0, 0, 1}));
}

// Equal restitutions take the blend, different ones the mean over levels: between them there is no step.
TEST(Reflections, HardlyDependOnARestitutionThatHardlyDiffers) {
  for (const double e : {0.0, 0.5, 1 - 1e-12}) {
    RowOfBalls one({1, 2, 1, 3}, e), other({1, 2, 1, 3}, e);
    other.impacts[1].material.restitution = e + 1e-12;
    for (RowOfBalls* row : {&one, &other}) {
      row->setSpeeds({1, 0.5, 0, 0});
      resolveReflections(row->impacts, row->bodies, row->state);
    }
    for (int ball = 0; ball < 4; ++ball) EXPECT_NEAR(one.speed(ball), other.speed(ball), 1e-11) << e;
  }
}

// The mean over levels in the open: ball 1 hits 2 and 3 at rest, e1 = 1/4, e2 = 3/4. Below 1/4 both contacts are
// elastic: (0, 0, 1). From there to 3/4 only the second: the first stops, (1/2, 1/2, 0), and the second passes on
// (1/2, 0, 1/2); then 1 closes with 2: (1/4, 1/4, 1/2). Above: (1/3, 1/3, 1/3).
TEST(Reflections, WithDifferentRestitutionsAreTheMeanOverLevels) {
  RowOfBalls row({1, 1, 1}, 0);
  row.impacts[0].material.restitution = 0.25, row.impacts[1].material.restitution = 0.75;
  row.setSpeeds({1, 0, 0});
  resolveReflections(row.impacts, row.bodies, row.state);
  const double slow = 0.5 * 0.25 + 0.25 / 3;
  EXPECT_THAT(row.speeds(), isNear({slow, slow, 0.25 + 0.5 * 0.5 + 0.25 / 3}));
}

// A heavy body on a light one on a floor that closes slowly, so that nothing rebounds: both stop, whatever the masses.
// One contact after the other, the heavy one would lose (light / heavy) of its speed in each round.
TEST(Reflections, OfAHeavyBodyOnALightOneComeToAnEnd) {
  for (const double e : {0.0, 0.3, 1.0})
    for (const double heavy : {1.0, 440.0, 1e4, 1e6})
      for (const double restSpeed : {0.0, 0.1, 10.0}) {
        RowOfBalls row({1, heavy}, e);
        row.impacts.push_back({{1, kFixed, 0, Vec3(-0.1, 0, 0), Vec3::UnitX(), 0}, {e, 0, 0}, 0, Vec3::Zero()});
        for (ImpactContact& impact : row.impacts) impact.restSpeed = restSpeed;
        row.setSpeeds({0, -1});
        resolveReflections(row.impacts, row.bodies, row.state);
        EXPECT_GE(row.speed(0), -1e-9) << heavy;
        EXPECT_GE(row.speed(1) - row.speed(0), -1e-9) << heavy;
        const double energy = row.speed(0) * row.speed(0) + heavy * row.speed(1) * row.speed(1);
        EXPECT_LE(energy, heavy * (1 + 1e-9)) << heavy;
        if (e == 0 || restSpeed == 10) {
          EXPECT_LT(energy, 1e-18 * heavy) << heavy;
        }
        if (e == 1 && restSpeed == 0) {
          EXPECT_NEAR(energy, heavy, 1e-9 * heavy);
        }
      }
}

// A light ball between two that it cannot move (1 + 1e-20 is 1), which come together: no impulse ends that. Reflections
// that do not end it are not repeated: 20000 of them would sum up to an impulse of 1e4 N s.
TEST(Reflections, AreNotRepeatedWhereNoImpulseEndsTheClosing) {
  RowOfBalls row({1e20, 1, 1e20}, 1);
  for (ImpactContact& impact : row.impacts) impact.restSpeed = 10;
  row.setSpeeds({1, 0, 0});
  resolveReflections(row.impacts, row.bodies, row.state);
  for (const ImpactContact& impact : row.impacts) EXPECT_LT(impact.impulse.norm(), 10);
  EXPECT_LE(std::abs(row.speed(1)), 1);
}

// An elastic ball that touches two walls goes to and fro between them, as one that joints hold there does: it stops,
// and two walls do not take the 40000 N s of 20000 reflections.
TEST(Reflections, ThatGoRoundInACircleEnd) {
  RowOfBalls row({1e20, 1, 1e20}, 1);
  row.setSpeeds({0, 1, 0});
  resolveReflections(row.impacts, row.bodies, row.state);
  for (const ImpactContact& impact : row.impacts) EXPECT_LT(impact.impulse.norm(), 10);
  EXPECT_NEAR(row.speed(1), 0, kRounding);
}

/// A disc that moves along x hits two that touch each other, both at once.
struct Break {
  std::vector<RigidBody> bodies{ball(1), ball(1), ball(1)};
  VectorX state = statesAtRest(3);
  std::vector<ImpactContact> impacts;

  Break() {
    linearVelocity(state, 0) = Vec3::UnitX();
    centerOfMass(state, 1) = 0.2 * Vec3(std::sqrt(0.75), 0.5, 0);
    centerOfMass(state, 2) = 0.2 * Vec3(std::sqrt(0.75), -0.5, 0);
    for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {2, 1}}) {
      const Vec3 from = centerOfMass(state, a), to = centerOfMass(state, b);
      const Contact contact{impacts.size(), a, b, (from + to) / 2, (to - from).normalized(), 0};
      impacts.push_back({contact, {1, 0, 0}, 0, Vec3::Zero()});
    }
  }
  void expectVelocities(const Vec3& v1, const Vec3& v2, const Vec3& v3) {
    EXPECT_LT((linearVelocity(state, 0) - v1).norm(), kRounding);
    EXPECT_LT((linearVelocity(state, 1) - v2).norm(), kRounding);
    EXPECT_LT((linearVelocity(state, 2) - v3).norm(), kRounding);
  }
};

TEST(SymmetricBreak, StaysSymmetricByReflectionsInAnyOrderOfContacts) {
  for (const bool isReversed : {false, true}) {
    Break play;
    if (isReversed) std::reverse(play.impacts.begin(), play.impacts.end());
    resolveReflections(play.impacts, play.bodies, play.state);
    play.expectVelocities({-0.2, 0, 0}, {0.6, std::sqrt(3) / 5, 0}, {0.6, -std::sqrt(3) / 5, 0});
  }
}

TEST(SymmetricBreak, DependsOnTheOrderOfContactsPairByPair) {
  Break play;
  resolvePairwise(play.impacts, play.bodies, play.state);
  play.expectVelocities({-0.125, -std::sqrt(3) / 8, 0}, {0.75, std::sqrt(3) / 4, 0}, {0.375, -std::sqrt(3) / 8, 0});
}

/// Mass ratio of a dumbbell, its angle to the plane that it falls on with its first ball, and restitution.
struct Dumbbell {
  double mass1, mass2, angle, restitution;
};

// Balls m1, m2 on a rod of length l at an angle a to the floor fall flat with v; ball 1 hits. Its inverse mass along
// the floor's normal, as part of the rigid dumbbell of mass M = m1 + m2 and inertia m1 m2 l^2 / M about a centre that
// is m2 l / M away: w = 1 / M + (m2 l cos(a) / M)^2 M / (m1 m2 l^2) = (1 + m2 cos(a)^2 / m1) / M. Impulse p = (1 + e) v
// / w; the centre then moves with p / M - v, and the rod turns with -(m2 l / M) cos(a) p / (m1 m2 l^2 / M) = -cos(a) p
// / (m1 l).
void expectClosedForm(const Dumbbell& dumbbell) {
  const auto& [m1, m2, angle, e] = dumbbell;
  const double length = 0.7, fall = 2, mass = m1 + m2;
  const Vec3 along(std::cos(angle), std::sin(angle), 0), across(-along.y(), along.x(), 0);
  const Constraints constraints = {{{0, Vec3::Zero()}, {1, Vec3::Zero()}, RodConstraint{length}}};
  const std::vector<RigidBody> bodies{ball(m1), ball(m2)};
  VectorX state = statesAtRest(2);
  centerOfMass(state, 1) = length * along;
  for (int body = 0; body < 2; ++body) linearVelocity(state, body).y() = -fall;
  ConstraintSolver solver(constraints, bodies);
  solver.factorize(state);
  std::vector<ImpactContact> impacts{{{0, 0, kFixed, Vec3(0, -0.1, 0), -Vec3::UnitY(), 0}, {e, 0, 0}, 0, Vec3::Zero()}};
  resolveReflections(impacts, ImpulseResponse(bodies, solver), state);

  const double impulse = (1 + e) * fall * mass / (1 + m2 / m1 * along.x() * along.x());
  const double turning = -along.x() * impulse / (m1 * length);
  const Vec3 center = (impulse / mass - fall) * Vec3::UnitY();
  EXPECT_NEAR(impacts[0].impulse.y(), -impulse, kRounding * mass);
  EXPECT_LT((linearVelocity(state, 0) - (center - turning * m2 / mass * length * across)).norm(), kRounding);
  EXPECT_LT((linearVelocity(state, 1) - (center + turning * m1 / mass * length * across)).norm(), kRounding);
}

TEST(DumbbellOnAPlane, MatchesTheClosedForm) {
  for (const double mass2 : {0.2, 1.0, 30.0})
    for (const double angle : {0.0, 0.4, 1.2, 1.5707})
      for (const double e : {0.0, 0.6, 1.0}) expectClosedForm({1.3, mass2, angle, e});
}

// A rod along the normal between a floor and the ball lets it move only across: nothing can happen at the contact.
TEST(Reflections, LeaveAContactThatARodHolds) {
  const Constraints constraints = {{{0, Vec3::Zero()}, {kFixed, Vec3(0, -0.1, 0)}, RodConstraint{0.1}}};
  const std::vector<RigidBody> bodies{ball(1)};
  VectorX state = statesAtRest(1);
  linearVelocity(state, 0) = Vec3(1, -1e-16, 0);
  const VectorX before = state;
  ConstraintSolver solver(constraints, bodies);
  solver.factorize(state);
  std::vector<ImpactContact> impacts{{{0, 0, kFixed, Vec3(0, -0.1, 0), -Vec3::UnitY(), 0}, {1, 0, 0}, 0, Vec3::Zero()}};
  resolveReflections(impacts, ImpulseResponse(bodies, solver), state);
  EXPECT_EQ(state, before);
}

// Redundant: three of the four corners hold the face already. Flat it bounces back as a ball does, whatever corner
// carries how much.
TEST(BoxOnItsFace, ReboundsFlat) {
  for (const double e : {0.0, 0.5, 1.0}) {
    const std::vector<RigidBody> bodies{makeRigidBody({3, Vec3::Zero(), Vec3(0.2, 0.5, 0.4).asDiagonal()})};
    VectorX state = statesAtRest(1);
    linearVelocity(state, 0) = Vec3(0.3, -2, 0.1);
    std::vector<ImpactContact> impacts;
    for (const double x : {-0.5, 0.5})
      for (const double z : {-0.4, 0.4})
        impacts.push_back({{0, 0, kFixed, Vec3(x, -0.3, z), -Vec3::UnitY(), 0}, {e, 0, 0}, 0, Vec3::Zero()});
    resolveReflections(impacts, bodies, state);
    EXPECT_LT((linearVelocity(state, 0) - Vec3(0.3, 2 * e, 0.1)).norm(), kRounding);
    EXPECT_LT(angularVelocity(state, 0).norm(), kRounding);
  }
}

/// Lopsided bodies that touch each other in random places, four of them in many contacts, some tied by rods.
class Heap {
 public:
  explicit Heap(std::mt19937& random) : random_(random) {
    for (int body = 0; body < 4; ++body)
      mechanism.bodies.push_back(makeRigidBody({mass(), Vec3::Zero(), mass() * Vec3(0.02, 0.05, 0.06).asDiagonal()}));
    state = VectorX::NullaryExpr(stateSize(4), [this] { return number(); });
    state.tail<kLedgerSize>().setZero();
    normalizeOrientations(state);
    mechanism.constraints = {{{0, Vec3(0.1, 0.2, 0)}, {1, Vec3(0, 0.1, 0.2)}, RodConstraint{1}}};
    solver.factorize(state);
    solver.project(state);
    for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 2}, {2, 3}}) addContact(a, b);
  }
  /// All contacts with one restitution, or each with one of its own between 0 and 1.
  void setRestitution(double restitution) {
    for (ImpactContact& impact : impacts) impact.material.restitution = restitution;
  }
  void mixRestitutions() {
    for (ImpactContact& impact : impacts) impact.material.restitution = std::abs(number());
  }
  Invariants invariants() const { return invariantsOf(mechanism, state); }
  void resolve() {
    solver.factorize(state);
    resolveReflections(impacts, ImpulseResponse(mechanism.bodies, solver), state);
  }
  double mostClosing() const {
    double most = 0;
    for (const ImpactContact& impact : impacts)
      most = std::max(most, -impact.contact.normal.dot(relativeVelocity(impact.contact, state)));
    return most;
  }

  /// How fast the rod's length changes, in m/s.
  double rodRate() const { return solver.largestRate(state).rate; }

  Mechanism mechanism;
  VectorX state;
  std::vector<ImpactContact> impacts;
  ConstraintSolver solver{mechanism.constraints, mechanism.bodies};

 private:
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  double mass() { return std::pow(10, number()); }
  void addContact(int a, int b) {
    const Vec3 normal = Vec3{number(), number(), number()}.normalized();
    impacts.push_back(
        {{impacts.size(), a, b, Vec3{number(), number(), number()}, normal, 0}, {1, 0, 0}, 0, Vec3::Zero()});
  }
  std::mt19937& random_;
};

// Some hundred impulses of up to 100 m/s: 1e-12 of what was there.
constexpr double kHeapRounding = 1e-11;

void expectMomentaKept(const Invariants& before, const Invariants& after) {
  EXPECT_LT((after.momentum - before.momentum).norm(), kHeapRounding * (1 + before.momentum.norm()));
  EXPECT_LT((after.angularMomentum - before.angularMomentum).norm(), kHeapRounding * (1 + before.kinetic));
}

TEST(HeapOfBodies, KeepsEnergyAndMomentaWithoutLossAndSeparates) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 300; ++trial) {
    Heap heap(random);
    const Invariants before = heap.invariants();
    heap.resolve();
    const Invariants after = heap.invariants();
    EXPECT_NEAR(after.kinetic / before.kinetic, 1, kHeapRounding) << trial;
    EXPECT_LT(heap.mostClosing(), kHeapRounding * std::sqrt(before.kinetic)) << trial;
    EXPECT_LT(heap.rodRate(), kHeapRounding * std::sqrt(before.kinetic)) << trial;
    expectMomentaKept(before, after);
  }
}

TEST(HeapOfBodies, NeverGainsEnergyWithRestitutionsThatDiffer) {
  std::mt19937 random(9);
  for (int trial = 0; trial < 1000; ++trial) {
    Heap heap(random);
    trial % 2 == 0 ? heap.mixRestitutions() : heap.setRestitution(trial * 1e-3);
    const Invariants before = heap.invariants();
    heap.resolve();
    const Invariants after = heap.invariants();
    EXPECT_LE(after.kinetic, before.kinetic * (1 + kHeapRounding)) << trial;
    EXPECT_LT(heap.mostClosing(), kHeapRounding * std::sqrt(before.kinetic)) << trial;
    EXPECT_LT(heap.rodRate(), kHeapRounding * std::sqrt(before.kinetic)) << trial;
    expectMomentaKept(before, after);
  }
}

TEST(HeapOfBodies, DoesNotDependOnTheOrderOfContacts) {
  std::mt19937 random(10);
  for (int trial = 0; trial < 300; ++trial) {
    Heap heap(random);
    if (trial % 2 == 1) heap.mixRestitutions();
    const VectorX start = heap.state;
    heap.resolve();
    const VectorX end = std::exchange(heap.state, start);
    std::shuffle(heap.impacts.begin(), heap.impacts.end(), random);
    heap.resolve();
    EXPECT_LT((heap.state - end).norm(), kHeapRounding * (1 + start.norm() + end.norm())) << trial;
  }
}

}  // namespace
}  // namespace cradle
