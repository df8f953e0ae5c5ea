#include "impact/frictional_impact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "constraints/invariants.h"
#include "impact/generalized_reflections.h"
#include "impact/row_of_balls.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

// A solid ball of radius r with speed v along a floor and w downwards, mu friction: it grips (surface speed 0, speed
// v - 2/7 (v - spin r)) if mu (1 + e) w suffices, else loses mu (1 + e) w (Garwin's ball with tangential e = 0).
TEST(FrictionalImpact, OfABallWithAFloorMatchesTheClosedForm) {
  for (const double along : {0.3, 2.0}) {
    RowOfBalls row({2}, 0);
    row.impacts = {{{0, 0, kFixed, Vec3(0, -0.1, 0), -Vec3::UnitY(), 0}, {0.8, 0.2, 0.2}, 0, Vec3::Zero()}};
    linearVelocity(row.state, 0) = Vec3(along, -1, 0);
    resolveFrictionalImpact(row.impacts, row.bodies, row.state);
    const double lost = std::min(2.0 / 7 * along, 0.2 * 1.8);
    EXPECT_LT((linearVelocity(row.state, 0) - Vec3(along - lost, 0.8, 0)).norm(), 1e-14);
    EXPECT_NEAR(angularVelocity(row.state, 0).z(), -2.5 * lost / 0.1, 1e-12);
  }
}

TEST(FrictionalImpact, LeavesARowOfBallsAtItsOtherEnd) {
  RowOfBalls row({1, 1, 1, 1, 1}, 1);
  for (ImpactContact& impact : row.impacts) impact.material = {1, 0.3, 0.3};
  row.setSpeeds({1, 0, 0, 0, 0});
  resolveFrictionalImpact(row.impacts, row.bodies, row.state);
  const auto zero = DoubleNear(0, 1e-12);  // ten times what a round leaves of closing speeds
  EXPECT_THAT(row.speeds(), ElementsAre(zero, zero, zero, zero, DoubleNear(1, 1e-12)));
}

// Nothing slides in a row of balls: friction changes nothing, whatever the restitution.
TEST(FrictionalImpact, OfARowOfBallsIsThatWithoutFriction) {
  for (const double restitution : {0.0, 0.3, 0.5, 0.9, 1.0}) {
    RowOfBalls rough({1, 2, 1, 1, 3}, restitution), smooth({1, 2, 1, 1, 3}, restitution);
    for (ImpactContact& impact : rough.impacts) impact.material.staticFriction = impact.material.dynamicFriction = 0.3;
    for (RowOfBalls* row : {&rough, &smooth}) row->setSpeeds({1, 0.5, 0, 0, 0});
    resolveFrictionalImpact(rough.impacts, rough.bodies, rough.state);
    resolveReflections(smooth.impacts, smooth.bodies, smooth.state);
    // Reflections stop at 1e-11 of the speeds, and there are about ten of them.
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(rough.speeds()[i], smooth.speeds()[i], 1e-10) << restitution;
  }
}

// A light ball between two that it cannot move (1 + 1e-20 is 1), which come together. A second round shows that the
// first one left all of their closing; more rounds would show the same.
TEST(FrictionalImpact, EndsWhereARoundLeavesAllClosing) {
  RowOfBalls row({1e20, 1, 1e20}, 1);
  for (ImpactContact& impact : row.impacts) impact.material = {1, 0.3, 0.3}, impact.restSpeed = 10;
  row.setSpeeds({1, 0, 0});
  const ImpactFaults faults = resolveFrictionalImpact(row.impacts, row.bodies, row.state);
  EXPECT_GE(faults.rounds, 1);
  EXPECT_LE(faults.rounds, 2);
  EXPECT_LE(std::abs(row.speed(1)), 1);
}

// Kinematic friction below static: a ball that slides gets the smaller one.
TEST(FrictionalImpact, SlidesWithDynamicFriction) {
  RowOfBalls row({2}, 0);
  row.impacts = {{{0, 0, kFixed, Vec3(0, -0.1, 0), -Vec3::UnitY(), 0}, {0, 0.3, 0.1}, 0, Vec3::Zero()}};
  linearVelocity(row.state, 0) = Vec3(2, -1, 0);
  resolveFrictionalImpact(row.impacts, row.bodies, row.state);
  EXPECT_NEAR(linearVelocity(row.state, 0).x(), 2 - 0.1, 1e-14);
}

TEST(FrictionalImpact, SlowerThanTheRestSpeedDoesNotRebound) {
  RowOfBalls row({1, 1}, 1);
  row.impacts[0].material = {1, 0.5, 0.5};
  row.impacts[0].restSpeed = 0.01;
  linearVelocity(row.state, 0).x() = 0.009;
  resolveFrictionalImpact(row.impacts, row.bodies, row.state);
  EXPECT_NEAR(row.speed(0), 0.0045, 1e-16);
}

/// Bodies that touch each other at random points, moving at random.
class Scatter {
 public:
  explicit Scatter(unsigned seed) : random_(seed) {}

  void shuffle(int bodies, int contacts) {
    mechanism.bodies.clear(), impacts.clear();
    for (int i = 0; i < bodies; ++i) {
      const double mass = std::pow(10.0, number(-1, 1));
      const Vec3 size{number(0.3, 1), number(0.3, 1), number(0.3, 1)};
      const Vec3 moments = i % 2 == 0 ? Vec3::Constant(0.4 * mass * 0.25)
                                      : Vec3(mass / 12 * (Vec3::Constant(size.squaredNorm()) - size.cwiseAbs2()));
      mechanism.bodies.push_back(makeRigidBody({mass, Vec3::Zero(), Mat3(moments.asDiagonal())}));
    }
    state = statesAtRest(bodies);
    for (Eigen::Index i = 0; i < bodies; ++i) {
      centerOfMass(state, i) = vector();
      const Vec3 axis = vector();
      setOrientation(state, i, rotationAbout(axis, number(0, 6)));
      linearVelocity(state, i) = vector(), angularVelocity(state, i) = 3 * vector();
    }
    for (int i = 0; i < contacts; ++i) {
      const int a = i % bodies, b = bodies == 1 ? kFixed : (a + 1) % bodies;
      const ContactMaterial material{number(0, 1), number(0, 1), 0};
      impacts.push_back({{0, a, b, vector(), vector().normalized(), 0}, material, 0, Vec3::Zero()});
      impacts.back().material.dynamicFriction = material.staticFriction * (i % 3 == 0 ? 0.7 : 1);
    }
  }
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  Vec3 vector() { return {number(-1, 1), number(-1, 1), number(-1, 1)}; }
  double fastestClosing() const {
    double closing = 0;
    for (const ImpactContact& impact : impacts)
      closing = std::max(closing, -impact.contact.normal.dot(relativeVelocity(impact.contact, state)));
    return closing;
  }

  Mechanism mechanism;
  std::vector<ImpactContact> impacts;
  VectorX state;

 private:
  std::mt19937 random_;
};

TEST(FrictionalImpact, NeverGainsEnergyAndKeepsMomenta) {
  Scatter scatter(5);
  int gained = 0, closing = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const int bodies = 2 + trial % 3;
    scatter.shuffle(bodies, 1 + trial % 5);
    if (trial % 4 == 0)  // one restitution at all contacts has a law of its own
      for (ImpactContact& impact : scatter.impacts)
        impact.material.restitution = scatter.impacts[0].material.restitution;
    const Invariants before = invariantsOf(scatter.mechanism, scatter.state);
    resolveFrictionalImpact(scatter.impacts, scatter.mechanism.bodies, scatter.state);
    const Invariants after = invariantsOf(scatter.mechanism, scatter.state);
    // Rounding of impulses on masses of up to 10 kg with 1 m/s, 3 rad/s; bodies that jam get impulses of up to 1e6 N s.
    double size = 100;
    for (const ImpactContact& impact : scatter.impacts) size += impact.impulse.norm();
    EXPECT_LT((after.momentum - before.momentum).norm(), 1e-14 * size) << trial;
    EXPECT_LT((after.angularMomentum - before.angularMomentum).norm(), 1e-14 * size) << trial;
    if (after.kinetic > before.kinetic * (1 + 1e-12)) ++gained;
    if (scatter.fastestClosing() > 1e-9) ++closing;
  }
  EXPECT_EQ(gained, 0);
  EXPECT_EQ(closing, 0);
}

TEST(FrictionalImpact, DoesNotDependOnTheOrderOfContacts) {
  Scatter scatter(6);
  for (int trial = 0; trial < 100; ++trial) {
    scatter.shuffle(3, 5);
    const VectorX start = scatter.state;
    resolveFrictionalImpact(scatter.impacts, scatter.mechanism.bodies, scatter.state);
    VectorX other = start;
    std::reverse(scatter.impacts.begin(), scatter.impacts.end());
    resolveFrictionalImpact(scatter.impacts, scatter.mechanism.bodies, other);
    EXPECT_LT((other - scatter.state).cwiseAbs().maxCoeff(), 1e-9) << trial;
  }
}

// A ball thrown flat between two others that touch it left and right moves on straight.
TEST(FrictionalImpact, KeepsMirrorSymmetry) {
  RowOfBalls row({1, 2, 2}, 0);
  row.impacts.clear();
  for (const int side : {-1, 1}) {
    const Vec3 normal = Vec3(4, 3 * side, 0) / 5;
    row.impacts.push_back({{0, 0, side < 0 ? 1 : 2, Vec3(0.1 * normal), normal, 0}, {0.6, 0.4, 0.4}, 0, Vec3::Zero()});
    centerOfMass(row.state, side < 0 ? 1 : 2) = 0.2 * normal;
  }
  linearVelocity(row.state, 0).x() = 3;
  resolveFrictionalImpact(row.impacts, row.bodies, row.state);
  EXPECT_NEAR(linearVelocity(row.state, 0).y(), 0, 1e-12);
  EXPECT_NEAR(angularVelocity(row.state, 0).norm(), 0, 1e-11);
  EXPECT_LT((linearVelocity(row.state, 1) - linearVelocity(row.state, 2).cwiseProduct(Vec3(1, -1, 1))).norm(), 1e-12);
  EXPECT_GT(linearVelocity(row.state, 1).x(), 0.5);
}

/// Five rows of billiard balls (17 cm of 0.17 kg, restitution 0.95, friction 0.05) that touch each other and a rough
/// cloth, struck dead centre by a ball that rolls at 7 m/s. Balls and contacts are listed in mirrored pairs.
struct Rack {
  static constexpr double kRadius = 0.1, kSpeed = 7;  // m, m/s
  static constexpr int kRows = 5;
  RowOfBalls balls{std::vector<double>(1 + kRows * (kRows + 1) / 2, 0.17), 0};

  Rack() {
    balls.impacts.clear();
    for (int row = 0, ball = 1; row < kRows; ++row)
      for (int place = 0; place <= row; ++place, ++ball)
        centerOfMass(balls.state, ball) = kRadius * Vec3(2 + std::sqrt(3.0) * row, 0, 2 * place - row);
    centerOfMass(balls.state, 0).setZero();
    linearVelocity(balls.state, 0).x() = kSpeed, angularVelocity(balls.state, 0).z() = -kSpeed / kRadius;
    const int count = static_cast<int>(std::ssize(balls.bodies));
    for (int a = 0; a < count; ++a) {
      const Vec3 center = centerOfMass(balls.state, a);
      add(a, kFixed, center - kRadius * Vec3::UnitY(), -Vec3::UnitY(), {0.5, 0.2, 0.2});
      for (int b = a + 1; b < count; ++b) {
        const Vec3 apart = centerOfMass(balls.state, b) - center;
        if (apart.norm() < 2.01 * kRadius) add(a, b, center + apart / 2, apart.normalized(), {0.95, 0.05, 0.05});
      }
    }
  }
  void add(int a, int b, const Vec3& point, const Vec3& normal, const ContactMaterial& material) {
    balls.impacts.push_back({{balls.impacts.size(), a, b, point, normal, 0}, material, 0, Vec3::Zero()});
  }
  /// The largest difference (m/s) between the velocity of a ball and that of its mirror image.
  double asymmetry() const {
    double largest = 0;
    for (int row = 0, first = 1; row < kRows; first += ++row)
      for (int place = 0; place <= row; ++place) {
        const Vec3 one = linearVelocity(balls.state, first + place);
        const Vec3 other = linearVelocity(balls.state, first + row - place);
        largest = std::max(largest, (one - other.cwiseProduct(Vec3(1, 1, -1))).norm());
      }
    return largest;
  }
};

// Friction between balls that press on each other in a circle may hold them with many forces. Which of them are found,
// must be symmetric as the rack is: sums of some fifty impulses of 1 m/s each leave 1e-14 m/s.
TEST(FrictionalImpact, BreaksARackAsItsMirrorImage) {
  Rack rack;
  resolveFrictionalImpact(rack.balls.impacts, rack.balls.bodies, rack.balls.state);
  EXPECT_LT(rack.asymmetry(), 1e-13);
  EXPECT_GT(linearVelocity(rack.balls.state, 15).z(), 0.5);
}

/// A ball of radius 0.1 m that comes into a corner between a floor and a wall, spinning.
struct Corner {
  double floorRestitution = 0.5, wallRestitution = 0.5, friction = 0.4;
  double mass = 2;     // kg
  double angle = 0;    // rad: how far the wall leans
  double drift = 0.5;  // m/s, along the corner

  /// The velocities (m/s, rad/s) with which the ball leaves, and its kinetic energy (J) in parts of that before.
  Eigen::Matrix<double, 7, 1> outcome() const {
    RowOfBalls row({mass}, 0);
    const Vec3 wall(std::cos(angle), std::sin(angle), 0);
    row.impacts = {{{0, 0, kFixed, Vec3(0, -0.1, 0), -Vec3::UnitY(), 0}, {floorRestitution, friction, friction}},
                   {{1, 0, kFixed, -0.1 * wall, -wall, 0}, {wallRestitution, friction, friction}}};
    linearVelocity(row.state, 0) = Vec3(-2, -3, drift);
    const double before = kineticEnergy(row.bodies, row.state);
    resolveFrictionalImpact(row.impacts, row.bodies, row.state);
    Eigen::Matrix<double, 7, 1> outcome;
    outcome << row.state.segment<6>(velocityOffset(row.state, 0)), kineticEnergy(row.bodies, row.state) / before;
    return outcome;
  }
};

/// The largest change of the outcome when a datum of the corner goes from one value to another in so many steps.
template <class Set>
double largestChange(const Set& set, double from, double to, int steps) {
  Corner corner;
  VectorX last;
  double largest = 0;
  for (int i = 0; i <= steps; ++i) {
    set(from + (to - from) * i / steps, corner);
    const VectorX now = corner.outcome();
    EXPECT_LE(now[6], 1 + 1e-12);
    if (i > 0) largest = std::max(largest, (now - last).cwiseAbs().maxCoeff());
    last = now;
  }
  return largest;
}

// What is continuous, and smooth but for kinks, changes by a tenth over a tenth of the way; a jump stays.
template <class Set>
void expectContinuous(const Set& set, double from, double to, const char* what) {
  EXPECT_LT(largestChange(set, from, to, 200), 0.2 * largestChange(set, from, to, 20)) << what;
}

TEST(BallInACorner, ReboundsContinuouslyInAllData) {
  expectContinuous([](double e, Corner& corner) { corner.floorRestitution = corner.wallRestitution = e; }, 0, 1, "e");
  expectContinuous([](double e, Corner& corner) { corner.wallRestitution = e; }, 0, 1, "e of the wall");
  for (const double e : {0.3, 0.97, 1.0}) {
    const auto with = [e](const auto& set) {
      return [e, set](double value, Corner& corner) {
        corner.floorRestitution = corner.wallRestitution = e;
        set(value, corner);
      };
    };
    expectContinuous(with([](double mu, Corner& corner) { corner.friction = mu; }), 0, 0.95, "friction");
    expectContinuous(with([](double mu, Corner& corner) { corner.friction = mu; }), 0.95, 1.1, "friction that wedges");
    expectContinuous(with([](double angle, Corner& corner) { corner.angle = angle; }), -0.2, 0.5, "angle");
    expectContinuous(with([](double drift, Corner& corner) { corner.drift = drift; }), -2, 2, "drift");
  }
}

// Neither surface lets it slide along the other: Coulomb's law has no solution with any rebound, and the limit of those
// with less friction is taken.
TEST(BallInACorner, ReboundsContinuouslyWhereFrictionWedgesIt) {
  for (const double friction : {1.0, 1.5}) {
    const auto with = [friction](const auto& set) {
      return [friction, set](double value, Corner& corner) { corner.friction = friction, set(value, corner); };
    };
    expectContinuous(with([](double e, Corner& corner) { corner.floorRestitution = corner.wallRestitution = e; }), 0, 1,
                     "e");
    expectContinuous(with([](double angle, Corner& corner) { corner.angle = angle; }), -0.2, 0.5, "angle");
    Corner corner;
    corner.friction = friction;
    EXPECT_NEAR(corner.outcome()[1], 0.5 * 3, 1e-10);  // impulses are 1e4 times as large as without wedging
  }
}

// As much restitution as gains nothing: where the full one would gain, nothing is lost either.
TEST(BallInACorner, KeepsAllEnergyWhereItsRestitutionWouldGainSome) {
  Corner corner;
  for (const double e : {0.975, 0.98, 0.99, 1.0}) {
    corner.floorRestitution = corner.wallRestitution = e;
    EXPECT_NEAR(corner.outcome()[6], 1, 1e-11) << e;  // 1e-12 of the restitution, and twice that of the energy
  }
  corner.floorRestitution = corner.wallRestitution = 0.9;
  EXPECT_NEAR(corner.outcome()[1], 0.9 * 3, 1e-12);
}

// Two laws for restitutions that are equal and that are not would part here.
TEST(FrictionalImpact, HardlyDependsOnARestitutionThatHardlyDiffers) {
  for (const double friction : {0.0, 0.3})
    for (const double e : {0.0, 0.3, 0.5, 1 - 1e-12}) {
      RowOfBalls one({1, 2, 1, 1, 3}, e), other({1, 2, 1, 1, 3}, e);
      other.impacts[1].material.restitution = e + 1e-12;
      for (RowOfBalls* row : {&one, &other}) {
        for (ImpactContact& impact : row->impacts)
          impact.material.staticFriction = impact.material.dynamicFriction = friction;
        row->setSpeeds({1, 0.5, 0, 0, 0});
        for (Eigen::Index ball = 0; ball < 5; ++ball) linearVelocity(row->state, ball).z() = 0.3 * std::pow(-1, ball);
        resolveFrictionalImpact(row->impacts, row->bodies, row->state);
      }
      // Cone problems are solved to 1e-12 of the speeds, reflections end at 1e-12 of them.
      EXPECT_LT((one.state - other.state).norm(), 1e-10) << friction << " " << e;
    }
}

}  // namespace
}  // namespace cradle
