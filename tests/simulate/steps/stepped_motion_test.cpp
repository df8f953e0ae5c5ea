#include "simulate/steps/stepped_motion.h"

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "experiments/ridged_ground.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;

constexpr double kTenth = 0.1;           // s: steps that are no binary fractions
constexpr double kGridTime = 1.0 / 960;  // s

/// An island that steps of one length move.
struct BySteps : OneIsland {
  template <class Source>
  BySteps(const Source& source, double timeStep)
      : OneIsland(source), ropes(island), motion(island, ropes, contactSteps(timeStep)) {}

  std::vector<double> endsOfSteps(int count) {
    std::vector<double> ends;
    for (int i = 0; i < count; ++i) motion.advance(INFINITY), ends.push_back(island.time);
    return ends;
  }
  /// The state at a fraction of the last step.
  VectorX inside(double fraction) {
    prepareInterpolant(island.rightHandSide, island.step);
    VectorX found;
    interpolate(island.step, fraction, found);
    motion.addContactMotion(fraction, found);
    return found;
  }

  LimitEvents ropes;
  SteppedMotion motion;
};

std::string steppedScene(double duration, const std::string& bodies, const std::string& more = "") {
  return fmt::format(R"("duration": {}, "materials": {{"stuff": {{"restitution": 0.5, "staticFriction": 0.3,
    "dynamicFriction": 0.2}}}}, "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static",
    "material": "stuff"}}, {}]{})",
                     duration, bodies, more);
}
std::string steppedBox(const std::string& name, const Vec3& position, const Vec3& velocity) {
  return fmt::format(R"({{"name": "{}", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "mass": 3, "material": "stuff",
    "position": {}, "linearVelocity": {}}})",
                     name, vectorText(position), vectorText(velocity));
}
std::string steppedBall(const Vec3& position, const Vec3& velocity) {
  return fmt::format(R"({{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "material": "stuff",
    "position": {}, "linearVelocity": {}}})",
                     vectorText(position), vectorText(velocity));
}

// Ends are multiples of the step, to the bit: they are not summed. The last is the end of the run.
TEST(SteppedMotion, EndsStepsAtMultiplesOfTheirLength) {
  BySteps at(R"("duration": 0.45, "bodies": [)" + cradle::ball("ball", Vec3::Zero()) + "]", kTenth);
  EXPECT_THAT(at.endsOfSteps(5), ElementsAre(kTenth, 2 * kTenth, 3 * kTenth, 4 * kTenth, 0.45));
  EXPECT_NEAR(centerOfMass(at.state(), 0).y(), -kGravity * 0.45 * 0.45 / 2, 1e-15);  // RK4 is exact
}

// A push that begins between two ends cuts a step, and so does its end.
TEST(SteppedMotion, CutsStepsWherePushesBeginAndEnd) {
  BySteps at(R"("duration": 1, "gravity": [0, 0, 0], "bodies": [)" + cradle::ball("ball", Vec3::Zero()) +
                 R"(], "pushes": [{"body": "ball", "point": [0, 0, 0], "force": [8, 0, 0], "start": 0.125,
                 "duration": 0.125}])",
             kTenth);
  EXPECT_THAT(at.endsOfSteps(5), ElementsAre(kTenth, 0.125, 2 * kTenth, 0.25, 3 * kTenth));
  EXPECT_NEAR(linearVelocity(at.state(), 0).x(), 1, 1e-15);
}

// The impact is at sqrt(2 h / g), with a gap of a thousandth of 1e-10 m at 1.4 m/s; the step after it ends where the
// one that it cut would have ended.
TEST(SteppedMotion, CutsStepsAtImpacts) {
  BySteps at(steppedScene(1, steppedBall(Vec3(0, 0.2, 0), Vec3::Zero())), kTenth);
  const double time = std::sqrt(2 * 0.1 / kGravity), speed = kGravity * time;
  const std::vector<double> ends = at.endsOfSteps(2);
  EXPECT_EQ(ends[0], kTenth);
  EXPECT_NEAR(ends[1], time, 1e-12);
  EXPECT_NEAR(linearVelocity(at.state(), 0).y(), speed / 2, 1e-11);
  EXPECT_NEAR(impactEnergy(at.state()), 0.75 * speed * speed, 1e-10);
  EXPECT_EQ(at.endsOfSteps(1)[0], 2 * kTenth);
}

// Contact holds a box against gravity: free motion falls by g s^2 h^2 / 2 within the step, contact gives that back. A
// box that slides with a = -mu g goes v s h - mu g s^2 h^2 / 2, and friction has taken mu m g times that.
TEST(SteppedMotion, AddsTheMotionOfContactsInsideAStep) {
  for (const double speed : {0.0, 0.5}) {
    BySteps at(steppedScene(1, steppedBox("box", Vec3(0, 0.1, 0), Vec3(speed, 0, 0))), kGridTime);
    at.motion.advance(0);
    ASSERT_EQ(at.island.time, kGridTime);
    const double friction = speed > 0 ? 0.2 * kGravity : 0;
    for (const double part : {0.25, 0.5, 1.0}) {
      const VectorX inside = at.inside(part);
      const double time = part * kGridTime, way = speed * time - friction * time * time / 2;
      // Impulses are found to 1e-7 of g h.
      EXPECT_NEAR(centerOfMass(inside, 0).x(), way, 1e-7 * kGravity * kGridTime * kGridTime) << part;
      EXPECT_NEAR(centerOfMass(inside, 0).y(), 0.1, 1e-7 * kGravity * kGridTime * kGridTime) << part;
      EXPECT_NEAR(linearVelocity(inside, 0).x(), speed - friction * time, 1e-7 * kGravity * kGridTime) << part;
      EXPECT_NEAR(linearVelocity(inside, 0).y(), 0, 1e-7 * kGravity * kGridTime) << part;
      EXPECT_NEAR(frictionEnergy(inside), 3 * friction * way, 1e-6 * 3 * friction * way) << part;
    }
  }
}

// A mass that its spring swings with omega h = 3 needs steps of a part of h: a half, a quarter, an eighth ... Each has
// an error of at most 1e-5 m, and the next is four times as long at most.
TEST(SteppedMotion, TakesPartsOfStepsWhereForcesChangeQuickly) {
  BySteps at(R"("duration": 1, "gravity": [0, 0, 0], "bodies": [)" + cradle::ball("ball", Vec3(1.01, 0, 0)) +
                 R"(], "springs": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": 900,
                 "restLength": 1}])",
             kTenth);
  int steps = 0;
  double last = 0;
  for (; at.island.time < 0.2; ++steps) {
    at.motion.advance(INFINITY);
    const double part = kTenth / at.island.step.timeStep;
    if (steps == 0) {
      EXPECT_EQ(std::exp2(std::round(std::log2(part))), part);
      EXPECT_GE(part, 4);
    } else {
      EXPECT_LE(at.island.step.timeStep, 4 * last * (1 + 1e-12));
    }
    last = at.island.step.timeStep;
  }
  EXPECT_EQ(at.island.time, 2 * kTenth);
  EXPECT_NEAR(centerOfMass(at.state(), 0).x(), 1 + 0.01 * std::cos(6), 1e-5 * steps);
}

// A body flies past the anchor of its spring, a millimetre beside it at 3 m/s: the force turns round within 3 ms,
// before and after which steps of 0.05 s are short enough. Parts of a step grow by four at most, one after the other.
TEST(SteppedMotion, LetsPartsOfStepsGrowByFour) {
  const double length = 0.05;
  double shortest = length, growth = 0;
  for (int start = 0; start < 8; ++start) {  // so that the passing is at any place in its step
    BySteps at(R"("duration": 1, "gravity": [0, 0, 0], "bodies": [)" +
                   cradle::ball("ball", Vec3(-0.3 - 0.02 * start, 1e-3, 0), Vec3(5, 0, 0)) +
                   R"(], "springs": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": 25,
                   "restLength": 1}])",
               length);
    double last = length;
    while (at.island.time < 0.3) {
      at.motion.advance(INFINITY);
      growth = std::max(growth, at.island.step.timeStep / last);
      shortest = std::min(shortest, last = at.island.step.timeStep);
    }
  }
  EXPECT_LT(shortest, length / 8);
  EXPECT_NEAR(growth, 4, 1e-9);
}

// A spring throws a ball at the floor: the interpolant, by which the impact is found, is off by the order of the step,
// and the step is taken again until its end leaves no more than a thousandth of the gap that touches.
TEST(SteppedMotion, EndsStepsWhereGapsAreClosed) {
  BySteps at(steppedScene(1, steppedBall(Vec3(0, 0.3, 0), Vec3::Zero()),
                          R"(, "springs": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, -0.9, 0],
                          "stiffness": 60, "restLength": 0}])"),
             kTenth);
  while (impactEnergy(at.state()) == 0 && at.island.time < 1) at.motion.advance(INFINITY);
  ASSERT_GT(impactEnergy(at.state()), 0);
  const double touch = 1e-9 * 0.1;
  EXPECT_NEAR(centerOfMass(at.state(), 0).y(), 0.1, 1e-3 * touch + 1e-16);
}

// Half the radius of a ball in a step, from where a sheet is near, whose other side is an outside as well.
TEST(SteppedMotion, GoesHalfARadiusAtMostBesideASheet) {
  for (const bool isSheet : {true, false}) {
    const LoadedModel ground = ridgedGround({{-2, 0}, {0, 0.1}, {2, 0}}, isSheet);
    const Scene scene =
        parseScene(R"({"schema": "cradle-scene/1", "name": "beside", "duration": 1, "accuracy": 1e-3, "bodies": [
            {"name": "ground", "shape": {"mesh": "ground.obj"}, "collision": "mesh", "motion": "static"},
            {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [-1, 0.2, 0],
             "linearVelocity": [0, 30, 40], "angularVelocity": [0, 0, 100]}]})",
                   "beside.json", [&](const MeshReference&) { return ground; })
            .scene;
    BySteps at(scene, kGridTime);
    at.island.findNearPairsNow(0.1);
    // A point of the ball moves with at most 50 m/s + 100/s x 0.1 m.
    EXPECT_NEAR(at.endsOfSteps(1)[0], isSheet ? 0.05 / 60 : kGridTime, 1e-15);
  }
}

// Boxes that lie have four contacts each: events serve twelve.
TEST(SteppedMotion, LeavesAFewContactsToEvents) {
  for (const int boxes : {0, 3, 4}) {
    std::string bodies = steppedBall(Vec3(0, 5, 0), Vec3::Zero());
    for (int i = 0; i < boxes; ++i) bodies += ", " + steppedBox(fmt::format("b{}", i), Vec3(i, 0.1, 0), Vec3(0, 0, 1));
    BySteps at(steppedScene(1, bodies), kGridTime);
    at.motion.advance(INFINITY);
    EXPECT_EQ(at.motion.isFree(), boxes == 0);
    EXPECT_EQ(at.motion.mayServeEvents(), boxes < 4);
  }
}

// Nothing moves until a push begins, and steps are counted from there as if they had been taken. In the step in which
// the box begins to slide, the static friction acts, then the dynamic one.
TEST(SteppedMotion, LetsTimePassAtRest) {
  BySteps at(steppedScene(2, steppedBox("box", Vec3(0, 0.1, 0), Vec3::Zero()),
                          R"(, "pushes": [{"body": "box", "point": [0, 0, 0], "force": [30, 0, 0], "start": 0.55,
                          "duration": 1}])"),
             kTenth);
  const VectorX before = at.state();
  for (int i = 0; i < 40 && !at.motion.isAtRest(); ++i) at.motion.advance(INFINITY);
  if (!at.motion.isAtRest()) at.island.resting.bringToRest({0}, at.state());
  EXPECT_TRUE(at.motion.isAtRest());
  at.motion.restUntil(9);
  EXPECT_EQ(at.island.time, 0.55);
  EXPECT_FALSE(at.motion.isAtRest());
  EXPECT_LT((centerOfMass(at.state(), 0) - centerOfMass(before, 0)).norm(), 1e-6);
  EXPECT_EQ(at.endsOfSteps(1)[0], 6 * kTenth);
  const double first = linearVelocity(at.state(), 0).x();
  EXPECT_NEAR(first, (10 - 0.3 * kGravity) * (0.6 - 0.55), 1e-6);
  EXPECT_EQ(at.endsOfSteps(1)[0], 7 * kTenth);
  EXPECT_NEAR(linearVelocity(at.state(), 0).x() - first, (10 - 0.2 * kGravity) * kTenth, 1e-6);
}

// A step of free motion leaves a rod longer than it is; projected, it is right to rounding, and the energy of that is
// booked.
TEST(SteppedMotion, KeepsConstraintsToRoundingAtEnds) {
  BySteps at(R"("duration": 1, "bodies": [)" + cradle::ball("ball", Vec3(0.6, -0.8, 0), Vec3(0, 0, 2)) +
                 R"(], "rods": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}])",
             0.02);
  const double constant = energyConstant(at.mechanism(), at.state());
  for (int i = 0; i < 5; ++i) {
    at.motion.advance(INFINITY);
    EXPECT_TRUE(at.motion.keepsConstraints());
    EXPECT_NEAR(centerOfMass(at.state(), 0).norm(), 1, 1e-15);
    EXPECT_NEAR(centerOfMass(at.state(), 0).dot(linearVelocity(at.state(), 0)), 0, 1e-14);
    EXPECT_NEAR(energyConstant(at.mechanism(), at.state()), constant, 1e-13);
  }
}

// Balls that strike in the second step cut it three times, and the fourth strikes inside what is left of it. Up to its
// end velocities are those of free motion, and friction has taken nothing of the boxes that slide: contact has lifted
// bodies alone, against m g.
TEST(SteppedMotion, LeavesFrictionToTheEndOfAStepWithAnImpact) {
  std::string bodies = steppedBox("b", Vec3(0, 0.1, 0), Vec3(0, 0, 0.5));
  for (int i = 1; i < 3; ++i) bodies += ", " + steppedBox(fmt::format("b{}", i), Vec3(i, 0.1, 0), Vec3(0, 0, 0.5));
  for (int i = 3; i < 7; ++i)
    bodies += fmt::format(R"(, {{"name": "ball{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2,
        "material": "stuff", "position": [{}, {}, 0], "linearVelocity": [0, -0.5, 0]}})",
                          i, i, 0.1003 + i * 0.00011);
  BySteps at(steppedScene(1, bodies), kGridTime);
  at.endsOfSteps(4);
  const double begin = at.island.time;
  const VectorX start = at.state();
  at.motion.advance(0);
  ASSERT_EQ(at.island.time, 2 * kGridTime);
  ASSERT_LT(linearVelocity(start, 6).y(), 0);
  ASSERT_GT(linearVelocity(at.state(), 6).y(), 0);
  ASSERT_GT(frictionEnergy(at.state()), frictionEnergy(start));
  for (const double part : {0.25, 0.5, 0.75}) {
    const VectorX inside = at.inside(part);
    const double time = part * (2 * kGridTime - begin);
    double lifted = 0;  // J
    for (Eigen::Index body = 0; body < 7; ++body) {
      const double fallen = linearVelocity(start, body).y() * time - kGravity * time * time / 2;
      const double mass = at.mechanism().bodies[static_cast<std::size_t>(body)].mass;
      lifted += mass * kGravity * (centerOfMass(inside, body).y() - centerOfMass(start, body).y() - fallen);
    }
    EXPECT_EQ(frictionEnergy(inside), frictionEnergy(start)) << part;
    EXPECT_NEAR(energyConstant(at.mechanism(), inside), energyConstant(at.mechanism(), start) + lifted, 1e-12) << part;
  }
}

// A motor that a step of its own body alone would bring to its target, 1 kg of 10 in one row, does not come there: all
// its force acts, beside the friction of a belt under the other 9 kg, and nothing holds the speed that it gives alone.
TEST(SteppedMotion, LeavesMotorsAllTheirForceWhereContactsHelp) {
  BySteps at(R"("duration": 1, "materials": {"stuff": {"staticFriction": 0.2, "dynamicFriction": 0.2}}, "bodies": [
                 {"name": "belt", "shape": {"box": {"size": [9, 0.2, 1]}}, "motion": "driven", "material": "stuff",
                  "position": [0, -0.1, 0], "linearVelocity": [5, 0, 0]},
                 {"name": "load", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 9, "material": "stuff",
                  "position": [0, 0.1, 0]},
                 {"name": "carriage", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "mass": 1,
                  "position": [-0.5, 0.1, 0]}],
                 "rods": [{"bodyA": "carriage", "bodyB": "load", "anchorA": [0, -0.1, 0], "anchorB": [-0.2, -0.1, 0]}],
                 "sliders": [{"bodyA": "carriage", "anchorA": [0, 0, 0], "anchorB": [-0.5, 0.1, 0], "axis": [1, 0, 0],
                              "motor": {"targetVelocity": 0.01, "maxForce": 10}}])",
             kGridTime);
  at.motion.advance(0);
  ASSERT_EQ(at.island.time, kGridTime);
  // Along x alone: all else that acts is the weight, and the rail.
  EXPECT_NEAR(linearVelocity(at.state(), 2).x(), (10 + 0.2 * 9 * kGravity) / 10 * kGridTime,
              1e-6 * kGravity * kGridTime);
}

}  // namespace
}  // namespace cradle
