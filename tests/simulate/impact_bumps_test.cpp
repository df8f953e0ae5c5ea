#include "simulate/impact_bumps.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/experiment.h"
#include "simulate/simulate.h"

namespace cradle {
namespace {

constexpr double kGravity = 9.81, kRadius = 0.1, kFall = 0.9;  // m/s^2, m

/// Text of a floor and of what falls onto it without friction.
std::string above(double restitution, const std::string& bodies) {
  return fmt::format(R"("materials": {{"smooth": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}},
    "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "smooth"}}, {}])",
                     restitution, bodies);
}

std::string named(const std::string& name, double x, double y,
                  const std::string& shape = R"({"sphere": {"radius": 0.1}})") {
  return fmt::format(R"({{"name": "{}", "shape": {}, "material": "smooth", "position": [{}, {}, 0]}})", name, shape, x,
                     y);
}

Scene bumpy(double deviationDegrees, long seed, const std::string& members, const std::string& changes = "") {
  return sceneWith(fmt::format(R"("bumps": {{"deviationDegrees": {}, "seed": {}{}}}, {})", deviationDegrees, seed,
                               changes, members));
}

/// What the first impact of the last body changed its velocity by, m/s; it is the only one before the end.
Vec3 changeOf(const Scene& scene) {
  const Trajectory run = simulate(scene);
  const double fallTime = std::sqrt(2 * kFall / kGravity);
  const BodyState& end = run.frames.back().states.back();
  return end.linearVelocity + Vec3(0, kGravity * (run.frames.back().time - fallTime), 0) +
         Vec3(0, kGravity * fallTime, 0);
}

// An impulse along the tilted normal n': the change of the velocity shows its direction. Its size follows from
// Newton's law along n': the ball closes with v cos(tilt), and its mobility there is 1/m (1 + (5/2) sin^2(tilt)), as
// n' passes the centre at r sin(tilt). Angles about two directions are normal: Kolmogorov and Smirnov's sup |F_n - F|
// exceeds 1.95 / sqrt(n) once in a thousand.
TEST(ImpactBumps, TiltNormalsByTwoNormalAngles) {
  constexpr double kDeviation = 3, kRestitution = 0.5;  // degrees
  std::vector<double> shares;
  for (long seed = 0; seed < 300; ++seed) {
    const Vec3 change = changeOf(
        bumpy(kDeviation, seed, R"("duration": 0.45, )" + above(kRestitution, named("ball", 0, kRadius + kFall))));
    const double tilt = std::atan2(std::hypot(change.x(), change.z()), change.y());
    const double speed = std::sqrt(2 * kGravity * kFall), sine = std::sin(tilt);
    EXPECT_NEAR(change.norm(), (1 + kRestitution) * speed * std::cos(tilt) / (1 + 2.5 * sine * sine), 1e-9);
    for (const double across : {change.x(), change.z()}) {
      const double angle = tilt * across / std::hypot(change.x(), change.z());
      const double deviations = angle / (kDeviation * std::numbers::pi / 180);
      shares.push_back(std::erfc(-deviations / std::numbers::sqrt2) / 2);
    }
  }
  std::sort(shares.begin(), shares.end());
  const double count = static_cast<double>(shares.size());
  double farthest = 0;
  for (std::size_t i = 0; i < shares.size(); ++i)
    farthest = std::max({farthest, double(i + 1) / count - shares[i], shares[i] - double(i) / count});
  EXPECT_LT(farthest, 1.95 / std::sqrt(count));
}

// A box that falls flat has four contacts: with one tilt the change is along it, as that of a ball of the same name.
TEST(ImpactBumps, AreTheSameAtAllContactsOfAPair) {
  for (long seed = 0; seed < 10; ++seed) {
    const auto change = [&](const std::string& shape) {
      return changeOf(bumpy(1, seed, R"("duration": 0.45, )" + above(0.5, named("body", 0, kRadius + kFall, shape))));
    };
    const Vec3 ofBox = change(R"({"box": {"size": [0.2, 0.2, 0.2]}})"),
               ofBall = change(R"({"sphere": {"radius": 0.1}})");
    EXPECT_LT((ofBox.normalized() - ofBall.normalized()).norm(), 1e-9);
    EXPECT_GT(std::abs(ofBall.x()), 1e-3);
  }
}

// The law is that of a smooth surface along another normal: without loss, and nothing gets into the floor.
TEST(ImpactBumps, KeepEnergyWhereRestitutionDoes) {
  for (const std::string method : {"", R"("method": {"name": "rk4", "timeStep": 0.002}, )"})
    for (const std::string shape : {R"({"sphere": {"radius": 0.1}})", R"({"box": {"size": [0.2, 0.2, 0.2]}})"}) {
      const Trajectory run =
          simulate(bumpy(5, 2, method + R"("duration": 8, )" + above(1, named("body", 0, 1, shape))));
      const double energy = run.frames.front().energy.kinetic + run.frames.front().energy.potential;
      for (const Frame& frame : run.frames) {
        EXPECT_GE(frame.states.back().position.y(), 0.1 - 1e-6 * kRadius) << method << shape;
        EXPECT_LT(std::abs(frame.energy.dissipated), 1e-6 * energy) << method << shape;
      }
      EXPECT_GT(run.frames.back().states.back().position.head<1>().norm(), 0.1) << method << shape;
    }
}

std::vector<Vec3> pathOf(const Trajectory& run, std::size_t body) {
  std::vector<Vec3> path;
  for (const Frame& frame : run.frames) path.push_back(frame.states[body].position);
  return path;
}

/// m
double largestDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

std::vector<double> impactTimes(const Trajectory& run, int body) {
  std::vector<double> times;
  for (const Event& event : run.events)
    if (event.kind == EventKind::impact && (event.bodyA == body || event.bodyB == body)) times.push_back(event.time);
  return times;
}

TEST(ImpactBumps, ChangeFromAnImpactOnForOneBodyAlone) {
  const std::string members = R"("duration": 2, )" + above(0.9, named("ball", 0, 1) + ", " + named("other", 30, 1.5));
  const Trajectory plain = simulate(bumpy(3, 1, members));
  const Trajectory changed =
      simulate(bumpy(3, 1, members, R"(, "changes": [{"body": "ball", "impact": 2, "seed": 9}])"));
  const std::vector<Vec3> before = pathOf(plain, 0), after = pathOf(changed, 0);
  const std::vector<double> impacts = impactTimes(plain, 1);
  ASSERT_GE(impacts.size(), 3);
  for (std::size_t frame = 0; frame < before.size() && plain.frames[frame].time < impacts[1]; ++frame)
    EXPECT_EQ(before[frame], after[frame]);
  EXPECT_GT((before.back() - after.back()).norm(), 0.01);
  EXPECT_LT(largestDistance(pathOf(plain, 1), pathOf(changed, 1)), 1e-6);
}

// Bumps are counted by body, however bodies are grouped and stepped. Accuracy is 1e-6, and five bounces of at most
// 2 m/s sideways leave 1e-5 m; another tilt is worth centimetres.
TEST(ImpactBumps, DoNotDependOnOtherBodiesOrOnTheMethod) {
  const std::string ball = named("ball", 0, 1), rest = R"("duration": 2, )";
  const auto path = [&](const std::string& members) { return pathOf(simulate(bumpy(3, 4, members)), 0); };
  const std::vector<Vec3> alone = path(rest + above(0.9, ball));
  EXPECT_GT(std::abs(alone.back().x()), 0.05);
  const std::string others = ball + ", " + named("near", 1, 0.8) + ", " + named("far", 30, 2);
  EXPECT_LT(largestDistance(alone, path(rest + above(0.9, others))), 1e-5);
  EXPECT_LT(largestDistance(alone, path(R"("method": {"name": "rk4", "timeStep": 0.004}, )" + rest + above(0.9, ball))),
            1e-5);
}

// A fall from 0.9 % of the radius is below the least that has bumps, one from 1.1 % above it.
TEST(ImpactBumps, AreNoneOfSlowImpacts) {
  const auto sideways = [](double fall) {
    const Trajectory run =
        simulate(bumpy(5, 1, R"("duration": 0.1, )" + above(0.5, named("ball", 0, kRadius * (1 + fall)))));
    return std::abs(run.frames.back().states.back().linearVelocity.x());
  };
  EXPECT_EQ(sideways(0.009), 0);
  EXPECT_GT(sideways(0.011), 1e-6);
}

// Where the tilted normal would open, the impact is the one without bumps: v sideways is far above v down.
TEST(ImpactBumps, KeepThoseWhoGrazeAbove) {
  for (long seed = 0; seed < 50; ++seed) {
    const std::string ball = R"({"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "material": "smooth",
      "position": [0, 0.2, 0], "linearVelocity": [20, -1, 0]})";
    const Trajectory run = simulate(bumpy(10, seed, R"("duration": 0.5, )" + above(0.7, ball)));
    for (const Frame& frame : run.frames) EXPECT_GE(frame.states.back().position.y(), 0.1 - 1e-6 * kRadius) << seed;
  }
}

}  // namespace
}  // namespace cradle
