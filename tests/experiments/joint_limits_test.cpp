// Stops of hinges and sliders, against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments/expect_ledger.h"

namespace cradle {
namespace {

constexpr double kPi = std::numbers::pi;

Trajectory runStopped(double duration, double accuracy, const std::string& bodies, const std::string& more) {
  return simulate(sceneWith(fmt::format(R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 100}}, {}
    "bodies": [{}])",
                                        duration, accuracy, more, bodies)));
}

std::string box(const std::string& more) {
  return R"({"name": "box", "mass": 2, "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "collision": "none")" + more + "}";
}

/// A box on a slider between two stops, without gravity: it goes between them at e, e^2, ... of its speed, and each
/// takes m (1 - e^2) v^2 / 2.
TEST(JointLimits, SliderBouncesBetweenItsStops) {
  const Trajectory moved =
      runStopped(2, 1e-8, box(R"(, "linearVelocity": [2, 0, 0])"),
                 R"("gravity": [0, 0, 0], "sliders": [{"bodyA": "box", "anchorB": [0, 0, 0], "axis": [1, 0, 0],
      "limits": {"lower": -0.3, "upper": 0.5, "restitution": 0.5}}],)");
  const double first = 0.25, second = first + 0.8 / 1;  // 0.8 m at 1 m/s
  for (const Frame& frame : moved.frames) {
    const double t = frame.time;
    const double x = t < first ? 2 * t : t < second ? 0.5 - (t - first) : -0.3 + 0.5 * (t - second);
    EXPECT_NEAR(frame.states[0].position.x(), x, 1e-9) << t;
  }
  const std::vector<Event> hits = eventsOf(moved, EventKind::impact);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_NEAR(hits[0].time, first, 1e-9);
  EXPECT_NEAR(hits[0].impulse, 2 * 2 * 1.5, 1e-9);
  EXPECT_LT((hits[0].normal - Vec3::UnitX()).norm() + (hits[1].normal + Vec3::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(hits[1].time, second, 1e-9);
  EXPECT_NEAR(moved.frames.back().energy.impact, (4 - 0.25) * 2 / 2, 1e-9);
  expectLedger(moved, 1e-12, 1e-9);
}

/// A box on a slider that is tilted by 30 degrees slides with g/2 to its stop, rests there, and leaves it as its
/// support tilts the other way: here as a push lifts it with more than its weight along the slider.
TEST(JointLimits, SliderRestsAtItsStopAndLeavesIt) {
  const Trajectory moved = runStopped(1, 1e-8, box(""), R"("sliders": [{"bodyA": "box", "anchorB": [0, 0, 0],
      "axis": [0.8660254037844387, 0.5, 0], "limits": {"lower": -0.25}}],
      "pushes": [{"body": "box", "point": [0, 0, 0], "force": [0, 39.24, 0], "start": 0.6, "duration": 0.2}],)");
  const double acceleration = kGravity / 2, reached = std::sqrt(0.5 / acceleration);
  for (const Frame& frame : moved.frames) {
    const double t = frame.time, along = frame.states[0].position.dot(Vec3(std::sqrt(0.75), 0.5, 0));
    const double q = t < reached ? -acceleration * t * t / 2 : -0.25;
    if (t <= 0.6) {
      EXPECT_NEAR(along, q, 1e-8) << t;
    } else if (t <= 0.8) {
      EXPECT_NEAR(along, -0.25 + acceleration * (t - 0.6) * (t - 0.6) / 2, 1e-8) << t;
    }
  }
  EXPECT_NEAR(eventsOf(moved, EventKind::impact).at(0).time, reached, 1e-9);
  EXPECT_NEAR(eventsOf(moved, EventKind::release).at(0).time, 0.6, 1e-9);
  expectLedger(moved, 1e-11, 1e-8);
}

/// A rod pendulum of length 1 m and 2 kg that a hinge stops: by energy it comes to the bottom with w^2 = 3 g / l (1 -
/// cos 60 degrees); with e it goes back with e w, and rises until w^2 e^2 = 3 g / l (1 - cos a).
TEST(JointLimits, HingeStopsAPendulumAtTheBottom) {
  const double tilt = kPi / 3, restitution = 0.6;
  const Trajectory moved = runStopped(
      1.2, 1e-9,
      fmt::format(R"({{"name": "rod", "mass": 2, "shape": {{"capsule": {{"radius": 0.02, "length": 1}}}},
      "inertiaTensor": [[{0}, 0, 0], [0, 1e-3, 0], [0, 0, {0}]], "centerOfMass": [0, 0, 0], "collision": "none",
      "position": [{1}, {2}, 0], "orientation": {{"axis": [0, 0, 1], "angleDegrees": 60}}}})",
                  2.0 / 12, std::sin(tilt) / 2, -std::cos(tilt) / 2),
      fmt::format(R"("hinges": [{{"bodyA": "rod", "anchorA": [0, 0.5, 0], "anchorB": [0, 0, 0], "axis": [0, 0, 1],
      "limits": {{"lower": {}, "restitution": {}}}}}],)",
                  -tilt, restitution));
  const std::vector<Event> hits = eventsOf(moved, EventKind::impact);
  ASSERT_FALSE(hits.empty());
  const double speed = std::sqrt(3 * kGravity * (1 - std::cos(tilt)));
  // The hinge is at the origin: r x p on the rod, whose normal goes from it, is I (1 + e) w, with l^2 m / 3 about the
  // end.
  EXPECT_NEAR(hits[0].point.cross(-hits[0].impulse * hits[0].normal).z(), 2.0 / 3 * (1 + restitution) * speed, 1e-7);
  double least = 0, highest = 0;
  for (const Frame& frame : moved.frames) {
    const double angle = std::atan2(frame.states[0].position.x(), -frame.states[0].position.y());
    least = std::min(least, angle);
    if (frame.time > hits[0].time && (hits.size() < 2 || frame.time < hits[1].time)) highest = std::max(highest, angle);
  }
  EXPECT_GT(least, -1e-9);
  // Between frames it is at most w^2 (0.005 s)^2 / 2 higher, with g / (2 l / 3) for w^2.
  const double rise = std::acos(1 - restitution * restitution * (1 - std::cos(tilt)));
  EXPECT_NEAR(highest, rise, 1.5 * kGravity * std::sin(rise) * 0.005 * 0.005 / 2 + 1e-8);
  const double taken = (1 - restitution * restitution) * speed * speed * (2.0 / 3) / 2;
  for (const Frame& frame : moved.frames)
    if (frame.time > hits[0].time && (hits.size() < 2 || frame.time < hits[1].time)) {
      EXPECT_NEAR(frame.energy.impact, taken, 1e-7);
    }
  expectLedger(moved, 1e-11, 1e-7);
}

/// A wheel that turns five times and a quarter: whole turns are counted.
TEST(JointLimits, HingeCountsWholeTurns) {
  for (const double rate : {30.0, -30.0}) {
    const Trajectory moved =
        runStopped(2, 1e-7, box(fmt::format(R"(, "angularVelocity": [0, 0, {}])", rate)),
                   fmt::format(R"("gravity": [0, 0, 0], "hinges": [{{"bodyA": "box", "anchorB": [0, 0, 0],
      "limits": {{"lower": {}, "upper": {}}}}}],)",
                               -10.5 * kPi, 10.5 * kPi));
    const std::vector<Event> hits = eventsOf(moved, EventKind::impact);
    ASSERT_EQ(hits.size(), 1u);
    EXPECT_NEAR(hits[0].time, 10.5 * kPi / 30, 1e-8);
    EXPECT_LT(moved.frames.back().states[0].angularVelocity.norm(), 1e-12);
  }
}

/// A rotor goes evenly, by more than half a turn in a step where the accuracy is coarse, to a stop several turns away.
TEST(JointLimits, RotorReachesAStopAfterWholeTurnsInLongSteps) {
  for (const double accuracy : {1e-2, 1e-3, 1e-6})
    for (const double speed : {-20.0, 1.0, 5.0})
      for (const double turned : {2.0, 7.0, 10.0, 30.0}) {
        const double time = turned / std::abs(speed), bound = std::copysign(turned, speed);
        const Trajectory moved = runStopped(
            1.5 * time, accuracy, box(fmt::format(R"(, "angularVelocity": [0, 0, {}])", speed)),
            fmt::format(R"("gravity": [0, 0, 0], "hinges": [{{"bodyA": "box", "anchorB": [0, 0, 0], "axis": [0, 0, 1],
            "limits": {{"{}": {}, "restitution": 0.5}}}}],)",
                        speed > 0 ? "upper" : "lower", bound));
        const std::vector<Event> hits = eventsOf(moved, EventKind::impact);
        ASSERT_EQ(hits.size(), 1u) << accuracy << " " << speed << " " << turned;
        EXPECT_NEAR(hits[0].time / time, 1, accuracy);
        const Frame& last = moved.frames.back();
        EXPECT_NEAR(last.joints[0].coordinate, bound - 0.5 * speed * (last.time - time), accuracy * turned);
      }
}

/// A light gate on a heavy one, 1 to 1000: the momentum of both about the hinges' common axis stays in the hit.
TEST(JointLimits, LightBodyStrikesTheStopOfAHeavyOne) {
  const std::string heavy = R"({"name": "heavy", "mass": 2000, "shape": {"box": {"size": [0.2, 0.2, 0.2]}},
      "collision": "none"})";
  const Trajectory moved =
      runStopped(1, 1e-9, box(R"(, "linearVelocity": [1, 0, 0])") + ", " + heavy,
                 R"("gravity": [0, 0, 0], "sliders": [{"bodyA": "box", "bodyB": "heavy", "anchorB": [0, 0, 0],
      "axis": [1, 0, 0], "limits": {"upper": 0.5, "restitution": 1}}],)");
  const Frame& end = moved.frames.back();
  EXPECT_NEAR(end.states[0].linearVelocity.x(), (2.0 - 2000) / 2002, 1e-11);
  EXPECT_NEAR(end.states[1].linearVelocity.x(), 2 * 2.0 / 2002, 1e-12);
  expectLedger(moved, 1e-12, 1e-10);
}

/// A body of 2 kg that a force presses on its stop is struck by one of 1 kg at v: without restitution both go on with
/// v / 3, in steps of one length as at events. The stop does not hold it back.
TEST(JointLimits, LoadedStopHoldsNothingThatLeavesIt) {
  for (const char* method : {"", R"("method": {"name": "rk4", "timeStep": 0.001}, )"}) {
    const Trajectory moved =
        runStopped(0.7, 1e-6, R"({"name": "buffer", "mass": 2, "shape": {"box": {"size": [0.2, 0.2, 0.2]}}},
        {"name": "ball", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "position": [-1, 0, 0],
         "linearVelocity": [2, 0, 0]})",
                   fmt::format(R"({}"gravity": [0, 0, 0], "sliders": [{{"bodyA": "buffer", "anchorB": [0, 0, 0],
        "axis": [1, 0, 0], "limits": {{"lower": 0}}, "motor": {{"force": -1}}}}],)",
                               method));
    // At 0.4 s, and with the force of 1 N on 3 kg from then on.
    EXPECT_NEAR(moved.frames.back().joints[0].velocity, 2.0 / 3 - (0.7 - 0.4) / 3, 1e-6) << method;
  }
}

/// A gate, shut at one stop, that a ball knocks open to the other: the bodies' impact and the gate's later hit.
TEST(JointLimits, BallKnocksAGateOpen) {
  const Trajectory moved =
      runStopped(1.5, 1e-7, R"({"name": "gate", "mass": 1, "shape": {"box": {"size": [1, 0.5, 0.05]}},
      "position": [0.5, 0, 0]},
      {"name": "ball", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "position": [0.8, 0, 1],
       "linearVelocity": [0, 0, -4]})",
                 R"("gravity": [0, 0, 0], "hinges": [{"bodyA": "gate", "anchorA": [-0.5, 0, 0], "anchorB": [0, 0, 0],
      "axis": [0, 1, 0], "limits": {"lower": 0, "upper": 1.2}}],)");
  double most = -1, least = 1;
  for (const Frame& frame : moved.frames) {
    const Vec3 along = frame.states[0].orientation * Vec3::UnitX();
    const double angle = std::atan2(-along.z(), along.x());
    most = std::max(most, angle), least = std::min(least, angle);
  }
  EXPECT_GT(least, -1e-9);
  EXPECT_NEAR(most, 1.2, 1e-7);
  EXPECT_GE(eventsOf(moved, EventKind::impact).size(), 2u);
  expectLedger(moved, 1e-11, 1e-6);
}

/// A lid of 2 kg that lies shut on its stop, with a ball of 1 kg in its middle: a push at its edge opens it if its
/// moment is more than that of both weights, and does not if it is less.
TEST(JointLimits, LidThatRestsOnItsStopOpensWhenItIsPushed) {
  for (const double part : {0.99, 1.01}) {
    const Trajectory moved =
        runStopped(1, 1e-6, R"({"name": "lid", "mass": 2, "shape": {"box": {"size": [0.6, 0.04, 0.4]}}},
      {"name": "ball", "mass": 1, "shape": {"sphere": {"radius": 0.05}}, "position": [0, 0.07, 0]})",
                   fmt::format(R"("hinges": [{{"bodyA": "lid", "anchorA": [-0.3, 0, 0], "anchorB": [-0.3, 0, 0],
      "limits": {{"lower": 0, "upper": 1.5}}}}],
      "pushes": [{{"body": "lid", "point": [0.3, 0, 0], "force": [0, {}, 0], "start": 0.5, "duration": 0.5}}],)",
                               part * 3 * kGravity / 2));
    const double height = moved.frames.back().states[0].position.y();
    if (part < 1) {
      EXPECT_NEAR(height, 0, 1e-9);
    } else {
      EXPECT_GT(height, 1e-3);
    }
    EXPECT_FALSE(eventsOf(moved, EventKind::rest).empty());
  }
}

/// The same stop in steps of contact: never beyond by more than a step's error.
TEST(JointLimits, StopsHoldInContactSteps) {
  const Trajectory moved =
      runStopped(2, 1e-6, box(""), R"("method": {"name": "rk4", "timeStep": 0.001}, "sliders": [{"bodyA": "box",
      "anchorB": [0, 0, 0], "axis": [0, 1, 0], "limits": {"lower": -0.2, "restitution": 0.3}}],)");
  for (const Frame& frame : moved.frames) EXPECT_GT(frame.states[0].position.y(), -0.2 - 1e-6) << frame.time;
  EXPECT_NEAR(moved.frames.back().states[0].position.y(), -0.2, 1e-6);
  expectLedger(moved, 1e-10, 1e-4);
}

/// A bar of any size and weight that falls about its end onto a stop without restitution stays there after one hit,
/// though it presses with 1e-11 N.
TEST(JointLimits, LightestBodiesStayAtTheirStops) {
  for (const double length : {1.0, 1e-2, 1e-4}) {
    const Trajectory moved =
        runStopped(1.5 * std::sqrt(length), 1e-6,
                   fmt::format(R"({{"name": "bar", "mass": {}, "shape": {{"box": {{"size": [{}, {}, {}]}}}},
        "position": [{}, 0, 0], "collision": "none"}})",
                               2 * std::pow(length, 3), 0.4 * length, 0.1 * length, 0.1 * length, 0.2 * length),
                   fmt::format(R"("hinges": [{{"bodyA": "bar", "anchorA": [{}, 0, 0], "anchorB": [0, 0, 0],
        "limits": {{"lower": -0.7}}}}],)",
                               -0.2 * length));
    EXPECT_NEAR(moved.frames.back().joints[0].coordinate, -0.7, 1e-9) << length;
    EXPECT_EQ(moved.events.size(), 1u) << length;
  }
}

/// A light block on a slider that stops it carries the pivot of a body of 1 kg, which goes with it at v = 1 m/s, its
/// centre of mass r across the way. The stop throws the pivot back with e v, whatever the block weighs. About the pivot
/// the body gets the angular velocity m (1 + e) v r / (I + m r^2). Later the body takes it to the stop again.
TEST(JointLimits, LightBlockStopsThePivotOfAHeavyBody) {
  const double arm = 0.3, inertia = (0.04 + 0.01) / 12;
  for (const double restitution : {0.0, 0.5, 1.0})
    for (const double lightness : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
      const Trajectory moved = runStopped(
          0.6, 1e-8,
          fmt::format(R"({{"name": "block", "mass": {}, "shape": {{"box": {{"size": [0.1, 0.1, 0.1]}}}},
        "linearVelocity": [1, 0, 0], "collision": "none"}},
        {{"name": "body", "mass": 1, "shape": {{"box": {{"size": [0.1, 0.2, 0.1]}}}}, "position": [0, -0.3, 0],
        "linearVelocity": [1, 0, 0], "collision": "none"}})",
                      lightness),
          fmt::format(R"("gravity": [0, 0, 0], "sliders": [{{"bodyA": "block", "anchorB": [0, 0, 0], "axis": [1, 0, 0],
        "limits": {{"upper": 0.3, "restitution": {}}}}}],
        "hinges": [{{"bodyA": "body", "anchorA": [0, 0.3, 0], "bodyB": "block", "anchorB": [0, 0, 0]}}],)",
                      restitution));
      const std::string which = fmt::format("restitution {}, {} kg", restitution, lightness);
      const double spin = (1 + restitution) * arm / (inertia + arm * arm);
      const double pivot = -restitution, centre = pivot + spin * arm;  // m/s, along the slider, in the instant after
      EXPECT_NEAR(moved.frames.at(31).energy.impact,
                  0.5 * (1 + lightness) - 0.5 * (lightness * pivot * pivot + centre * centre + inertia * spin * spin),
                  1e-8)
          << which;
      if (restitution == 0) {  // about the pivot, which the body presses against the stop for half a turn
        for (const Frame& frame : moved.frames) {
          if (frame.time < 0.3 + 1e-9) continue;
          EXPECT_NEAR(frame.states[0].position.x(), 0.3, 1e-8) << which;
          EXPECT_NEAR(frame.states[1].angularVelocity.z(), spin, 1e-7) << which << " " << frame.time;
        }
      }
      expectLedger(moved, 1e-9, 1e-6);
    }
}

/// A box at the stop of a level slider on an arm that falls along a slope until that stops it: nothing presses the box
/// against its stop, and nothing takes it away, but for rounding, which makes no events.
TEST(JointLimits, StopThatNothingLoadsIsNoEvent) {
  for (const double accuracy : {1e-3, 1e-6, 1e-8}) {
    const Trajectory moved =
        runStopped(0.5, accuracy, R"({"name": "hand", "motion": "driven", "collision": "none", "position": [0, 1.9, 0],
         "shape": {"sphere": {"radius": 0.1}},
         "oscillation": {"direction": [0, 1, 0], "amplitude": 0.2221409776194208, "frequency": 1.0576459139852903,
         "phase": 5.59453463370967}},
        {"name": "arm", "mass": 0.42, "shape": {"box": {"size": [0.45, 0.26, 0.13]}}, "collision": "none",
         "position": [0.3, 1.618830310534665, 0], "orientation": {"axis": [0, 0, 1], "angleDegrees": 45}},
        {"name": "box", "mass": 0.8, "shape": {"box": {"size": [0.1, 0.2, 0.1]}}, "collision": "none",
         "position": [0.9, 1.618830310534665, 0], "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}})",
                   R"("sliders": [{"bodyA": "arm", "anchorA": [0, 0, 0], "bodyB": "hand", "anchorB": [0.3, -0.14, 0],
         "axis": [0.7071067811865476, 0.7071067811865475, 0], "limits": {"lower": -0.03, "upper": 0, "restitution": 0}},
        {"bodyA": "box", "anchorA": [0, 0.3, 0], "bodyB": "arm", "anchorB": [0.21213203435596426, -0.21213203435596426, 0],
         "axis": [0, -1, 0], "limits": {"lower": -0.08, "upper": 0, "restitution": 0}}],)");
    for (const Frame& frame : moved.frames) EXPECT_NEAR(frame.joints[1].coordinate, 0, 1e-11) << frame.time;
    EXPECT_LE(moved.events.size(), 2U) << accuracy;  // the arm's
  }
}

/// A body of 1 kg at a stop without restitution that a force across gravity presses, however weakly, stays there.
TEST(JointLimits, WeakForceHoldsABodyAtItsStop) {
  for (const double force : {5e-6, 5e-9}) {
    const Trajectory moved = runStopped(
        2000, 1e-6, R"({"name": "box", "mass": 1, "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "collision": "none"})",
        fmt::format(R"("sliders": [{{"bodyA": "box", "anchorB": [0, 0, 0], "axis": [1, 0, 0],
          "limits": {{"upper": 0}}, "motor": {{"force": {}}}}}],)",
                    force));
    EXPECT_NEAR(moved.frames.back().joints[0].coordinate, 0, 1e-9) << force;
    EXPECT_LE(moved.events.size(), 1U);
  }
}

/// Without gravity, a slider on a driven rail that swings lies at its stop as long as the rail pushes it, and leaves it
/// once, at the rail's greatest speed v = A w, to go on with that.
TEST(JointLimits, StopOfASwingingRailLetsGoAtItsGreatestSpeed) {
  const double amplitude = 0.1, rate = 2 * kPi;
  for (const double accuracy : {1e-3, 1e-6, 1e-9}) {
    const Trajectory moved = runStopped(1.2, accuracy, R"({"name": "rail", "motion": "driven", "collision": "none",
        "shape": {"sphere": {"radius": 0.1}}, "oscillation": {"direction": [1, 0, 0], "amplitude": 0.1, "frequency": 1,
        "phase": -1.5707963267948966}},
        {"name": "box", "mass": 1, "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "position": [-0.1, 0, 0], "collision": "none"})",
                                        R"("gravity": [0, 0, 0], "sliders": [{"bodyA": "box", "bodyB": "rail",
          "anchorB": [0, 0, 0], "axis": [1, 0, 0], "limits": {"lower": 0}}],)");
    for (const Frame& frame : moved.frames) {
      const double t = frame.time, turn = 0.25;
      const double x = t < turn ? -amplitude * std::cos(rate * t) : amplitude * rate * (t - turn);
      EXPECT_NEAR(frame.states[1].position.x(), x, 10 * accuracy) << t;
    }
    EXPECT_LE(moved.events.size(), 2U) << accuracy;
  }
}

/// A motor presses a slider against its upper stop, from which it bounces until it lies there. The hinge that carries
/// it lies at a stop of its own, pressed by nothing: that this one is crossed, by rounding, is looked for no farther
/// than up to the next bounce, or the slider would go through its stop.
TEST(JointLimits, StopIsNotPassedWhileAnotherIsLookedFor) {
  for (const double accuracy : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    const Trajectory moved = runStopped(10, accuracy, R"(
        {"name": "a", "mass": 0.5240725914080964, "shape": {"sphere": {"radius": 2.119978468248363}},
         "position": [3.533297447080605, 50.94822335446625, 0], "collision": "none",
         "orientation": {"w": 0.9951241018179657, "x": -0.07533774062114874, "y": 0.05954143164406595, "z": 0.022518097985007757}},
        {"name": "b", "mass": 20.247331441210566, "shape": {"sphere": {"radius": 1.7661759212885149}},
         "position": [10.010221429642069, 50.94822335446625, 0], "orientation": {"axis": [1, 0, 0], "angleDegrees": 90}},
        {"name": "c", "mass": 0.9318771971954372, "shape": {"sphere": {"radius": 2.805059299279237}},
         "position": [17.62894679725499, 50.94822335446625, 0],
         "orientation": {"w": -0.583046919803226, "x": 0.4000703554476019, "y": 0.400070355447602, "z": -0.583046919803226}})",
                                        R"("hinges": [{"bodyA": "a",
          "anchorA": [-3.504661860398961, 0.19004913710432003, -0.4067154033192244], "anchorB": [0, 50.94822335446625, 0],
          "axis": [0.9918955063618252, -0.05378803793078457, 0.11510930212096161],
          "limits": {"lower": -0.29551988391118666, "upper": 0, "restitution": 0.001596303474423188},
          "motor": {"targetVelocity": 0, "maxTorque": 10.024014709401866}}],
        "sliders": [{"bodyA": "b", "anchorA": [-2.943626535480859, 0, 0], "bodyB": "a",
          "anchorB": [3.504661860398961, -0.19004913710430893, 0.406715403319223], "axis": [0, 1, 2.220446049250313e-16],
          "limits": {"lower": -0.1766175921288515, "upper": 0.1766175921288515, "restitution": 0.5}},
         {"bodyA": "c", "anchorA": [1.1102230246251565e-14, 1.6819829472557224, 4.362050258232195], "bodyB": "b",
          "anchorB": [2.943626535480859, 0, 0], "axis": [0, -0.3597748427681178, -0.9330391537932243],
          "limits": {"lower": -0.41815704118842073, "upper": 2.3994514083948193, "restitution": 0.8047104791065666},
          "motor": {"targetVelocity": 1.5737175271736787, "maxForce": 10.993825494759873}}],)");
    for (const Frame& frame : moved.frames) EXPECT_LT(frame.joints[2].coordinate, 2.3994514 + 1e-6) << accuracy;
    EXPECT_NEAR(moved.frames.back().joints[2].coordinate, 2.3994514, 1e-6) << accuracy;
  }
}

}  // namespace
}  // namespace cradle
