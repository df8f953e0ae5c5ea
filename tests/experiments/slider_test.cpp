#include <gtest/gtest.h>

#include "experiments/tie_error.h"

// Bodies on sliders. No body has a symmetry that the experiment does not need.

namespace cradle {
namespace {

constexpr const char* kSledInertia =
    R"("inertiaTensor": [[0.08, 0.01, -0.02], [0.01, 0.05, 0.005], [-0.02, 0.005, 0.07]])";

std::string sled(const std::string& name, double mass, const std::string& members) {
  return fmt::format(
      R"({{"name": "{}", "shape": {{"box": {{"size": [0.2, 0.3, 0.4]}}}}, "collision": "none", "mass": {}, {}}})", name,
      mass, members);
}

// Down the axis with the part of gravity along it, whatever its anchor and centre of mass; without a turn. DOP853 is
// exact for parabolas: rounding alone.
TEST(Sled, OnATiltedSliderFallsAlongIt) {
  const Vec3 axis = Vec3(2, -1, 2) / 3;
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 2, "accuracy": 1e-8, "output": {{"framesPerSecond": 10}}, "bodies": [{}],
      "sliders": [{{"bodyA": "a", "anchorA": [-0.3, 0.2, 0.7], "anchorB": [-0.3, 0.2, 0.7], "axis": {}}}])",
      sled("a", 2, fmt::format(R"("centerOfMass": [0.05, -0.1, 0.02], {})", kSledInertia)), vectorText(axis)));
  const Trajectory run = simulate(scene);
  const double acceleration = -kGravity * axis.y();
  for (const Frame& frame : run.frames) {
    const Vec3 way = 0.5 * acceleration * frame.time * frame.time * axis;
    EXPECT_LT((frame.states[0].position - Vec3(0.05, -0.1, 0.02) - way).norm(), 1e-12) << frame.time;
    EXPECT_LT((frame.states[0].linearVelocity - acceleration * frame.time * axis).norm(), 1e-12);
    EXPECT_LT(orientationError(frame.states[0].orientation, Quat::Identity()), 1e-13);
  }
  EXPECT_LT(largestEnergyError(run), 1e-11);
}

// A spring along the axis: s = m g' / k (1 - cos w t), w^2 = k / m, from where the spring is at its length.
TEST(Sled, OnASpringOscillatesAlongItsSlider) {
  const double mass = 2, stiffness = 50, frequency = std::sqrt(stiffness / mass);
  const Vec3 axis(0.6, -0.8, 0);
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 3, "accuracy": 1e-10, "output": {{"framesPerSecond": 20}}, "bodies": [{}],
      "sliders": [{{"bodyA": "a", "anchorA": [0.1, 0.2, 0], "anchorB": [0.1, 0.2, 0], "axis": {}}}],
      "springs": [{{"bodyA": "a", "anchorA": [0.1, 0.2, 0], "anchorB": {}, "stiffness": {}, "restLength": 5}}])",
      sled("a", mass, kSledInertia), vectorText(axis), vectorText(Vec3(0.1, 0.2, 0) - 5 * axis), stiffness));
  const Trajectory run = simulate(scene);
  const double amplitude = mass * kGravity * 0.8 / stiffness;
  for (const Frame& frame : run.frames) {
    const double way = amplitude * (1 - std::cos(frequency * frame.time));
    EXPECT_LT((frame.states[0].position - way * axis).norm(), 1e-9) << frame.time;
  }
  EXPECT_LT(largestTieError(run, scene), 1e-12);
}

// A block m slides down a wedge M that slides on the level, without friction: the wedge goes back with m g sin a cos a
// / (M + m sin^2 a), the block on it down with (M + m) g sin a / (M + m sin^2 a).
TEST(Wedge, AndItsBlockPartAtAnyRatioOfMasses) {
  const double sine = 0.6, cosine = 0.8;
  for (const auto& [wedge, block] : {std::pair(2.0, 3.0), {1e-3, 1.0}, {1000.0, 1.0}}) {
    const Scene scene = sceneWith(fmt::format(
        R"("duration": 0.5, "accuracy": 1e-8, "output": {{"framesPerSecond": 10}}, "bodies": [{}, {}],
        "sliders": [{{"bodyA": "wedge", "anchorA": [0.3, 0, 0.1], "anchorB": [0.3, 0, 0.1], "axis": [1, 0, 0]}},
          {{"bodyA": "block", "anchorA": [0, -0.2, 0], "bodyB": "wedge", "anchorB": [0.1, 0.3, 0.2], "axis": [0.8, -0.6, 0]}}])",
        sled("wedge", wedge, kSledInertia),
        sled("block", block, std::string(R"("position": [0.1, 0.5, 0.2], )") + kSledInertia)));
    const Trajectory run = simulate(scene);
    const double mass = wedge + block * sine * sine;
    const double back = block * kGravity * sine * cosine / mass, down = (wedge + block) * kGravity * sine / mass;
    for (const Frame& frame : run.frames) {
      const double half = 0.5 * frame.time * frame.time;
      const Vec3 wedgeAt(-back * half, 0, 0),
          blockAt = Vec3(0.1, 0.5, 0.2) + wedgeAt + down * half * Vec3(0.8, -0.6, 0);
      EXPECT_LT((frame.states[0].position - wedgeAt).norm(), 1e-11) << wedge << " " << frame.time;
      EXPECT_LT((frame.states[1].position - blockAt).norm(), 1e-11) << wedge << " " << frame.time;
    }
    EXPECT_LT(largestTieError(run, scene), 1e-12);
  }
}

/// Two bodies on a slider through both centres of mass that spin across it: mu (r'' - r w^2) = 0 with w = L / (I + mu
/// r^2), in steps of the classical Runge-Kutta method.
struct SpinningPair {
  double reducedMass, inertia, angularMomentum;  // kg, kg m^2 of both about their centres, kg m^2/s

  double spinAt(double distance) const { return angularMomentum / (inertia + reducedMass * distance * distance); }
  /// Distance, its rate, and the angle turned.
  Vec3 after(double time, Vec3 state) const {
    const auto rate = [this](const Vec3& s) {
      const double spin = spinAt(s[0]);
      return Vec3(s[1], s[0] * spin * spin, spin);
    };
    const int steps = 4000;
    const double h = time / steps;
    for (int i = 0; i < steps; ++i) {
      const Vec3 k1 = rate(state), k2 = rate(state + h / 2 * k1), k3 = rate(state + h / 2 * k2),
                 k4 = rate(state + h * k3);
      state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return state;
  }
};

// Steps of 5e-4 s at 4 rad/s leave (2e-3)^4 / 100 = 2e-13. They come together first, then fly apart.
TEST(PairOnASlider, FliesApartAsItSpins) {
  const double massA = 2, massB = 0.5, distance = 0.8, spin = 4, approach = 0.9;
  const auto text = [&](const char* name, double mass, double place, double speed, double degrees, double axial) {
    return sled(name, mass,
                fmt::format(
                    R"("position": [{}, 0, 0], "linearVelocity": [{}, {}, 0], "angularVelocity": [0, 0, {}],
         "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}},
         "inertiaTensor": [[0.05, 0.01, 0], [0.01, 0.04, 0], [0, 0, {}]])",
                    place, speed, spin * place, spin, degrees, axial));
  };
  const double placeA = -massB / (massA + massB) * distance, placeB = massA / (massA + massB) * distance;
  const Scene scene = sceneWith(fmt::format(
      R"("duration": 2, "accuracy": 1e-10, "gravity": [0, 0, 0], "output": {{"framesPerSecond": 16}}, "bodies": [{}, {}],
      "sliders": [{{"bodyA": "b", "anchorA": [0.1, 0.2, 0.3], "bodyB": "a", "anchorB": {}, "axis": [1, 0, 0]}}])",
      text("a", massA, placeA, massB / (massA + massB) * approach, 90, 0.06),
      text("b", massB, placeB, -massA / (massA + massB) * approach, 0, 0.03),
      // seen from A, which is turned by a right angle: x is -y, y is x
      vectorText(Vec3(0.2, -(placeB - placeA) - 0.1, 0.3))));
  const Trajectory run = simulate(scene);
  const double reduced = massA * massB / (massA + massB);
  SpinningPair pair{reduced, 0.09, 0};
  pair.angularMomentum = (pair.inertia + reduced * distance * distance) * spin;
  for (const Frame& frame : run.frames) {
    const Vec3 expected = pair.after(frame.time, Vec3(distance, -approach, 0));
    const BodyState &a = frame.states[0], &b = frame.states[1];
    const Vec3 along(std::cos(expected[2]), std::sin(expected[2]), 0);
    EXPECT_LT((b.position - a.position - expected[0] * along).norm(), 1e-8) << frame.time;
    EXPECT_NEAR((b.linearVelocity - a.linearVelocity).dot(along), expected[1], 1e-8) << frame.time;
    EXPECT_LT((a.angularVelocity - Vec3(0, 0, pair.spinAt(expected[0]))).norm(), 1e-8) << frame.time;
  }
  EXPECT_LT((run.frames[1].states[1].position - run.frames[1].states[0].position).norm(), distance);
  EXPECT_LT(largestTieError(run, scene), 1e-11);
}

/// Two lopsided bodies on a slider beside their centres of mass, which tumble; `ends`: bodyA, anchorA, bodyB, anchorB.
Scene tumblingPair(const std::string& ends) {
  return sceneWith(fmt::format(
      R"("duration": 3, "accuracy": 1e-10, "gravity": [0, 0, 0], "output": {{"framesPerSecond": 20}},
      "bodies": [{}, {}], "sliders": [{{{}, "axis": [1, -2, 2]}}])",
      sled("a", 2, fmt::format(R"("angularVelocity": [1, 2, -1], "linearVelocity": [1, 0, 0], {})", kSledInertia)),
      sled("b", 0.7, fmt::format(R"("position": [1, 0, -0.125], "angularVelocity": [1, 2, -1], {})", kSledInertia)),
      ends));
}

TEST(PairOnASlider, KeepsMomentaEnergyAndItsAxisAsItTumbles) {
  const Scene scene =
      tumblingPair(R"("bodyA": "a", "anchorA": [0.5, 0.25, 0], "bodyB": "b", "anchorB": [-0.5, 0.25, 0.125])");
  const Trajectory run = simulate(scene);
  const EnergyBalance& start = run.frames[0].energy;
  for (const Frame& frame : run.frames) {
    EXPECT_LT((frame.energy.momentum - start.momentum).norm(), 1e-10);
    EXPECT_LT((frame.energy.angularMomentum - start.angularMomentum).norm(), 1e-8);
    EXPECT_NEAR(ledgerConstantOf(frame), ledgerConstantOf(run.frames[0]), 1e-12);
  }
  EXPECT_LT(largestEnergyError(run), 1e-8);
  EXPECT_LT(largestTieError(run, scene), 1e-10);
  const Frame& end = run.frames.back();  // it did slide
  EXPECT_GT((end.states[0].position - end.states[1].position).norm(), 1.5);
}

// The axis that B carries is the one that A carries, so that it does not matter which of them is which.
TEST(PairOnASlider, MovesAlikeWhicheverIsA) {
  const Trajectory run = simulate(
      tumblingPair(R"("bodyA": "a", "anchorA": [0.5, 0.25, 0], "bodyB": "b", "anchorB": [-0.5, 0.25, 0.125])"));
  const Trajectory other = simulate(
      tumblingPair(R"("bodyA": "b", "anchorA": [-0.5, 0.25, 0.125], "bodyB": "a", "anchorB": [0.5, 0.25, 0])"));
  for (std::size_t i = 0; i < run.frames.size(); ++i)
    for (std::size_t body = 0; body < 2; ++body) {
      const BodyState &state = run.frames[i].states[body], &same = other.frames[i].states[body];
      EXPECT_LT((state.position - same.position).norm(), 1e-8) << i;
      EXPECT_LT(orientationError(state.orientation, same.orientation), 1e-8) << i;
    }
}

/// A crank on a hinge about z at the origin, a rod, and a piston on a slider along x, without gravity, from the dead
/// centre on.
struct SliderCrank {
  double radius = 0.3, length = 0.7, spin = 5;  // m, m, rad/s at the start
  double pistonMass = 1.5, rodMass = 0.8, crankInertia = 0.05, rodInertia = 0.06;

  double root(double angle) const { return std::sqrt(length * length - std::pow(radius * std::sin(angle), 2)); }
  double place(double angle) const { return radius * std::cos(angle) + root(angle); }
  double placeRate(double angle) const {
    return -radius * std::sin(angle) * (1 + radius * std::cos(angle) / root(angle));
  }
  /// Of the whole, as the crank's angle feels it: kinetic energy = inertia x (rate of the angle)^2 / 2.
  double inertia(double angle) const {
    const double tilt = radius * std::cos(angle) / root(angle), x = placeRate(angle);
    const Eigen::Vector2d pin(-radius * std::sin(angle), radius * std::cos(angle));
    const double rodSquared = (Eigen::Vector2d(x, 0) + pin).squaredNorm() / 4;
    return crankInertia + rodInertia * tilt * tilt + rodMass * rodSquared + pistonMass * x * x;
  }
  double spinAt(double angle) const { return spin * std::sqrt(inertia(0) / inertia(angle)); }

  /// `pins` and `wrists` are keys of joints: of the crank pin, and between rod and piston.
  Scene scene(const std::string& pin, const std::string& wrist) const {
    const std::string pinText = fmt::format(
        R"({{"bodyA": "rod", "anchorA": [-{}, 0, 0], "bodyB": "crank", "anchorB": [{}, 0, 0]}})", length / 2, radius);
    const std::string wristText = fmt::format(
        R"({{"bodyA": "piston", "anchorA": [0, 0, 0], "bodyB": "rod", "anchorB": [{}, 0, 0]}})", length / 2);
    std::string hinges = R"({"bodyA": "crank", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]})", balls;
    for (const auto& [key, text] : {std::pair(pin, pinText), {wrist, wristText}}) {
      std::string& list = key == "hinges" ? hinges : balls;
      list += (list.empty() ? "" : ", ") + text;
    }
    const auto inertiaText = [](double axial) {
      return fmt::format(R"("inertiaTensor": [[{}, 0, 0], [0, 0.04, 0], [0, 0, {}]])", axial - 0.03, axial);
    };
    return sceneWith(fmt::format(
        R"("duration": 3, "accuracy": 1e-10, "gravity": [0, 0, 0], "output": {{"framesPerSecond": 20}}, "bodies": [{}, {}, {}],
        "hinges": [{}], "ballJoints": [{}],
        "sliders": [{{"bodyA": "piston", "anchorA": [0, 0, 0], "anchorB": [{}, 0, 0], "axis": [1, 0, 0]}}])",
        sled("crank", 3, fmt::format(R"("angularVelocity": [0, 0, {}], {})", spin, inertiaText(crankInertia))),
        sled("rod", rodMass,
             fmt::format(R"("position": [{}, 0, 0], "linearVelocity": [0, {}, 0], "angularVelocity": [0, 0, {}], {})",
                         radius + length / 2, radius * spin / 2, -radius / length * spin, inertiaText(rodInertia))),
        sled("piston", pistonMass, fmt::format(R"("position": [{}, 0, 0], {})", place(0), inertiaText(0.05))), hinges,
        balls, place(0)));
  }
};

class Crank : public testing::TestWithParam<std::array<const char*, 2>> {};

// x = r cos a + sqrt(l^2 - r^2 sin^2 a) of the piston, and the crank's rate at each angle from the energy, which is all
// kinetic. Three hinges and a slider hold 20 rows, of which a mechanism that moves in a plane needs 17; two ball joints
// in place of hinges none too many.
TEST_P(Crank, MovesItsPistonByTheClosedForm) {
  const SliderCrank crank;
  const Scene scene = crank.scene(GetParam()[0], GetParam()[1]);
  const Trajectory run = simulate(scene);
  double farthest = 0;
  for (const Frame& frame : run.frames) {
    const BodyState &state = frame.states[0], &piston = frame.states[2];
    const Vec3 arm = state.orientation * Vec3::UnitX();
    const double angle = std::atan2(arm.y(), arm.x());
    EXPECT_LT((piston.position - Vec3(crank.place(angle), 0, 0)).norm(), 1e-10) << frame.time;
    EXPECT_LT((state.angularVelocity - Vec3(0, 0, crank.spinAt(angle))).norm(), 1e-8) << frame.time;
    EXPECT_NEAR(piston.linearVelocity.x(), crank.placeRate(angle) * crank.spinAt(angle), 1e-8) << frame.time;
    farthest = std::max(farthest, std::abs(angle));
  }
  EXPECT_GT(farthest, 3);
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}
INSTANTIATE_TEST_SUITE_P(, Crank,
                         testing::Values(std::array{"hinges", "hinges"}, std::array{"hinges", "ballJoints"},
                                         std::array{"ballJoints", "ballJoints"}));

}  // namespace
}  // namespace cradle
