// A ball whose centre of mass lies off its middle, spun up on a floor: it slides, and its spin turns it over
// (tippe-top).

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/experiment.h"

namespace cradle {
namespace {

// Jellett's integral: with the centre of mass C off the ball's middle along the axis of symmetry, L . (P - C) is kept,
// where P is the ball's lowest point and L the angular momentum about C. Forces and impulses at P add (P - C) x F to L,
// which is across P - C; the rest is L . (w x axis), where L, w and the axis lie in one plane (J. H. Jellett, "A
// treatise on the theory of friction", 1872). Nothing is asked of the law of friction, nor that the ball touches.
struct TippeTop {
  double radius = 0.02, offset = 0.004, mass = 0.02;  // m, m, kg
  double along = 0.38, across = 0.40;                 // moments of inertia in mass radius^2

  double jellett(const BodyState& state) const {
    const Vec3 axis = state.orientation * Vec3::UnitY();  // from the middle away from the centre of mass
    const Vec3 toContact = offset * axis - radius * Vec3::UnitY();
    const Vec3 spin = state.angularVelocity, spinAlong = spin.dot(axis) * axis;
    const Vec3 angularMomentum = mass * radius * radius * (along * spinAlong + across * (spin - spinAlong));
    return angularMomentum.dot(toContact);
  }

  /// Spins about the vertical.
  Trajectory run(double tiltDegrees, double spin, double friction, double restitution, double drop,
                 double accuracy) const {
    const double unit = mass * radius * radius;
    const Vec3 middle(0, radius + drop, 0);
    return simulate(sceneWith(fmt::format(
        R"("duration": 1.5, "accuracy": {}, "output": {{"framesPerSecond": 100}},
        "materials": {{"m": {{"restitution": {}, "staticFriction": {}, "dynamicFriction": {}}}}},
        "bodies": [{{"name": "floor", "material": "m", "shape": {{"plane": {{}}}}, "motion": "static"}},
          {{"name": "top", "material": "m", "mass": {}, "shape": {{"sphere": {{"radius": {}}}}},
            "centerOfMass": [0, {}, 0], "inertiaTensor": [[{}, 0, 0], [0, {}, 0], [0, 0, {}]],
            "position": {}, "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}}, "angularVelocity": {}}}])",
        accuracy, restitution, friction, friction, mass, radius, -offset, across * unit, along * unit, across * unit,
        vectorText(middle), tiltDegrees, vectorText(Vec3(0, spin, 0)))));
  }

  /// As part of the largest angular momentum times the radius.
  double jellettError(const Trajectory& run) const {
    double error = 0, largest = 0;
    const double start = jellett(run.frames[0].states[0]);
    for (const Frame& frame : run.frames) {
      error = std::max(error, std::abs(jellett(frame.states[0]) - start));
      largest = std::max(largest, mass * radius * radius * along * frame.states[0].angularVelocity.norm() * radius);
    }
    return error / largest;
  }
};

// Some 200 rad/s for 1.5 s: 300 rad, each with an error of the accuracy.
constexpr double kTurns = 300;

TEST(TippeTop, KeepsJellettsIntegralWhileItTurnsOver) {
  const TippeTop top;
  for (const double accuracy : {1e-6, 1e-8}) {
    const Trajectory run = top.run(10, 200, 0.3, 0, 0, accuracy);
    EXPECT_LT(top.jellettError(run), kTurns * accuracy);
    double lowest = 1;  // cosine of the axis' tilt: the top turns over
    for (const Frame& frame : run.frames) lowest = std::min(lowest, (frame.states[0].orientation * Vec3::UnitY()).y());
    EXPECT_LT(lowest, -0.5);
  }
}

TEST(TippeTop, KeepsJellettsIntegralThroughImpacts) {
  const TippeTop top;
  for (const double restitution : {0.3, 0.7})
    EXPECT_LT(top.jellettError(top.run(35, 150, 0.2, restitution, 0.05, 1e-8)), kTurns * 1e-8);
}

}  // namespace
}  // namespace cradle
