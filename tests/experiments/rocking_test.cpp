#include <gtest/gtest.h>

#include "experiments/experiment.h"

// A slender block that rocks from edge to edge: G. W. Housner, "The behavior of inverted pendulum structures during
// earthquakes", Bull. Seismological Society of America 53(2), 1963. Angular momentum about the new edge is kept: of its
// speed a part r = 1 - m R^2 (1 - cos 2 alpha) / I is left, I about an edge, R to the centre, tan alpha = width /
// height.

namespace cradle {
namespace {

/// Boxes above each other, 1 m wide and 10 kg together, turned as one about an edge on the floor and let go.
struct Tower {
  int boxes = 1;
  double height = 4;    // m, of all
  double angle = 0.02;  // rad
  double radius() const { return std::hypot(1, height) / 2; }
  double inertia() const { return 10 * 4 * radius() * radius() / 3; }
  double slenderness() const { return std::atan2(1, height); }
  double speedLeft() const { return 1 - 10 * radius() * radius() * (1 - std::cos(2 * slenderness())) / inertia(); }
  double lift() const {  // J
    return 10 * kGravity * radius() * (std::cos(slenderness() - angle) - std::cos(slenderness()));
  }
  /// s, until it first stands: dt = d(theta) / sqrt(2 (U(angle) - U(theta)) / I) by the midpoint rule, theta = angle (1
  /// - s^2).
  double timeOfFall() const {
    constexpr int kPieces = 1000;
    double time = 0;
    for (int i = 0; i < kPieces; ++i) {
      const double s = (i + 0.5) / kPieces, theta = angle * (1 - s * s);
      const double fall =
          10 * kGravity * radius() * (std::cos(slenderness() - angle) - std::cos(slenderness() - theta));
      time += 2 * angle * s / std::sqrt(2 * fall / inertia()) / kPieces;
    }
    return time;
  }
  Trajectory run(double duration) const;
};

Trajectory Tower::run(double duration) const {
  std::string bodies;
  for (int i = 0; i < boxes; ++i) {
    const double x = -0.5, y = (i + 0.5) * height / boxes, c = std::cos(angle), s = -std::sin(angle);
    bodies += fmt::format(R"(, {{"name": "b{}", "material": "m", "shape": {{"box": {{"size": [1, {}, 1]}}}},
        "mass": {:.17g}, "position": [{:.17g}, {:.17g}, 0], "orientation": {{"w": {:.17g}, "x": 0, "y": 0, "z": {:.17g}}}}})",
                          i, height / boxes, 10.0 / boxes, c * x - s * y + 0.5, s * x + c * y, std::cos(angle / 2),
                          -std::sin(angle / 2));
  }
  return simulate(sceneWith(fmt::format(R"("duration": {}, "accuracy": 1e-6, "output": {{"framesPerSecond": 240}},
    "materials": {{"m": {{"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.5}}}},
    "bodies": [{{"name": "floor", "motion": "static", "material": "m", "shape": {{"plane": {{}}}}}}{}])",
                                        duration, bodies)));
}

/// Energy (J) above that of the tower at rest, relative to that of its start.
double energyPart(const Tower& tower, const Frame& frame) {
  const double energy = frame.energy.kinetic + frame.energy.potential;
  return (energy - 10 * kGravity * tower.height / 2) / tower.lift();
}

// Four landings, with an order 8 between them: energies are off by the accuracy, 1e-7 a step of some dozens.
TEST(RockingBlock, LosesAtEachImpactWhatHousnerSays) {
  const Tower tower;
  const Trajectory run = tower.run(1.5);
  const double r2 = tower.speedLeft() * tower.speedLeft();
  int landings = 0;
  double last = 0;
  for (const Event& event : run.events) {
    if (event.kind != EventKind::impact || event.time < last + 1e-3) continue;  // an edge lands with two corners
    if (++landings == 1) {
      EXPECT_NEAR(event.time, tower.timeOfFall(), 1e-6);
    }
    last = event.time;
    const Frame& after = run.frames.at(static_cast<std::size_t>(event.time * 240) + 2);
    EXPECT_NEAR(energyPart(tower, after), std::pow(r2, landings), 1e-5) << landings;
  }
  EXPECT_GE(landings, 4);
  EXPECT_NEAR(r2, std::pow(1 - 1.5 * std::pow(std::sin(tower.slenderness()), 2), 2), 1e-12);
}

// Boxes on each other rock as one: what an edge of the lowest takes, the others can pass on without leaving each other.
// Steps of 1/960 s end where an edge lands, and between landings keep the energy to their order 2: the block's 1.5
// rad/s make (1.5 / 960)^2 = 2e-6 of it in a step, of changing sign: no frame has more than that in excess.
TEST(RockingTower, LosesInTheContactStepWhatABlockDoes) {
  const Tower tower{3, 6, 0.01};
  const Trajectory run = tower.run(1);
  const double r2 = tower.speedLeft() * tower.speedLeft();
  double before = 1 + 1e-9;
  for (const Frame& frame : run.frames) {
    const double part = energyPart(tower, frame);
    EXPECT_LE(part, before + 2e-6) << frame.time;
    before = part;
  }
  // By then it has landed twice: Housner's times are 0.23, 0.66 and 1.08 s.
  EXPECT_NEAR(before, r2 * r2, 2e-3);
}

// Small angles: constant accelerations c = m g R sin(alpha) / I between impacts that leave a part r of the speed, so
// that all landings together take sqrt(2 angle / c) (1 + 2 r / (1 - r)). What the contact step loses besides ends it
// earlier, the more the shorter the last swings are; a block that events move takes the whole time.
TEST(RockingTower, ComesToRestWhenItsEnergyIsGone) {
  for (const int boxes : {1, 3}) {
    const Tower tower{boxes, 3, 0.001};
    const double acceleration = 10 * kGravity * tower.radius() * std::sin(tower.slenderness()) / tower.inertia();
    const double r = tower.speedLeft(), end = std::sqrt(2 * tower.angle / acceleration) * (1 + 2 * r / (1 - r));
    const Trajectory run = tower.run(1.2 * end);
    double rest = 0;
    for (const Event& event : run.events)
      if (event.kind == EventKind::rest) rest = event.time;
    EXPECT_LT(rest, 1.01 * end)
        << boxes;  // accelerations are as constant as cos(angle), and end later by angle / alpha
    EXPECT_GT(rest, (boxes == 1 ? 0.99 : 0.85) * end) << boxes;
    EXPECT_EQ(run.frames.back().energy.kinetic, 0) << boxes;
    for (const BodyState& state : run.frames.back().states)
      EXPECT_LT(std::hypot(state.position.x(), state.position.z()), tower.angle * 3) << boxes;
  }
}

// A disc without friction that bounces down to rocking on its rim, where the point that touches runs around it from one
// side to the other. Each frame has no more energy than the one before, in parts of what is left: integration with an
// accuracy of 1e-6.
TEST(RockingDisc, RocksWithoutGainOfEnergyOrSinking) {
  const Trajectory run = simulate(sceneWith(
      R"("duration": 1.2, "accuracy": 1e-6, "output": {"framesPerSecond": 960},
         "materials": {"m": {"restitution": 0.3, "staticFriction": 0, "dynamicFriction": 0}},
         "bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "m"},
                    {"name": "disc", "shape": {"cylinder": {"radius": 0.1, "length": 0.05}}, "mass": 1, "material": "m",
                     "position": [0, 0.05, 0], "orientation": {"axis": [1, 0, 2], "angleDegrees": 4},
                     "angularVelocity": [-20, 0, -37], "linearVelocity": [0, -2, 0]}])"));
  double before = INFINITY, deepest = 0;
  for (const Frame& frame : run.frames) {
    const double energy = frame.energy.kinetic + frame.energy.potential - kGravity * 0.025;  // J, above rest
    EXPECT_LE(energy, before * (1 + 1e-6) + 1e-7) << frame.time;
    // Steps in which something strikes are of order 1: m g times the change of speed times a step, 2 mJ, for each.
    EXPECT_NEAR(energyConstantOf(frame), energyConstantOf(run.frames[0]), 4e-3) << frame.time;
    EXPECT_NEAR(ledgerConstantOf(frame), ledgerConstantOf(run.frames[0]), 1e-12) << frame.time;
    before = energy;
    const double tilt = (frame.states[0].orientation * Vec3::UnitY()).y();
    const double low = 0.025 * std::abs(tilt) + 0.1 * std::sqrt(std::max(0.0, 1 - tilt * tilt));
    deepest = std::max(deepest, low - frame.states[0].position.y());
  }
  EXPECT_LT(deepest, 1e-3);  // the rim turns within a step
}

}  // namespace
}  // namespace cradle
