// Places where ties leave more motion than elsewhere, or none: the motion goes on as it should, or the run stops and
// says why.

#include <gtest/gtest.h>

#include "experiments/tie_error.h"

namespace cradle {
namespace {

std::string rodToWorld(const std::string& body, const Vec3& end) {
  return fmt::format(R"({{"bodyA": "{}", "anchorA": [0, 0, 0], "anchorB": {}}})", body, vectorText(end));
}
std::string rodBetween(const std::string& a, const std::string& b) {
  return fmt::format(R"({{"bodyA": "{}", "anchorA": [0, 0, 0], "bodyB": "{}", "anchorB": [0, 0, 0]}})", a, b);
}

Scene sceneUnder(double duration, const Vec3& gravity, const std::string& members) {
  return sceneWith(
      fmt::format(R"("duration": {}, "accuracy": 1e-10, "gravity": {}, {})", duration, vectorText(gravity), members));
}
const Vec3 kDown(0, -kGravity, 0), kNone = Vec3::Zero();

/// Three balls in line along x on rods of 1 m.
const std::string kChain = R"("bodies": [)" + ball("a", Vec3(1, 0, 0)) + ", " + ball("b", Vec3(2, 0, 0)) + ", " +
                           ball("c", Vec3(3, 0, 0)) + R"(], "rods": [)" + rodToWorld("a", Vec3::Zero()) + ", " +
                           rodBetween("b", "a") + ", " + rodBetween("c", "b");

TEST(StraightChain, StaysStraightUnderTension) {
  const Trajectory run = simulate(sceneUnder(
      1, kNone,
      kChain + R"(], "pushes": [{"body": "c", "point": [0, 0, 0], "force": [50, 0, 0], "start": 0, "duration": 1}])"));
  for (const Frame& frame : run.frames)
    for (const std::size_t i : {0u, 1u, 2u})
      EXPECT_LT((frame.states[i].position - Vec3(static_cast<double>(i) + 1, 0, 0)).norm(), 1e-14) << frame.time;
}

TEST(StraightChain, FallsWithItsEnergy) {
  const Scene scene = sceneUnder(2, kDown, kChain + "]");
  const Trajectory run = simulate(scene);
  EXPECT_GT(run.frames[40].energy.kinetic, 5);
  EXPECT_LT(largestEnergyError(run), 1e-8);
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}

void expectLock(const Scene& scene) {
  SCOPED_TRACE(fmt::format("accuracy {}", scene.accuracy));
  try {
    simulate(scene);
    FAIL() << "ran to its end";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    for (const char* word : {"unstable at", "what ties it leaves no motion", "look at its rods"})
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in " << error.what();
  }
}

void expectLockAtAllAccuracies(Scene scene) {
  for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8, 1e-10}) {
    scene.accuracy = accuracy;
    expectLock(scene);
  }
}

// Stretched to its full length between fixed points a chain cannot move, and no finite tension carries its weight. What
// lets it sag by a ten-thousandth and throws it back is no motion of its own.
TEST(ChainAtItsFullLength, IsRefusedAsSoonAsSomethingActsAcrossIt) {
  const std::string held = kChain + ", " + rodToWorld("c", Vec3(4, 0, 0)) + "]";
  const Trajectory still = simulate(sceneUnder(1, kNone, held));
  EXPECT_LT((still.frames.back().states[1].position - Vec3(2, 0, 0)).norm(), 1e-14);
  expectLockAtAllAccuracies(sceneUnder(1, kDown, held));
  expectLockAtAllAccuracies(sceneUnder(1, kGravity * Vec3(0.6, -0.8, 0), held));
  expectLock(sceneWith("\"duration\": 1, " + methodText("rk4", 1e-3) + ", " + held));
  expectLockAtAllAccuracies(sceneUnder(1, kNone,
                                       R"("bodies": [)" + ball("a", Vec3(1, 0, 0), Vec3(0, 1, 0)) + R"(], "rods": [)" +
                                           rodToWorld("a", Vec3::Zero()) + ", " + rodToWorld("a", Vec3(2, 0, 0)) +
                                           "]"));
}

// The same of two bars between hinges.
TEST(BarsAtTheirFullLength, AreRefused) {
  const auto bar = [](const std::string& name, double x) {
    return fmt::format(R"({{"name": "{}", "shape": {{"box": {{"size": [1, 0.1, 0.1]}}}}, "collision": "none",
        "mass": 1, "position": [{}, 0, 0]}})",
                       name, x);
  };
  expectLockAtAllAccuracies(
      sceneUnder(1, kDown, R"("bodies": [)" + bar("a", 0.5) + ", " + bar("b", 1.5) + R"(], "hinges": [
        {"bodyA": "a", "anchorA": [-0.5, 0, 0], "anchorB": [0, 0, 0]},
        {"bodyA": "b", "anchorA": [-0.5, 0, 0], "bodyB": "a", "anchorB": [0.5, 0, 0]},
        {"bodyA": "b", "anchorA": [0.5, 0, 0], "anchorB": [2, 0, 0]}])"));
}

// A parallelogram of rods of 1 m and 2 m, in line twice a turn: there it could go on as a parallelogram or crosswise.
// What moves is no constraint's doing: it stays a parallelogram, whose ends go round evenly without gravity.
TEST(Parallelogram, PassesItsFlatPositions) {
  const double speed = 4;
  const Scene scene =
      sceneUnder(5, kNone,
                 R"("bodies": [)" + ball("a", Vec3(0, -1, 0), Vec3(speed, 0, 0)) + ", " +
                     ball("b", Vec3(2, -1, 0), Vec3(speed, 0, 0)) + R"(], "rods": [)" + rodToWorld("a", Vec3::Zero()) +
                     ", " + rodToWorld("b", Vec3(2, 0, 0)) + ", " + rodBetween("a", "b") + "]");
  const Trajectory run = simulate(scene);
  for (const Frame& frame : run.frames) {
    const double angle = speed * frame.time;
    const Vec3 expected(std::sin(angle), -std::cos(angle), 0);
    EXPECT_LT((frame.states[0].position - expected).norm(), 1e-7) << frame.time;
    EXPECT_LT((frame.states[1].position - expected - Vec3(2, 0, 0)).norm(), 1e-7) << frame.time;
  }
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}

// The same of three bars on hinges, swinging in gravity with enough speed to go round.
TEST(HingedParallelogram, PassesItsFlatPositionsWithItsEnergy) {
  const auto bar = [](const std::string& name, const Vec3& size, const std::string& motion) {
    return fmt::format(R"({{"name": "{}", "shape": {{"box": {{"size": {}}}}}, "collision": "none", "mass": 1, {}}})",
                       name, vectorText(size), motion);
  };
  const Scene scene = sceneUnder(
      3, kDown,
      R"("bodies": [)" +
          bar("left", Vec3(0.1, 1, 0.1),
              R"("position": [0, -0.5, 0], "linearVelocity": [4, 0, 0], "angularVelocity": [0, 0, 8])") +
          ", " + bar("coupler", Vec3(2, 0.1, 0.1), R"("position": [1, -1, 0], "linearVelocity": [8, 0, 0])") + ", " +
          bar("right", Vec3(0.1, 1, 0.1),
              R"("position": [2, -0.5, 0], "linearVelocity": [4, 0, 0], "angularVelocity": [0, 0, 8])") +
          R"(], "hinges": [{"bodyA": "left", "anchorA": [0, 0.5, 0], "anchorB": [0, 0, 0]},
        {"bodyA": "right", "anchorA": [0, 0.5, 0], "anchorB": [2, 0, 0]},
        {"bodyA": "coupler", "anchorA": [-1, 0, 0], "bodyB": "left", "anchorB": [0, -0.5, 0]},
        {"bodyA": "coupler", "anchorA": [1, 0, 0], "bodyB": "right", "anchorB": [0, -0.5, 0]}])");
  const Trajectory run = simulate(scene);
  double highest = -1;
  for (const Frame& frame : run.frames) {
    highest = std::max(highest, frame.states[1].position.y());
    EXPECT_LT(orientationError(frame.states[1].orientation, Quat::Identity()), 1e-8) << frame.time;
  }
  EXPECT_GT(highest, 0.99) << "did not go over the top";
  EXPECT_LT(largestEnergyError(run), 1e-7);
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}

// A rod pendulum that just reaches the top takes for ever; a thousandth faster, it goes over, and slower, falls back.
// Just there: tan((pi + theta) / 4) = e^(w0 t), from the bottom with speed 2 w0 (1 m).
TEST(RodPendulum, ReachesTheTopOrDoesNot) {
  const double frequency = std::sqrt(kGravity);
  const auto thrown = [&](double part, double duration) {
    return simulate(sceneUnder(duration, kDown,
                               R"("bodies": [)" + ball("bob", Vec3(0, -1, 0), Vec3(2 * frequency * part, 0, 0)) +
                                   R"(], "rods": [)" + rodToWorld("bob", Vec3::Zero()) + "]"));
  };
  // A disturbance grows as e^(w0 t): 500 times in 2 s.
  for (const Frame& frame : thrown(1, 2).frames) {
    const double angle = 4 * std::atan(std::exp(frequency * frame.time)) - std::acos(-1);
    EXPECT_LT((frame.states[0].position - Vec3(std::sin(angle), -std::cos(angle), 0)).norm(), 1e-7) << frame.time;
  }
  const auto crosses = [](const Trajectory& run) {
    return std::any_of(run.frames.begin(), run.frames.end(), [](const Frame& frame) {
      return frame.states[0].position.y() > 0.5 && frame.states[0].position.x() < -0.1;
    });
  };
  EXPECT_TRUE(crosses(thrown(1.001, 3)));
  EXPECT_FALSE(crosses(thrown(0.999, 3)));
  EXPECT_LT(largestEnergyError(thrown(1.001, 6)), 1e-8);
}

/// Two equal cranks of 0.2 m, coupled by a rod, that a torque on one turns from near their dead point. Turned as a
/// parallelogram they have the inertia J = 2 I + m r^2, I about their bearings. Near the dead point the rod tells
/// little of the other crank: the angle T t^2 / 2 J is right, though the promise may be given up. At 1e-8 rounding
/// decides too much there, and a run may end.
TEST(CoupledCranks, GoThroughTheirDeadPoint) {
  const double turning = 2 * ((0.04 + 0.0004) / 12 + 0.01) + 0.04;
  int right = 0;
  for (const double start : {0.002, 0.01, 0.05, 0.5, 1.2})
    for (const double accuracy : {1e-4, 1e-6, 1e-7, 1e-8}) {
      SCOPED_TRACE(fmt::format("{} {}", start, accuracy));
      const double x = 0.1 * std::cos(start), y = 0.1 * std::sin(start);
      const auto crank = [&](const char* name, double at) {
        return fmt::format(R"({{"name": "{}", "mass": 1, "collision": "none", "position": [{}, {}, 0],
            "shape": {{"box": {{"size": [0.2, 0.02, 0.02]}}}},
            "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}}}})",
                           name, at + x, y, start * 180 / M_PI);
      };
      const auto hinge = [](const char* a, double from, const char* to) {
        return fmt::format(R"({{"bodyA": "{}", "anchorA": [{}, 0, 0], {}}})", a, from, to);
      };
      const Scene scene = sceneWith(fmt::format(
          R"("duration": 2, "accuracy": {}, "gravity": [0, 0, 0], "bodies": [{}, {}, {{"name": "rod", "mass": 1,
          "collision": "none", "position": [{}, {}, 0], "shape": {{"box": {{"size": [1, 0.02, 0.02]}}}}}}],
          "hinges": [{}, {}, {}, {}])",
          accuracy, crank("c0", 0), crank("c1", 1), 0.5 + 2 * x, 2 * y,
          hinge("c0", -0.1, R"("anchorB": [0, 0, 0], "motor": {"torque": -1})"),
          hinge("c1", -0.1, R"("anchorB": [1, 0, 0])"), hinge("c0", 0.1, R"("bodyB": "rod", "anchorB": [-0.5, 0, 0])"),
          hinge("c1", 0.1, R"("bodyB": "rod", "anchorB": [0.5, 0, 0])")));
      try {
        const Trajectory run = simulate(scene);
        double off = 0;
        for (const Frame& frame : run.frames) {
          const double angle = -frame.time * frame.time / (2 * turning);
          off = std::max(off, std::abs(frame.joints[0].coordinate - angle));
        }
        EXPECT_LT(off, 100 * accuracy);
        ++right;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::unstable);
        EXPECT_EQ(accuracy, 1e-8) << error.what();
      }
    }
  EXPECT_GE(right, 18);
}

}  // namespace
}  // namespace cradle
