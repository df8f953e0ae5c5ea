#include "simulate/joint_coordinates.h"

#include <gtest/gtest.h>

#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

/// Two bodies joined by a hinge about the axis (0, 0.6, 0.8).
const char* const kHinged = R"("duration": 9, "bodies": [
    {"name": "a", "mass": 1, "shape": {"box": {"size": [1, 2, 3]}}, "collision": "none"},
    {"name": "b", "mass": 2, "shape": {"box": {"size": [3, 2, 1]}}, "collision": "none"}],
    "hinges": [{"bodyA": "a", "anchorA": [0, 0, 0], "bodyB": "b", "anchorB": [0, 0, 0], "axis": [0, 0.6, 0.8]}])";
const Vec3 kHingeAxis(0, 0.6, 0.8);

/// Turns body a by q and body b against it, at a time (s): q = rate t + acceleration t^2 / 2 is shared by both.
struct Turning {
  double rate, acceleration;  // rad/s, rad/s^2

  double angle(double time) const { return rate * time + acceleration * time * time / 2; }
  double velocity(double time) const { return rate + acceleration * time; }

  VectorX stateAt(double time, VectorX state) const {
    for (const int body : {0, 1}) {
      const double share = body == 0 ? 0.7 : -0.3;
      setOrientation(state, body, rotationAbout(kHingeAxis, share * angle(time)));
      angularVelocity(state, body) = share * velocity(time) * kHingeAxis;
    }
    return state;
  }
};

/// A motion of constant acceleration turns by the mean of a step's first and last velocity, so that steps of several
/// turns are told apart; rounding is that of an orientation.
TEST(JointCoordinates, CountTurns) {
  for (const Turning& turning : {Turning{3, 0}, Turning{-40, 0}, Turning{25, 30}, Turning{25, -30}}) {
    OneIsland world(kHinged);
    JointCoordinates coordinates(world.island.assembly);
    std::vector<JointState> found(1);
    const double step = 0.4;
    for (int i = 0; i < 20; ++i) {
      const double end = (i + 1) * step;
      coordinates.beginStep(turning.stateAt(i * step, world.state()));
      coordinates.endStep(step, turning.stateAt(end, world.state()));
      for (const double before : {0.0, -0.1, -0.25, -0.4}) {
        coordinates.find(before, turning.stateAt(end + before, world.state()), found);
        EXPECT_NEAR(found[0].coordinate, turning.angle(end + before), 1e-12) << end << " " << before;
        EXPECT_NEAR(found[0].velocity, turning.velocity(end + before), 1e-12);
      }
    }
  }
}

/// What an impact at the end of a step does to velocities says nothing of the step.
TEST(JointCoordinates, FollowTheMotionBeforeAnImpact) {
  OneIsland world(kHinged);
  JointCoordinates coordinates(world.island.assembly);
  std::vector<JointState> found(1);
  const Turning fast{50, 0}, back{-50, 0};
  coordinates.beginStep(fast.stateAt(0, world.state()));
  coordinates.endStep(0.3, fast.stateAt(0.3, world.state()));
  coordinates.find(0, back.stateAt(-0.3, world.state()), found);
  EXPECT_NEAR(found[0].coordinate, 15, 1e-12);
  EXPECT_NEAR(found[0].velocity, -50, 1e-12);
  coordinates.find(-0.1, fast.stateAt(0.2, world.state()), found);
  EXPECT_NEAR(found[0].coordinate, 10, 1e-12);
}

/// Anchors that are apart by less than what a scene may be off by still start at 0.
TEST(JointCoordinates, OfASliderIsADisplacement) {
  OneIsland world(
      R"("duration": 9, "bodies": [{"name": "a", "mass": 1, "shape": {"sphere": {"radius": 1}}, "position": [1, 2, 3]}],
    "sliders": [{"bodyA": "a", "anchorA": [0.5, 0, 0], "anchorB": [1.5000001, 2, 3], "axis": [1, 0, 0]}])");
  JointCoordinates coordinates(world.island.assembly);
  std::vector<JointState> found(1);
  coordinates.find(0, world.state(), found);
  EXPECT_EQ(found[0].coordinate, 0);
  VectorX moved = world.state();
  centerOfMass(moved, 0).x() -= 0.25;
  linearVelocity(moved, 0).x() = 7;
  coordinates.find(0, moved, found);
  EXPECT_NEAR(found[0].coordinate, -0.25, 1e-15);
  EXPECT_EQ(found[0].velocity, 7);
}

}  // namespace
}  // namespace cradle
