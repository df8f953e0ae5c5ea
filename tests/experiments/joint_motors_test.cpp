// Motors of hinges and sliders, against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments/expect_ledger.h"

namespace cradle {
namespace {

Trajectory runMotor(double duration, double accuracy, const std::string& bodies, const std::string& more) {
  return simulate(sceneWith(fmt::format(R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 100}}, {},
    "bodies": [{}])",
                                        duration, accuracy, more, bodies)));
}

/// 2 kg, and 2/60 (0.3^2 + 0.3^2) = 0.03 kg m^2 about its middle.
const char* const kMotorBox =
    R"({"name": "box", "mass": 2, "shape": {"box": {"size": [0.3, 0.3, 0.3]}}, "collision": "none"})";
constexpr double kInertia = 2 * 0.09 / 6;

/// A wheel that a motor of T brings to w: T t / I until it has it at I w / T, and w from then on; the motor's work is I
/// w^2 / 2.
TEST(JointMotors, MotorBringsAWheelToItsVelocity) {
  for (const double target : {8.0, -8.0}) {
    const Trajectory moved =
        runMotor(1, 1e-8, kMotorBox,
                 fmt::format(R"("gravity": [0, 0, 0], "hinges": [{{"bodyA": "box", "anchorB": [0, 0, 0],
      "motor": {{"targetVelocity": {}, "maxTorque": 0.6}}}}])",
                             target));
    const double reached = kInertia * 8 / 0.6, sign = target / 8;
    for (const Frame& frame : moved.frames) {
      const double rate = sign * std::min(0.6 * frame.time / kInertia, 8.0);
      EXPECT_NEAR(frame.states[0].angularVelocity.z(), rate, 1e-8) << frame.time;
      EXPECT_NEAR(frame.energy.work, kInertia * rate * rate / 2, 1e-8);
      const double turning = std::min(frame.time, reached), most = 0.6 / kInertia;
      ASSERT_EQ(frame.joints.size(), 1u);
      EXPECT_NEAR(frame.joints[0].coordinate, sign * (most * turning * turning / 2 + 8 * (frame.time - turning)), 1e-8);
      EXPECT_NEAR(frame.joints[0].velocity, rate, 1e-8);
      if (std::abs(frame.time - reached) > 1e-6) {
        EXPECT_NEAR(frame.joints[0].force, frame.time < reached ? sign * 0.6 : 0, 1e-8) << frame.time;
      }
    }
    expectLedger(moved, 1e-12, 1e-8);
  }
}

/// A constant torque, and a constant force against the weight of a body of 2 kg.
TEST(JointMotors, ConstantForcesAccelerate) {
  const Trajectory turned =
      runMotor(1, 1e-8, kMotorBox, R"("gravity": [0, 0, 0], "hinges": [{"bodyA": "box", "anchorB": [0, 0, 0],
      "motor": {"torque": -0.06}}])");
  EXPECT_NEAR(endOf(turned).angularVelocity.z(), -0.06 / kInertia, 1e-10);
  expectLedger(turned, 1e-13, 1e-10);
  const Trajectory lifted =
      runMotor(1, 1e-8, kMotorBox, R"("sliders": [{"bodyA": "box", "anchorB": [0, 0, 0], "axis": [0, 1, 0],
      "motor": {"force": 20}}])");
  const double acceleration = 10 - kGravity;
  EXPECT_NEAR(endOf(lifted).position.y(), acceleration / 2, 1e-10);
  EXPECT_NEAR(lifted.frames.back().energy.work, 20 * acceleration / 2, 1e-9);
}

/// A motor that is to hold an arm level: it does if it has more than m g r, and if it has less the arm falls with I a =
/// m g r - T at first.
TEST(JointMotors, BrakeHoldsWhatItCan) {
  const double moment = 2 * kGravity * 0.5, inertia = kInertia + 2 * 0.25;
  for (const double part : {1.001, 0.999, 0.5}) {
    const Trajectory moved =
        runMotor(0.1, 1e-9, kMotorBox,
                 fmt::format(R"("hinges": [{{"bodyA": "box", "anchorA": [-0.5, 0, 0], "anchorB": [-0.5, 0, 0],
      "motor": {{"targetVelocity": 0, "maxTorque": {}}}}}])",
                             part * moment));
    const double angle = std::asin(-endOf(moved).position.y() / 0.5), time = moved.frames.back().time;
    const double expected = part > 1 ? 0 : (moment - part * moment) / inertia * time * time / 2;
    // Its moment is less by 1 - cos(angle) on the way.
    EXPECT_NEAR(angle, expected, 1e-10 + expected * expected * expected * moment / ((1 - part) * moment + 1e-9))
        << part;
    expectLedger(moved, 1e-12, 1e-8);
  }
}

/// A motor's force is known where all lies still: it bears an arm of 1 kg, and from 3 ms on a box of 1 kg on its end.
/// The force is that at a lever that a torque turned by less than the accuracy.
TEST(JointMotors, HoldingForceIsKnownAtRest) {
  const Trajectory held = runMotor(0.5, 1e-6, R"(
      {"name": "arm", "mass": 1, "shape": {"box": {"size": [0.4, 0.1, 0.1]}}, "position": [0.2, 0, 0], "material": "m"},
      {"name": "box", "mass": 1, "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "position": [0.3, 0.1001, 0], "material": "m"})",
                                   R"("materials": {"m": {"restitution": 0}}, "hinges": [{"bodyA": "arm",
      "anchorA": [-0.2, 0, 0], "anchorB": [0, 0, 0], "motor": {"targetVelocity": 0, "maxTorque": 100}}])");
  EXPECT_NEAR(held.frames.front().joints[0].force, kGravity * 0.2, 1e-12);
  for (const Frame& frame : held.frames)
    if (frame.time > 0.1) {
      EXPECT_NEAR(frame.joints[0].force, kGravity * 0.5, 2 * kGravity * 1e-6);
    }
  EXPECT_EQ(held.frames.back().states[0].angularVelocity.norm(), 0);
}

/// A body that no force turns, on the axis of one that is led from rest to rest through eight turns in a second, in
/// steps of any length: q = -8 turns in the end.
TEST(JointMotors, CoordinatesCountTurnsOfDrivenBodies) {
  std::string frames = R"({"time": 0})";
  for (int quarter = 1; quarter <= 32; ++quarter)
    frames += fmt::format(R"(, {{"time": {}, "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}}}})",
                          quarter / 32.0, 90 * quarter % 360);
  const Trajectory led = simulate(sceneWith(fmt::format(R"("duration": 1.5, "accuracy": 1e-2, "gravity": [0, 0, 0],
      "output": {{"framesPerSecond": 2}}, "bodies": [
      {{"name": "free", "mass": 1, "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none"}},
      {{"name": "led", "motion": "driven", "keyFrames": [{}], "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none"}}],
      "hinges": [{{"bodyA": "free", "bodyB": "led", "anchorB": [0, 0, 0]}}])",
                                                        frames)));
  EXPECT_NEAR(led.frames.back().joints[0].coordinate, -8 * 2 * std::numbers::pi, 1e-2);
}

/// A motor pulls a body at v against a spring: until k x = F at x = F / k; with all of its force the body then swings
/// about that place, and comes to v again after a period.
TEST(JointMotors, MotorComesToTheEndOfItsForce) {
  const Trajectory moved = runMotor(
      3, 1e-9, kMotorBox, R"("gravity": [0, 0, 0], "sliders": [{"bodyA": "box", "anchorB": [0, 0, 0], "axis": [1, 0, 0],
      "motor": {"targetVelocity": 0.5, "maxForce": 20}}], "springs": [{"bodyA": "box", "anchorB": [-1, 0, 0], "stiffness": 50,
      "restLength": 1}])");
  // From rest m x'' = F - k x brings it to v: x = F / k (1 - cos w t), v = F / k w sin w t.
  const double rate = std::sqrt(50.0 / 2), place = 20.0 / 50;
  const double started = std::asin(0.5 / (place * rate)) / rate, from = place * (1 - std::cos(rate * started));
  const double ended = started + (place - from) / 0.5, again = ended + 2 * std::numbers::pi / rate;
  for (const Frame& frame : moved.frames) {
    const double t = frame.time;
    const double x = t < started ? place * (1 - std::cos(rate * t))
                     : t < ended ? from + 0.5 * (t - started)
                                 : place + 0.5 / rate * std::sin(rate * (t - ended));
    if (t > again) break;
    EXPECT_NEAR(frame.states[0].position.x(), x, 1e-8) << t;
    EXPECT_NEAR(frame.joints[0].coordinate, x, 1e-8);
    EXPECT_NEAR(frame.joints[0].force, t < started || t > ended ? 20 : 50 * x, 1e-6) << t;
  }
  expectLedger(moved, 1e-11, 1e-8);
}

/// A motor turns a rod, I = m l^2 / 3 + m w^2 / 12 about its end, at w, against m g l / 2 sin(q). It has f m g l / 2:
/// at sin(q) = f it is at its end, and I q'^2 / 2 - m g l / 2 cos(q) - T q stays from then on, until the rod is back at
/// w, behind the top of its load, however short that is.
TEST(JointMotors, ForceThatIsMissingForAMomentIsMissed) {
  const double weight = 2 * kGravity / 2, inertia = 2 / 3.0 + 2 * 0.0025 / 12;
  for (const double accuracy : {1e-3, 1e-6, 1e-9})
    for (const double part : {0.9, 0.97, 0.995, 0.999})
      for (const double rate : {0.1, 0.4, 2.0}) {
        const double most = part * weight, end = std::asin(part), duration = 2.2 / rate;
        const Trajectory moved =
            runMotor(duration, accuracy, R"({"name": "rod", "mass": 2, "shape": {"box": {"size": [0.05, 1, 0.05]}},
            "position": [0, -0.5, 0], "collision": "none"})",
                     fmt::format(R"("hinges": [{{"bodyA": "rod", "anchorA": [0, 0.5, 0], "anchorB": [0, 0, 0],
            "motor": {{"targetVelocity": {}, "maxTorque": {}}}}}])",
                                 rate, most));
        const double energy = inertia * rate * rate / 2 - weight * std::cos(end) - most * end;
        int pushing = 0;
        for (const Frame& frame : moved.frames) {
          const auto& [angle, velocity, force] = frame.joints[0];
          EXPECT_LE(force, most * (1 + 1e-6)) << accuracy << " " << part << " " << rate << " at " << frame.time;
          if (angle < end) continue;
          if (velocity > rate * (1 - 1e-9)) continue;
          ++pushing;
          EXPECT_EQ(force, most);
          const double now = inertia * velocity * velocity / 2 - weight * std::cos(angle) - most * angle;
          EXPECT_NEAR(now, energy, 100 * accuracy * weight) << part << " " << rate << " at " << frame.time;
        }
        EXPECT_GT(pushing, 0) << part << " " << rate;
      }
}

/// A motor moves a body at v past the anchor of a spring: what it works is what the spring has, k (r - L)^2 / 2,
/// whatever the length of steps that have no error.
TEST(JointMotors, WorkAgainstASpringIsTheSprings) {
  for (const double accuracy : {1e-3, 1e-6, 1e-9}) {
    const Trajectory moved =
        runMotor(4, accuracy, kMotorBox, R"("gravity": [0, 0, 0], "sliders": [{"bodyA": "box", "anchorB": [0, 0, 0],
        "axis": [1, 0, 0], "motor": {"targetVelocity": 0.5, "maxForce": 1e3}}], "springs": [{"bodyA": "box",
        "anchorB": [1, 1, 0], "stiffness": 20, "restLength": 1.4142135623730951}])");
    for (const Frame& frame : moved.frames) {
      if (frame.time < 0.1) continue;
      const double length = std::hypot(frame.states[0].position.x() - 1, 1), more = length - std::sqrt(2.0);
      EXPECT_NEAR(frame.energy.work, 2 * 0.5 * 0.5 / 2 + 20 * more * more / 2, 10 * accuracy) << frame.time;
      EXPECT_NEAR(frame.energy.numerical, 0, 10 * accuracy) << frame.time;
    }
  }
}

/// Two bodies on a turned slider that a motor drives apart at v, on which nothing acts: no step of any length has an
/// error, and what a step amplifies of rounding is rounding.
TEST(JointMotors, HeldVelocityOfFreeBodiesIsExactInLongSteps) {
  for (const double accuracy : {1e-3, 1e-6, 1e-9}) {
    const double c = std::cos(1.0), s = std::sin(1.0);
    const std::string body = R"("shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "collision": "none",
        "orientation": {"axis": [0, 1, 0], "angleDegrees": 57.29577951308232})";
    const Trajectory moved = runMotor(
        9, accuracy,
        fmt::format(R"({{"name": "a", "mass": 1, "linearVelocity": [{}, 0, {}], {}}},
        {{"name": "b", "mass": 2, "position": [{}, 0, {}], {}}})",
                    -0.5 * c, 0.5 * s, body, c, -s, body),
        R"("gravity": [0, 0, 0], "sliders": [{"bodyA": "a", "bodyB": "b", "anchorA": [1, 0, 0], "anchorB": [0, 0, 0],
        "axis": [1, 0, 0], "motor": {"targetVelocity": -0.5, "maxForce": 0.3}}])");
    for (const Frame& frame : moved.frames) {
      EXPECT_NEAR(frame.joints[0].coordinate, -0.5 * frame.time, 1e-12) << accuracy << " at " << frame.time;
      EXPECT_NEAR(frame.energy.work, 0, 1e-13) << accuracy << " at " << frame.time;
    }
  }
}

/// A torque from rest by every method: w = T t / I, as no step has any energy before it.
TEST(JointMotors, TorqueFromRestByEveryMethod) {
  for (const char* method : {"explicitEuler", "semiImplicitEuler", "rk4"}) {
    const Trajectory moved = runMotor(1, 1e-3, kMotorBox,
                                      fmt::format(R"("gravity": [0, 0, 0], "method": {{"name": "{}", "timeStep": 1e-3}},
        "hinges": [{{"bodyA": "box", "anchorB": [0, 0, 0], "motor": {{"torque": 0.06}}}}])",
                                                  method));
    EXPECT_NEAR(endOf(moved).angularVelocity.z(), 0.06 / kInertia, 1e-9) << method;
  }
}

constexpr double kCarWheel = 0.1, kCarMass = 4 + 4;  // m, kg
constexpr double kCarInertia = kCarMass + 4 * 0.4;   // kg: and 4 I / r^2 of its wheels

struct Car {
  std::string bodies, hinges;
};

/// A board of 4 kg and four balls of 1 kg as wheels on the ground, each with the motor `motorOf(wheel)`.
template <class MotorOf>
Car carWith(const MotorOf& motorOf) {
  Car car{R"({"name": "ground", "material": "m", "shape": {"plane": {}}, "motion": "static"},
      {"name": "board", "mass": 4, "shape": {"box": {"size": [0.8, 0.05, 0.3]}}, "position": [0, 0.1, 0]})",
          ""};
  for (int i = 0; i < 4; ++i) {
    const Vec3 place(i % 2 ? 0.3 : -0.3, kCarWheel, i < 2 ? 0.3 : -0.3);
    car.bodies += fmt::format(
        R"(, {{"name": "w{}", "material": "m", "mass": 1, "shape": {{"sphere": {{"radius": {}}}}}, "position": {}}})",
        i, kCarWheel, vectorText(place));
    car.hinges += fmt::format(
        R"({}{{"bodyA": "board", "anchorA": {}, "bodyB": "w{}", "anchorB": [0, 0, 0], "axis": [0, 0, 1], "motor": {}}})",
        i ? ", " : "", vectorText(place - Vec3(0, 0.1, 0)), i, motorOf(i));
  }
  return car;
}

/// A car with equal motors, from rest up a slope along x.
Trajectory runCar(double duration, double accuracy, double slope, double friction, const std::string& motor,
                  const std::string& method = "") {
  const auto [bodies, hinges] = carWith([&motor](int) { return motor; });
  return runMotor(
      duration, accuracy, bodies,
      fmt::format(
          R"({}"gravity": {}, "materials": {{"m": {{"staticFriction": {}, "dynamicFriction": {}}}}}, "hinges": [{}])",
          method, vectorText(kGravity * Vec3(-std::sin(slope), -std::cos(slope), 0)), friction, friction, hinges));
}

/// Motors of T each drive a car with a = (4 T / r - M g sin) / (M + 4 I / r^2); friction is enough for rolling.
TEST(JointMotors, WheelsDriveACar) {
  for (const double slope : {0.0, 0.1}) {
    const Trajectory moved = runCar(1, 1e-7, slope, 1, R"({"torque": 0.3})");
    const double acceleration = (4 * 0.3 / kCarWheel - kCarMass * kGravity * std::sin(slope)) / kCarInertia;
    for (const Frame& frame : moved.frames)
      EXPECT_NEAR(frame.states[0].position.x(), acceleration * frame.time * frame.time / 2, 1e-6) << frame.time;
    for (const JointState& axle : moved.frames.back().joints) {
      EXPECT_NEAR(axle.coordinate, acceleration / 2 / kCarWheel, 1e-5);
      EXPECT_EQ(axle.force, 0.3);
    }
    EXPECT_NEAR(moved.frames.back().energy.work, 4 * 0.3 * acceleration / 2 / kCarWheel, 1e-5);
    expectLedger(moved, 1e-10, 1e-5);
  }
}

/// A car climbs with motors that hold the wheels at w: with all their torque until it has v = w r, and then at v. A
/// wheel on ice spins at w, and the car slides down: a = g (sin - mu cos).
TEST(JointMotors, CarClimbsASlopeAtItsVelocityAndSlipsOnIce) {
  const double most = 1, slope = 0.3, target = 20;
  for (const double friction : {0.8, 0.05}) {
    const Trajectory moved =
        runCar(2, 1e-6, slope, friction, fmt::format(R"({{"targetVelocity": {}, "maxTorque": {}}})", target, most));
    const Frame& end = moved.frames.back();
    if (friction > 0.5) {
      const double acceleration = (4 * most / kCarWheel - kCarMass * kGravity * std::sin(slope)) / kCarInertia;
      const double velocity = target * kCarWheel, reached = velocity / acceleration;
      for (const Frame& frame : moved.frames) {
        const double t = std::min(frame.time, reached);
        EXPECT_NEAR(frame.states[0].position.x(), acceleration * t * t / 2 + velocity * (frame.time - t), 1e-6);
      }
    } else {
      EXPECT_NEAR(end.states[1].angularVelocity.z(), -target, 1e-6);
      EXPECT_NEAR(end.states[0].linearVelocity.x(), -kGravity * (std::sin(slope) - friction * std::cos(slope)) * 2,
                  1e-6);
    }
    expectLedger(moved, 1e-9, 1e-4);
  }
}

/// The first wheel in steps of a fixed length: within what a step may be off.
TEST(JointMotors, MotorBringsAWheelToItsVelocityInSteps) {
  const Trajectory moved =
      runMotor(1, 1e-8, kMotorBox, R"("gravity": [0, 0, 0], "method": {"name": "rk4", "timeStep": 0.001},
      "hinges": [{"bodyA": "box", "anchorB": [0, 0, 0], "motor": {"targetVelocity": 8, "maxTorque": 0.6}}])");
  for (const Frame& frame : moved.frames)
    EXPECT_NEAR(frame.states[0].angularVelocity.z(), std::min(0.6 * frame.time / kInertia, 8.0), 0.02) << frame.time;
  EXPECT_NEAR(moved.frames.back().states[0].angularVelocity.z(), 8, 1e-9);
}

/// The car that climbs, in steps h of a fixed length, in which motors are rows of the contact problem. They and
/// contacts give way by 1e-3 of what their load would do in a step: by T h / I about the axle, and by T h / r (1 / m +
/// r^2 / I) at the contact, 2e-5 of the velocity together. What the load's changes take on the way up is of the order
/// of h.
TEST(JointMotors, CarClimbsInSteps) {
  const double slope = 0.3, target = 20, timeStep = 1e-3, velocity = target * kCarWheel;
  const Trajectory moved =
      runCar(2, 1e-6, slope, 0.8, fmt::format(R"({{"targetVelocity": {}, "maxTorque": 1}})", target),
             fmt::format(R"("method": {{"name": "rk4", "timeStep": {}}}, )", timeStep));
  const double holding = kCarMass * kGravity * std::sin(slope) * kCarWheel / 4;
  const double inertia = 0.4 * kCarWheel * kCarWheel, load = 1e-3 * holding * timeStep;  // of wheels of 1 kg
  const double slower = load / inertia / target + load / kCarWheel * (1 + 1 / 0.4) / velocity;
  const double acceleration = (4 / kCarWheel - kCarMass * kGravity * std::sin(slope)) / kCarInertia;
  const double reached = velocity / acceleration;
  ASSERT_LT(reached, 1.5);
  for (const Frame& frame : moved.frames) {
    const double t = std::min(frame.time, reached);
    EXPECT_NEAR(frame.states[0].position.x(), acceleration * t * t / 2 + velocity * (frame.time - t),
                velocity * (timeStep + slower * frame.time));
    if (frame.time < reached + 0.1) continue;
    EXPECT_NEAR(frame.states[0].linearVelocity.x(), velocity, 1.2 * slower * velocity);
    for (const JointState& axle : frame.joints) {
      EXPECT_NEAR(axle.velocity, target, 1.2 * slower * target);
      EXPECT_NEAR(std::abs(axle.force), holding, 0.01 * holding) << frame.time;
    }
  }
  expectLedger(moved, 1e-6, 1e-3);
}

/// The car of constant torques by contact steps, which move it by the mean of velocities whatever the order of the
/// method: x = a t^2 / 2 to rounding and what is taken for energy that contact would give, 1e-8 J a step.
TEST(JointMotors, WheelsDriveACarByEveryMethod) {
  for (const std::string method : {"explicitEuler", "semiImplicitEuler", "rk4"}) {
    const Trajectory moved = runCar(1, 1e-6, 0.1, 1, R"({"torque": 0.3})",
                                    fmt::format(R"("method": {{"name": "{}", "timeStep": 0.001}}, )", method));
    const double acceleration = (4 * 0.3 / kCarWheel - kCarMass * kGravity * std::sin(0.1)) / kCarInertia;
    EXPECT_NEAR(moved.frames.back().states[0].position.x(), acceleration / 2, 1e-6) << method;
  }
}

/// Motors that are too weak push with all they have, and the car rolls back.
TEST(JointMotors, WeakMotorsLetACarRollBackInSteps) {
  const double slope = 0.3, timeStep = 1e-3;
  const Trajectory moved = runCar(1, 1e-6, slope, 0.8, R"({"targetVelocity": 20, "maxTorque": 0.3})",
                                  fmt::format(R"("method": {{"name": "rk4", "timeStep": {}}}, )", timeStep));
  const double acceleration = (4 * 0.3 / kCarWheel - kCarMass * kGravity * std::sin(slope)) / kCarInertia;
  for (const Frame& frame : moved.frames) {
    EXPECT_NEAR(frame.states[0].linearVelocity.x(), acceleration * frame.time, -2 * acceleration * timeStep);
    for (const JointState& axle : frame.joints) EXPECT_NEAR(std::abs(axle.force), 0.3, 1e-12);
  }
  expectLedger(moved, 1e-6, 1e-3);
}

/// A wheel of r = 0.2 m and 2 kg, in a fork of no more than 1 kg that goes up and down, stands on a belt that its
/// friction makes it follow: mu (m + m_f) g r and the motor's T both turn it towards a target that is faster than the
/// belt. In contact steps too the motor does not hold it back.
TEST(JointMotors, MotorPushesOnWhereFrictionHelpsItInSteps) {
  constexpr double kTorque = 0.3, kFriction = 0.1, kRadius = 0.2, kWheelInertia = 0.4 * 2 * kRadius * kRadius;
  for (const double sign : {1.0, -1.0}) {
    const Trajectory moved = runMotor(
        0.1, 1e-3,
        fmt::format(
            R"({{"name": "belt", "shape": {{"box": {{"size": [9, 1, 1]}}}}, "position": [0, -0.5, 0], "motion": "driven", "material": "m",
        "linearVelocity": [{}, 0, 0]}}, {{"name": "wheel", "mass": 2, "material": "m", "shape": {{"sphere": {{"radius": 0.2}}}}, "position":
        [0, 0.2, 0]}}, {{"name": "fork", "mass": 1, "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none",
        "position": [0, 0.2, 0]}})",
            2 * sign),
        fmt::format(R"("materials": {{"m": {{"staticFriction": {0}, "dynamicFriction": {0}, "restitution": 0}}}},
        "method": {{"name": "semiImplicitEuler", "timeStep": 0.001}},
        "sliders": [{{"bodyA": "fork", "anchorB": [0, 0.2, 0], "axis": [0, 1, 0]}}],
        "hinges": [{{"bodyA": "wheel", "bodyB": "fork", "anchorB": [0, 0, 0], "axis": [0, 0, 1],
        "motor": {{"targetVelocity": {1}, "maxTorque": {2}}}}}])",
                    kFriction, 40 * sign, kTorque));
    const double rate = (kTorque + kFriction * 3 * kGravity * kRadius) / kWheelInertia;
    for (const Frame& frame : moved.frames) {
      if (frame.time == 0) continue;
      EXPECT_NEAR(frame.states[1].angularVelocity.z(), sign * rate * frame.time, 1e-3 * rate) << frame.time;
      EXPECT_NEAR(frame.joints[0].force, sign * kTorque, 1e-9) << frame.time;
    }
  }
}

/// Three bodies on hinges, the upper two on each other's edges from 2 s on: contact is resolved in steps then, and
/// events are tried again and again. A frame inside the last step before a trial belongs to that step: far below its
/// target, the motor pushes with all it has in each.
TEST(JointMotors, FramesBeforeATrialOfEventsHaveTheForcesOfTheirStep) {
  const Trajectory run = simulate(sceneWith(R"("duration": 3, "accuracy": 1e-5, "output": {"framesPerSecond": 977},
    "materials": {"m": {"staticFriction": 0, "dynamicFriction": 0}},
    "bodies": [{"name": "lower", "shape": {"cylinder": {"radius": 2.1101312, "length": 7.5321196}}, "material":
    "m", "position": [62.746284, 49.126532, -1.9547938], "orientation": {"w": 0.52287965, "x": 0.16594409, "y":
    -0.37007215, "z": -0.74973731}, "mass": 84.000492}, {"name": "middle", "shape": {"box": {"size": [5.357652,
    3.9177492, 4.4512147]}}, "material": "m", "position": [73.246284, 47.626532, 1.0452062], "orientation":
    {"w": 0.97827059, "x": 0.11978288, "y": 0.035225012, "z": -0.16552313}, "mass": 42.974069}, {"name":
    "upper", "shape": {"cylinder": {"radius": 2.293634, "length": 11.597637}}, "material": "m", "position":
    [83.746284, 46.126532, 4.0452062], "orientation": {"w": 0.66771619, "x": 0.14394257, "y": -0.66341919, "z":
    0.30546784}}], "hinges": [{"bodyA": "lower", "anchorA": [1.0069594, -4.6262685, 2.5794713], "anchorB":
    [57.646284, 50.026532, -3.4547938], "axis": [-0.64646981, 0.66719024, 0.61917051], "limits": {"lower":
    -0.26114553, "upper": 0.13112267, "restitution": 0.5}}, {"bodyA": "middle", "anchorA": [-4.9288986,
    -1.2038779, -1.823907], "bodyB": "lower", "anchorB": [-1.3984553, 4.7708491, -2.6558091], "axis":
    [-0.72062603, -0.047947092, 0.33520097], "motor": {"targetVelocity": 1.6983637, "maxTorque": 58532330.0}},
    {"bodyA": "upper", "anchorA": [-0.92454451, 4.0688601, 3.4146149], "bodyB": "middle", "anchorB": [5.1170911,
    1.5785178, 1.7588803], "axis": [-2.0008517, 0.85309991, -0.13955584]}]
    )"));
  long slow = 0;
  for (const Frame& frame : run.frames) {
    if (frame.time == 0 || std::abs(frame.joints[1].velocity) > 1.6) continue;
    ++slow;
    EXPECT_NEAR(frame.joints[1].force, 58532330, 1) << frame.time;
  }
  EXPECT_GT(slow, 100);
}

/// A crank of 0.25 m from (0, 0), a coupler of 1 m and a rocker of 0.8 m from (0.85, 0), at right angles to the line of
/// the pivots at the start. Their coordinates keep the coupler's length; the motor's work is the integral of its force
/// over the crank's coordinate. Both ends of an interval in which the motor comes to its target have forces that
/// differ: that interval is left out.
TEST(JointMotors, CoordinatesAndForcesOfAFourBarLinkage) {
  const auto bar = [](const char* name, double mass, const char* size, const char* place, double angle) {
    return fmt::format(
        R"({{"name": "{}", "mass": {}, "shape": {{"box": {{"size": {}}}}}, "position": {}, "collision": "none",
        "orientation": {{"axis": [0, 0, 1], "angleDegrees": {:.17g}}}}})",
        name, mass, size, place, angle);
  };
  const Trajectory run = simulate(
      sceneWith(R"("duration": 2, "accuracy": 1e-9, "output": {"framesPerSecond": 500}, "bodies": [)" +
                bar("crank", 1, "[0.25, 0.1, 0.1]", "[0.125, 0, 0]", 0) + ", " +
                bar("coupler", 2, "[1, 0.1, 0.1]", "[0.55, 0.4, 0]", std::atan2(4, 3) * 180 / std::numbers::pi) + ", " +
                bar("rocker", 3, "[0.1, 0.8, 0.1]", "[0.85, 0.4, 0]", 0) + R"(], "hinges": [
        {"bodyA": "crank", "anchorA": [-0.125, 0, 0], "anchorB": [0, 0, 0], "motor": {"targetVelocity": 4, "maxTorque": 40}},
        {"bodyA": "rocker", "anchorA": [0, -0.4, 0], "anchorB": [0.85, 0, 0]},
        {"bodyA": "coupler", "anchorA": [-0.5, 0, 0], "bodyB": "crank", "anchorB": [0.125, 0, 0]}],
        "ballJoints": [{"bodyA": "coupler", "anchorA": [0.5, 0, 0], "bodyB": "rocker", "anchorB": [0, 0.4, 0]}])"));
  double work = 0, reached = -1;
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const std::vector<JointState>& joints = run.frames[i].joints;
    const double crank = joints[0].coordinate, rocker = joints[1].coordinate;
    const Vec3 pin = 0.25 * Vec3(std::cos(crank), std::sin(crank), 0),
               end = Vec3(0.85, 0, 0) + 0.8 * Vec3(-std::sin(rocker), std::cos(rocker), 0);
    EXPECT_NEAR((end - pin).norm(), 1, 1e-8) << run.frames[i].time;
    if (reached < 0 && std::abs(joints[0].velocity - 4) < 1e-6) reached = run.frames[i].time;
    if (reached < 0 || i < 2 || run.frames[i - 2].time < reached || i % 2) continue;
    const double first = run.frames[i - 2].joints[0].force, middle = run.frames[i - 1].joints[0].force;
    work += 4 * (run.frames[i].time - run.frames[i - 2].time) / 6 * (first + 4 * middle + joints[0].force);  // Simpson
    if (run.frames[i - 2].time < reached + 0.0041) work = run.frames[i].energy.work;
    EXPECT_NEAR(run.frames[i].energy.work, work, 1e-5) << run.frames[i].time;
  }
  EXPECT_GT(reached, 0);
  EXPECT_GT(run.frames.back().joints[0].coordinate, 2 * std::numbers::pi);
  expectLedger(run, 1e-10, 1e-6);
}

const char* const kEveryMethod[] = {R"("accuracy": 1e-3)", R"("accuracy": 1e-6)", R"("accuracy": 1e-9)",
                                    R"("method": {"name": "rk4", "timeStep": 0.001})"};

Trajectory runMotors(double duration, const std::string& method, const std::string& bodies, const std::string& joints) {
  return simulate(
      sceneWith(fmt::format(R"("duration": {}, {}, "output": {{"framesPerSecond": 100}}, "bodies": [{}], {})", duration,
                            method, bodies, joints)));
}

/// Two bodies of 1 kg in a row: the first pushes off the world with 1 N to come to 2 m/s, the second off the first with
/// up to 3 N to come to -0.5 m/s. With both forces the second comes to it after 1/14 s, v = (4, -3) t and v2 - v1 = -7
/// t; from then on both go as one, with 1/2 m/s^2 and a force of 1/2 N between them.
TEST(JointMotors, MotorsInARow) {
  for (const char* method : kEveryMethod) {
    const Trajectory moved = runMotors(1, method, R"(
        {"name": "a", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "collision": "none"},
        {"name": "b", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "collision": "none"})",
                                       R"("gravity": [0, 0, 0], "sliders": [
        {"bodyA": "a", "anchorB": [0, 0, 0], "axis": [1, 0, 0], "motor": {"targetVelocity": 2, "maxForce": 1}},
        {"bodyA": "b", "bodyB": "a", "anchorB": [0, 0, 0], "axis": [1, 0, 0], "motor": {"targetVelocity": -0.5, "maxForce": 3}}])");
    const std::vector<JointState>& joints = moved.frames.back().joints;
    EXPECT_NEAR(joints[0].velocity, 4.0 / 14 + 13.0 / 28, 1e-3) << method;
    EXPECT_NEAR(joints[1].velocity, -0.5, 1e-3) << method;
    EXPECT_NEAR(joints[0].force, 1, 1e-6) << method;
    EXPECT_NEAR(joints[1].force, 0.5, 1e-3) << method;
  }
}

/// Two motors against each other on one body: the weaker gives all it has, and the stronger has its way.
TEST(JointMotors, StrongerMotorHasItsWay) {
  for (const char* method : kEveryMethod) {
    const Trajectory moved =
        runMotors(1, method, R"({"name": "a", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "collision": "none"})",
                  R"("gravity": [0, 0, 0], "sliders": [
        {"bodyA": "a", "anchorB": [0, 0, 0], "axis": [1, 0, 0], "motor": {"targetVelocity": 0.5, "maxForce": 10}},
        {"bodyA": "a", "anchorB": [0, 0, 0], "axis": [1, 0, 0], "motor": {"targetVelocity": -1, "maxForce": 5}}])");
    EXPECT_NEAR(moved.frames.back().joints[0].velocity, 0.5, 1e-5) << method;
    EXPECT_NEAR(moved.frames.back().joints[0].force, 5, 1e-4) << method;
    EXPECT_NEAR(moved.frames.back().joints[1].force, -5, 1e-4) << method;
  }
}

/// Three links of 1 kg and 0.4 m that fall from the level are led to velocities by motors with room to spare: 1 s later
/// each coordinate is what its velocity makes of it, less than what full torque needs to bring it there.
TEST(JointMotors, ArmComesToItsVelocities) {
  for (const char* method : kEveryMethod) {
    std::string links, hinges;
    for (int i = 0; i < 3; ++i) {
      links += fmt::format(R"({}{{"name": "l{}", "mass": 1, "shape": {{"box": {{"size": [0.4, 0.05, 0.05]}}}},
          "position": [{}, 0, 0], "collision": "none"}})",
                           i ? ", " : "", i, 0.2 + 0.4 * i);
      hinges +=
          fmt::format(R"({}{{"bodyA": "l{}", "anchorA": [-0.2, 0, 0], {}, "motor": {{"targetVelocity": {},
          "maxTorque": 100}}}})",
                      i ? ", " : "", i,
                      i ? fmt::format(R"("bodyB": "l{}", "anchorB": [0.2, 0, 0])", i - 1) : R"("anchorB": [0, 0, 0])",
                      i == 1 ? -1 : 1);
    }
    const Trajectory moved = runMotors(1, method, links, R"("hinges": [)" + hinges + "]");
    for (int i = 0; i < 3; ++i) {
      const JointState& joint = moved.frames.back().joints[static_cast<std::size_t>(i)];
      EXPECT_NEAR(joint.velocity, i == 1 ? -1 : 1, 1e-4) << method;
      EXPECT_NEAR(joint.coordinate, i == 1 ? -1 : 1, 0.03) << method;
    }
  }
}

/// Brakes of 2 N m each and one motor of 1: the car stands where it is, whoever bears it.
TEST(JointMotors, BrakesHoldACarAgainstItsMotor) {
  const auto [bodies, hinges] = carWith([](int wheel) {
    return fmt::format(R"({{"targetVelocity": {}, "maxTorque": {}}})", wheel ? 0 : 10, wheel ? 2 : 1);
  });
  for (const char* method : kEveryMethod) {
    const Trajectory moved = runMotors(
        0.5, method, bodies,
        fmt::format(R"("materials": {{"m": {{"staticFriction": 0.8, "dynamicFriction": 0.8}}}}, "hinges": [{}])",
                    hinges));
    EXPECT_NEAR(moved.frames.back().states[0].position.x(), 0, 1e-4) << method;
    for (const JointState& axle : moved.frames.back().joints) EXPECT_LE(std::abs(axle.force), 2);
  }
}

/// A wheel that touches nothing on a box that rests on the floor: it spins, and its motor turns it.
TEST(JointMotors, WheelOnABoxAtRestTurns) {
  for (const std::string motor : {"", R"(, "motor": {"torque": 0.001})"}) {
    const Trajectory moved = runMotors(1, R"("accuracy": 1e-6)", R"(
        {"name": "floor", "shape": {"plane": {}}, "motion": "static"},
        {"name": "box", "mass": 5, "shape": {"box": {"size": [0.4, 0.4, 0.4]}}, "position": [0, 0.2, 0]},
        {"name": "wheel", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.5, 0], "collision": "none",
         "angularVelocity": [0, 5, 0]})",
                                       R"("hinges": [{"bodyA": "wheel", "bodyB": "box", "anchorB": [0, 0.3, 0],
        "axis": [0, 1, 0])" + motor + "}]");
    const double gained = motor.empty() ? 0 : 0.001 / (0.4 * 0.01);
    EXPECT_NEAR(moved.frames.back().joints[0].velocity, 5 + gained, 1e-6) << motor;
    EXPECT_NEAR(moved.frames.back().joints[0].coordinate, 5 + gained / 2, 1e-6) << motor;
  }
}

/// A motor lifts a body against a stop and presses it there with all that it has: one impact, and no more.
TEST(JointMotors, MotorPressesAgainstAStop) {
  for (const char* method : kEveryMethod) {
    const Trajectory moved =
        runMotors(1, method, R"({"name": "a", "mass": 2, "shape": {"sphere": {"radius": 0.1}}, "collision": "none"})",
                  R"("sliders": [{"bodyA": "a", "anchorB": [0, 0, 0], "axis": [0, 1, 0], "limits": {"upper": 0.3},
        "motor": {"targetVelocity": 0.5, "maxForce": 30}}])");
    EXPECT_NEAR(moved.frames.back().joints[0].coordinate, 0.3, 1e-9) << method;
    EXPECT_EQ(moved.frames.back().joints[0].force, 30) << method;
    EXPECT_EQ(std::count_if(moved.events.begin(), moved.events.end(),
                            [](const Event& event) { return event.kind == EventKind::impact; }),
              1)
        << method;
  }
}

/// A motor of any strength lifts an arm of 30 kg to its stop, and with it a ball that bounces and rolls on it. Pressed
/// against the stop it works nothing, whatever errors of steps there are in the arm's velocity.
TEST(JointMotors, StrongMotorWorksNothingAtItsStop) {
  for (const double accuracy : {1e-3, 1e-6, 1e-9})
    for (const double most : {1e6, 1e9, 1e12}) {
      const Trajectory moved = runMotor(
          0.4, accuracy,
          R"({"name": "arm", "shape": {"box": {"size": [1, 0.1, 0.3]}}, "mass": 30, "material": "arm", "position": [0, 0.6, 0]},
          {"name": "ball", "shape": {"sphere": {"radius": 0.22}}, "mass": 13, "material": "ball", "position": [0.234, 0.87, 0.029]})",
          fmt::format(R"("materials": {{"arm": {{"restitution": 0, "staticFriction": 1, "dynamicFriction": 1}},
          "ball": {{"restitution": 1, "staticFriction": 0.5, "dynamicFriction": 0.35}}}},
          "hinges": [{{"bodyA": "arm", "anchorA": [-0.45, 0, 0], "axis": [0, 0, 1], "anchorB": [-0.45, 0.6, 0],
          "motor": {{"targetVelocity": 1, "maxTorque": {}}}, "limits": {{"lower": -0.2, "upper": 0.2263}}}}])",
                      most));
      EXPECT_NEAR(moved.frames.back().joints[0].coordinate, 0.2263, 1e-9);
      EXPECT_LT(std::abs(moved.frames.back().energy.numerical), accuracy * moved.frames.back().energy.work + 1e-8)
          << accuracy << " " << most;
    }
}

/// A motor of 1e9 N has a body of 2 kg at 3 m/s after 6 ns, one of 1e15 N at once. A wall of 4 kg, struck without
/// restitution, leaves both at 1 m/s and 6 J less, and 12 ns later the motor has both at 3 m/s: 21 nm less on the way.
TEST(JointMotors, StrongMotorIsAtItsTargetAtOnce) {
  for (const double force : {1e9, 1e15}) {
    const bool meetsWall = force < 1e10;
    const Trajectory moved =
        runMotor(1, 1e-6,
                 fmt::format(R"({{"name": "a", "mass": 2, "shape": {{"sphere": {{"radius": 0.1}}}}}},
        {{"name": "b", "mass": 4, "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [1.75, {}, 0]}})",
                             meetsWall ? 0 : 1),
                 fmt::format(R"("gravity": [0, 0, 0], "sliders": [{{"bodyA": "a", "anchorB": [0, 0, 0],
        "axis": [1, 0, 0], "motor": {{"targetVelocity": 3, "maxForce": {}}}}}])",
                             force));
    for (const Frame& frame : moved.frames) {
      if (frame.number == 0) continue;
      const bool hasMet = meetsWall && frame.time > 1.55 / 3;
      EXPECT_NEAR(frame.states[0].linearVelocity.x(), 3, 1e-11) << frame.time;
      EXPECT_NEAR(frame.states[0].position.x(), 3 * frame.time, 2.2e-8);
      EXPECT_NEAR(frame.states[1].linearVelocity.x(), hasMet ? 3 : 0, 1e-11);
      EXPECT_NEAR(frame.energy.work, hasMet ? 9 + 6 * (9 - 1) / 2 : 9, 1e-10);
      EXPECT_NEAR(frame.energy.impact, hasMet ? 9 - 3 : 0, 1e-10);
    }
    expectLedger(moved, 1e-11, 1e-10);
  }
}

/// Velocities that motors hold, in all frames of a swinging arm, however far inside a step: to rounding.
TEST(JointMotors, HeldVelocitiesAreExactInAllFrames) {
  for (const double accuracy : {1e-3, 1e-6}) {
    const Trajectory moved = simulate(sceneWith(fmt::format(R"("duration": 1, "accuracy": {},
      "output": {{"framesPerSecond": 1000}}, "bodies": [
        {{"name": "a", "mass": 1, "shape": {{"box": {{"size": [0.4, 0.05, 0.1]}}}}, "position": [0.2, 0, 0], "collision": "none"}},
        {{"name": "b", "mass": 1, "shape": {{"box": {{"size": [0.4, 0.05, 0.1]}}}}, "position": [0.6, 0, 0], "collision": "none"}}],
      "hinges": [{{"bodyA": "a", "anchorA": [-0.2, 0, 0], "anchorB": [0, 0, 0]}},
        {{"bodyA": "b", "anchorA": [-0.2, 0, 0], "bodyB": "a", "anchorB": [0.2, 0, 0], "axis": [0, 1, 1],
         "motor": {{"targetVelocity": 5, "maxTorque": 1000}}}}])",
                                                            accuracy)));
    for (const Frame& frame : moved.frames)
      if (frame.time > 0.01) {
        EXPECT_NEAR(frame.joints[1].velocity, 5, 1e-12) << frame.time;
        EXPECT_GT(std::abs(frame.joints[0].velocity), 0.01) << frame.time;
      }
  }
}

/// A motor lowers a pole of 1 kg and l on a cart of 1 kg that is free along x, at a constant rate w: the centre of mass
/// of both stays over its place, and the cart is at (l / 4) (1 - cos(w t)). Bodies of all sizes take the same few
/// steps: with forces that are known less well than to rounding, those of 1 km would take no end of them.
TEST(JointMotors, HoldsLargeBodiesAtTheirRateAsWellAsSmallOnes) {
  for (const double length : {0.01, 1.0, 1000.0}) {
    const double most = kGravity * length * length;
    const Trajectory moved = runMotor(
        1.5, 1e-11,
        fmt::format(
            R"({{"name": "cart", "mass": 1, "shape": {{"box": {{"size": [{0}, {0}, {0}]}}}}, "collision": "none"}},
        {{"name": "pole", "mass": 1, "shape": {{"box": {{"size": [{1}, {0}, {0}]}}}}, "collision": "none",
        "position": [{2}, 0, 0], "linearVelocity": [0, {3}, 0], "angularVelocity": [0, 0, -0.65]}})",
            0.1 * length, length, length / 2, -0.65 * length / 2),
        fmt::format(R"("gravity": [0, {}, 0], "sliders": [{{"bodyA": "cart", "anchorB": [0, 0, 0], "axis": [1, 0, 0]}}],
        "hinges": [{{"bodyA": "pole", "anchorA": [{}, 0, 0], "bodyB": "cart", "anchorB": [0, 0, 0],
        "motor": {{"targetVelocity": -0.65, "maxTorque": {}}}}}])",
                    -kGravity * length, -length / 2, most));
    for (const Frame& frame : moved.frames)
      EXPECT_NEAR(frame.states[0].position.x() / length, (1 - std::cos(0.65 * frame.time)) / 4, 1e-9) << length;
  }
}

/// A motor of 5 N that brakes the fall of a plate of 3 kg to 0.5 m/s pushes it down once it lies on a box: it has not
/// its velocity there.
TEST(JointMotors, MotorPressesWhatItHasBrakedBefore) {
  const Trajectory moved = runMotor(0.5, 1e-6, R"({"name": "floor", "shape": {"plane": {}}, "motion": "static"},
        {"name": "box", "mass": 1, "shape": {"box": {"size": [0.4, 0.4, 0.4]}}, "position": [0, 0.2, 0]},
        {"name": "plate", "mass": 3, "shape": {"box": {"size": [1, 0.1, 1]}}, "position": [0, 0.6, 0]})",
                                    R"("sliders": [{"bodyA": "plate", "anchorB": [0, 0.6, 0], "axis": [0, 1, 0],
        "motor": {"targetVelocity": -0.5, "maxForce": 5}}])");
  EXPECT_NEAR(moved.frames[10].joints[0].force, 5, 1e-9);
  EXPECT_NEAR(moved.frames[10].joints[0].velocity, -0.5 - (kGravity - 5.0 / 3) * (0.1 - 0.5 / (kGravity + 5.0 / 3)),
              1e-6);
  EXPECT_EQ(moved.frames.back().joints[0].force, -5);
  EXPECT_FALSE(eventsOf(moved, EventKind::rest).empty());
}

/// A box that slides with mu g as a motor on it, which touches nothing, comes to its target.
TEST(JointMotors, MotorComesToItsTargetOnASlidingBox) {
  const double friction = 0.4;
  const Trajectory moved =
      runMotor(0.5, 1e-8, R"({"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "m"},
        {"name": "box", "mass": 3, "shape": {"box": {"size": [0.6, 0.2, 0.6]}}, "position": [0, 0.1, 0],
         "linearVelocity": [2.5, 0, 0], "material": "m"},
        {"name": "wheel", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.3, 0], "collision": "none",
         "linearVelocity": [2.5, 0, 0]})",
               R"("materials": {"m": {"staticFriction": 0.4, "dynamicFriction": 0.4}},
         "hinges": [{"bodyA": "wheel", "bodyB": "box", "anchorB": [0, 0.2, 0],
        "motor": {"targetVelocity": -4, "maxTorque": 0.2}}])");
  const double reached = 4 * 0.004 / 0.2, deceleration = friction * kGravity;
  for (const Frame& frame : moved.frames) {
    EXPECT_NEAR(frame.states[0].position.x(), 2.5 * frame.time - deceleration * frame.time * frame.time / 2, 1e-7);
    EXPECT_NEAR(frame.joints[0].velocity, -4 * std::min(1.0, frame.time / reached), 1e-7) << frame.time;
  }
}

/// A motor of 10 N between bodies of 1 and 1000 kg that float brings them to 2 m/s against each other after 2 mu / F,
/// mu the reduced mass 1000/1001 kg: with momentum zero, and mu v^2 / 2 of work.
TEST(JointMotors, MotorPartsALightBodyFromAHeavyOne) {
  const double reduced = 1000.0 / 1001, target = 2, reached = reduced * target / 10;
  for (const bool isLightA : {true, false}) {
    const Trajectory moved =
        runMotor(1, 1e-8, R"({"name": "light", "mass": 1, "shape": {"sphere": {"radius": 0.1}}, "collision": "none"},
        {"name": "heavy", "mass": 1000, "shape": {"sphere": {"radius": 0.1}}, "collision": "none"})",
                 fmt::format(R"("gravity": [0, 0, 0], "sliders": [{{"bodyA": "{}", "bodyB": "{}", "anchorB": [0, 0, 0],
        "axis": [1, 0, 0], "motor": {{"targetVelocity": 2, "maxForce": 10}}}}])",
                             isLightA ? "light" : "heavy", isLightA ? "heavy" : "light"));
    const double sign = isLightA ? 1 : -1;
    for (const Frame& frame : moved.frames) {
      const double speed = target * std::min(1.0, frame.time / reached);
      EXPECT_NEAR(frame.states[0].linearVelocity.x(), sign * speed * reduced, 1e-9) << frame.time;
      EXPECT_NEAR(frame.states[1].linearVelocity.x(), -sign * speed * reduced / 1000, 1e-12);
      EXPECT_NEAR(frame.energy.work, reduced * speed * speed / 2, 1e-9);
    }
    expectLedger(moved, 1e-12, 1e-9);
  }
}

/// A box with a wheel that its motor turns goes with a table that swings by half of what friction holds, and the table
/// works what its velocity asks for.
TEST(JointMotors, FrictionCarriesABoxWithAMotor) {
  const double rate = 2 * std::numbers::pi, amplitude = 0.05, fastest = amplitude * rate;
  const Trajectory moved =
      runMotor(1, 1e-8,
               fmt::format(R"({{"name": "table", "material": "m", "shape": {{"box": {{"size": [2, 0.2, 2]}}}},
         "motion": "driven", "oscillation": {{"direction": [1, 0, 0], "amplitude": {}, "frequency": 1}}}},
        {{"name": "box", "mass": 3, "material": "m", "shape": {{"box": {{"size": [0.6, 0.2, 0.6]}}}},
         "position": [0, 0.2, 0], "linearVelocity": [{}, 0, 0]}},
        {{"name": "wheel", "mass": 1, "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [0, 0.4, 0],
         "collision": "none", "linearVelocity": [{}, 0, 0]}})",
                           amplitude, fastest, fastest),
               R"("materials": {"m": {"staticFriction": 0.4, "dynamicFriction": 0.4}},
         "hinges": [{"bodyA": "wheel", "bodyB": "box", "anchorB": [0, 0.2, 0], "axis": [0, 1, 0],
        "motor": {"targetVelocity": -4, "maxTorque": 0.2}}])");
  for (const Frame& frame : moved.frames) {
    EXPECT_NEAR(frame.states[1].position.x(), amplitude * std::sin(rate * frame.time), 1e-8) << frame.time;
    const double velocity = fastest * std::cos(rate * frame.time), spin = frame.joints[0].velocity;
    EXPECT_NEAR(frame.energy.work,
                4 * (velocity * velocity - fastest * fastest) / 2 + 0.4 * 1 * 0.1 * 0.1 * spin * spin / 2, 1e-7);
  }
  EXPECT_TRUE(eventsOf(moved, EventKind::slip).empty());
  expectLedger(moved, 1e-11, 1e-7);
}

/// A brake of 8 N between a table that swings and a body of 2 kg that slides and sticks on it, between stops with e =
/// 0.5: the same at every accuracy.
TEST(JointMotors, BrakeBetweenStopsOnASwingingTable) {
  std::vector<double> ends;
  for (const char* accuracy : {"1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9"}) {
    const Trajectory moved =
        runMotors(3, fmt::format(R"("accuracy": {})", accuracy), R"(
        {"name": "t", "shape": {"box": {"size": [1, 0.1, 1]}}, "motion": "driven", "collision": "none",
         "oscillation": {"direction": [1, 0, 0], "amplitude": 0.2, "frequency": 1}},
        {"name": "b", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "position": [0, 0.3, 0], "mass": 2, "collision": "none",
         "linearVelocity": [1.2566370614359172, 0, 0]})",
                  R"("sliders": [{"bodyA": "b", "axis": [1, 0, 0], "bodyB": "t", "anchorB": [0, 0.3, 0],
        "motor": {"targetVelocity": 0, "maxForce": 8}, "limits": {"lower": -0.1, "upper": 0.05, "restitution": 0.5}}])");
    ends.push_back(moved.frames.back().joints[0].coordinate);
  }
  for (const double end : ends) EXPECT_NEAR(end, ends.back(), 1e-3);
}

/// A plate that a motor of 2 N lowers, on a capsule that slips out from under it over a ball: the harder the motor
/// holds the plate up, the less friction it leaves to the capsule, and the faster both fall. The plate parts from it at
/// the motor's velocity, and sinks with that, its weight on the motor.
TEST(JointMotors, MotorHoldsAPlateWhoseSupportSlipsAway) {
  for (const double accuracy : {1e-3, 1e-6}) {
    const Trajectory moved = runMotor(0.13, accuracy, R"({"name": "floor", "shape": {"plane": {}}, "motion": "static",
         "material": "m"},
        {"name": "ball", "mass": 1.283, "shape": {"sphere": {"radius": 0.0343}}, "position": [-0.0309, 0.0343, -0.02645],
         "material": "m"},
        {"name": "capsule", "mass": 5.769, "shape": {"capsule": {"radius": 0.04042, "length": 0.05557}},
         "position": [-0.0309, 0.12603, -0.02645], "material": "m", "orientation": {"w": -0.5919244091548097,
         "x": 0.29382281730726073, "y": 0.709351030477861, "z": -0.2451831181716032}},
        {"name": "plate", "mass": 0.1735, "shape": {"box": {"size": [0.1742, 0.01307, 0.1742]}},
         "position": [0, 0.19264, 0], "material": "m"})",
                                      R"("materials": {"m": {"restitution": 0, "staticFriction": 1.2668,
         "dynamicFriction": 1.2668}}, "sliders": [{"bodyA": "plate", "anchorB": [0, 0.19264, 0], "axis": [0, 1, 0],
         "motor": {"targetVelocity": -0.196, "maxForce": 2}}])");
    EXPECT_LT(moved.frames[2].joints[0].velocity, -0.05);
    for (const Frame& frame : moved.frames) {
      EXPECT_GE(frame.joints[0].velocity, -0.196 - 1e-12) << frame.time;
      if (frame.time < 0.07) continue;
      EXPECT_NEAR(frame.joints[0].velocity, -0.196, 1e-12) << frame.time;
      EXPECT_NEAR(frame.joints[0].force, 0.1735 * kGravity, 1e-9) << frame.time;
    }
  }
}

/// Four motors of a car come to their targets at one instant: T / r on each of four wheels brings M + sum I / r^2 to
/// v = w r, and they hold that with no torque, and all contacts as they were.
TEST(JointMotors, MotorsOfACarComeToTheirTargetsTogether) {
  std::string bodies = R"({"name": "ground", "shape": {"plane": {}}, "motion": "static"},
      {"name": "chassis", "mass": 1, "shape": {"box": {"size": [1, 0.05, 0.3]}}, "position": [0, 0.12, 0]})",
              hinges;
  for (const double x : {0.4, -0.4})
    for (const double z : {0.25, -0.25}) {
      bodies += fmt::format(R"(, {{"name": "w{0}{1}", "mass": 0.5, "shape": {{"sphere": {{"radius": 0.1}}}},
          "position": [{0}, 0.1, {1}], "orientation": {{"axis": [1, 0, 0], "angleDegrees": 90}}}})",
                            x, z);
      hinges +=
          fmt::format(R"({0}{{"bodyA": "w{1}{2}", "bodyB": "chassis", "anchorB": [{1}, -0.02, {2}], "axis": [0, 1, 0],
          "motor": {{"targetVelocity": -1, "maxTorque": 0.03}}}})",
                      hinges.empty() ? "" : ", ", x, z);
    }
  const double mass = 3 + 4 * 0.4 * 0.5, reached = 0.1 * mass / (4 * 0.03 / 0.1);
  for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
    const Trajectory moved = runMotor(1, accuracy, bodies, R"("hinges": [)" + hinges + "]");
    EXPECT_TRUE(moved.events.empty()) << accuracy;
    for (const Frame& frame : moved.frames) {
      const bool holds = frame.time > reached + 1e-6;
      EXPECT_NEAR(frame.states[0].linearVelocity.x(), 0.1 * std::min(1.0, frame.time / reached), 1e-9) << frame.time;
      for (const JointState& joint : frame.joints) EXPECT_NEAR(joint.force, holds ? 0 : -0.03, 1e-9) << frame.time;
    }
  }
}

/// A car rolls over the edge of a table at the velocity that four motors hold. Its front wheels turn about the edge,
/// and the targets of front and rear contradict each other from then on: two motors push with all they have, and the
/// others hold against them, left and right alike, whatever the accuracy.
TEST(JointMotors, TargetsOfACarContradictEachOtherAtAnEdge) {
  std::string bodies = R"({"name": "table", "material": "rubber", "shape": {"box": {"size": [3, 0.5, 2]}},
       "position": [0, -0.25, 0], "motion": "static"},
      {"name": "chassis", "material": "body", "shape": {"box": {"size": [0.8, 0.12, 0.36]}}, "position": [0, 0.16, 0]})",
              hinges;
  for (const double x : {0.28, -0.28})
    for (const double z : {0.26, -0.26}) {
      bodies += fmt::format(R"(, {{"name": "w{0}{1}", "material": "rubber", "position": [{0}, 0.1, {1}],
          "shape": {{"cylinder": {{"radius": 0.1, "length": 0.1}}}},
          "orientation": {{"axis": [1, 0, 0], "angleDegrees": 90}}}})",
                            x, z);
      hinges += fmt::format(R"({0}{{"bodyA": "w{1}{2}", "bodyB": "chassis", "anchorB": [{1}, -0.06, {2}],
          "axis": [0, 1, 0], "motor": {{"targetVelocity": -8, "maxTorque": 1}}}})",
                            hinges.empty() ? "" : ", ", x, z);
    }
  Vec3 place = Vec3::Zero();
  for (const double accuracy : {1e-8, 1e-6, 1e-4}) {
    const Trajectory moved = runMotor(1.85, accuracy, bodies, R"("materials": {"body": {"density": 300},
        "rubber": {"density": 900, "staticFriction": 0.6, "dynamicFriction": 0.6, "restitution": 0}},
        "hinges": [)" + hinges + "]");
    int contradicting = 0;
    for (const Frame& frame : moved.frames) {
      double most = 0;
      for (const JointState& joint : frame.joints) {
        EXPECT_LE(std::min(std::abs(joint.velocity + 8), std::abs(joint.force + 1)), 1e-6) << frame.time;
        most = std::max(most, std::abs(joint.velocity + 8));
      }
      EXPECT_NEAR(frame.joints[0].force, frame.joints[1].force, 1e-6) << frame.time;
      EXPECT_NEAR(frame.joints[2].force, frame.joints[3].force, 1e-6) << frame.time;
      contradicting += frame.time > 1.7 && most > 0.01;
    }
    EXPECT_GT(contradicting, 2);
    const Vec3 end = moved.frames.back().states[0].position;
    if (accuracy == 1e-8) place = end;
    EXPECT_LT((end - place).norm(), 10 * accuracy) << accuracy;
  }
}

}  // namespace
}  // namespace cradle
