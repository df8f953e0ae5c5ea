// What becomes of the energy: each cause against its closed form, and the sum against the states.

#include <gtest/gtest.h>

#include "experiments/experiment.h"

namespace cradle {
namespace {

const char* const kGround = R"({"name": "ground", "shape": {"plane": {}}, "motion": "static"})";

/// Kinetic energy and potential energy of weight (J), from the states and masses of a trajectory alone.
double energyOfStates(const Trajectory& run, const Frame& frame) {
  double energy = 0;
  std::size_t next = 0;
  for (const BodyRecord& body : run.header.bodies) {
    if (!body.hasStates()) continue;
    const BodyState& state = frame.states[next++];
    const Vec3 spin = state.orientation.conjugate() * state.angularVelocity;
    energy += body.massProperties.mass * (0.5 * state.linearVelocity.squaredNorm() + kGravity * state.position.y()) +
              0.5 * spin.dot(body.massProperties.inertiaTensor * spin);
  }
  return energy;
}

/// What operations book is measured to the rounding of the energy, some 1e-16 of it; a run has some thousands of them.
constexpr double kLedgerRounding = 1e-12;

/// The ledger balances in every frame, by the states; causes never give back what they took.
void expectBalance(const Trajectory& run) {
  double scale = 0;
  for (const Frame& frame : run.frames)
    scale = std::max({scale, frame.energy.kinetic, std::abs(frame.energy.potential), std::abs(frame.energy.work)});
  const double start = energyOfStates(run, run.frames[0]) + run.frames[0].energy.numerical;
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const EnergyBalance& energy = run.frames[i].energy;
    EXPECT_NEAR(energyOfStates(run, run.frames[i]) + energy.impact + energy.friction + energy.damping - energy.work +
                    energy.numerical,
                start, kLedgerRounding * scale)
        << run.frames[i].time;
    EXPECT_DOUBLE_EQ(energy.dissipated, energy.impact + energy.friction + energy.damping);
    if (i == 0) continue;
    const EnergyBalance& before = run.frames[i - 1].energy;
    EXPECT_GE(energy.impact, before.impact - kLedgerRounding * scale) << run.frames[i].time;
    EXPECT_GE(energy.damping, before.damping - kLedgerRounding * scale) << run.frames[i].time;
  }
}

double largestNumerical(const Trajectory& run) {
  double largest = 0;
  for (const Frame& frame : run.frames)
    largest = std::max(largest, std::abs(frame.energy.numerical - run.frames[0].energy.numerical));
  return largest;
}

/// A box of 2 kg on the ground that slides with 3 m/s, friction 0.3, until it stops after 1.02 s and 1.53 m.
Trajectory slidingBox(const std::string& method) {
  return simulate(sceneWith(fmt::format(R"("duration": 1.25, {},
    "materials": {{"m": {{"staticFriction": 0.3, "dynamicFriction": 0.3}}}},
    "bodies": [{{"name": "box", "material": "m", "shape": {{"box": {{"size": [1, 0.1, 1]}}}}, "mass": 2,
                "position": [0, 0.05, 0], "linearVelocity": [3, 0, 0]}},
               {{"name": "ground", "material": "m", "shape": {{"plane": {{}}}}, "motion": "static"}}])",
                                        method)));
}

// Friction works with the way: mu m g x, and nothing else takes anything. In steps of one length that is as exact
// (constant forces), but for the step in which the box stops: it stops at its end, by up to a mu g h^2 / 2 too far.
TEST(EnergyLedger, FrictionOfASlidingBlockIsItsForceTimesTheWay) {
  const double force = 0.3 * 2 * kGravity, timeStep = 1e-3;
  for (const std::string& method : {std::string(R"("accuracy": 1e-8)"), methodText("rk4", timeStep)}) {
    const Trajectory run = slidingBox(method);
    expectBalance(run);
    const double accuracy = 1e-8 * 9;  // J: of all that there is
    const double lastStep = method.find("rk4") == std::string::npos ? 0 : force * 0.3 * kGravity * timeStep * timeStep;
    for (const Frame& frame : run.frames) {
      EXPECT_NEAR(frame.energy.friction, force * frame.states[0].position.x(), accuracy + lastStep) << frame.time;
      EXPECT_NEAR(frame.energy.impact, 0, 1e-12) << frame.time;
      EXPECT_EQ(frame.energy.damping, 0);
      EXPECT_NEAR(frame.energy.numerical, 0, accuracy + lastStep) << frame.time;
    }
    EXPECT_NEAR(run.frames.back().energy.friction, 9, accuracy + lastStep);
  }
}

// Each bounce takes (1 - e^2) of what is left of m g h: after k of them e^(2 k) is left.
TEST(EnergyLedger, ImpactsOfABouncingBallTakeAllButTheSquareOfTheRestitution) {
  const double restitution = 0.6, height = 0.8, energy = 1.5 * kGravity * height;
  const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 1.4, "accuracy": 1e-8,
    "materials": {{"m": {{"restitution": {}}}}},
    "bodies": [{{"name": "ball", "material": "m", "shape": {{"sphere": {{"radius": 0.2}}}}, "mass": 1.5,
                "position": [0, {}, 0]}},
               {{"name": "ground", "material": "m", "shape": {{"plane": {{}}}}, "motion": "static"}}])",
                                                        restitution, 0.2 + height)));
  expectBalance(run);
  const std::vector<Event> bounces = eventsOf(run, EventKind::impact);
  ASSERT_GE(bounces.size(), 2u);
  for (const Frame& frame : run.frames) {
    const auto count =
        std::count_if(bounces.begin(), bounces.end(), [&](const Event& bounce) { return bounce.time <= frame.time; });
    const double left = std::pow(restitution, 2 * static_cast<double>(count));
    EXPECT_NEAR(frame.energy.impact, (1 - left) * energy, 1e-8 * energy) << frame.time;
    EXPECT_EQ(frame.energy.friction, 0);
    EXPECT_NEAR(frame.energy.numerical, 0, 1e-8 * energy);
  }
}

// m x'' + c x' + k x = 0 from rest at x0, with b = c / 2m and w^2 = k/m - b^2: x = x0 e^(-bt) (cos wt + b/w sin wt),
// x' = -x0 e^(-bt) (w + b^2/w) sin wt. The damper has taken what m x'^2 / 2 + k x^2 / 2 has lost.
TEST(EnergyLedger, DampingIsWhatADampedOscillatorLoses) {
  const double mass = 1, stiffness = 40, damping = 1.2, start = 0.3;
  const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 3, "accuracy": 1e-9, "gravity": [0, 0, 0],
    "bodies": [{}], "springs": [{{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": {},
                                  "damping": {}, "restLength": 1}}])",
                                                        ball("ball", {1 + start, 0, 0}), stiffness, damping)));
  const double b = damping / (2 * mass), w = std::sqrt(stiffness / mass - b * b);
  for (const Frame& frame : run.frames) {
    const double t = frame.time, decay = start * std::exp(-b * t);
    const double x = decay * (std::cos(w * t) + b / w * std::sin(w * t));
    const double speed = -decay * (w + b * b / w) * std::sin(w * t);
    const double left = 0.5 * mass * speed * speed + 0.5 * stiffness * x * x;
    EXPECT_NEAR(frame.energy.damping, 0.5 * stiffness * start * start - left, 1e-8) << t;
    EXPECT_EQ(frame.energy.impact, 0);
    EXPECT_EQ(frame.energy.friction, 0);
    EXPECT_NEAR(frame.energy.numerical, 0, 1e-8) << t;
  }
}

// A ball falls 0.5 m until its rope of 1 m is taut and vertical: v^2 = 2 g 0.5 m; the rope takes (1 - e^2) m v^2 / 2.
TEST(EnergyLedger, ARopeThatCatchesIsAnImpact) {
  const double restitution = 0.4;
  const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 0.4, "accuracy": 1e-8,
    "bodies": [{}], "ropes": [{{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "maxLength": 1,
                                "restitution": {}}}])",
                                                        ball("ball", {0, -0.5, 0}), restitution)));
  expectBalance(run);
  ASSERT_EQ(eventsOf(run, EventKind::taut).size(), 1u);
  EXPECT_NEAR(run.frames.back().energy.impact, (1 - restitution * restitution) * kGravity * 0.5, 1e-9);
  EXPECT_EQ(run.frames.back().energy.friction, 0);
  EXPECT_EQ(run.frames.back().energy.damping, 0);
  EXPECT_NEAR(run.frames.back().energy.numerical, 0, 1e-8);
}

// A rod without weight's influence meets the ground with its lower cap and sticks there for the instant. In the plane,
// with u = (along the ground, up) of the cap's lowest point, u0 before and u1 = (0, -e u0y) after: p = W^-1 (u1 - u0),
// W = 1/m + the turning about z, and it takes -p.(u0 + u1)/2. It slides little, but would be turned to slide the other
// way: friction pushes it on, and its part alone gives energy.
TEST(EnergyLedger, ARodThatHitsWithFrictionIsOneImpactWhoseFrictionAloneMayGive) {
  const double mass = 2, inertia = 0.3, restitution = 0.5, length = 1, radius = 0.05, angle = 0.7;
  const Vec3 velocity(-0.1, -2, 0);
  const Trajectory run = simulate(
      sceneWith(fmt::format(R"("duration": 0.1, "accuracy": 1e-8, "gravity": [0, 0, 0],
    "materials": {{"m": {{"restitution": {}, "staticFriction": 5, "dynamicFriction": 5}}}},
    "bodies": [{{"name": "rod", "material": "m", "shape": {{"capsule": {{"radius": {}, "length": {}}}}}, "mass": {},
                "inertiaTensor": [[{},0,0],[0,0.01,0],[0,0,{}]], "position": [0, {}, 0],
                "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}}, "linearVelocity": {}}},
               {{"name": "ground", "material": "m", "shape": {{"plane": {{}}}}, "motion": "static"}}])",
                            restitution, radius, length, mass, inertia, inertia,
                            0.05 + radius + 0.5 * length * std::cos(angle), angle * 180 / M_PI, vectorText(velocity))));
  ASSERT_EQ(eventsOf(run, EventKind::impact).size(), 1u);
  const double x = 0.5 * length * std::sin(angle), y = -0.5 * length * std::cos(angle) - radius;
  Eigen::Matrix2d inverseMass;
  inverseMass << 1 / mass + y * y / inertia, -x * y / inertia, -x * y / inertia, 1 / mass + x * x / inertia;
  const Eigen::Vector2d before(velocity.x(), velocity.y()), after(0, -restitution * velocity.y());
  const Eigen::Vector2d impulse = inverseMass.inverse() * (after - before), mean = (before + after) / 2;
  const double taken = -impulse.dot(mean);
  ASSERT_LT(std::abs(impulse.x()), 5 * impulse.y());  // it sticks
  EXPECT_LT(-impulse.x() * mean.x(), -0.01);
  EXPECT_GT(taken, 0);
  const EnergyBalance &start = run.frames[0].energy, &end = run.frames.back().energy;
  EXPECT_NEAR(end.impact, taken, 1e-9);
  EXPECT_NEAR(start.kinetic - end.kinetic, taken, 1e-9);
  EXPECT_EQ(end.friction, 0);
  EXPECT_NEAR(end.numerical, 0, 1e-9);
}

// A heap is right to what pictures show: contacts, not errors, take what it loses. Taking out overlaps and sinking into
// each other is worth about half a percent.
TEST(EnergyLedger, AHeapLosesItsEnergyToContacts) {
  const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 3, "accuracy": "visual",
    "materials": {{"m": {{"restitution": 0.2, "staticFriction": 0.5, "dynamicFriction": 0.5}}}},
    "bodies": [{{"name": "box", "material": "m", "shape": {{"box": {{"size": [0.2, 0.16, 0.24]}}}},
                "position": [-0.4, 0.6, -0.4], "orientation": {{"axis": [1, 2, 3], "angleDegrees": 40}},
                "copies": {{"count": [4, 4, 4], "spacing": [0.31, 0.33, 0.32]}}}}, {}])",
                                                        kGround)));
  expectBalance(run);
  double kinetic = 0;
  for (const Frame& frame : run.frames) kinetic = std::max(kinetic, frame.energy.kinetic);
  const EnergyBalance& end = run.frames.back().energy;
  EXPECT_LT(largestNumerical(run), 1e-2 * kinetic);
  EXPECT_GT(end.impact, 0.5 * kinetic);
  EXPECT_GT(end.friction, 0.01 * kinetic);
}

// Ropes, rods, contacts that come and go, chatter and rest: operations of all kinds.
TEST(EnergyLedger, BalancesInEveryFrameWhateverHappens) {
  for (const char* method :
       {R"("accuracy": 1e-3)", R"("accuracy": 1e-6)", R"("method": {"name": "rk4", "timeStep": 0.001})"}) {
    const Trajectory run = simulate(sceneWith(fmt::format(R"("duration": 2, {}, "output": {{"framesPerSecond": 240}},
    "materials": {{"m": {{"restitution": 0.4, "staticFriction": 0.4, "dynamicFriction": 0.3}}}},
    "bodies": [{{"name": "a", "material": "m", "shape": {{"box": {{"size": [0.3, 0.2, 0.4]}}}}, "mass": 2,
                "position": [0, 0.6, 0], "orientation": {{"axis": [1, 2, 3], "angleDegrees": 40}}}},
               {{"name": "b", "material": "m", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1,
                "position": [0.5, 0.9, 0]}},
               {{"name": "c", "material": "m", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 0.5,
                "position": [0.9, 0.4, 0.05]}}, {}],
    "rods": [{{"bodyA": "a", "anchorA": [0.1, 0.1, 0], "bodyB": "b", "anchorB": [0, 0, 0]}}],
    "ropes": [{{"bodyA": "b", "anchorA": [0, 0, 0], "bodyB": "c", "anchorB": [0, 0, 0], "maxLength": 0.7}}],
    "pushes": [{{"body": "c", "point": [0, 0, 0], "force": [3, 0, 0], "start": 0.3, "duration": 0.2}}])",
                                                          method, kGround)));
    SCOPED_TRACE(method);
    expectBalance(run);
    const EnergyBalance& end = run.frames.back().energy;
    EXPECT_GT(end.impact, 0.1);
    EXPECT_GT(end.work, 0.1);
  }
}

}  // namespace
}  // namespace cradle
