#include <gtest/gtest.h>

#include "experiments/experiment.h"

namespace cradle {
namespace {

/// A ball dropped so that its lowest point falls 1 m onto a plane.
Trajectory dropBall(double restitution, double duration, const std::string& method) {
  return simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Bounce", "duration": {},
    "output": {{"framesPerSecond": 1}}, {},
    "materials": {{"m": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}},
    "bodies": [{{"name": "ground", "shape": {{"plane": {{"normal": [0, 1, 0]}}}}, "motion": "static", "material": "m"}},
      {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [0, 1.1, 0],
       "material": "m"}}]}})",
                                      duration, method, restitution)));
}

std::vector<double> impactTimes(const Trajectory& run) {
  std::vector<double> times;
  for (const Event& event : run.events)
    if (event.kind == EventKind::impact) times.push_back(event.time);
  return times;
}

// t_n = t1 (1 + 2 sum e^k), t1 = sqrt(2 h / g). RK4 is exact on parabolas, so that what is left is the gap to which an
// impact is resolved, 1e-13 m at 4 m/s, and rounding that grows with the bounces.
TEST(BouncingBall, Rk4HitsTheClosedFormWithoutLoss) {
  const Trajectory run = dropBall(1, 5, methodText("rk4", 1.0 / 960));
  const double first = std::sqrt(2 / 9.81);
  const std::vector<double> times = impactTimes(run);
  ASSERT_EQ(times.size(), 6u);
  for (std::size_t n = 0; n < times.size(); ++n)
    EXPECT_NEAR(times[n], first * (1 + 2 * static_cast<double>(n)), 1e-11) << n;
  EXPECT_NEAR(run.frames[5].states[0].position.y() - 0.1, 0.14181508420121035975, 1e-10);
  EXPECT_NEAR(run.frames[5].states[0].linearVelocity.y(), 4.1033630168402420719, 1e-10);
}

TEST(BouncingBall, Rk4HitsTheClosedFormWithLoss) {
  const Trajectory run = dropBall(0.8, 3, methodText("rk4", 1.0 / 960));
  const std::vector<double> times = impactTimes(run);
  double expected = std::sqrt(2 / 9.81), flight = 2 * expected;
  for (std::size_t n = 0; n < 6; ++n) {
    EXPECT_NEAR(times.at(n), expected, 1e-11) << n;
    flight *= 0.8;
    expected += flight;
  }
  const std::vector<std::pair<double, double>> values = {{0.46800445252603631079, -1.8369955474739636892},
                                                         {0.26074172832705719667, -0.16586913583647140167},
                                                         {0.068707460965765722041, -0.015354133384744759320}};
  for (std::size_t second = 1; second <= 3; ++second) {
    EXPECT_NEAR(run.frames[second].states[0].position.y() - 0.1, values[second - 1].first, 1e-10);
    EXPECT_NEAR(run.frames[second].states[0].linearVelocity.y(), values[second - 1].second, 1e-10);
  }
}

// Semi-implicit Euler falls g h t / 2 farther: the first impact is early by g h t / (2 g t) = h / 2 to first order.
TEST(BouncingBall, SemiImplicitEulerIsHalfAStepEarlyAtTheFirstImpact) {
  const double step = 1.0 / 960;
  const std::vector<double> times = impactTimes(dropBall(1, 1, methodText("semiImplicitEuler", step)));
  ASSERT_FALSE(times.empty());
  EXPECT_NEAR(times[0], std::sqrt(2 / 9.81) - step / 2, step * step);
}

// The bounces of e = 0.8 end at 4.0637 s. A rebound is not resolved once it would end within about two steps, at a
// speed of 2 g h: the ball then comes to rest earlier by the time that the rest would take, e v / g x 2 / (1 - e) = 16
// h.
TEST(BouncingBall, ComesToRestAtTheZenoTimeAndStays) {
  const double step = 1.0 / 960;
  const Trajectory run = dropBall(0.8, 6, methodText("rk4", step));
  const auto rest = std::find_if(run.events.begin(), run.events.end(),
                                 [](const Event& event) { return event.kind == EventKind::rest; });
  ASSERT_NE(rest, run.events.end());
  EXPECT_NEAR(rest->time, 4.0637127688715781401, 20 * step);
  EXPECT_LT(rest->time, 4.0637127688715781401 + 2 * step);
  EXPECT_NEAR(run.frames[6].states[0].position.y(), 0.1, 1e-9);
  EXPECT_EQ(run.frames[6].states[0].linearVelocity, Vec3::Zero());
  EXPECT_EQ(run.frames[6].states[0].position, run.frames[5].states[0].position);
  EXPECT_EQ(run.events.back().kind, EventKind::rest);
}

// All of m g h = 9.81 J goes into impacts. Semi-implicit Euler keeps H - (h / 2) m g v instead of the energy H (v
// upward), so each impact from -v to e v changes H by (h / 2) m g (1 + e) v too little; over all bounces that is (h /
// 2) g (1 + e) v1 / (1 - e), v1 = sqrt(2 g 1 m). The last bounces, not resolved, are below 1e-3 J.
TEST(BouncingBall, AccountsForTheEnergyThatItLoses) {
  const double step = 1.0 / 960, restitution = 0.8;
  const double missing = step / 2 * 9.81 * (1 + restitution) * std::sqrt(2 * 9.81) / (1 - restitution);
  const auto dissipated = [&](const char* method) {
    return dropBall(restitution, 6, methodText(method, step)).frames.back().energy.dissipated;
  };
  EXPECT_NEAR(dissipated("rk4"), 9.81, 1e-3);
  EXPECT_NEAR(dissipated("semiImplicitEuler"), 9.81 - missing, 0.1 * missing);
}

}  // namespace
}  // namespace cradle
