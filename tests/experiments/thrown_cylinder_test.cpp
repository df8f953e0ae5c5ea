#include <gtest/gtest.h>

#include <random>

#include "experiments/experiment.h"

// Cylinders that are thrown on a floor land on a rim, slap down on their end or side, and tip over it: of some hundred
// throws those in which rows of points of the rim once held what tipped, up to 7 cm deep and 1 cm high.

namespace cradle {
namespace {

constexpr double kContactStep = 1.0 / 960;  // s

struct Throw {
  double radius = 0, length = 0;  // m
  Trajectory run;

  /// m, over the floor.
  double lowest(const BodyState& state) const {
    const double upright = std::abs((state.orientation * Vec3::UnitY()).y());
    return state.position.y() - upright * length / 2 - std::sqrt(std::max(0.0, 1 - upright * upright)) * radius;
  }
};

Throw thrown(unsigned number, const std::string& floor) {
  std::mt19937 random(number);
  std::uniform_real_distribution<double> part(0, 1);
  const auto within = [&](double most) { return most * (2 * part(random) - 1); };
  Throw result{0.05 + 0.15 * part(random), 0.03 + 0.27 * part(random), {}};
  const Vec3 tilt(within(1), 0, within(1)), spin(within(2), within(8), within(2)), velocity(within(1), 0, within(1));
  const double friction = 0.4 * static_cast<double>(number % 3);
  result.run = simulate(sceneWith(fmt::format(
      R"("duration": 1.5, "accuracy": 1e-5, "output": {{"framesPerSecond": 100}},
      "materials": {{"m": {{"staticFriction": {0}, "dynamicFriction": {0}}}}},
      "bodies": [{1}, {{"name": "cylinder", "shape": {{"cylinder": {{"radius": {2}, "length": {3}}}}}, "material": "m",
      "position": [0, 0.4, 0], "orientation": {{"axis": {4}, "angleDegrees": {5}}},
      "linearVelocity": {6}, "angularVelocity": {7}}}])",
      friction, floor, result.radius, result.length, vectorText(tilt), 60 * tilt.norm(), vectorText(velocity),
      vectorText(spin))));
  return result;
}

// What meets no other body falls by g between two frames; a rim sinks by no more than it goes down in a contact step.
void expectNeitherSinksNorFloats(const Throw& of, const std::string& what) {
  for (std::size_t i = 1; i < of.run.frames.size(); ++i) {
    const Frame &frame = of.run.frames[i], &before = of.run.frames[i - 1];
    const BodyState &state = frame.states[0], &former = before.states[0];
    const double reach = std::hypot(of.radius, of.length / 2);
    const double speed = state.linearVelocity.norm() + reach * state.angularVelocity.norm();
    EXPECT_GT(of.lowest(state), -kContactStep * speed - 1e-6) << what << " at " << frame.time;
    const bool isEventful = std::any_of(of.run.events.begin(), of.run.events.end(), [&](const Event& event) {
      return event.time > before.time && event.time <= frame.time;
    });
    if (isEventful || of.lowest(state) < 1e-4 || of.lowest(former) < 1e-4) continue;
    const double fall = kGravity * (frame.time - before.time);
    EXPECT_NEAR(state.linearVelocity.y(), former.linearVelocity.y() - fall, 1e-9) << what << " at " << frame.time;
  }
}

TEST(ThrownCylinder, NeitherSinksIntoAPlaneNorFloatsOverIt) {
  for (const unsigned number : {23U, 136U, 218U, 224U, 284U, 314U})
    expectNeitherSinksNorFloats(
        thrown(number, R"({"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "m"})"),
        fmt::format("throw {}", number));
}

TEST(ThrownCylinder, NeitherSinksIntoABoxNorFloatsOverIt) {
  for (const unsigned number : {23U, 38U, 59U})
    expectNeitherSinksNorFloats(
        thrown(number, R"({"name": "floor", "shape": {"box": {"size": [20, 1, 20]}}, "motion": "static",
                           "material": "m", "position": [0, -0.5, 0]})"),
        fmt::format("throw {}", number));
}

}  // namespace
}  // namespace cradle
