// Bodies that slide over an edge, tip, roll and rock on it: contact of lines that cross, or of a line under a sphere.
// References are the equations of motion in one or two coordinates, integrated by RK4 in steps so small that a tenth as
// many change nothing that is compared.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "experiments/experiment.h"

namespace cradle {
namespace {

/// x and x' of one or two coordinates.
template <std::size_t N>
using Coordinates = std::array<double, N>;

/// RK4 from t = 0 in 20000 steps; `rate` gives the derivative.
template <std::size_t N, class Rate>
Coordinates<N> integratedTo(double duration, Coordinates<N> x, const Rate& rate) {
  constexpr int kSteps = 20000;
  const double h = duration / kSteps;
  const auto moved = [](const Coordinates<N>& from, double by, const Coordinates<N>& along) {
    Coordinates<N> to = from;
    for (std::size_t i = 0; i < N; ++i) to[i] += by * along[i];
    return to;
  };
  for (int step = 0; step < kSteps; ++step) {
    const auto a = rate(x), b = rate(moved(x, h / 2, a)), c = rate(moved(x, h / 2, b)), d = rate(moved(x, h, c));
    for (std::size_t i = 0; i < N; ++i) x[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  return x;
}

/// The angle (rad) by which a body is turned about z, clockwise.
double tiltOf(const BodyState& body) {
  return -2 * std::atan2(body.orientation.z(), body.orientation.w());
}

/// A block of 0.6 x 0.2 x 0.3 m on a table that ends at x = 0, its centre of mass at `x`; frames at 0, T/2 and T.
Trajectory onTable(double accuracy, double duration, double x, double speed, double friction,
                   const std::string& orientation = R"({"axis": [0, 1, 0], "angleDegrees": 0})") {
  return simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": {}}},
      "materials": {{"m": {{"restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
      {{"name": "table", "shape": {{"box": {{"size": [4, 0.1, 2]}}}}, "position": [-2, -0.05, 0], "motion": "static",
        "material": "m"}},
      {{"name": "block", "shape": {{"box": {{"size": [0.6, 0.2, 0.3]}}}}, "mass": 2, "material": "m",
        "position": [{}, 0.1, 0], "linearVelocity": [{}, 0, 0], "orientation": {}}}])",
      duration, accuracy, 2 / duration, friction, friction, x, speed, orientation)));
}
constexpr double kHeight = 0.1, kSquareRadius = (0.6 * 0.6 + 0.2 * 0.2) / 12;  // m: half of it; m^2: I / m across

/// The accuracy is kept to the end.
void expectPromised(const Trajectory& run) {
  EXPECT_THAT(run.cost.promise, testing::Not(testing::HasSubstr("not ")));
}

// With the edge at q along the block's face from the foot of its centre of mass, and its tilt a, the centre moves with
// (q' + b a', -q a') along face and normal, b half the height. Lagrange's equations of both coordinates are
//   q'' + b a'' = q a'^2 + g sin a,   (k + q^2) a'' = g q cos a - 2 q q' a' - b q a'^2,   k = I / m.
// It slides with constant speed until q = 0. Errors grow by the tipping: its exponent is sqrt(g q / k) < 5/s over 0.25
// s.
TEST(EdgeContact, BlockThatSlidesOverATableTipsByItsEquations) {
  const double speed = 0.6, start = -0.15, duration = 0.5;
  const auto rate = [](const Coordinates<4>& x) {
    const auto [q, a, dq, da] = x;
    const double dda = (kGravity * q * std::cos(a) - 2 * q * dq * da - kHeight * q * da * da) / (kSquareRadius + q * q);
    return Coordinates<4>{dq, da, q * da * da + kGravity * std::sin(a) - kHeight * dda, dda};
  };
  const auto [q, a, dq, da] = integratedTo<4>(duration + start / speed, {0, 0, speed, 0}, rate);
  const Vec3 along(std::cos(a), -std::sin(a), 0), normal(std::sin(a), std::cos(a), 0);
  for (const double accuracy : {1e-4, 1e-6, 1e-8, 1e-10}) {
    const Trajectory run = onTable(accuracy, duration, start, speed, 0);
    expectPromised(run);
    const BodyState block = endOf(run);
    EXPECT_LT((block.position - (q * along + kHeight * normal)).norm(), 3 * accuracy) << accuracy;
    EXPECT_NEAR(tiltOf(block), a, 10 * accuracy);
    EXPECT_LT((block.linearVelocity - ((dq + kHeight * da) * along - q * da * normal)).norm(), 30 * accuracy);
  }
}

// A block that stands with its centre of mass d = 0.02 m beyond the edge turns about it, a pendulum upside down:
// (k + d^2 + b^2) a'' = g (d cos a + b sin a). Its friction slips where the force along its face is mu times the normal
// force; both follow from a and a'^2.
TEST(EdgeContact, BlockThatTurnsOnAnEdgeSlipsAtItsFrictionLimit) {
  const double beyond = 0.02, friction = 0.3, inertia = kSquareRadius + beyond * beyond + kHeight * kHeight;
  const auto acceleration = [&](double a) {
    return kGravity * (beyond * std::cos(a) + kHeight * std::sin(a)) / inertia;
  };
  const auto rate = [&](const Coordinates<2>& x) { return Coordinates<2>{x[1], acceleration(x[0])}; };
  // Along the face and its normal the centre of mass is at (d, b), and accelerates by (b a'' - d a'^2, -d a'' - b
  // a'^2).
  const auto excess = [&](double time) {
    const auto [a, da] = integratedTo<2>(time, {0, 0}, rate);
    const double dda = acceleration(a);
    const double along = kHeight * dda - beyond * da * da - kGravity * std::sin(a);
    const double normal = -beyond * dda - kHeight * da * da + kGravity * std::cos(a);
    return std::abs(along) - friction * normal;
  };
  double early = 0.3, late = 0.4;
  ASSERT_LT(excess(early), 0);
  ASSERT_GT(excess(late), 0);
  while (late - early > 1e-12) (excess((early + late) / 2) > 0 ? late : early) = (early + late) / 2;
  for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
    const Trajectory run = onTable(accuracy, 0.6, beyond, 0, friction);
    expectPromised(run);
    const std::vector<Event> slips = eventsOf(run, EventKind::slip);
    ASSERT_FALSE(slips.empty());
    // The excess grows by 31 m/s^2 a second, and is an event at kInfeasibleRatio, 1e-6 of g: 3.2e-7 s later.
    EXPECT_NEAR(slips[0].time, early, std::max(3 * accuracy, 4e-7));
  }
}

/// A bar that rolls without slip on a fixed one across it, both round, with their axes horizontal: its angle to the
/// horizontal at the end. Capsules or cylinders.
Trajectory barOnBar(const std::string& shape, double accuracy, double duration, double lower, double upper,
                    double spin) {
  return simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": {}}},
      "materials": {{"m": {{"restitution": 0, "staticFriction": 2, "dynamicFriction": 2}}}}, "bodies": [
      {{"name": "fixed", "shape": {{"{}": {{"radius": {}, "length": 2}}}}, "motion": "static", "material": "m",
        "position": [0, {}, 0.1], "orientation": {{"axis": [1, 0, 0], "angleDegrees": 90}}}},
      {{"name": "bar", "shape": {{"{}": {{"radius": {}, "length": 2}}}}, "mass": 2, "material": "m",
        "inertiaTensor": [[0.5, 0, 0], [0, 0.02, 0], [0, 0, 0.5]], "orientation": {{"axis": [0, 0, 1], "angleDegrees": 90}},
        "position": [0, {}, 0], "linearVelocity": [{}, 0, 0], "angularVelocity": [0, 0, {}]}}])",
      duration, accuracy, 1 / duration, shape, lower, -lower, shape, upper, upper, upper * spin, -spin)));
}

// The bar's line of contact rolls on the fixed one: at a tilt a it touches at a distance R a from its middle, and the
// place on the fixed bar has come down by a as well. (k + r^2 + R^2 a^2) a'' = -R^2 a a'^2 - g (R a cos a - r sin a),
// R the fixed radius and r its own, k = I / m.
TEST(EdgeContact, BarRocksOnABarAcrossIt) {
  const double lower = 0.2, upper = 0.05, inertia = 0.25, spin = 1, duration = 1.5;
  const auto rate = [&](const Coordinates<2>& x) {
    const auto [a, da] = x;
    const double pull = lower * a * std::cos(a) - upper * std::sin(a);
    return Coordinates<2>{
        da, -(lower * lower * a * da * da + kGravity * pull) / (inertia + upper * upper + lower * lower * a * a)};
  };
  const auto [a, da] = integratedTo<2>(duration, {0, spin}, rate);
  const Vec3 along(std::cos(a), -std::sin(a), 0), normal(std::sin(a), std::cos(a), 0);
  for (const char* shape : {"capsule", "cylinder"})
    for (const double accuracy : {1e-4, 1e-6, 1e-8, 1e-10}) {
      const Trajectory run = barOnBar(shape, accuracy, duration, lower, upper, spin);
      expectPromised(run);
      const BodyState bar = endOf(run);
      const Vec3 place = (lower + upper) * normal - lower * a * along - lower * Vec3::UnitY();
      EXPECT_LT((bar.position - place).norm(), 10 * accuracy) << shape << " " << accuracy;
      EXPECT_LT((bar.angularVelocity - Vec3(0, 0, -da)).norm(), 10 * accuracy) << shape << " " << accuracy;
    }
}

/// The state at which `margin` of it falls to zero, from x on.
template <std::size_t N, class Rate, class Margin>
Coordinates<N> integratedUntil(const Margin& margin, const Coordinates<N>& x, const Rate& rate) {
  double early = 0, late = 1;
  while (margin(integratedTo<N>(late, x, rate)) > 0) late *= 2;
  while (late - early > 1e-12) {
    const double middle = (early + late) / 2;
    (margin(integratedTo<N>(middle, x, rate)) > 0 ? early : late) = middle;
  }
  return integratedTo<N>(early, x, rate);
}

// A ball that comes to an edge rolls over it, (7/5) r a'' = g sin a, until the friction (2/7) m g sin a is mu times the
// normal force m (g cos a - r a'^2); then it slides, r a'' = g sin a - mu (g cos a - r a'^2), until that is zero; then
// it flies on with r a' cos a along x. Capsules and cylinders along the edge, of the same moment of inertia, do the
// same.
TEST(EdgeContact, RoundBodiesRollAndSlideOverAnEdgeUntilNothingPresses) {
  const double radius = 0.1, speed = 0.3, friction = 0.5;
  using Turning = Coordinates<2>;  // a and a'
  const auto normal = [&](const Turning& x) { return kGravity * std::cos(x[0]) - radius * x[1] * x[1]; };
  const auto rolling = [&](const Turning& x) { return Turning{x[1], kGravity * std::sin(x[0]) / (1.4 * radius)}; };
  const auto sliding = [&](const Turning& x) {
    return Turning{x[1], (kGravity * std::sin(x[0]) - friction * normal(x)) / radius};
  };
  const auto grip = [&](const Turning& x) { return friction * normal(x) - kGravity * std::sin(x[0]) / 3.5; };
  const Turning slip = integratedUntil<2>(grip, {0, speed / radius}, rolling);
  const Turning end = integratedUntil<2>(normal, slip, sliding);
  for (const char* shape : {R"("sphere": {"radius": 0.1})", R"("capsule": {"radius": 0.1, "length": 0.4})",
                            R"("cylinder": {"radius": 0.1, "length": 0.4})"})
    for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
      const Trajectory run = simulate(sceneWith(fmt::format(
          R"("duration": 0.8, "accuracy": {}, "output": {{"framesPerSecond": 10}},
          "materials": {{"m": {{"restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
          {{"name": "table", "shape": {{"box": {{"size": [4, 0.1, 2]}}}}, "position": [-2, -0.05, 0],
            "motion": "static", "material": "m"}},
          {{"name": "round", "shape": {{{}}}, "mass": 2, "material": "m", "position": [-0.05, 0.1, 0],
            "inertiaTensor": [[0.008, 0, 0], [0, 0.008, 0], [0, 0, 0.008]], "linearVelocity": [{}, 0, 0],
            "angularVelocity": [0, 0, {}], "orientation": {{"axis": [1, 0, 0], "angleDegrees": 90}}}}])",
          accuracy, friction, friction, shape, speed, -speed / radius)));
      expectPromised(run);
      EXPECT_NEAR(endOf(run).linearVelocity.x(), radius * end[1] * std::cos(end[0]), 10 * accuracy) << shape;
    }
}

/// A cylinder that is dropped on a floor at an angle (degrees) between its axis and the vertical, rolls on its rim, and
/// lands on the other one; the state after 0.8 s.
Trajectory onFloor(const std::string& floor, double length, double tilt, double spin, double accuracy) {
  return simulate(sceneWith(fmt::format(
      R"("duration": 0.8, "accuracy": {}, "output": {{"framesPerSecond": 50}},
      "materials": {{"m": {{"restitution": 0.2, "staticFriction": 0.4, "dynamicFriction": 0.4}}}}, "bodies": [
      {{"name": "floor", {}, "motion": "static", "material": "m"}},
      {{"name": "cylinder", "shape": {{"cylinder": {{"radius": 0.06, "length": {}}}}}, "mass": 1, "material": "m",
        "position": [0, 0.15, 0], "orientation": {{"axis": [1, 0, 0.2], "angleDegrees": {}}},
        "linearVelocity": [0.3, 0, 0], "angularVelocity": [1, {}, -2]}}])",
      accuracy, floor, length, tilt, spin)));
}

// A table is as good as a plane to a rim that rolls on it. Motions differ by rounding, which impacts make larger.
TEST(EdgeContact, RimsRollOnATableAsOnAPlane) {
  for (const auto& [length, tilt, spin] : {std::tuple(0.01, 60.0, 0.0), std::tuple(0.05, 85.0, 10.0),
                                           std::tuple(0.2, 85.0, 0.0), std::tuple(0.05, 89.0, -5.0)})
    for (const double accuracy : {1e-6, 1e-8}) {
      const Trajectory plane = onFloor(R"("shape": {"plane": {}})", length, tilt, spin, accuracy);
      const Trajectory table = onFloor(R"("shape": {"box": {"size": [20, 0.2, 20]}}, "position": [0, -0.1, 0])", length,
                                       tilt, spin, accuracy);
      expectPromised(plane);
      expectPromised(table);
      EXPECT_FALSE(eventsOf(plane, EventKind::impact).empty());
      const BodyState on = endOf(plane), other = endOf(table);
      EXPECT_LT((on.position - other.position).norm(), 1e-9) << length << " " << tilt << " " << accuracy;
      EXPECT_LT((on.linearVelocity - other.linearVelocity).norm(), 1e-8) << length << " " << tilt << " " << accuracy;
    }
}

}  // namespace
}  // namespace cradle
