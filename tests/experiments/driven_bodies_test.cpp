// Bodies that are led, against closed forms: what they carry, strike, shake, drag and lift, and what they work.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments/expect_ledger.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kPi = std::numbers::pi;

std::string drivenBox(const Vec3& size, const std::string& motion) {
  return fmt::format(
      R"({{"name": "table", "material": "m", "shape": {{"box": {{"size": {}}}}}, "motion": "driven", {}}})",
      vectorText(size), motion);
}

Trajectory runDriven(double duration, double accuracy, const std::string& bodies, const std::string& more = "") {
  return simulate(sceneWith(fmt::format(R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 100}},
    "materials": {{"m": {{"restitution": 0.5, "staticFriction": 0.4, "dynamicFriction": 0.3}},
    "grip": {{"restitution": 0, "staticFriction": 1, "dynamicFriction": 1}},
    "half": {{"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.5}},
    "slips": {{"restitution": 0, "staticFriction": 0.2, "dynamicFriction": 0.2}}}}, {}
    "bodies": [{}])",
                                        duration, accuracy, more, bodies)));
}

double timeOf(const Trajectory& run, EventKind kind) {
  for (const Event& event : run.events)
    if (event.kind == kind) return event.time;
  ADD_FAILURE() << "no such event";
  return NAN;
}

/// A block of 2 kg on a belt of 1 m/s: mu g t until v / (mu g), then with the belt. The belt works mu m g v t = m v^2,
/// of which friction takes half.
TEST(DrivenBodies, BeltCarriesABlock) {
  const Trajectory moved = runDriven(0.6, 1e-8,
                                     drivenBox({20, 0.2, 1}, R"("linearVelocity": [1, 0, 0])") +
                                         R"(, {"name": "block", "material": "m", "mass": 2,
      "shape": {"box": {"size": [0.2, 0.1, 0.2]}}, "position": [0, 0.15, 0]})");
  const double acceleration = 0.3 * kGravity, caught = 1 / acceleration;
  for (const Frame& frame : moved.frames) {
    const double t = std::min(frame.time, caught), later = frame.time - t;
    EXPECT_NEAR(frame.states[1].position.x(), acceleration * t * t / 2 + later, 1e-8) << frame.time;
    EXPECT_NEAR(frame.states[1].position.y(), 0.15, 1e-9);
    EXPECT_EQ(frame.states[0].position, Vec3(frame.time, 0, 0));
  }
  EXPECT_NEAR(timeOf(moved, EventKind::stick), caught, 1e-9);
  EXPECT_NEAR(moved.frames.back().energy.work, 2, 1e-8);
  EXPECT_NEAR(moved.frames.back().energy.friction, 1, 1e-8);
  expectLedger(moved, 1e-12, 1e-8);
}

/// The same by time stepping, whose friction changes the velocity in whole steps: half of mu g h, and twice that way.
TEST(DrivenBodies, BeltCarriesABlockInSteps) {
  const Trajectory moved = runDriven(0.6, 1e-8,
                                     drivenBox({20, 0.2, 1}, R"("linearVelocity": [1, 0, 0])") +
                                         R"(, {"name": "block", "material": "m", "mass": 2,
      "shape": {"box": {"size": [0.2, 0.1, 0.2]}}, "position": [0, 0.15, 0]})",
                                     R"("method": {"name": "rk4", "timeStep": 0.001},)");
  const double acceleration = 0.3 * kGravity, caught = 1 / acceleration, step = acceleration * 0.001;
  for (const Frame& frame : moved.frames) {
    const double t = std::min(frame.time, caught), later = frame.time - t;
    EXPECT_NEAR(frame.states[1].position.x(), acceleration * t * t / 2 + later, step) << frame.time;
  }
  EXPECT_NEAR(moved.frames.back().energy.work, 2, 2 * step);
  EXPECT_NEAR(moved.frames.back().energy.friction, 1, 2 * step);
  expectLedger(moved, 1e-12, 1e-9);
}

/// A block that starts with the velocity of an oscillating table slips when A w^2 sin(w t) comes to mu_s g, and slides,
/// slower by mu_d g a second, until the table has its velocity again.
TEST(DrivenBodies, BlockSlipsOnAShakenTableAndSticks) {
  const double amplitude = 0.05, rate = 2 * kPi * 2, peak = amplitude * rate;
  const Trajectory moved = runDriven(
      0.5, 1e-9,
      drivenBox({4, 0.2, 1}, R"("oscillation": {"direction": [1, 0, 0], "amplitude": 0.05, "frequency": 2})") +
          fmt::format(R"(, {{"name": "block", "material": "m", "linearVelocity": [{}, 0, 0],
      "shape": {{"box": {{"size": [0.2, 0.1, 0.2]}}}}, "position": [0, 0.15, 0]}})",
                      peak));
  const double slip = std::asin(0.4 * kGravity / (amplitude * rate * rate)) / rate;
  // Forces of four corners tell that they cannot hold from 1e-6 g on: that is reached later by that over A w^3 cos(w
  // t).
  const double late = 1e-6 * kGravity / (amplitude * std::pow(rate, 3) * std::cos(rate * slip));
  EXPECT_NEAR(timeOf(moved, EventKind::slip), slip, 1.1 * late);
  const auto relative = [&](double t) {
    return peak * std::cos(rate * slip) - 0.3 * kGravity * (t - slip) - peak * std::cos(rate * t);
  };
  // The table turns back at a quarter of a period, and is as fast as the block before a half; the block, which is
  // faster until then, meets it there with more acceleration than static friction gives, and slides on.
  double before = slip + 1e-3, after = 0.375;
  while (after - before > 1e-15) ((relative((before + after) / 2) > 0) ? before : after) = (before + after) / 2;
  const double met = before;
  for (const Frame& frame : moved.frames)
    if (frame.time > slip && frame.time < met) {
      EXPECT_NEAR(frame.states[1].linearVelocity.x(), relative(frame.time) + peak * std::cos(rate * frame.time),
                  1.1 * late * 0.1 * kGravity);
    }
  expectLedger(moved, 1e-12, 1e-8);
}

/// A ball that rolls on a turntable of rate W goes on a circle with 2/7 W. (J. M. Lee, Amer. J. Phys.; E. J. Routh,
/// "Dynamics of a System of Rigid Bodies", 1905, II, 224)
TEST(DrivenBodies, BallOnATurntableGoesOnACircle) {
  const double rate = 7, radius = 0.1, away = 0.5, speed = 0.3;
  // Rolling: the lowest point of the ball has the velocity of the table, W y x r: v + w x (-R y) = (0, 0, -W r).
  const Trajectory moved =
      runDriven(3.2, 1e-8,
                drivenBox({6, 0.2, 6}, R"("angularVelocity": [0, 7, 0])") +
                    fmt::format(R"(, {{"name": "ball", "material": "m", "shape": {{"sphere": {{"radius": {}}}}},
      "position": [{}, 0.2, 0], "linearVelocity": [0, 0, {}], "angularVelocity": [{}, 0, 0]}})",
                                radius, away, speed, (speed + rate * away) / radius));
  const double slow = 2 * rate / 7, circle = speed / slow;
  for (const Frame& frame : moved.frames) {
    const double angle = slow * frame.time;  // about y: from z to x
    EXPECT_NEAR(frame.states[1].position.x(), away + circle * (1 - std::cos(angle)), 1e-7) << frame.time;
    EXPECT_NEAR(frame.states[1].position.z(), circle * std::sin(angle), 1e-7) << frame.time;
  }
  EXPECT_NEAR(moved.frames.back().energy.friction, 0, 1e-9);
  expectLedger(moved, 1e-11, 1e-7);
}

/// A ball of 1 kg on a spring of 40 N/m, whose other end a hand moves by A sin(w t) along it.
TEST(DrivenBodies, HandDragsABallByASpring) {
  const double amplitude = 0.2, rate = 2 * kPi * 1.5, own = std::sqrt(40.0);
  const Trajectory moved =
      runDriven(2, 1e-10, R"({"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven",
      "oscillation": {"direction": [1, 0, 0], "amplitude": 0.2, "frequency": 1.5}, "collision": "none"},
      {"name": "ball", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "position": [1, 0, 0], "collision": "none"})",
                R"("gravity": [0, 0, 0], "springs": [{"bodyA": "ball", "bodyB": "hand", "stiffness": 40}],)");
  const double gain = own * own / (own * own - rate * rate);
  for (const Frame& frame : moved.frames) {
    const double t = frame.time;
    EXPECT_NEAR(frame.states[1].position.x(),
                1 + amplitude * gain * (std::sin(rate * t) - rate / own * std::sin(own * t)), 1e-9)
        << t;
    EXPECT_NEAR(frame.states[0].position.x(), amplitude * std::sin(rate * t), 1e-15);
  }
  expectLedger(moved, 1e-13, 1e-9);
}

/// A wall that comes with V strikes a ball at rest: (1 + e) V. Its impulse m (1 + e) V works with V; what it takes is
/// m (1 - e^2) V^2 / 2.
TEST(DrivenBodies, WallStrikesABall) {
  for (const char* method : {"", R"("method": {"name": "rk4", "timeStep": 0.001},)"}) {
    const Trajectory moved = runDriven(0.5, 1e-9,
                                       drivenBox({0.2, 2, 2}, R"("linearVelocity": [2, 0, 0])") +
                                           R"(, {"name": "ball", "material": "m", "mass": 3,
      "shape": {"sphere": {"radius": 0.1}}, "position": [0.5, 0, 0]})",
                                       std::string(R"("gravity": [0, 0, 0],)") + method);
    EXPECT_NEAR(timeOf(moved, EventKind::impact), 0.15, 1e-9);
    const Frame& end = moved.frames.back();
    EXPECT_NEAR(end.states[1].linearVelocity.x(), 3, 1e-12);
    EXPECT_NEAR(end.states[1].position.x(), 0.5 + 3 * 0.35, 1e-9);
    EXPECT_NEAR(end.energy.work, 3 * 3 * 2, 1e-11);
    EXPECT_NEAR(end.energy.impact, 3 * 0.75 * 2 * 2 / 2, 1e-11);
    expectLedger(moved, 1e-11, 1e-11);
  }
}

/// A lift raises a box of 2 kg by 1 m, which rests before and after that: it works m g h.
TEST(DrivenBodies, LiftLiftsABoxFromRestToRest) {
  const Trajectory moved =
      runDriven(4, 1e-7,
                drivenBox({1, 0.2, 1}, R"("keyFrames": [{"time": 1}, {"time": 3, "position": [0, 1, 0]}])") +
                    R"(, {"name": "box", "material": "m", "mass": 2,
      "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "position": [0.1, 0.2, 0.1]})");
  for (const Frame& frame : moved.frames)
    EXPECT_NEAR(frame.states[1].position.y() - frame.states[0].position.y(), 0.2, 1e-9) << frame.time;
  EXPECT_NEAR(moved.frames.back().states[1].position.y(), 1.2, 1e-9);
  EXPECT_NEAR(moved.frames.back().energy.work, 2 * kGravity, 1e-6);
  EXPECT_LT(timeOf(moved, EventKind::rest), 0.1);
  EXPECT_NEAR(timeOf(moved, EventKind::wake), 1, 1e-12);
  EXPECT_EQ(moved.frames.back().states[1].linearVelocity, Vec3(0, 0, 0));
  expectLedger(moved, 1e-11, 1e-6);
}

/// A pendulum of length l on a support that vibrates by a sin(W t) stands upright if W a > sqrt(2 g l), and sways there
/// with the square of its rate a^2 W^2 / (2 l^2) - g / l. (P. L. Kapitza, 1951; L. D. Landau, E. M. Lifshitz,
/// "Mechanics", 30) That is so to the order a / l, here 0.04.
TEST(DrivenBodies, PendulumOnAVibratingSupportStandsUpright) {
  const double length = 0.5, amplitude = 0.02, frequency = 300 / (2 * kPi), start = 0.1;
  const Trajectory moved = runDriven(
      1, 1e-8,
      fmt::format(R"({{"name": "support", "shape": {{"sphere": {{"radius": 0.02}}}},
      "motion": "driven", "collision": "none", "oscillation": {{"amplitude": {}, "frequency": {}, "phase": {}}}}},
      {{"name": "bob", "mass": 1, "shape": {{"sphere": {{"radius": 0.02}}}}, "position": [{}, {}, 0], "collision": "none"}})",
                  amplitude, frequency, kPi / 2, length * std::sin(start), amplitude + length * std::cos(start)),
      R"("rods": [{"bodyA": "bob", "bodyB": "support", "anchorB": [0, 0, 0]}],)");
  const double slow = std::sqrt(std::pow(amplitude * 300 / length, 2) / 2 - kGravity / length);
  double crossed = 0;
  for (const Frame& frame : moved.frames) {
    const Vec3 along = frame.states[1].position - frame.states[0].position;
    EXPECT_NEAR(along.norm(), length, 1e-9);
    EXPECT_LT(std::abs(along.x()) / length, start * (1 + 2 * amplitude / length));
    if (crossed == 0 && along.x() < 0) crossed = frame.time;
  }
  EXPECT_NEAR(crossed, kPi / 2 / slow, 0.08 * kPi / 2 / slow + 0.01);
  expectLedger(moved, 1e-11, 1e-5);
}

/// A ball that rolls on a turntable, by time stepping: what drives the disc accelerates the place under the ball within
/// a step, which is no energy from nowhere. Velocities of 4 m/s that turn by 1 % in a step are right to 1e-4 of that.
TEST(DrivenBodies, BallOnATurntableKeepsItsEnergyInSteps) {
  const Trajectory moved = runDriven(3.2, 1e-6,
                                     drivenBox({6, 0.2, 6}, R"("angularVelocity": [0, 7, 0])") +
                                         R"(, {"name": "ball", "material": "m", "shape": {"sphere": {"radius": 0.1}},
      "position": [0.5, 0.2, 0], "linearVelocity": [0, 0, 0.3], "angularVelocity": [38, 0, 0]})",
                                     R"("method": {"name": "rk4", "timeStep": 0.001},)");
  for (const Frame& frame : moved.frames) {
    const double angle = 2 * frame.time;
    EXPECT_NEAR(frame.states[1].position.x(), 0.65 - 0.15 * std::cos(angle), 1e-4) << frame.time;
    EXPECT_NEAR(frame.states[1].position.z(), 0.15 * std::sin(angle), 1e-4) << frame.time;
  }
  EXPECT_EQ(moved.cost.corrections.size(), 0u);
  expectLedger(moved, 1e-11, 1e-6);
}

/// A hand that goes up with V jerks a ball of 2 kg, which hangs slack, to (1 + e) V. The impulse m (1 + e) V works with
/// V; what it takes is m (1 - e^2) V^2 / 2.
TEST(DrivenBodies, HandJerksABallByARope) {
  for (const double restitution : {0.0, 0.5}) {
    const Trajectory moved =
        runDriven(0.5, 1e-8,
                  R"({"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven",
      "collision": "none", "linearVelocity": [0, 2, 0], "position": [0, 0.5, 0]},
      {"name": "ball", "mass": 2, "shape": {"sphere": {"radius": 0.1}}, "collision": "none"})",
                  fmt::format(R"("gravity": [0, 0, 0], "ropes": [{{"bodyA": "ball", "bodyB": "hand",
      "anchorB": [0, 0, 0], "maxLength": 1, "restitution": {}}}],)",
                              restitution));
    EXPECT_NEAR(timeOf(moved, EventKind::taut), 0.25, 1e-9);
    const double speed = 2 * (1 + restitution);
    const Frame& end = moved.frames.back();
    EXPECT_NEAR(end.states[1].linearVelocity.y(), speed, 1e-12);
    EXPECT_NEAR(end.energy.work, 2 * speed * 2, 1e-11);
    EXPECT_NEAR(end.energy.impact, (1 - restitution * restitution) * 4, 1e-11);
    expectLedger(moved, 1e-11, 1e-8);
  }
}

/// A plate that a hand lowers onto the ground on three ropes, by events and by time stepping: it lies there, and the
/// ropes are slack. Its impact takes no more than its kinetic energy, and the hand has worked what it sank by.
TEST(DrivenBodies, HandLowersAPlateOnRopes) {
  for (const char* method : {"", R"("method": {"name": "rk4", "timeStep": 0.001},)"}) {
    const Trajectory moved = runDriven(1.5, 1e-6,
                                       R"({"name": "ground", "shape": {"plane": {}}, "motion": "static"},
      {"name": "hand", "shape": {"sphere": {"radius": 0.02}}, "motion": "driven", "collision": "none",
       "keyFrames": [{"time": 0, "position": [0, 0.8, 0]}, {"time": 1, "position": [0, 0.4, 0]}]},
      {"name": "plate", "mass": 2, "shape": {"box": {"size": [0.4, 0.04, 0.4]}}, "position": [0, 0.3, 0]})",
                                       std::string(R"("ropes": [
      {"bodyA": "plate", "anchorA": [0.15, 0.02, 0], "bodyB": "hand", "anchorB": [0, 0, 0]},
      {"bodyA": "plate", "anchorA": [-0.1, 0.02, 0.12], "bodyB": "hand", "anchorB": [0, 0, 0]},
      {"bodyA": "plate", "anchorA": [-0.1, 0.02, -0.12], "bodyB": "hand", "anchorB": [0, 0, 0]}],)") +
                                           method);
    const Frame& end = moved.frames.back();
    EXPECT_NEAR(end.states[1].position.y(), 0.02, 1e-6);
    EXPECT_LT(end.states[1].linearVelocity.norm(), 1e-6);
    EXPECT_LT(end.energy.impact + end.energy.friction, 2);  // m v^2 / 2, v up to 0.75 m/s
    EXPECT_NEAR(end.energy.work, -2 * kGravity * 0.28 + end.energy.impact + end.energy.friction, 1e-9);
    EXPECT_LT(std::abs(end.energy.numerical), 1e-9);
    // Frames inside steps have the error of the interpolant, as large as the local one: 2e-8 (1 + 8 J).
    expectLedger(moved, 1e-11, 2e-8 * (1 + 8));
  }
}

/// A box falls onto one that lies on a tilting platform, as large as its face: corners come to its border and sliding
/// stops, both within a step. Friction takes energy, whatever comes first, and the accuracy decides nothing.
TEST(DrivenBodies, TiltBoxesOnBoxes) {
  for (const double degrees : {5.0, 20.0}) {
    Vec3 place = Vec3::Zero();
    for (const double accuracy : {1e-8, 1e-6, 1e-5, 1e-4}) {
      const Trajectory moved = runDriven(0.3, accuracy,
                                         fmt::format(R"(
      {{"name": "platform", "shape": {{"box": {{"size": [2, 0.2, 2]}}}}, "motion": "driven", "material": "slips",
       "keyFrames": [{{"time": 0, "position": [0, 0.1, 0]}}, {{"time": 0.6, "position": [0, 0.2, 0],
       "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}}}}]}},
      {{"name": "b0", "shape": {{"box": {{"size": [0.2, 0.2, 0.2]}}}}, "position": [0.15, 0.3, 0], "material": "slips"}},
      {{"name": "b1", "shape": {{"box": {{"size": [0.2, 0.2, 0.2]}}}}, "position": [0.15, 0.55, 0],
       "material": "slips"}})",
                                                     degrees));
      double taken = 0;
      for (const Frame& frame : moved.frames) {
        EXPECT_GE(frame.energy.friction, taken - 1e-13) << degrees << " " << accuracy << " " << frame.time;
        taken = frame.energy.friction;
      }
      const Vec3 end = moved.frames.back().states[2].position;
      if (place.isZero(0)) place = end;
      EXPECT_LT((end - place).norm(), 10 * accuracy) << degrees << " " << accuracy;
    }
  }
}

/// A step rises under a plank whose end strikes the ground: both its corners and both points on the step's edge have
/// impulses, and slide. Several friction forces fit there; a plank that is its own mirror image at z = 0 stays so.
TEST(DrivenBodies, StepThatRisesTurnsAPlankStraight) {
  for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
    const Trajectory moved = runDriven(0.04, accuracy, R"(
      {"name": "floor", "shape": {"box": {"size": [4, 0.1, 1]}}, "position": [0, -0.05, 0], "motion": "static",
       "material": "half"},
      {"name": "step", "shape": {"box": {"size": [0.2, 0.2, 1]}}, "position": [0.22, -0.09643307392071382, 0],
       "motion": "driven", "linearVelocity": [0, 0.7379037850781669, 0], "material": "half"},
      {"name": "plank", "shape": {"box": {"size": [0.5, 0.1, 0.3]}},
       "position": [0.41275972558574037, 0.052605155509809584, 0],
       "orientation": {"axis": [0, 0, 1], "angleDegrees": -0.5957138542517577},
       "linearVelocity": [0.10877277208966601, 0.5321514035707416, 0],
       "angularVelocity": [0, 0, -2.218121929621737], "material": "half"})");
    EXPECT_THAT(eventsOf(moved, EventKind::impact), testing::SizeIs(testing::Ge(4)));
    for (const Frame& frame : moved.frames) {
      const BodyState& plank = frame.states[1];
      // What is left of the accuracy in positions of 1e-2 s becomes speeds.
      EXPECT_LT(std::abs(plank.linearVelocity.z()), 100 * accuracy) << accuracy;
      EXPECT_LT(plank.angularVelocity.head<2>().norm(), 100 * accuracy) << accuracy;
    }
  }
}

/// A bar that a hand lifts by two ropes, of which one is longer: the shorter one pulls within the impulse of the other,
/// and the hand works against both.
TEST(DrivenBodies, HandLiftsABarByUnequalRopes) {
  const Trajectory moved = runDriven(0.8, 1e-8,
                                     R"({"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven",
      "collision": "none", "linearVelocity": [0.1, 1, 0], "position": [0, 0.5, 0]},
      {"name": "bar", "mass": 2, "shape": {"box": {"size": [1, 0.1, 0.2]}}, "collision": "none"})",
                                     R"("gravity": [0, 0, 0], "ropes": [
      {"bodyA": "bar", "anchorA": [0.5, 0, 0], "bodyB": "hand", "anchorB": [0, 0, 0], "maxLength": 0.75},
      {"bodyA": "bar", "anchorA": [-0.5, 0, 0], "bodyB": "hand", "anchorB": [0, 0, 0], "maxLength": 0.8}],)");
  EXPECT_GE(eventsOf(moved, EventKind::taut).size(), 2u);
  EXPECT_GT(moved.frames.back().energy.work, 0.5);
  expectLedger(moved, 1e-11, 1e-6);
}

/// A ball on a joint of a crank goes around with it: what drives the crank works against the ball's weight alone.
TEST(DrivenBodies, CrankLeadsABallAround) {
  const Trajectory moved =
      runDriven(1, 1e-8, R"({"name": "crank", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "motion": "driven",
      "angularVelocity": [0, 0, 3]},
      {"name": "ball", "mass": 2, "shape": {"sphere": {"radius": 0.1}}, "position": [0.5, 0, 0],
       "linearVelocity": [0, 1.5, 0]})",
                R"("ballJoints": [{"bodyA": "ball", "bodyB": "crank", "anchorB": [0.5, 0, 0]}],)");
  for (const Frame& frame : moved.frames) {
    const Vec3 expected(0.5 * std::cos(3 * frame.time), 0.5 * std::sin(3 * frame.time), 0);
    EXPECT_LT((frame.states[1].position - expected).norm(), 1e-8) << frame.time;
    EXPECT_NEAR(frame.energy.work, 2 * kGravity * expected.y(), 1e-6) << frame.time;
  }
  expectLedger(moved, 1e-11, 1e-6);
}

/// A ball between the ground and a press that comes lower than the ball is thick: no motion is right, and the run ends
/// with a message that says so, with friction and without, at every accuracy.
TEST(DrivenBodies, PressThatLeavesNoRoomEndsTheRun) {
  for (const double friction : {0.0, 0.4})
    for (const double accuracy : {1e-3, 1e-6, 1e-8}) {
      const std::string text = fmt::format(R"("duration": 2, "accuracy": {},
      "materials": {{"m": {{"staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
      {{"name": "ground", "material": "m", "shape": {{"plane": {{}}}}, "motion": "static"}},
      {{"name": "press", "material": "m", "shape": {{"box": {{"size": [1, 0.2, 1]}}}}, "motion": "driven",
        "keyFrames": [{{"time": 0, "position": [0, 1, 0]}}, {{"time": 1, "position": [0, 0.25, 0]}}]}},
      {{"name": "ball", "material": "m", "mass": 1, "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [0, 0.1, 0]}}])",
                                           accuracy, friction, friction);
      try {
        simulate(sceneWith(text));
        ADD_FAILURE() << friction << ' ' << accuracy;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::unstable);
        EXPECT_NE(std::string(error.what()).find("no room"), std::string::npos) << error.what();
      }
    }
}

/// Likewise where it presses a ball into the ground by a rod, which leaves the contact no motion.
TEST(DrivenBodies, RodThatLeavesNoRoomEndsTheRun) {
  for (const double accuracy : {1e-3, 1e-6, 1e-8}) {
    const std::string text = fmt::format(R"("duration": 2, "accuracy": {}, "bodies": [
      {{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static"}},
      {{"name": "hand", "shape": {{"sphere": {{"radius": 0.05}}}}, "motion": "driven",
        "keyFrames": [{{"time": 0, "position": [0, 1.2, 0]}}, {{"time": 1, "position": [0, 0.7, 0]}}]}},
      {{"name": "ball", "mass": 1, "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [0, 0.2, 0]}}],
      "rods": [{{"bodyA": "ball", "bodyB": "hand", "anchorB": [0, 0, 0]}}])",
                                         accuracy);
    try {
      simulate(sceneWith(text));
      ADD_FAILURE() << accuracy;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::unstable);
      EXPECT_NE(std::string(error.what()).find("no room"), std::string::npos) << error.what();
    }
  }
}

/// Likewise where it presses a bar against a block by the stop of a hinge. It takes the bar along from 0.1 rad on, and
/// the bar's corner (1, 0.05) m comes to the block's lower side at y = 0.4 m at an angle a with sin a + 0.05 cos a =
/// 0.4.
TEST(DrivenBodies, StopThatLeavesNoRoomEndsTheRun) {
  const double met = 0.1 + std::asin(0.4 / std::hypot(1, 0.05)) - std::atan(0.05);
  for (const double friction : {0.0, 0.4})
    for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
      const std::string text = fmt::format(R"("duration": 2, "accuracy": {}, "gravity": [0, 0, 0],
      "materials": {{"m": {{"staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
      {{"name": "hub", "shape": {{"sphere": {{"radius": 0.1}}}}, "motion": "driven", "collision": "none",
        "angularVelocity": [0, 0, 1]}},
      {{"name": "bar", "material": "m", "mass": 10, "shape": {{"box": {{"size": [1, 0.1, 0.1]}}}},
        "position": [0.5, 0, 0]}},
      {{"name": "block", "material": "m", "shape": {{"box": {{"size": [0.2, 0.2, 0.2]}}}}, "motion": "static",
        "position": [0.9, 0.5, 0]}}],
      "hinges": [{{"bodyA": "bar", "bodyB": "hub", "anchorA": [-0.5, 0, 0], "anchorB": [0, 0, 0],
        "limits": {{"lower": -0.1}}}}])",
                                           accuracy, friction, friction);
      try {
        simulate(sceneWith(text));
        ADD_FAILURE() << friction << ' ' << accuracy;
      } catch (const Error& error) {
        const std::string expected = fmt::format("at {:.4f}", met);
        EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("\"bar\" is pressed into \"block\": what is driven leaves no room"),
                  std::string::npos)
            << error.what();
      }
    }
}

/// A box hangs on a rope from a hand that goes to another place and stops: the rope is never too long.
TEST(DrivenBodies, HandCarriesABodyOnARope) {
  const Trajectory moved =
      runDriven(3, 1e-6, R"({"name": "hand", "shape": {"sphere": {"radius": 0.05}}, "motion": "driven",
      "keyFrames": [{"time": 0, "position": [0, 2, 0]}, {"time": 1, "position": [0.5, 2.5, 0]}, {"time": 2, "position": [1, 2, 0]}]},
      {"name": "box", "mass": 1, "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "position": [0, 1, 0]})",
                R"("ropes": [{"bodyA": "box", "anchorA": [0, 0.1, 0], "bodyB": "hand", "anchorB": [0, 0, 0],
      "maxLength": 0.9}],)");
  for (const Frame& frame : moved.frames) {
    const Vec3 end = frame.states[1].position + frame.states[1].orientation * Vec3(0, 0.1, 0);
    EXPECT_LT((end - frame.states[0].position).norm(), 0.9 + 1e-8) << frame.time;
  }
  expectLedger(moved, 1e-11, 1e-5);
}

/// An L prism of 4 kg that stands around a post, which its hull would be in: a hand lifts it by 0.3 m on a rope that
/// hangs over its centre of mass, and sets it down again. Its work is m g h at the top; at last it lies as at the
/// start.
TEST(DrivenBodies, HandLiftsAConcaveModelAlongAPost) {
  const std::string text = fmt::format(
      R"({{"schema": "cradle-scene/1", "name": "Lifted", "duration": 3, "accuracy": 1e-6,
      "output": {{"framesPerSecond": 100}}, "bodies": [
      {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static"}},
      {{"name": "post", "shape": {{"box": {{"size": [0.16, 1, 0.06]}}}}, "position": [0.2, 0.5, -0.15], "motion": "static"}},
      {{"name": "hand", "shape": {{"sphere": {{"radius": 0.02}}}}, "motion": "driven", "collision": "none",
        "keyFrames": [{{"time": 0, "position": [0.125, 0.5, -0.075]}}, {{"time": 1, "position": [0.125, 0.8, -0.075]}},
                      {{"time": 1.3, "position": [0.125, 0.8, -0.075]}}, {{"time": 2.3, "position": [0.125, 0.45, -0.075]}}]}},
      {{"name": "prism", "shape": {{"mesh": "{}/assets/l_prism.3ds"}},
        "orientation": {{"axis": [1, 0, 0], "angleDegrees": -90}}}}],
      "ropes": [{{"bodyA": "prism", "anchorA": [0.125, 0.075, 0.1], "bodyB": "hand", "anchorB": [0, 0, 0]}}]}})",
      CRADLE_SOURCE_DIR);
  const Trajectory moved = simulate(parseScene(text, "lifted.json", modelFilesBeside("lifted.json")).scene);
  const Frame &start = moved.frames[0], &top = moved.frames[115], &end = moved.frames.back();
  EXPECT_NEAR(top.states[1].position.y(), 0.05 + 0.3, 1e-6);
  EXPECT_NEAR(top.energy.work, 4 * kGravity * 0.3, 1e-5);
  EXPECT_LT((end.states[1].position - start.states[1].position).norm(), 1e-5);
  EXPECT_LT(orientationError(end.states[1].orientation, start.states[1].orientation), 1e-5);
  for (const Event& event : moved.events) EXPECT_NE(std::min(event.bodyA, event.bodyB), 1) << event.time;
  expectLedger(moved, 1e-10, 1.2e-4);  // 10 times the accuracy, of 4 g 0.3 J
}

/// A capsule that stands, spins and falls on its side, without friction: a table that shakes to the side under it
/// changes nothing, and its far end strikes when and as it does on a fixed one. The steps of this accuracy are as long
/// as the fall.
TEST(DrivenBodies, CapsuleFallsOnAShakenTableAsOnAFixedOne) {
  std::vector<Event> first;
  for (const char* motion : {R"("static")", R"("driven", "oscillation": {"direction": [0, 0, 1],
      "amplitude": 0.0386, "frequency": 2.54, "phase": 1.5707963267948966})"}) {
    const Trajectory moved = simulate(sceneWith(fmt::format(R"("duration": 0.5, "accuracy": 1e-4,
      "output": {{"framesPerSecond": 240}},
      "materials": {{"m": {{"staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [
        {{"name": "table", "material": "m", "shape": {{"box": {{"size": [0.7725, 0.0386, 0.7725]}}}}, "motion": {}}},
        {{"name": "capsule", "material": "m", "shape": {{"capsule": {{"radius": 0.0596, "length": 0.0222}}}},
         "mass": 78, "position": [0, 0.09, 0], "angularVelocity": [5.2646, 3.1116, -7.3603]}}])",
                                                            motion)));
    const std::vector<Event> hits = eventsOf(moved, EventKind::impact);
    ASSERT_FALSE(hits.empty());
    first.push_back(hits.front());
  }
  EXPECT_NEAR(first[1].time, first[0].time, 1e-5);
  EXPECT_NEAR(first[1].impulse, first[0].impulse, 1e-3 * first[0].impulse);
}

/// A ball on a table that sinks with V falls, whichever of them comes first in the file: it meets the table again after
/// 2 V / g.
TEST(DrivenBodies, BallFallsBehindATableThatSinks) {
  const std::string table = drivenBox({1, 0.2, 1}, R"("linearVelocity": [0, -0.05, 0])");
  const std::string fallen = R"({"name": "ball", "material": "m", "shape": {"sphere": {"radius": 0.1}}, "mass": 2,
      "position": [0, 0.2, 0]})";
  for (const std::string& bodies : {table + ", " + fallen, fallen + ", " + table})
    for (const char* method : {"", R"("method": {"name": "rk4", "timeStep": 0.001},)"}) {
      const Trajectory moved = runDriven(0.3, 1e-6, bodies, method);
      EXPECT_NEAR(timeOf(moved, EventKind::impact), 2 * 0.05 / kGravity, 1e-3);
      EXPECT_NEAR(moved.frames.back().states[0].position.y() + moved.frames.back().states[1].position.y(),
                  0.2 - 2 * 0.05 * 0.3, 1e-5);
    }
}

/// A hand that pulls by a spring at a box which friction holds works what the spring takes up and its damper wastes,
/// however long the steps of a box at rest are. From key frame to key frame it goes by 10 u^3 - 15 u^4 + 6 u^5, u = t /
/// T. The damper takes c times the integral of the square of the rate at which the spring lengthens, here by Simpson's
/// rule.
TEST(DrivenBodies, HandPullsAtABoxThatStands) {
  const double restLength = 0.5, stiffness = 120, damping = 3, way = 0.25, duration = 0.3;
  const Vec3 anchor(0, 0.34, 0), middle(0.45, 0.15, 0);  // on the box; where the hand begins its way along z
  const auto placeAt = [&](double t) {
    const double u = t / duration;
    return way * u * u * u * (10 + u * (6 * u - 15));
  };
  const auto lengthAt = [&](double t) { return (middle + Vec3(0, 0, placeAt(t)) - anchor).norm(); };
  const auto lossRate = [&](double t) {
    const double u = t / duration, speed = way / duration * 30 * u * u * (1 - u) * (1 - u);
    return damping * std::pow(placeAt(t) * speed / lengthAt(t), 2);
  };
  for (const double accuracy : {1e-4, 1e-6, 1e-9}) {
    const Trajectory moved = runDriven(
        duration, accuracy,
        fmt::format(
            R"({{"name": "hand", "motion": "driven", "collision": "none", "shape": {{"sphere": {{"radius": 0.05}}}},
         "keyFrames": [{{"time": 0, "position": {}}}, {{"time": {}, "position": {}}}]}},
        {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
        {{"name": "box", "mass": 20, "material": "m", "shape": {{"box": {{"size": [0.4, 0.3, 0.4]}}}},
         "position": [0, 0.15, 0]}})",
            vectorText(middle), duration, vectorText(middle + Vec3(0, 0, way))),
        fmt::format(R"("springs": [{{"bodyA": "box", "anchorA": [0, 0.19, 0], "bodyB": "hand", "stiffness": {},
          "damping": {}, "restLength": {}}}],)",
                    stiffness, damping, restLength));
    const double start = stiffness / 2 * std::pow(lengthAt(0) - restLength, 2), most = 10 * accuracy * 0.1;  // of 0.1 J
    for (const Frame& frame : moved.frames) {
      double lost = 0;
      for (int i = 0; i <= 2000; ++i)
        lost += (i == 0 || i == 2000 ? 1 : i % 2 ? 4 : 2) * lossRate(frame.time * i / 2000) * frame.time / 6000;
      const double taken = stiffness / 2 * std::pow(lengthAt(frame.time) - restLength, 2) - start;
      EXPECT_NEAR(frame.energy.damping, lost, most) << frame.time;
      EXPECT_NEAR(frame.energy.work, taken + lost, most) << frame.time;
      EXPECT_LT((frame.states[1].position - moved.frames[0].states[1].position).norm(), 1e-12);
    }
    expectLedger(moved, 1e-12, most);
  }
}

/// A box that two tines carry down and to the side, against a stop along which it slides down, and up again as the
/// tines do: its sliding there turns around in a plane, and frames show nothing across that plane. Two ways of the
/// tines: in one a step beyond the turn is taken first, in the other one a step that ends at a stop of the sliding.
/// Errors across the plane are those of a frame, ten times the accuracy; across a sliding that is nearly at its stop
/// velocities have ten times more. Without shorter steps they were 0.8 and 0.06 m.
TEST(DrivenBodies, BoxOnTinesSlidesAlongAStopInAPlane) {
  struct Way {
    double xTurn, yTurn, turn, xEnd, yEnd, end, friction;
  };
  const auto tine = [](const char* name, double z, const Way& way) {
    return fmt::format(
        R"({{"name": "{}", "motion": "driven", "material": "m", "shape": {{"box": {{"size": [0.3, 0.02, 0.04]}}}},
        "keyFrames": [{{"time": 1, "position": {}}}, {{"time": 1.7, "position": {}}}, {{"time": {}, "position": {}}},
         {{"time": {}, "position": {}}}]}})",
        name, vectorText({0.8, 1.2, z}), vectorText({0.8, 0.44, z}), way.turn, vectorText({way.xTurn, way.yTurn, z}),
        way.end, vectorText({way.xEnd, way.yEnd, z}));
  };
  for (const Way& way :
       {Way{0.689, 0.392, 1.873, 0.525, 0.448, 2.166, 0.6}, Way{0.722, 0.413, 1.942, 0.532, 0.406, 2.475, 0.8}}) {
    const Trajectory moved = simulate(sceneWith(fmt::format(
        R"("duration": 2.4, "output": {{"framesPerSecond": 240}},
           "materials": {{"m": {{"staticFriction": {0}, "dynamicFriction": {0}}}}}, "bodies": [
        {{"name": "box", "mass": 8.4, "shape": {{"box": {{"size": [0.2, 0.2, 0.3]}}}}, "position": [0.8, 1.31, 0], "material": "m"}},
        {{"name": "stop", "motion": "driven", "material": "m", "shape": {{"box": {{"size": [0.04, 0.08, 0.25]}}}},
         "keyFrames": [{{"time": 1, "position": [0.63, 1.26, 0]}}, {{"time": 1.8, "position": [0.63, 0.475, 0]}},
          {{"time": 2.3, "position": [0.63, 0.475, 0]}}, {{"time": 2.7, "position": [0.13, 0.475, 0]}}]}},
        {1}, {2}])",
        way.friction, tine("left", 0.09, way), tine("right", -0.09, way))));
    for (const Frame& frame : moved.frames) {
      EXPECT_LT(std::abs(frame.states[0].position.z()), 1e-5) << frame.time;
      EXPECT_LT(std::abs(frame.states[0].linearVelocity.z()), 1e-4) << frame.time;
    }
  }
}

/// On a table x = A sin(w t) a box slips, and on y = A sin(w t) a box or a ball leaves it, as soon as A w^2 sin(w t) is
/// mu_s g, or g, though it is more for a hundredth of a period alone.
TEST(DrivenBodies, BriefExcessOfATableIsSeen) {
  for (const double ratio : {1.0005, 1.005, 1.05})
    for (const double frequency : {0.3, 1.0, 20.0})
      for (const char* shape : {R"({"box": {"size": [1, 0.2, 1]}})", R"({"sphere": {"radius": 0.1}})"})
        for (const bool isLevel : {true, false}) {
          if (isLevel && std::string(shape).find("sphere") != std::string::npos) continue;  // it rolls
          const double rate = 2 * kPi * frequency, amplitude = ratio * (isLevel ? 0.5 : 1) * kGravity / (rate * rate);
          const Trajectory moved = simulate(sceneWith(fmt::format(
              R"("duration": {}, "accuracy": 1e-4, "output": {{"framesPerSecond": {}}},
             "materials": {{"m": {{"staticFriction": 0.5, "dynamicFriction": 0.1, "restitution": 0}}}}, "bodies": [
              {{"name": "table", "material": "m", "motion": "driven", "shape": {{"box": {{"size": [400, 1, 400]}}}},
               "position": [0, -0.5, 0], "oscillation": {{"direction": {}, "amplitude": {}, "frequency": {}}}}},
              {{"name": "body", "material": "m", "mass": 1, "shape": {}, "position": [0, 0.1, 0],
               "linearVelocity": {}}}])",
              0.4 / frequency, 10 * frequency, isLevel ? "[1, 0, 0]" : "[0, 1, 0]", amplitude, frequency, shape,
              isLevel ? vectorText({amplitude * rate, 0, 0}) : vectorText({0, amplitude * rate, 0}))));
          // Forces that are beyond the cone by 1e-6 of gravity are found; the excess grows by its cosine.
          const double expected = std::asin(1 / ratio) / rate, late = 2e-6 / (rate * std::sqrt(ratio * ratio - 1));
          EXPECT_NEAR(timeOf(moved, isLevel ? EventKind::slip : EventKind::release), expected, late + 1e-7 / rate)
              << ratio << " " << frequency << shape << isLevel;
        }
}

/// A plate that comes down on a ball on the floor, or two walls that close over a ball, leave it no way, whatever
/// friction and restitution there are. That is said at once, and no ball goes through the floor.
TEST(DrivenBodies, BallThatIsPressedEndsTheRun) {
  for (const double friction : {0.0, 0.5, 1.0})
    for (const double restitution : {0.0, 0.5})
      for (const double speed : {0.1, 3.0}) {
        const std::string material =
            fmt::format(R"("materials": {{"m": {{"restitution": {}, "staticFriction": {}, "dynamicFriction": {}}}}},)",
                        restitution, friction, friction);
        const Scene pressed = sceneWith(fmt::format(R"("duration": 12, {} "bodies": [
            {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
            {{"name": "press", "shape": {{"box": {{"size": [3, 1, 3]}}}}, "motion": "driven", "material": "m",
              "position": [0, 1.5, 0], "linearVelocity": [0, {}, 0]}},
            {{"name": "ball", "shape": {{"sphere": {{"radius": 0.5}}}}, "position": [0, 0.5, 0], "material": "m"}}])",
                                                    material, -speed));
        const Scene squeezed = sceneWith(fmt::format(R"("duration": 12, "gravity": [0, 0, 0], {0} "bodies": [
            {{"name": "left", "shape": {{"box": {{"size": [1, 3, 3]}}}}, "motion": "driven", "material": "m",
              "position": [-1.1, 0, 0], "linearVelocity": [{1}, 0, 0]}},
            {{"name": "right", "shape": {{"box": {{"size": [1, 3, 3]}}}}, "motion": "driven", "material": "m",
              "position": [1.1, 0, 0], "linearVelocity": [-{1}, 0, 0]}},
            {{"name": "ball", "shape": {{"sphere": {{"radius": 0.5}}}}, "material": "m"}}])",
                                                     material, speed));
        for (const Scene& scene : {pressed, squeezed}) {
          try {
            simulate(scene);
            ADD_FAILURE() << friction << " " << restitution << " " << speed;
          } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("what is driven"))
                << friction << " " << restitution << " " << speed;
          }
        }
      }
}

/// A body in touch with two walls that carry it along the floor from rest to rest has all the room that it needs, also
/// in the instants in which all speeds are rounding.
TEST(DrivenBodies, BodyBetweenWallsThatGoTogetherHasRoom) {
  const auto wall = [](const char* name, double x) {
    return fmt::format(
        R"({{"name": "{}", "motion": "driven", "material": "m", "shape": {{"box": {{"size": [0.2, 0.3, 2]}}}},
        "keyFrames": [{{"time": 0.1, "position": {}}}, {{"time": 0.6, "position": {}}}, {{"time": 1, "position": {}}}]}})",
        name, vectorText({x, 0.2, 0}), vectorText({x + 0.5, 0.2, 0}), vectorText({x + 0.5, 0.2, 0.4}));
  };
  for (const char* shape : {R"({"sphere": {"radius": 0.1}})", R"({"box": {"size": [0.2, 0.2, 0.2]}})",
                            R"({"cylinder": {"radius": 0.1, "length": 0.2}})"})
    for (const double friction : {0.0, 0.5})
      for (const double accuracy : {1e-3, 1e-6}) {
        const Trajectory moved = simulate(sceneWith(fmt::format(
            R"("duration": 1.2, "accuracy": {}, "materials": {{"m": {{"staticFriction": {}, "dynamicFriction": {}}}}},
               "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}}, {}, {},
               {{"name": "body", "mass": 1, "shape": {}, "position": [0, 0.1, 0], "material": "m"}}])",
            accuracy, friction, friction, wall("left", -0.2), wall("right", 0.2), shape)));
        EXPECT_NEAR(moved.frames.back().states[2].position.x(), 0.5, 1e-6) << shape << friction;
        EXPECT_NEAR(moved.frames.back().states[2].position.y(), 0.1, 1e-6) << shape << friction;
      }
}

/// A box falls onto a lift of constant V on one of its edges, rocks, and stands. What drives the lift gives it, with
/// the impulse P, the work V . P = V . (m v + m g t), and no ledger lacks what ends the rocking.
TEST(DrivenBodies, BoxRocksOnALiftUntilItStands) {
  for (const double accuracy : {1e-6, 1e-11}) {
    const double speed = 20;
    const Trajectory moved =
        runDriven(2.5, accuracy,
                  drivenBox({9, 0.2, 9}, fmt::format(R"("linearVelocity": [0, {}, 0])", speed)) + fmt::format(R"(,
        {{"name": "box", "material": "m", "mass": 2, "shape": {{"box": {{"size": [1, 1, 1]}}}}, "position": [0, 0.8, 0],
        "linearVelocity": [0, {}, 0], "orientation": {{"axis": [0, 0, 1], "angleDegrees": 10}}}})",
                                                                                                              speed));
    const Frame& last = moved.frames.back();
    EXPECT_NEAR(last.states[1].position.y() - last.states[0].position.y(), 0.6, 1e-9) << accuracy;
    const double gained = 2 * (last.states[1].linearVelocity.y() - speed);
    EXPECT_NEAR(last.energy.work / (speed * (gained + 2 * kGravity * last.time)), 1, 3 * accuracy + 1e-12) << accuracy;
    EXPECT_LT(std::abs(last.energy.numerical) / last.energy.work, accuracy + 1e-12) << accuracy;
  }
}

/// Two fingers on sliders of a hand hold a box with unequal forces and lift it off the ground: its contacts with the
/// ground and with the fingers forbid each other as soon as the hand goes up, whatever friction could hold.
TEST(DrivenBodies, HandLiftsABoxBetweenUnequalFingers) {
  for (const double accuracy : {1e-4, 1e-6, 1e-9}) {
    const Trajectory moved =
        runDriven(1.2, accuracy,
                  R"({"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "grip"},
        {"name": "hand", "shape": {"box": {"size": [1.4, 0.1, 0.3]}}, "motion": "driven", "collision": "none",
        "position": [0, 1, 0], "keyFrames": [{"time": 0.2}, {"time": 1, "position": [0, 2, 0]}]},
        {"name": "box", "shape": {"box": {"size": [0.4, 0.4, 0.4]}}, "mass": 64, "material": "grip", "position": [0, 0.2, 0]},
        {"name": "left", "shape": {"box": {"size": [0.1, 0.3, 0.3]}}, "mass": 9, "material": "grip", "position": [-0.25, 0.2, 0]},
        {"name": "right", "shape": {"box": {"size": [0.1, 0.3, 0.3]}}, "mass": 9, "material": "grip", "position": [0.25, 0.2, 0]})",
                  R"("sliders": [{"bodyA": "left", "bodyB": "hand", "anchorB": [-0.25, -0.8, 0], "axis": [1, 0, 0],
        "motor": {"force": 861}}, {"bodyA": "right", "bodyB": "hand", "anchorB": [0.25, -0.8, 0], "axis": [-1, 0, 0],
        "motor": {"force": 1171}}],)");
    for (const Frame& frame : moved.frames)
      EXPECT_NEAR(frame.states[1].position.y() - frame.states[0].position.y(), -0.8, accuracy) << frame.time;
  }
}

/// A turning bar sweeps a box over the ground, by two corners of one of its edges: nothing presses it into the ground
/// by that, whose impulses Coulomb's law would leave undetermined. The same for every direction in which it happens.
TEST(DrivenBodies, BarSweepsABoxAlikeInAllDirections) {
  std::vector<BodyState> ends;
  for (const double degrees : {0.0, 20.0, 200.0, 300.0}) {
    const Quat turn = rotationAbout(Vec3::UnitY(), degrees * kPi / 180);
    const auto orientationOf = [&](double angle) {
      const Quat q = turn * rotationAbout(Vec3::UnitY(), angle * kPi / 180);
      return fmt::format(R"({{"w": {}, "x": {}, "y": {}, "z": {}}})", q.w(), q.x(), q.y(), q.z());
    };
    const Trajectory moved = runDriven(
        0.3, 1e-8,
        fmt::format(R"({{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static", "material": "grip"}},
        {{"name": "bar", "shape": {{"box": {{"size": [4, 0.3, 0.1]}}}}, "motion": "driven", "material": "grip",
        "position": [0, 0.2, 0], "orientation": {}, "angularVelocity": [0, 1.7, 0]}},
        {{"name": "box", "shape": {{"box": {{"size": [0.209, 0.209, 0.209]}}}}, "mass": 9, "material": "grip",
        "position": {}, "orientation": {}}})",
                    orientationOf(-26), vectorText(turn * Vec3(-1.2, 0.1045, -0.05)), orientationOf(0)));
    EXPECT_GE(eventsOf(moved, EventKind::impact).size(), 2u);
    BodyState end = moved.frames.back().states[1];
    end.position = turn.conjugate() * end.position, end.linearVelocity = turn.conjugate() * end.linearVelocity;
    ends.push_back(end);
    EXPECT_LT((end.position - ends[0].position).norm(), 1e-7) << degrees;
    EXPECT_LT((end.linearVelocity - ends[0].linearVelocity).norm(), 1e-6) << degrees;
  }
}

// A hand sets something down, or pushes it off, whose taut rope or stop holds it along the normal of the contact. Such
// a tie holds one way only: it goes slack, or opens, and what is met carries, by events and by time stepping alike.
const char* const kByEvents = "";
const char* const kBySteps = R"("method": {"name": "rk4", "timeStep": 0.001},)";

TEST(DrivenBodies, RopesGoSlackWhereTheirBallIsSetDown) {
  for (const double aside : {0.0, 1e-8, 0.2})  // m, of the hand: two ropes there, as a V
    for (const char* const method : {kByEvents, kBySteps}) {
      const std::string ropes =
          aside < 0.1 ? fmt::format(R"({{"bodyA": "ball", "bodyB": "hand", "anchorB": [{}, 0, 0]}})", aside)
                      : R"({"bodyA": "ball", "bodyB": "hand", "anchorB": [0.2, 0, 0]},
                                               {"bodyA": "ball", "bodyB": "hand", "anchorB": [-0.2, 0, 0]})";
      const Trajectory moved =
          runDriven(1.5, 1e-6,
                    R"({"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "half"},
        {"name": "hand", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "motion": "driven", "collision": "none",
        "position": [0, 1.5, 0], "linearVelocity": [0, -0.5, 0]},
        {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "half", "position": [0, 0.5, 0],
        "linearVelocity": [0, -0.5, 0]})",
                    fmt::format(R"("ropes": [{}], {})", ropes, method));
      EXPECT_LT((moved.frames.back().states[1].position - Vec3(0, 0.1, 0)).norm(), 1e-7) << aside << method;
      EXPECT_FALSE(eventsOf(moved, EventKind::slack).empty()) << aside << method;
      if (method != kByEvents) continue;
      double impulse = 0;  // N s: all of the ball's momentum, at 0.8 s
      for (const Event& event : eventsOf(moved, EventKind::impact)) impulse += event.impulse;
      EXPECT_NEAR(impulse, 0.5, 1e-7) << aside;
      EXPECT_NEAR(eventsOf(moved, EventKind::slack)[0].time, 0.8, 1e-7) << aside;
    }
}

// The stop is not the wheel's, but that of the carriage with its axle.
TEST(DrivenBodies, StopOpensWhereAWheelOnItsCarriageIsSetDown) {
  for (const char* const method : {kByEvents, kBySteps}) {
    const Trajectory moved =
        runDriven(1.5, 1e-6,
                  R"({"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "half"},
        {"name": "lift", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "motion": "driven", "collision": "none",
        "position": [0, 0.7, 0], "linearVelocity": [0, -0.2, 0]},
        {"name": "carriage", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "collision": "none", "mass": 1.5,
        "position": [0, 0.5, 0], "linearVelocity": [0, -0.2, 0]},
        {"name": "wheel", "shape": {"sphere": {"radius": 0.15}}, "mass": 1, "material": "half", "position": [0, 0.35, 0],
        "linearVelocity": [0, -0.2, 0]})",
                  fmt::format(R"("sliders": [{{"bodyA": "carriage", "bodyB": "lift", "anchorB": [0, -0.2, 0],
        "axis": [0, 1, 0], "limits": {{"lower": 0}}}}],
        "hinges": [{{"bodyA": "wheel", "bodyB": "carriage", "anchorB": [0, -0.15, 0]}}], {})",
                              method));
    const std::vector<BodyState>& end = moved.frames.back().states;
    EXPECT_LT((end[2].position - Vec3(0, 0.15, 0)).norm(), 1e-6) << method;
    EXPECT_LT((end[1].position - Vec3(0, 0.3, 0)).norm(), 1e-6) << method;
  }
}

// A ball on the upper stop of its slider is lifted off it as long as the lower one leaves room, and no longer.
TEST(DrivenBodies, LiftTakesABallOffItsStopUpToTheNextOne) {
  for (const char* const method : {kByEvents, kBySteps}) {
    const auto lift = [&](double upper) {
      return runDriven(1.4, 1e-6,
                       R"({"name": "lift", "shape": {"box": {"size": [1, 0.1, 1]}}, "motion": "driven", "material": "m",
          "position": [0, -0.55, 0], "linearVelocity": [0, 0.5, 0]},
          {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "half"})",
                       fmt::format(R"("sliders": [{{"bodyA": "ball", "anchorB": [0, 0, 0], "axis": [0, 1, 0],
          "limits": {{"lower": 0, "upper": {}}}}}], {})",
                                   upper, method));
    };
    EXPECT_NEAR(lift(3).frames.back().states[1].position.y(), 0.3, 1e-6) << method;  // 0.05 + 0.1 above the lift
    try {
      lift(0.2);
      FAIL() << method;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("\"lift\" is pressed into \"ball\": what is driven leaves no room"));
      EXPECT_THAT(error.what(), testing::HasSubstr("unstable at 1.2")) << error.what();
    }
  }
}

// The line from the hinge to the middle of the door stands off the hand by the radius and half of the thickness:
// 0.8 sin a - z cos a = 0.125, z the way of the hand beyond the shut door.
TEST(DrivenBodies, HandPushesADoorOffItsStop) {
  for (const char* const method : {kByEvents, kBySteps}) {
    const Trajectory moved =
        runDriven(1.2, 1e-6,
                  R"({"name": "door", "shape": {"box": {"size": [1, 0.5, 0.05]}}, "mass": 1, "material": "half",
        "position": [0.5, 0, 0]},
        {"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven", "material": "half",
        "position": [0.8, 0, 0.5], "linearVelocity": [0, 0, -0.6]})",
                  fmt::format(R"("hinges": [{{"bodyA": "door", "anchorA": [-0.5, 0, 0], "anchorB": [0, 0, 0],
        "axis": [0, 1, 0], "limits": {{"lower": 0, "upper": 2}}, "motor": {{"torque": -1}}}}], {})",
                              method));
    const double far = std::hypot(0.8, 0.22), angle = std::asin(0.125 / far) + std::atan2(0.22, 0.8);
    const Vec3 middle = 0.5 * Vec3(std::cos(angle), 0, -std::sin(angle));
    EXPECT_LT((moved.frames.back().states[0].position - middle).norm(), method == kByEvents ? 1e-6 : 1e-4) << method;
  }
}

/// One ball goes with a belt, another one falls on it far away: that impact is none of the first.
TEST(DrivenBodies, BeltCarriesNoImpactFromOneBodyToAnother) {
  const Trajectory moved =
      runDriven(0.5, 1e-6,
                drivenBox({20, 1, 20}, R"("linearVelocity": [1, 0, 0], "position": [0, -0.5, 0])") +
                    R"(, {"name": "lying", "material": "m", "shape": {"sphere": {"radius": 0.1}},
        "position": [0, 0.1, 0], "linearVelocity": [1, 0, 0]}, {"name": "falling", "material": "m",
        "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.5, 4], "linearVelocity": [1, 0, 0]})");
  EXPECT_FALSE(eventsOf(moved, EventKind::impact).empty());
  for (const Event& event : moved.events) EXPECT_TRUE(event.bodyA != 0 || event.bodyB != 1) << event.time;
}

}  // namespace
}  // namespace cradle
