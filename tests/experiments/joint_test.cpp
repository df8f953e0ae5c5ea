#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "experiments/tie_error.h"

// Bodies on ball joints and hinges. No body has a symmetry that the experiment does not need.

namespace cradle {
namespace {

const Mat3 kLopsided = (Mat3() << 0.08, 0.01, -0.02, 0.01, 0.05, 0.005, -0.02, 0.005, 0.07).finished();
constexpr const char* kLopsidedText =
    R"("inertiaTensor": [[0.08, 0.01, -0.02], [0.01, 0.05, 0.005], [-0.02, 0.005, 0.07]])";

std::string body(const std::string& name, const std::string& members) {
  return fmt::format(R"({{"name": "{}", "shape": {{"box": {{"size": [0.2, 0.3, 0.4]}}}}, "collision": "none", {}}})",
                     name, members);
}

/// A body that turns about a tilted axis away from its centre of mass, let go at rest.
struct TiltedPendulum {
  double mass = 2;
  Vec3 center{0.05, -0.1, 0.02}, pin{-0.3, 0.1, -0.05}, axis = Vec3(1, 2, 2) / 3;

  Vec3 across(const Vec3& v) const { return v - axis.dot(v) * axis; }
  Vec3 pull() const { return across(Vec3(0, -kGravity, 0)); }
  Vec3 arm() const { return across(center - pin); }
  /// rad, signed about the axis, from the place where it would hang.
  double startAngle() const { return std::atan2(axis.dot(pull().cross(arm())), pull().dot(arm())); }
  double smallFrequency() const {
    const double inertia = axis.dot(kLopsided * axis) + mass * arm().squaredNorm();
    return std::sqrt(mass * pull().norm() * arm().norm() / inertia);
  }
  double modulus() const { return std::sin(std::abs(startAngle()) / 2); }
  double period() const { return 4 * std::comp_ellint_1(modulus()) / smallFrequency(); }
};

// theta(t) = 2 asin(k sn(K - w0 t)), k = sin(theta0 / 2), w0^2 = m g' d / I: through the bottom at a quarter of the
// period with the speed 2 k w0, on the other side at half of it. In that time a disturbance grows by about w0 t < 10.
TEST(HingePendulum, SwingsInThePeriodOfItsEllipticIntegral) {
  const TiltedPendulum pendulum;
  const double period = pendulum.period(), start = pendulum.startAngle();
  ASSERT_GT(std::abs(start), 0.5);
  const Scene scene = sceneWith(fmt::format(
      R"("duration": {}, "accuracy": 1e-10, "output": {{"framesPerSecond": {}}}, "bodies": [{}],
      "hinges": [{{"bodyA": "a", "anchorA": {}, "anchorB": {}, "axis": {}}}])",
      period, 4 / period,
      body("a", fmt::format(R"("mass": 2, "centerOfMass": {}, {})", vectorText(pendulum.center), kLopsidedText)),
      vectorText(pendulum.pin), vectorText(pendulum.pin), vectorText(pendulum.axis)));
  const Trajectory run = simulate(scene);
  ASSERT_EQ(run.frames.size(), 5u);
  const double turned[] = {0, -start, -2 * start, -start, 0};
  const double speed = 2 * pendulum.modulus() * pendulum.smallFrequency() * (start > 0 ? -1 : 1);
  const double speeds[] = {0, speed, 0, -speed, 0};
  for (std::size_t i = 0; i < 5; ++i) {
    const BodyState& state = run.frames[i].states[0];
    EXPECT_LT(orientationError(state.orientation, Quat(Eigen::AngleAxisd(turned[i], pendulum.axis))), 1e-9) << i;
    EXPECT_LT((state.angularVelocity - speeds[i] * pendulum.axis).norm(), 1e-8) << i;
  }
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}

/// Two bodies on parallel hinges, in the plane: angles and their rates.
class PlanarDoublePendulum {
 public:
  using Vec2 = Eigen::Vector2d;
  double massA = 2, massB = 1.5, inertiaA = 0.07, inertiaB = 0.07;  // kg, kg m^2 about the centres of mass
  Vec2 centerA, joint, centerB;                                     // m: from the pin, and from the joint

  /// Lagrange's equations in steps of the classical Runge-Kutta method.
  Eigen::Vector4d after(double time, Eigen::Vector4d state) const {
    const int steps = 20000;
    const double h = time / steps;
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector4d k1 = rate(state), k2 = rate(state + h / 2 * k1), k3 = rate(state + h / 2 * k2),
                            k4 = rate(state + h * k3);
      state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return state;
  }
  Vec2 positionA(const Eigen::Vector4d& state) const { return turned(centerA, state[0]); }
  Vec2 positionB(const Eigen::Vector4d& state) const { return turned(joint, state[0]) + turned(centerB, state[1]); }

 private:
  static Vec2 turned(const Vec2& v, double angle) { return Eigen::Rotation2Dd(angle) * v; }
  static Vec2 left(const Vec2& v) { return {-v.y(), v.x()}; }
  Eigen::Vector4d rate(const Eigen::Vector4d& state) const {
    const Vec2 a = turned(centerA, state[0]), l = turned(joint, state[0]), b = turned(centerB, state[1]);
    const Vec2 gravity(0, -kGravity);
    Eigen::Matrix2d mass;
    mass << inertiaA + massA * a.squaredNorm() + massB * l.squaredNorm(), massB * l.dot(b), massB * l.dot(b),
        inertiaB + massB * b.squaredNorm();
    const Vec2 force(gravity.dot(left(massA * a + massB * l)) + massB * state[3] * state[3] * left(l).dot(b),
                     gravity.dot(left(massB * b)) + massB * state[2] * state[2] * left(b).dot(l));
    Eigen::Vector4d result;
    result << state[2], state[3], mass.inverse() * force;
    return result;
  }
};

// Hinges along z keep the motion in the plane, whatever the products of inertia and the offsets along z. The planar
// integration's step of 1e-4 s leaves (8 rad/s x 1e-4 s)^4 = 4e-13; ours grows by some ten times in 2 s.
TEST(TwoHinges, MoveLikeThePlanarDoublePendulum) {
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 2, "accuracy": 1e-10, "output": {{"framesPerSecond": 1}}, "bodies": [{}, {}],
      "hinges": [{{"bodyA": "a", "anchorA": [0.1, 0.3, -0.05], "anchorB": [0.1, 0.3, -0.05]}},
                 {{"bodyA": "b", "anchorA": [-0.2, 0.3, 0.25], "bodyB": "a", "anchorB": [0.4, -0.2, 0.1], "axis": [0, 0, -1]}}])",
      body("a", fmt::format(R"("mass": 2, "centerOfMass": [0.05, -0.1, 0.02], {})", kLopsidedText)),
      body("b", fmt::format(R"("mass": 1.5, "position": [0.6, -0.5, -0.15], {})", kLopsidedText))));
  const Trajectory run = simulate(scene);
  PlanarDoublePendulum planar;
  planar.centerA = {-0.05, -0.4}, planar.joint = {0.3, -0.5}, planar.centerB = {0.2, -0.3};
  for (const int second : {1, 2}) {
    const Eigen::Vector4d expected = planar.after(second, Eigen::Vector4d::Zero());
    const auto& states = run.frames.at(static_cast<std::size_t>(second)).states;
    EXPECT_LT((states[0].position.head<2>() - (planar.positionA(expected) + Eigen::Vector2d(0.1, 0.3))).norm(), 1e-8);
    EXPECT_LT((states[1].position.head<2>() - (planar.positionB(expected) + Eigen::Vector2d(0.1, 0.3))).norm(), 1e-8);
    EXPECT_NEAR(states[0].angularVelocity.z(), expected[2], 1e-7);
    EXPECT_NEAR(states[1].angularVelocity.z(), expected[3], 1e-7);
  }
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}

TEST(HingeBetweenFreeBodies, KeepsMomentaEnergyAndItsAxis) {
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 5, "accuracy": 1e-10, "gravity": [0, 0, 0], "output": {{"framesPerSecond": 20}}, "bodies": [{}, {}],
      "hinges": [{{"bodyA": "a", "anchorA": [0.5, 0.25, 0], "bodyB": "b", "anchorB": [-0.5, 0.25, 0.125], "axis": [1, -2, 2]}}])",
      body("a",
           fmt::format(R"("mass": 2, "angularVelocity": [1, 2, -1], "linearVelocity": [1, 0, 0], {})", kLopsidedText)),
      body("b", fmt::format(R"("mass": 0.7, "position": [1, 0, -0.125], "angularVelocity": [3, -2, 3], {})",
                            kLopsidedText))));
  const Trajectory run = simulate(scene);
  const EnergyBalance& start = run.frames[0].energy;
  for (const Frame& frame : run.frames) {
    EXPECT_LT((frame.energy.momentum - start.momentum).norm(), 1e-10);
    EXPECT_LT((frame.energy.angularMomentum - start.angularMomentum).norm(), 1e-8);
  }
  EXPECT_LT(largestEnergyError(run), 1e-8);
  EXPECT_LT(largestTieError(run, scene), 1e-10);
  const Frame& end = run.frames.back();  // it did turn about the hinge
  EXPECT_GT((end.states[0].angularVelocity - end.states[1].angularVelocity).norm(), 0.1);
}

// The hinge puts no torque on the wheel about its own axis, and a wheel round about that axis has no gyroscopic torque
// about it: the spin about the axis stays what it was, however the arm swings.
TEST(WheelOnASwingingArm, KeepsItsSpin) {
  const double spin = 30;
  const Vec3 axis = Vec3(2, 1, 2) / 3;
  const Mat3 inertia = 0.02 * Mat3::Identity() + 0.015 * axis * axis.transpose();
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 3, "accuracy": 1e-10, "output": {{"framesPerSecond": 20}}, "bodies": [{},
        {{"name": "wheel", "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none", "mass": 1, "position": [0.6, 0, 0.1],
          "centerOfMass": [0, 0, 0], "angularVelocity": {}, "inertiaTensor": [{}, {}, {}]}}],
      "hinges": [{{"bodyA": "arm", "anchorA": [-0.2, 0, 0], "anchorB": [-0.2, 0, 0], "axis": [0, 1, 3]}},
                 {{"bodyA": "wheel", "anchorA": [0, 0, 0], "bodyB": "arm", "anchorB": [0.6, 0, 0.1], "axis": {}}}])",
      body("arm", fmt::format(R"("mass": 2, {})", kLopsidedText)), vectorText(spin * axis), vectorText(inertia.row(0)),
      vectorText(inertia.row(1)), vectorText(inertia.row(2)), vectorText(axis)));
  const Trajectory run = simulate(scene);
  double fastestArm = 0;
  for (const Frame& frame : run.frames) {
    const BodyState &arm = frame.states[0], &wheel = frame.states[1];
    EXPECT_NEAR((wheel.orientation * axis).dot(wheel.angularVelocity), spin, 1e-8) << frame.time;
    fastestArm = std::max(fastestArm, arm.angularVelocity.norm());
  }
  EXPECT_GT(fastestArm, 1);
  EXPECT_LT(largestTieError(run, scene), 1e-10);
  EXPECT_LT(largestEnergyError(run), 1e-7);
}

// A body on a ball joint at the world's origin: gravity has no moment about the vertical there.
TEST(SphericalPendulum, OfALopsidedBodyKeepsEnergyAndAngularMomentumAboutTheVertical) {
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 5, "accuracy": 1e-10, "output": {{"framesPerSecond": 20}}, "bodies": [{}],
      "ballJoints": [{{"bodyA": "a", "anchorA": [0.1, 0.4, -0.2], "anchorB": [0, 0, 0]}}])",
      body("a", fmt::format(R"("mass": 2, "position": [-0.1, -0.4, 0.2], "angularVelocity": [4, 3, -2], {})",
                            kLopsidedText))));
  const Trajectory run = simulate(scene);
  const double start = run.frames[0].energy.angularMomentum.y();
  ASSERT_GT(std::abs(start), 0.1);
  double sideways = 0;
  for (const Frame& frame : run.frames) {
    EXPECT_NEAR(frame.energy.angularMomentum.y(), start, 1e-8) << frame.time;
    sideways =
        std::max(sideways, std::abs(frame.energy.angularMomentum.x() - run.frames[0].energy.angularMomentum.x()));
  }
  EXPECT_GT(sideways, 0.1);
  EXPECT_LT(largestEnergyError(run), 1e-8);
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}

// A wheel on a level axle held at one end goes round the vertical at W = m g l / (I3 w3): with the axle level that is
// exact, since the terms that come with its tilt have its cosine. Both vectors turn along with it.
TEST(Gyroscope, OnALevelAxlePrecessesAtItsClosedForm) {
  const double mass = 1.5, length = 0.3, spin = 80, axial = 0.02;
  const double precession = mass * kGravity * length / (axial * spin);
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 2, "accuracy": 1e-10, "output": {{"framesPerSecond": 2}},
      "bodies": [{{"name": "wheel", "shape": {{"sphere": {{"radius": 0.1}}}}, "collision": "none", "mass": {}, "centerOfMass": [0, 0, 0],
        "inertiaTensor": [[{}, 0, 0], [0, 0.011, 0], [0, 0, 0.011]], "position": [{}, 0, 0], "angularVelocity": [{}, {}, 0]}}],
      "ballJoints": [{{"bodyA": "wheel", "anchorA": [-{}, 0, 0], "anchorB": [0, 0, 0]}}])",
      mass, axial, length, spin, precession, length));
  const Trajectory run = simulate(scene);
  for (const Frame& frame : run.frames) {
    const Eigen::AngleAxisd turned(precession * frame.time, Vec3::UnitY());
    const BodyState& state = frame.states[0];
    EXPECT_LT((state.position - turned * Vec3(length, 0, 0)).norm(), 1e-8) << frame.time;
    EXPECT_LT((state.angularVelocity - turned * Vec3(spin, precession, 0)).norm(), 1e-6) << frame.time;
  }
}

/// A rod of 1 m that hangs from a hinge at its upper end, and starts with these velocities (m/s, rad/s).
BodyState startOfRod(const Vec3& velocity, const Vec3& spin) {
  return simulate(sceneWith(fmt::format(R"("duration": 0.01, "bodies": [{{"name": "rod", "collision": "none",
      "shape": {{"box": {{"size": [0.02, 1, 0.02]}}}}, "mass": 1, "position": [0, -0.5, 0],
      "linearVelocity": {}, "angularVelocity": {}}}],
      "hinges": [{{"bodyA": "rod", "anchorA": [0, 0.5, 0], "anchorB": [0, 0, 0], "axis": [0, 0, 1]}}])",
                                        vectorText(velocity), vectorText(spin))))
      .frames.front()
      .states.front();
}

// About the hinge v = w / 2 along x. A spin that is given is kept, and a velocity without one; what the hinge allows of
// neither, along it and along the rod, goes.
TEST(StartVelocities, FollowTheOneThatIsGiven) {
  const struct {
    Vec3 velocity, spin;
    double speed;  // m/s, along x
  } cases[] = {{Vec3(1, 0, 0), Vec3::Zero(), 1},
               {Vec3::Zero(), Vec3(0, 0, 2), 1},
               {Vec3(1, 0.3, 0.2), Vec3::Zero(), 1},
               {Vec3(1, 0, 0), Vec3(0, 0, 1), 0.5},
               {Vec3(0.25, 0, 0), Vec3(0, 0, 0.5), 0.25}};
  for (const auto& given : cases) {
    const BodyState start = startOfRod(given.velocity, given.spin);
    EXPECT_LT((start.linearVelocity - given.speed * Vec3::UnitX()).norm(), 1e-15) << given.velocity.transpose();
    EXPECT_LT((start.angularVelocity - 2 * given.speed * Vec3::UnitZ()).norm(), 2e-15) << given.velocity.transpose();
  }
}

}  // namespace
}  // namespace cradle
