#include <gtest/gtest.h>

#include <algorithm>

#include "dynamics/free_bodies.h"
#include "experiments/experiment.h"

// Balls and boxes that friction of 0.3 brings to roll or to rest on a plane. Each step is flown freely and friction
// comes at its end, so that speeds are exact while it acts, and the way is farther by half of what friction does in a
// step, each step: acceleration x h t / 2.

namespace cradle {
namespace {

constexpr double kStep = 1.0 / 1000;  // s: frames lie on steps
constexpr double kFriction = 0.3 * 9.81;
constexpr double kSolverError = 1e-8;  // m, m/s: sweeps end at 1e-12 of the largest change, a step

Trajectory onPlane(const std::string& body, double duration) {
  return simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Friction", "duration": {},
    "output": {{"framesPerSecond": 20}}, {},
    "materials": {{"m": {{"restitution": 0, "staticFriction": 0.3, "dynamicFriction": 0.3}}}},
    "bodies": [{{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
      {{"name": "body", "material": "m", {}}}]}})",
                                      duration, methodText("rk4", kStep), body)));
}

/// Thrown along +x at 5 m/s; `spin` > 0 is that of rolling forwards.
Trajectory throwBall(double spin) {
  return onPlane(fmt::format(R"("shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "position": [0, 0.1, 0],
    "linearVelocity": [5, 0, 0], "angularVelocity": [0, 0, {}])",
                             -spin),
                 3);
}

struct Throw {
  double spin;                               // rad/s
  double rollTime, finalSpeed, wayAtTheEnd;  // s, m/s, m at 3 s
};

// t = 2 (v - r w) / (7 mu g), v' = (5 v + 2 r w) / 7. Friction acts at a contact point in the middle of the overlap of
// g h^2 / 2 that a step makes: its lever is shorter than r by g h^2 / 4, part of which is missing from the turning that
// friction makes and from the speed at which the point stands still.
TEST(ThrownBall, SlidesThenRollsByTheClosedForm) {
  for (const Throw& thrown : {Throw{0, 0.48541332945002669773, 3.5714285714285714286, 11.061009521035733356},
                              Throw{-30, 0.77666132712004271637, 2.7142857142857142857, 9.0304700881371916759}}) {
    const Trajectory run = throwBall(thrown.spin);
    const BodyState end = endOf(run);
    const double leverError = 9.81 * kStep * kStep / 4 / 0.1, slowed = 5 - thrown.finalSpeed;
    const double speedError = leverError * (slowed + thrown.finalSpeed) + kSolverError;
    EXPECT_NEAR(end.linearVelocity.x(), thrown.finalSpeed, speedError) << thrown.spin;
    EXPECT_NEAR(end.angularVelocity.z(), -thrown.finalSpeed / 0.1, speedError / 0.1) << thrown.spin;
    EXPECT_NEAR(end.position.x(), thrown.wayAtTheEnd,
                kFriction * kStep * (thrown.rollTime / 2 + 2 * kStep) + 3 * speedError)
        << thrown.spin;
    const Frame& sliding = run.frames[8];  // 0.4 s
    EXPECT_NEAR(sliding.states[0].linearVelocity.x(), 5 - kFriction * 0.4, kSolverError) << thrown.spin;
  }
}

// A box of base 0.4 x 0.2 m on its four corners: 6 mu g / sqrt(a^2 + b^2) slows its spin of 10 rad/s, which ends within
// the step of the closed form's time.
TEST(SpinningBox, StopsByTheClosedFormOfFourCorners) {
  const Trajectory run = onPlane(R"("shape": {"box": {"size": [0.4, 0.1, 0.2]}}, "position": [0, 0.05, 0],
    "angularVelocity": [0, 10, 0])",
                                 0.5);
  const double slowing = 39.484488346691286459, stop = 0.25326401376144407027, angle = 1.2663200688072203513;
  EXPECT_NEAR(run.frames[4].states[0].angularVelocity.y(), 10 - slowing * 0.2, slowing * kStep);
  const Quat turn = endOf(run).orientation;
  EXPECT_NEAR(2 * std::atan2(turn.y(), turn.w()), angle, slowing * kStep * (stop / 2 + 2 * kStep));
  EXPECT_LT((endOf(run).position - Vec3(0, 0.05, 0)).norm(), 1e-6);
  const auto rest = std::find_if(run.events.begin(), run.events.end(),
                                 [](const Event& event) { return event.kind == EventKind::rest; });
  ASSERT_NE(rest, run.events.end());
  EXPECT_NEAR(rest->time, stop, 2 * kStep);
}

// A box on its four corners that a hand drags by a spring at one of its corners: it sticks, slips, pivots about one
// corner, and tips a little, so that corners carry nothing and load again. Some lie on a wider box that is free as
// well. Each ends that bends with its state only, so that ends at several accuracies agree within about ten times
// these, and the promise is kept.
TEST(DraggedBox, EndsWithinItsAccuracy) {
  Random random;
  for (int scene = 0; scene < 12; ++scene) {
    const double below = scene < 8 ? 0 : 0.2;  // m: height of the wider box
    const Vec3 size{random.between(0.2, 0.5), random.between(0.1, 0.4), random.between(0.2, 0.5)};
    const double friction = random.between(0.2, 0.8), ratio = scene % 3 == 0 ? 1.2 : 1;
    const std::string bodies = fmt::format(
        R"({{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
        {{"name": "box", "shape": {{"box": {{"size": {}}}}}, "material": "m", "position": [0, {}, 0],
          "orientation": {{"axis": [0, 1, 0], "angleDegrees": {}}}}},
        {{"name": "hand", "shape": {{"sphere": {{"radius": 0.02}}}}, "motion": "driven", "collision": "none",
          "position": {}, "linearVelocity": [{}, 0, {}]}})",
        vectorText(size), below + size.y() / 2, random.between(-180, 180),
        vectorText({random.between(-1, 1), below + random.between(0.1, 0.6), random.between(-1, 1)}),
        random.between(-0.6, 0.6), random.between(-0.6, 0.6));
    const std::string wider = below == 0 ? "" : R"(, {"name": "wider", "shape": {"box": {"size": [0.8, 0.2, 0.8]}},
        "material": "m", "position": [0, 0.1, 0]})";
    const std::string spring = fmt::format(
        R"({{"bodyA": "box", "anchorA": {}, "bodyB": "hand", "anchorB": [0, 0, 0], "stiffness": {}, "restLength": {},
          "damping": {}}})",
        vectorText({size.x() / 2, random.between(-0.5, 0.5) * size.y(), size.z() / 2}), random.between(20, 200),
        random.between(0, 0.5), scene % 2);
    const auto run = [&](double accuracy) {
      const Trajectory moved = simulate(sceneWith(fmt::format(
          R"("duration": 3, "accuracy": {}, "output": {{"framesPerSecond": 20}}, "materials": {{"m": {{"density": 500,
          "restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [{}], "springs": [{}])",
          accuracy, ratio * friction, friction, bodies + wider, spring)));
      EXPECT_TRUE(moved.cost.promise.ends_with("; kept")) << scene << " " << accuracy << moved.cost.promise;
      return endOf(moved);
    };
    const BodyState exact = run(1e-10);
    for (const double accuracy : {1e-5, 1e-7, 1e-9}) {
      const BodyState end = run(accuracy);
      EXPECT_LT((end.position - exact.position).norm(), 10 * accuracy) << scene;
      EXPECT_LT(orientationError(end.orientation, exact.orientation), 10 * accuracy) << scene;
    }
  }
}

// Three boxes on each other, of which a spring drags the lowest: it slides, and so do the others on it in the end, at
// instants that follow from their loads alone. Ends as above.
TEST(DraggedStack, EndsWithinItsAccuracy) {
  const auto run = [](double accuracy) {
    const Trajectory moved = simulate(sceneWith(fmt::format(
        R"("duration": 1.5, "accuracy": {}, "output": {{"framesPerSecond": 20}}, "materials": {{"m": {{"density": 553,
        "restitution": 0, "staticFriction": 0.656, "dynamicFriction": 0.546}}}},
        "bodies": [{{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
          {{"name": "low", "shape": {{"box": {{"size": [0.284, 0.177, 0.348]}}}}, "material": "m",
            "position": [0.000675, 0.0885, 0.0124]}},
          {{"name": "middle", "shape": {{"box": {{"size": [0.103, 0.0663, 0.311]}}}}, "material": "m",
            "position": [0.0182, 0.21015, 0.00344]}},
          {{"name": "top", "shape": {{"box": {{"size": [0.116, 0.188, 0.174]}}}}, "material": "m",
            "position": [-0.00956, 0.3373, -0.00634]}}],
        "springs": [{{"bodyA": "low", "anchorA": [-0.0289, 0.00219, -0.0274], "anchorB": [0.67, 0.491, 0.0309],
          "stiffness": 207, "restLength": 0.163, "damping": 0.148}}])",
        accuracy)));
    EXPECT_TRUE(moved.cost.promise.ends_with("; kept")) << accuracy << moved.cost.promise;
    return moved.frames.back().states;
  };
  const std::vector<BodyState> exact = run(1e-10);
  for (const double accuracy : {1e-6, 1e-8}) {
    const std::vector<BodyState> end = run(accuracy);
    for (std::size_t i = 0; i < end.size(); ++i) {
      EXPECT_LT((end[i].position - exact[i].position).norm(), 10 * accuracy) << i;
      EXPECT_LT(orientationError(end[i].orientation, exact[i].orientation), 10 * accuracy) << i;
    }
  }
}

// A block that slides askew over the edge of a table: it tips when its centre is beyond the edge, or before, as its
// friction bends it forwards. Loads of its corners fall below zero then and come back in a step as long as the rest of
// the motion, as they have poles where a corner comes to the edge.
TEST(BlockOverAnEdge, TipsAtEveryAccuracy) {
  Random random;
  for (int scene = 0; scene < 12; ++scene) {
    const Vec3 size{random.between(0.1, 0.4), random.between(0.05, 0.3), random.between(0.1, 0.3)};
    const double friction = random.between(0.1, 0.6);
    const std::string bodies = fmt::format(
        R"({{"name": "table", "shape": {{"box": {{"size": [1, 0.2, 1]}}}}, "motion": "static", "material": "m",
          "position": [-0.5, -0.1, 0]}},
        {{"name": "block", "shape": {{"box": {{"size": {}}}}}, "material": "m", "position": [{}, {}, 0],
          "orientation": {{"axis": [0, 1, 0], "angleDegrees": {}}}, "linearVelocity": [{}, 0, 0]}})",
        vectorText(size), -size.x() / 2 - random.between(0.01, 0.3), size.y() / 2, random.between(10, 40),
        random.between(1.5, 3));
    const auto run = [&](double accuracy) {
      const Trajectory moved = simulate(sceneWith(fmt::format(
          R"("duration": 0.4, "accuracy": {}, "output": {{"framesPerSecond": 20}}, "materials": {{"m": {{"density": 1000,
          "restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [{}])",
          accuracy, friction, friction, bodies)));
      EXPECT_TRUE(moved.cost.promise.ends_with("; kept")) << scene << " " << accuracy << moved.cost.promise;
      return endOf(moved);
    };
    const BodyState exact = run(1e-10);
    for (const double accuracy : {1e-4, 1e-6}) {
      const BodyState end = run(accuracy);
      EXPECT_LT((end.position - exact.position).norm(), 10 * accuracy) << scene << " " << accuracy;
      EXPECT_LT(orientationError(end.orientation, exact.orientation), 100 * accuracy) << scene << " " << accuracy;
    }
  }
}

}  // namespace
}  // namespace cradle
