#include "simulate/events/coming_to_rest.h"

#include <gmock/gmock.h>

#include <cmath>

#include "simulate/events/on_plane.h"

namespace cradle {
namespace {

/// Balls of 0.1 m and 1 kg in a row on the rough floor, as far apart as told.
std::string ballsInARow(const std::vector<double>& places) {
  std::string text;
  for (const double x : places)
    text += fmt::format(R"({}{{"name": "b{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "material": "rough",
      "position": [{}, 0.1, 0]}})",
                        text.empty() ? "" : ", ", text.size(), x);
  return text;
}

struct ToRest : OnPlane {
  explicit ToRest(const std::string& bodies, const std::string& more = R"("gravity": [0, -9.81, 0])")
      : OnPlane(bodies, more), limits(island), rest(island, limits, solver, tolerances) {}

  /// m/s: the fastest speed of a body at rest.
  double still(std::size_t body = 0) { return tolerances.maxRestSpeed(island.assembly.radii[body]); }
  void letSleep() {
    if (solver.hasConstraints()) solver.factorize(state());
    rest.letSleep(contactsWithin(tolerances.touch));
  }
  std::vector<int> resting() {
    std::vector<int> found;
    for (int body = 0; body < std::ssize(mechanism().bodies); ++body)
      if (island.resting.isResting(body)) found.push_back(body);
    return found;
  }

  LimitEvents limits;
  ComingToRest rest;
};

using testing::ElementsAre;
using testing::IsEmpty;

// Turning counts as the speed of the surface.
TEST(ComingToRest, IsOfBodiesThatAreStill) {
  for (const double part : {0.99, 1.01}) {
    ToRest at(ballsInARow({0, 2}));
    linearVelocity(at.state(), 0) = part * at.still() * Vec3(0.6, 0, 0.8);
    angularVelocity(at.state(), 1) = part * at.still() / 0.1 * Vec3(0, 0.6, 0.8);
    EXPECT_EQ(at.rest.isAnySlow(), part < 1);
    at.letSleep();
    if (part < 1)
      EXPECT_THAT(at.resting(), ElementsAre(0, 1));
    else
      EXPECT_THAT(at.resting(), IsEmpty());
    EXPECT_FALSE(at.rest.isAnySlow());  // of those that do not rest
  }
}

// Friction holds a box on a slope up to its coefficient; without anything below it, nothing does.
TEST(ComingToRest, IsOfBodiesInEquilibrium) {
  for (const double part : {0.999, 1.001}) {
    ToRest at(std::string(kBox) + "}", slopeOf(part * kStaticFriction));
    at.letSleep();
    EXPECT_EQ(at.island.resting.isResting(0), part < 1);
  }
  ToRest falling(ballsInARow({0}));
  centerOfMass(falling.state(), 0).y() += 1;
  falling.letSleep();
  EXPECT_THAT(falling.resting(), IsEmpty());
}

// Bodies on each other, on a rod, or on a spring come to rest together: none while one of them moves.
TEST(ComingToRest, IsOfAllThatAreJoined) {
  const std::string links[] = {
      R"("gravity": [0, -9.81, 0])",
      R"("gravity": [0, -9.81, 0], "rods": [{"bodyA": "b0", "anchorA": [0, 0, 0], "bodyB": "b1", "anchorB": [0, 0, 0]}])",
      R"("gravity": [0, -9.81, 0], "springs": [{"bodyA": "b0", "anchorA": [0, 0, 0], "bodyB": "b1",
         "anchorB": [0, 0, 0], "stiffness": 10}])"};
  for (int link = 0; link < 3; ++link) {
    const double second = link == 0 ? 0.2 : 0.5;
    std::string bodies = ballsInARow({0, second});
    bodies.replace(bodies.rfind("\"b"), bodies.find(',', bodies.rfind("\"b")) - bodies.rfind("\"b"), "\"b1\"");
    ToRest at(bodies, links[link]);
    angularVelocity(at.state(), 1).y() = 1;  // on the spot
    at.letSleep();
    EXPECT_THAT(at.resting(), IsEmpty()) << link;
    angularVelocity(at.state(), 1).setZero();
    at.letSleep();
    EXPECT_THAT(at.resting(), ElementsAre(0, 1)) << link;
  }
}

// Body 3 spins beside 2, which rested with 1, beside which 0 rested alone: all are woken, from the last to the first.
// A push keeps 0 from coming to rest again, and with it 1. Body 4 lies apart, and stays at rest.
TEST(ComingToRest, EndsForAllThatRestedWithWhatTouchesAMovingBody) {
  ToRest at(ballsInARow({0, 0.2, 3, 3.2, 6}));
  at.island.resting.bringToRest({0}, at.state());
  at.island.resting.bringToRest({1, 2}, at.state());
  at.island.resting.bringToRest({4}, at.state());
  at.mechanism().pushes = {{{0, Vec3::Zero()}, Vec3(-1, 0, 0)}};
  angularVelocity(at.state(), 3).y() = 1;
  at.letSleep();
  EXPECT_THAT(at.resting(), ElementsAre(4));
}

// A contact that opens joins nothing: the ball beside the one that leaves comes to rest.
TEST(ComingToRest, DoesNotWaitForWhatLeaves) {
  for (const double speed : {-1.0, 1.0}) {
    ToRest at(ballsInARow({0, 0.2}));
    linearVelocity(at.state(), 1).x() = speed;
    at.letSleep();
    if (speed > 0)
      EXPECT_THAT(at.resting(), ElementsAre(0));
    else
      EXPECT_THAT(at.resting(), IsEmpty());
  }
}

// Only the struck bodies that an impact set in motion are woken.
TEST(ComingToRest, EndsForWhatAnImpactSetsInMotion) {
  for (const double part : {0.99, 1.01}) {
    ToRest at(ballsInARow({0, 2, 4}));
    at.island.resting.bringToRest({0, 2}, at.state());
    at.island.resting.bringToRest({1}, at.state());
    linearVelocity(at.state(), 0).x() = part * at.still();
    Contact struck;
    struck.bodyA = 0, struck.bodyB = 1;
    at.rest.wakeStruck(struck);
    if (part < 1)
      EXPECT_THAT(at.resting(), ElementsAre(0, 1, 2));
    else
      EXPECT_THAT(at.resting(), ElementsAre(1));
  }
}

}  // namespace
}  // namespace cradle
