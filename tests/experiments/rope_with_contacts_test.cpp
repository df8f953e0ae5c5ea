// Ropes of bodies that contact steps move: what contacts push, ropes hold within the same step.

#include <gtest/gtest.h>

#include <utility>

#include "experiments/experiment.h"

namespace cradle {
namespace {

// A box of 120 kg falls onto a leaning cylinder of 40 g, which a rope ties to a point below the floor: it is squeezed
// out beneath the box, and neither lengthens the rope nor enters the floor.
constexpr double kRopeLength = 0.0607528, kTiedRadius = 0.025, kTiedLength = 0.2;
const Vec3 kHeld(0, -0.1, kTiedRadius), kPeg(0.7326835, -0.0596993, 0.4176552);

Scene squeezedCylinder(double accuracy, double restitution) {
  return sceneWith(fmt::format(R"("duration": 0.3, "accuracy": {},
    "materials": {{"smooth": {{"restitution": 0, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "smooth"}},
    {{"name": "cylinder", "shape": {{"cylinder": {{"radius": {}, "length": {}}}}}, "mass": 0.0393, "material": "smooth",
      "position": [0.7419657, 0.0991026, 0.4396233],
      "orientation": {{"w": 0.9659258262890684, "x": 0.2588190451025208, "y": 0, "z": 0}}}},
    {{"name": "box", "shape": {{"box": {{"size": [0.03, 0.2, 0.2]}}}}, "mass": 120, "material": "smooth",
      "position": [0.7419657, 0.2982062, 0.4089885]}}],
    "ropes": [{{"bodyA": "cylinder", "anchorA": {}, "anchorB": {}, "maxLength": {}, "restitution": {}}}])",
                               accuracy, kTiedRadius, kTiedLength, vectorText(kHeld), vectorText(kPeg), kRopeLength,
                               restitution));
}

/// m: of the lowest point of the cylinder.
double lowestOf(const BodyState& cylinder) {
  const double up = (cylinder.orientation * Vec3::UnitY()).y();
  return cylinder.position.y() - 0.5 * kTiedLength * std::abs(up) - kTiedRadius * std::sqrt(std::max(0.0, 1 - up * up));
}

// What steps take out along straight lines is a twentieth of a size at most, and leaves its square, 1/400 of the radius
// or 6e-5 m, to the next step.
TEST(RopeOfASqueezedCylinder, KeepsItsLengthAboveTheFloor) {
  const double most = 6e-5;
  for (const auto& [accuracy, restitution] : {std::pair(1e-3, 0.0), std::pair(1e-3, 0.5), std::pair(1e-4, 0.0)})
    for (const Frame& frame : simulate(squeezedCylinder(accuracy, restitution)).frames) {
      SCOPED_TRACE(fmt::format("accuracy {}, restitution {}, {} s", accuracy, restitution, frame.time));
      const BodyState& cylinder = frame.states[0];
      EXPECT_LT((cylinder.position + cylinder.orientation * kHeld - kPeg).norm(), kRopeLength + most);
      EXPECT_GT(lowestOf(cylinder), -most);
    }
}

// A hand pulls a box off the ground by a rope, and a drum at the box by another one. As an edge of the box presses on
// the drum, contact steps take over from events and give back to them: what these leave of the ropes' errors is no
// energy from nowhere, however fine the accuracy is with which the run goes on.
TEST(RopesOfAHoist, GoBackToEventsAfterContactSteps) {
  const Trajectory run = simulate(sceneWith(R"("duration": 0.3, "accuracy": 1e-11, "output": {"framesPerSecond": 100},
    "materials": {"m": {"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.5}}, "bodies": [
    {"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "m"},
    {"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven", "collision": "none", "position": [0, 1.5, 0],
      "keyFrames": [{"time": 0}, {"time": 0.883445, "position": [0.96875, 3.993048, 0]},
      {"time": 1.915653, "position": [0, 3.684775, -0.845621]}]},
    {"name": "box", "shape": {"box": {"size": [0.4, 0.3, 0.5]}}, "mass": 60, "material": "m", "position": [0, 0.15, 0],
      "linearVelocity": [0.979193, 1.048319, -1.531999]},
    {"name": "drum", "shape": {"cylinder": {"radius": 0.194648, "length": 0.246352}}, "mass": 29.3, "material": "m",
      "position": [0.6, 0.6, 0]}],
    "ropes": [{"bodyA": "box", "anchorA": [0.1, 0.15, 0], "bodyB": "hand", "anchorB": [0, 0, 0], "maxLength": 1.602228},
    {"bodyA": "box", "bodyB": "drum", "anchorB": [0, 0, 0], "maxLength": 0.971139}])"));
  const EnergyBalance& energy = run.frames.back().energy;
  EXPECT_LT(std::abs(energy.numerical), 1e-4 * energy.kinetic);
}

}  // namespace
}  // namespace cradle
