// Outcomes of impacts in which several contacts, or a rod, take part, from scenes to frames: rows of balls, a break of
// billiard balls, a dumbbell on a floor. Frames lie at the instant of the impact, and show what follows it.

#include <gtest/gtest.h>

#include <cmath>

#include "collision/random_poses.h"
#include "experiments/experiment.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kRadius = 0.1;       // m
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
                     number, kRadius, mass, vectorText(position), vectorText(velocity));
}

/// The frame of the impact.
Frame impactOf(const Way& way, double restitution, const std::string& bodies, const std::string& more = "") {
  const Trajectory run = simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": 1e-10, "gravity": [0, 0, 0], {} "output": {{"framesPerSecond": 4}},
      "materials": {{"m": {{"restitution": {:.17g}, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [{}] {})",
      kImpactTime, way.method, restitution, way.friction, way.friction, bodies, more)));
  return run.frames.back();
}

using Speeds = std::vector<double>;

/// A row of balls of 1 kg along x. Those at rest touch each other; those that come in do too, and arrive at once.
Speeds rowAfterImpact(const Way& way, double restitution, const Speeds& before) {
  std::vector<std::string> balls;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double place = 2 * kRadius * static_cast<double>(i) - before[i] * kImpactTime;
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
    for (int i = 0; i <= row; ++i) places.push_back(2 * kRadius * Vec3(row * std::sqrt(0.75), 0, i - 0.5 * row));
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
      balls.push_back(ballText(balls.size(), 1, 2 * kRadius * Vec3(std::sqrt(0.75), 0, side / 2), Vec3::Zero()));
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
      asymmetry = std::max(asymmetry, kRadius * (ball.angularVelocity - Vec3(-w.x(), -w.y(), w.z())).norm());
    }
    first += count;
  }
  return asymmetry;
}

TEST(BilliardBreak, HeadOnIsMirrorSymmetric) {
  for (const Way& way : kWays)
    for (const int rows : {2, 3, 5}) {
      const Frame frame = breakOf(way, rows, -2 * kRadius * Vec3::UnitX());
      EXPECT_LT(asymmetryOf(frame, rows), kRounding) << way.method << " friction " << way.friction << " rows " << rows;
      EXPECT_GT(frame.states[0].linearVelocity.norm() + frame.states[1].linearVelocity.norm(), 0.1);
      EXPECT_NEAR(frame.energy.momentum.x(), 1, kRounding);
      EXPECT_NEAR(frame.energy.kinetic, 0.5, way.friction > 0 ? 0.5 : kRounding) << way.method << rows;
    }
}

/// Two balls on a rod at the instant at which ball 1 reaches the floor, or both do.
struct Dumbbell {
  double mass1, mass2;  // kg
  Vec3 rod;             // m, from ball 1 to ball 2
  Vec3 velocity, spin;  // m/s of the centre of mass, rad/s; spin across the rod
  double mass() const { return mass1 + mass2; }
  Vec3 offset1() const { return -mass2 / mass() * rod; }  // m, from the centre of mass
  Vec3 offset2() const { return mass1 / mass() * rod; }
  Vec3 velocity1() const { return velocity + spin.cross(offset1()); }
  Vec3 velocity2() const { return velocity + spin.cross(offset2()); }
};

/// It flies freely until then: the centre straight, the rod turning steadily.
Frame dropOf(const Dumbbell& dumbbell, double restitution, const char* method) {
  const double turned = dumbbell.spin.norm() * kImpactTime;
  const Quat back = turned > 0 ? rotationAbout(Vec3(dumbbell.spin.normalized()), -turned) : Quat::Identity();
  const Vec3 center = Vec3(0, kRadius, 0) - dumbbell.offset1() - kImpactTime * dumbbell.velocity;
  const std::string bodies = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "m"}, )" +
                             ballText(1, dumbbell.mass1, center + back * dumbbell.offset1(),
                                      dumbbell.velocity + back * dumbbell.spin.cross(dumbbell.offset1())) +
                             ", " +
                             ballText(2, dumbbell.mass2, center + back * dumbbell.offset2(),
                                      dumbbell.velocity + back * dumbbell.spin.cross(dumbbell.offset2()));
  return impactOf({method, 0}, restitution, bodies,
                  R"(, "rods": [{"bodyA": "b1", "anchorA": [0, 0, 0], "bodyB": "b2", "anchorB": [0, 0, 0]}])");
}

// The floor's impulse p along y on ball 1 and the rod's q along d keep its length: p d_y / m1 + q (1 / m1 + 1 / m2) =
// 0. Ball 1's speed along y then changes by p (1 - m2 d_y^2 / M) / m1 = -(1 + e) v1_y.
void expectClosedForm(const Dumbbell& dumbbell, double restitution, const char* method) {
  const Vec3 d = dumbbell.rod.normalized();
  const double m1 = dumbbell.mass1, m2 = dumbbell.mass2, part = m2 / dumbbell.mass();
  const double p = -(1 + restitution) * dumbbell.velocity1().y() * m1 / (1 - part * d.y() * d.y());
  const double q = -p * d.y() * part;
  const Frame frame = dropOf(dumbbell, restitution, method);
  // A rod that turns at some rad/s is integrated up to the impact: local errors of 1e-11, ten of them.
  const double tolerance = dumbbell.spin.isZero() ? kRounding : 1e-10;
  EXPECT_LT((frame.states[0].linearVelocity - (dumbbell.velocity1() + (p * Vec3::UnitY() + q * d) / m1)).norm(),
            tolerance);
  EXPECT_LT((frame.states[1].linearVelocity - (dumbbell.velocity2() - q * d / m2)).norm(), tolerance);
}

TEST(DumbbellOnAFloor, OneEndFirstMatchesTheClosedForm) {
  RandomPoses random(21);
  for (const char* method : {"", R"("method": {"name": "rk4"},)"})
    for (const double restitution : {1.0, 0.5, 0.0})
      for (const double mass2 : {0.2, 1.3, 30.0})
        for (const double angle : {0.1, 0.8, 1.5}) {
          const double turn = random.number(0, 6);
          const Vec3 rod =
              0.7 * Vec3(std::cos(angle) * std::cos(turn), std::sin(angle), std::cos(angle) * std::sin(turn));
          SCOPED_TRACE(fmt::format("{} e {} m2 {} angle {}", method, restitution, mass2, angle));
          expectClosedForm({1.3, mass2, rod, Vec3(0, -2, 0), Vec3::Zero()}, restitution, method);
          expectClosedForm({1.3, mass2, rod, Vec3(0.7, -2, -0.4), Vec3::Zero()}, restitution, method);
        }
}

TEST(DumbbellOnAFloor, TurningMatchesTheClosedForm) {
  RandomPoses random(22);
  for (const double restitution : {1.0, 0.5, 0.0})
    for (int trial = 0; trial < 6; ++trial) {
      const Vec3 direction = random.direction();
      const Vec3 rod = 0.7 * Vec3(direction.x(), std::abs(direction.y()) + 0.5, direction.z()).normalized();
      const double mass2 = random.number(0.3, 3);
      const Vec3 spin = 2 * rod.cross(random.direction());  // slow: ball 2 stays above
      SCOPED_TRACE(fmt::format("e {} trial {}", restitution, trial));
      expectClosedForm({1.3, mass2, rod, Vec3(0.3, -3, 0.2), spin}, restitution, "");
    }
}

// Flat on the floor each ball bounces for itself: the rod lies across both impulses.
TEST(DumbbellOnAFloor, BothEndsAtOnceMatchTheClosedForm) {
  for (const char* method : {"", R"("method": {"name": "rk4"},)"})
    for (const double restitution : {1.0, 0.5, 0.0})
      for (const double mass2 : {0.2, 1.3, 30.0}) {
        const Frame frame =
            dropOf({1.3, mass2, Vec3(0.6, 0, 0.3), Vec3(0.7, -2, -0.4), Vec3::Zero()}, restitution, method);
        for (const BodyState& ball : frame.states)
          EXPECT_LT((ball.linearVelocity - Vec3(0.7, 2 * restitution, -0.4)).norm(), kRounding)
              << method << restitution << ' ' << mass2;
      }
}

}  // namespace
}  // namespace cradle
