// Outcomes of impacts in which several contacts, or a rod, take part, from scenes to frames: rows of balls, a break of
// billiard balls, a dumbbell on a floor. Frames lie at the instant of the impact, and show what follows it.

#include <gtest/gtest.h>

#include <cmath>

#include "collision/random_poses.h"
#include "experiments/experiment.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kPuckRadius = 0.1;   // m
constexpr double kImpactTime = 0.25;  // s
// Velocities of some m/s: the instant is found to 1e-16 s, ten impulses round to 1e-15 each.
constexpr double kRounding = 1e-12;

/// How the impact is computed: balls without friction by collisions in closed form, if nothing is named.
struct Way {
  const char* method;  // members of the scene
  double friction;
};
const Way kWays[] = {{"", 0}, {R"("method": {"name": "dop853"},)", 0}, {R"("method": {"name": "rk4"},)", 0}, {"", 0.3}};

std::string ballText(std::size_t number, double mass, const Vec3& position, const Vec3& velocity) {
  return fmt::format(R"({{"name": "b{}", "shape": {{"sphere": {{"radius": {}}}}}, "mass": {:.17g}, "material": "m",
    "position": {}, "linearVelocity": {}}})",
                     number, kPuckRadius, mass, vectorText(position), vectorText(velocity));
}

/// The frame of the impact.
Frame impactOf(const Way& way, double restitution, const std::string& bodies, const std::string& more = "",
               double frameTime = kImpactTime) {
  const Trajectory run = simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": 1e-10, "gravity": [0, 0, 0], {} "output": {{"framesPerSecond": {}}},
      "materials": {{"m": {{"restitution": {:.17g}, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [{}] {})",
      frameTime, way.method, 1 / frameTime, restitution, way.friction, way.friction, bodies, more)));
  return run.frames.back();
}

using Speeds = std::vector<double>;

/// A row of balls of 1 kg along x. Those at rest touch each other; those that come in do too, and arrive at once.
Speeds rowAfterImpact(const Way& way, double restitution, const Speeds& before) {
  std::vector<std::string> balls;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double place = 2 * kPuckRadius * static_cast<double>(i) - before[i] * kImpactTime;
    balls.push_back(ballText(i, 1, Vec3(place, 0, 0), Vec3(before[i], 0, 0)));
  }
  Speeds after;
  for (const BodyState& ball : impactOf(way, restitution, fmt::format("{}", fmt::join(balls, ", "))).states)
    after.push_back(ball.linearVelocity.x());
  return after;
}

// By exact rationals: as many leave as arrive; with e, (1 - e) of the velocity they have in common and e of that.
struct Outcome {
  double restitution;
  Speeds before, after;
};
const Outcome kOutcomes[] = {{1, {1, 0, 0}, {0, 0, 1}},
                             {1, {1, 0, 0, 0}, {0, 0, 0, 1}},
                             {1, {1, 0, 0, 0, 0}, {0, 0, 0, 0, 1}},
                             {1, {1, 1, 0, 0, 0}, {0, 0, 0, 1, 1}},
                             {1, {1, 1, 1, 0, 0}, {0, 0, 1, 1, 1}},
                             {1, {1, 1, 0}, {0, 1, 1}},
                             {1, {1, 0, -1}, {-1, 0, 1}},
                             {1, {1, 0, 0, 0, -1}, {-1, 0, 0, 0, 1}},
                             {0.5, {1, 0, 0}, {1. / 6, 1. / 6, 2. / 3}},
                             {0, {1, 0, 0}, {1. / 3, 1. / 3, 1. / 3}}};

TEST(RowsOfBalls, LeaveTheirImpactAsTheRationalsSay) {
  for (const Way& way : kWays)
    for (const auto& [restitution, before, after] : kOutcomes) {
      if (way.friction > 0 && restitution > 0 && restitution < 1) continue;  // Newton's law, contact by contact
      const Speeds speeds = rowAfterImpact(way, restitution, before);
      for (std::size_t i = 0; i < after.size(); ++i)
        EXPECT_NEAR(speeds[i], after[i], kRounding) << way.method << " friction " << way.friction << " e "
                                                    << restitution << " row of " << after.size() << ", " << i;
    }
}

/// A rack of `rows` rows of touching balls, opening along x, and a ball that comes along x at 1 m/s: the last body.
std::vector<Vec3> rackOf(int rows) {
  std::vector<Vec3> places;
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i <= row; ++i) places.push_back(2 * kPuckRadius * Vec3(row * std::sqrt(0.75), 0, i - 0.5 * row));
  return places;
}

Frame breakOf(const Way& way, int rows, const Vec3& cueAtImpact) {
  std::vector<std::string> balls;
  for (const Vec3& place : rackOf(rows)) balls.push_back(ballText(balls.size(), 1, place, Vec3::Zero()));
  balls.push_back(ballText(balls.size(), 1, cueAtImpact - kImpactTime * Vec3::UnitX(), Vec3::UnitX()));
  return impactOf(way, 1, fmt::format("{}", fmt::join(balls, ", ")));
}

// Impulses p along (cos 30, +-sin 30): 1 - 2 p c = v1, p = v2 along its normal, energy stays: p = 2 c / (1 + 2 c^2).
TEST(BilliardBreak, OfTwoBallsMatchesTheClosedForm) {
  for (const Way& way : kWays) {
    if (way.friction > 0) continue;  // the balls that are struck rub
    // The pair opens along x: rows 2 and 3 of a rack without its first ball, struck from there.
    std::vector<std::string> balls;
    for (const double side : {1.0, -1.0})
      balls.push_back(ballText(balls.size(), 1, 2 * kPuckRadius * Vec3(std::sqrt(0.75), 0, side / 2), Vec3::Zero()));
    balls.push_back(ballText(2, 1, -kImpactTime * Vec3::UnitX(), Vec3::UnitX()));
    const Frame frame = impactOf(way, 1, fmt::format("{}", fmt::join(balls, ", ")));
    const Vec3 expected[] = {{0.6, 0, std::sqrt(3) / 5}, {0.6, 0, -std::sqrt(3) / 5}, {-0.2, 0, 0}};
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_LT((frame.states[i].linearVelocity - expected[i]).norm(), kRounding) << way.method << i;
  }
}

/// Largest difference of velocities between the balls of a frame and their mirror images in z = 0.
double asymmetryOf(const Frame& frame, int rows) {
  double asymmetry = std::abs(frame.states.back().linearVelocity.z());
  std::size_t first = 0;
  for (int row = 0; row < rows; ++row) {
    const std::size_t count = static_cast<std::size_t>(row) + 1;
    for (std::size_t i = 0; i < count; ++i) {
      const BodyState &ball = frame.states[first + i], &image = frame.states[first + count - 1 - i];
      const Vec3 v = image.linearVelocity, w = image.angularVelocity;  // axial: x and y change sign
      asymmetry = std::max(asymmetry, (ball.linearVelocity - Vec3(v.x(), v.y(), -v.z())).norm());
      asymmetry = std::max(asymmetry, kPuckRadius * (ball.angularVelocity - Vec3(-w.x(), -w.y(), w.z())).norm());
    }
    first += count;
  }
  return asymmetry;
}

TEST(BilliardBreak, HeadOnIsMirrorSymmetric) {
  for (const Way& way : kWays)
    for (const int rows : {2, 3, 5}) {
      const Frame frame = breakOf(way, rows, -2 * kPuckRadius * Vec3::UnitX());
      EXPECT_LT(asymmetryOf(frame, rows), kRounding) << way.method << " friction " << way.friction << " rows " << rows;
      EXPECT_GT(frame.states[0].linearVelocity.norm() + frame.states[1].linearVelocity.norm(), 0.1);
      EXPECT_NEAR(frame.energy.momentum.x(), 1, kRounding);
      EXPECT_NEAR(frame.energy.kinetic, 0.5, way.friction > 0 ? 0.5 : kRounding) << way.method << rows;
    }
}

/// Two balls on a rod at the instant at which ball 1 reaches the floor, or both do.
struct Dumbbell {
  double mass1, mass2;        // kg
  Vec3 rod;                   // m, from ball 1 to ball 2
  Vec3 velocity1, velocity2;  // m/s; the rod keeps its length
  double mass() const { return mass1 + mass2; }
  Vec3 center() const { return Vec3(0, kPuckRadius, 0) + mass2 / mass() * rod; }
  Vec3 velocity() const { return (mass1 * velocity1 + mass2 * velocity2) / mass(); }
  Vec3 spin() const { return rod.cross(velocity2 - velocity1) / rod.squaredNorm(); }

  /// Free flight for a time, or back: the centre straight on, the rod turning steadily.
  Dumbbell after(double time) const {
    const Quat turn = spin().isZero() ? Quat::Identity() : rotationAbout(spin().normalized(), spin().norm() * time);
    const Vec3 relative = turn * (velocity2 - velocity1), rodThen = turn * rod;
    return {mass1, mass2, rodThen, velocity() - mass2 / mass() * relative, velocity() + mass1 / mass() * relative};
  }
};

/// A dumbbell that falls with `velocity`, spinning across its rod.
Dumbbell falling(double mass2, const Vec3& rod, const Vec3& velocity, const Vec3& spin = Vec3::Zero()) {
  const double mass1 = 1.3;
  const Vec3 relative = spin.cross(rod);
  return {mass1, mass2, rod, velocity - mass2 / (mass1 + mass2) * relative,
          velocity + mass1 / (mass1 + mass2) * relative};
}

/// A frame of its fall onto the floor, which it reaches at kImpactTime.
Frame dropOf(const Dumbbell& atImpact, const Way& way, double restitution, double frameTime) {
  const Dumbbell start = atImpact.after(-kImpactTime);
  const Vec3 center = atImpact.center() - kImpactTime * atImpact.velocity();
  const double part1 = start.mass1 / start.mass(), part2 = start.mass2 / start.mass();
  const std::string bodies = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "m"}, )" +
                             ballText(1, start.mass1, center - part2 * start.rod, start.velocity1) + ", " +
                             ballText(2, start.mass2, center + part1 * start.rod, start.velocity2);
  return impactOf(way, restitution, bodies,
                  R"(, "rods": [{"bodyA": "b1", "anchorA": [0, 0, 0], "bodyB": "b2", "anchorB": [0, 0, 0]}])",
                  frameTime);
}

// The floor's impulse p along y on ball 1 and the rod's q along d keep its length: p d_y / m1 + q (1 / m1 + 1 / m2) =
// 0. Ball 1's speed along y then changes by p (1 - m2 d_y^2 / M) / m1 = -(1 + e) v1_y.
Dumbbell afterImpact(const Dumbbell& before, double restitution) {
  const Vec3 d = before.rod.normalized();
  const double part2 = before.mass2 / before.mass();
  const double p = -(1 + restitution) * before.velocity1.y() * before.mass1 / (1 - part2 * d.y() * d.y());
  const double q = -p * d.y() * part2;
  return {before.mass1, before.mass2, before.rod, before.velocity1 + (p * Vec3::UnitY() + q * d) / before.mass1,
          before.velocity2 - q * d / before.mass2};
}

void expectVelocities(const Frame& frame, const Dumbbell& expected, double tolerance) {
  EXPECT_LT((frame.states[0].linearVelocity - expected.velocity1).norm(), tolerance);
  EXPECT_LT((frame.states[1].linearVelocity - expected.velocity2).norm(), tolerance);
}

const Way kEvents{"", 0}, kSteps{R"("method": {"name": "rk4"},)", 0};

TEST(DumbbellOnAFloor, OneEndFirstMatchesTheClosedForm) {
  RandomPoses random(21);
  for (const Way& way : {kEvents, kSteps})
    for (const double restitution : {1.0, 0.5, 0.0})
      for (const double mass2 : {0.2, 1.3, 30.0})
        for (const double angle : {0.1, 0.8, 1.5})
          for (const Vec3& velocity : {Vec3(0, -2, 0), Vec3(0.7, -2, -0.4)}) {
            const double turn = random.number(0, 6), c = std::cos(angle);
            const Vec3 rod = 0.7 * Vec3(c * std::cos(turn), std::sin(angle), c * std::sin(turn));
            const Dumbbell dumbbell = falling(mass2, rod, velocity);
            SCOPED_TRACE(fmt::format("{} e {} m2 {} angle {}", way.method, restitution, mass2, angle));
            expectVelocities(dropOf(dumbbell, way, restitution, kImpactTime), afterImpact(dumbbell, restitution),
                             kRounding);
          }
}

// A rod that turns is integrated, with local errors of 1e-11: the impact comes some 1e-11 s early or late. A frame a
// little later sees the velocities of all, 100 times that off at most.
TEST(DumbbellOnAFloor, TurningMatchesTheClosedForm) {
  constexpr double kLater = 0.01;  // s
  RandomPoses random(22);
  for (const double restitution : {1.0, 0.5})
    for (int trial = 0; trial < 6; ++trial) {
      const Vec3 direction = random.direction();
      const Vec3 rod = 0.7 * Vec3(direction.x(), std::abs(direction.y()) + 0.5, direction.z()).normalized();
      const double mass2 = random.number(0.3, 3);
      const Vec3 spin = 2 * rod.cross(random.direction());  // slow: ball 2 stays above
      const Dumbbell dumbbell = falling(mass2, rod, Vec3(0.3, -3, 0.2), spin);
      SCOPED_TRACE(fmt::format("e {} trial {}", restitution, trial));
      expectVelocities(dropOf(dumbbell, kEvents, restitution, kImpactTime + kLater),
                       afterImpact(dumbbell, restitution).after(kLater), 1e-9);
    }
}

// Flat on the floor each ball bounces for itself: the rod lies across both impulses.
TEST(DumbbellOnAFloor, BothEndsAtOnceMatchTheClosedForm) {
  for (const Way& way : {kEvents, kSteps})
    for (const double restitution : {1.0, 0.5, 0.0})
      for (const double mass2 : {0.2, 1.3, 30.0}) {
        const Dumbbell dumbbell = falling(mass2, Vec3(0.6, 0, 0.3), Vec3(0.7, -2, -0.4));
        const Vec3 expected(0.7, 2 * restitution, -0.4);
        SCOPED_TRACE(fmt::format("{} e {} m2 {}", way.method, restitution, mass2));
        expectVelocities(dropOf(dumbbell, way, restitution, kImpactTime),
                         {1.3, mass2, dumbbell.rod, expected, expected}, kRounding);
      }
}

}  // namespace
}  // namespace cradle
