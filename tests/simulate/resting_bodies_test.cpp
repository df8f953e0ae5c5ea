#include "simulate/resting_bodies.h"

#include <gmock/gmock.h>

#include <cmath>

#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kNear = 1e-9;  // m: contacts of what is placed to touch

std::vector<int> letSleep(OneIsland& at, double time = 0) {
  return at.island.resting.letSleep(time, at.contactsWithin(kNear), at.state());
}

std::string floorAnd(const std::string& bodies, double friction = 0.5, const std::string& more = "") {
  return fmt::format(R"("duration": 9, "materials": {{"rough": {{"staticFriction": {}, "dynamicFriction": {}}}}},
    "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "rough"}}, {}]{})",
                     friction, friction / 2, bodies, more);
}

/// A box of 0.4 x 0.2 x 0.6 m with its bottom at height y.
std::string brick(const std::string& name, double x, double y, const std::string& more = "") {
  return fmt::format(R"({{"name": "{}", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "material": "rough",
    "position": [{}, {}, 0]{}}})",
                     name, x, y + 0.1, more);
}

std::string tilted(double angle) {
  return fmt::format(R"(, "gravity": [{}, {}, 0])", kGravity * std::sin(angle), -kGravity * std::cos(angle));
}

// Coulomb: a body stays on a slope up to the angle whose tangent is the static friction. On one box there are four
// supports, and under four boxes of a stack sixteen, which are solved as a sparse problem.
TEST(RestingBodies, StayOnSlopesThatFrictionHolds) {
  for (const double part : {0.99, 1.01})
    for (const int boxes : {1, 4}) {
      std::string bodies;
      for (int i = 0; i < boxes; ++i) bodies += (i > 0 ? ", " : "") + brick(fmt::format("b{}", i), 0, 0.2 * i);
      // A friction of 0.2: the line of gravity through the centre of the stack, 0.4 m high, leaves by 0.08 m of 0.2 m.
      OneIsland at(floorAnd(bodies, 0.2, tilted(std::atan(part * 0.2))));
      EXPECT_EQ(letSleep(at).size(), part < 1 ? static_cast<std::size_t>(boxes) : 0) << part << " " << boxes;
    }
}

// The stack tips over its lower edge where the line of gravity leaves its bottom: tan(angle) = 0.2 m / 0.4 m.
TEST(RestingBodies, StayOnSlopesThatDoNotTipThemOver) {
  for (const double part : {0.99, 1.01}) {
    std::string bodies;
    for (int i = 0; i < 4; ++i) bodies += (i > 0 ? ", " : "") + brick(fmt::format("b{}", i), 0, 0.2 * i);
    OneIsland at(floorAnd(bodies, 0.9, tilted(std::atan(part * 0.5))));
    EXPECT_EQ(letSleep(at).size(), part < 1 ? 4u : 0u) << part;
  }
}

// A box over the edge of a table, with its centre of mass 0.07 m to that side: its middle may be 0.07 m before the
// edge.
TEST(RestingBodies, StayWhereTheCentreOfMassIsSupported) {
  for (const double beyond : {-1e-3, 1e-3}) {
    OneIsland at(floorAnd(R"({"name": "table", "shape": {"box": {"size": [2, 1, 2]}}, "motion": "static",
        "material": "rough", "position": [-1, 0.5, 0]}, )" +
                          brick("box", -0.07 + beyond, 1, R"(, "mass": 3, "centerOfMass": [0.07, 0.01, 0.02])")));
    EXPECT_EQ(letSleep(at).size(), beyond < 0 ? 1u : 0u) << beyond;
  }
}

// What moves counts as slow if its kinetic energy, as that of a point at its rim, could not lift it by 1e-7 of its
// size: v^2 + (size w)^2 < 2 g 1e-7 size. It is put to rest without a trace but for the ledger.
TEST(RestingBodies, AreThoseThatCouldNotLiftThemselves) {
  for (const double part : {0.99, 1.01}) {
    OneIsland at(floorAnd(brick("box", 0, 0, R"(, "mass": 3, "centerOfMass": [0.07, 0.01, 0.02])")));
    const double size = at.island.assembly.radii[0];
    EXPECT_NEAR(size, Vec3(0.27, 0.11, 0.32).norm(), 1e-15);
    const double speed = part * std::sqrt(2 * kGravity * 1e-7 * size);
    linearVelocity(at.state(), 0) = 0.6 * speed * Vec3(1, 2, -2) / 3;
    angularVelocity(at.state(), 0) = 0.8 * speed / size * Vec3(2, 1, 2) / 3;
    const Vec3 spin = angularVelocity(at.state(), 0);
    const double kinetic = 1.5 * linearVelocity(at.state(), 0).squaredNorm() +
                           spin.dot(worldInertia(at.mechanism().bodies[0], 0, at.state()) * spin) / 2;
    if (part > 1) {
      EXPECT_THAT(letSleep(at), IsEmpty());
      EXPECT_FALSE(at.island.resting.anyRests());
      continue;
    }
    EXPECT_THAT(letSleep(at), ElementsAre(0));
    EXPECT_TRUE(at.island.resting.allRest());
    EXPECT_TRUE(linearVelocity(at.state(), 0).isZero(0) && angularVelocity(at.state(), 0).isZero(0));
    EXPECT_NEAR(numericalEnergy(at.state()), kinetic, 1e-15 * kinetic);
  }
}

// On a smooth floor nothing stops a slow sliding: only 1e-7 of sqrt(g size), less than a fall by 5e-15 sizes gives, is
// none.
TEST(RestingBodies, DoNotSlideWithoutFriction) {
  for (const double part : {0.99, 1.01}) {
    OneIsland at(floorAnd(brick("box", 0, 0), 0));
    linearVelocity(at.state(), 0).x() = part * 1e-7 * std::sqrt(kGravity * at.island.assembly.radii[0]);
    EXPECT_EQ(letSleep(at).size(), part < 1 ? 1u : 0u);
  }
}

TEST(RestingBodies, ComeToRestWithAllThatTheyTouchOrNotAtAll) {
  const std::string two = brick("lower", 0, 0) + ", " + brick("upper", 0.1, 0.2) + ", " + brick("other", 2, 0);
  OneIsland at(floorAnd(two));
  linearVelocity(at.state(), 1) = Vec3(0, 0, 1);
  EXPECT_THAT(letSleep(at), ElementsAre(2));
  EXPECT_TRUE(at.island.resting.anyRests());
  EXPECT_FALSE(at.island.resting.allRest());
  linearVelocity(at.state(), 1).setZero();
  EXPECT_THAT(letSleep(at), ElementsAre(0, 1));
  EXPECT_TRUE(at.island.resting.allRest());
}

// A rod or a spring carries motion as touch does.
TEST(RestingBodies, ComeToRestWithAllThatTheyAreTiedTo) {
  for (const char* tie :
       {R"("rods": [{"bodyA": "one", "bodyB": "two"}])", R"("springs": [{"bodyA": "one", "bodyB": "two"}])"}) {
    OneIsland at(floorAnd(brick("one", 0, 0) + ", " + brick("two", 1, 0), 0.5, std::string(", ") + tie));
    linearVelocity(at.state(), 1) = Vec3(0, 0, 1);
    EXPECT_THAT(letSleep(at), IsEmpty());
    linearVelocity(at.state(), 1).setZero();
    EXPECT_THAT(letSleep(at), ElementsAre(0, 1));
  }
}

TEST(RestingBodies, WakeWithThoseThatTheyCameToRestWith) {
  OneIsland at(floorAnd(brick("lower", 0, 0) + ", " + brick("other", 2, 0) + ", " + brick("upper", 0.1, 0.2)));
  RestingBodies& resting = at.island.resting;
  EXPECT_THAT(letSleep(at), ElementsAre(0, 2, 1));
  EXPECT_THAT(resting.wake(3, kFixed), IsEmpty());
  EXPECT_THAT(resting.wake(3, 2), ElementsAre(0, 2));
  EXPECT_THAT(resting.wake(3, 2), IsEmpty());
  EXPECT_TRUE(resting.isResting(1));
  EXPECT_FALSE(resting.isResting(0) || resting.isResting(2));
}

TEST(RestingBodies, StayAwakeForAWhileOnceTheyWereWoken) {
  OneIsland at(floorAnd(brick("box", 0, 0)));
  at.island.resting.setStillTime(0.25);
  EXPECT_THAT(letSleep(at, 1), ElementsAre(0));  // never woken: at once
  at.island.resting.wake(2, 0);
  EXPECT_THAT(letSleep(at, 2.125), IsEmpty());
  EXPECT_THAT(letSleep(at, 2.25), ElementsAre(0));
}

// Points that hover by less than 1e-6 of the size of the smallest body carry.
TEST(RestingBodies, AreCarriedByWhatHoversHardly) {
  for (const double part : {0.99, 1.01}) {
    OneIsland at(floorAnd(brick("box", 0, 0) + R"(, {"name": "ball", "shape": {"sphere": {"radius": 0.05}},
      "position": [3, 3, 3]})"));
    const std::vector<Contact> contacts = at.contactsWithin(kNear);
    // A corner that is lifted: the box turns about the edge of the others, at z = 0.3.
    setOrientation(at.state(), 0, rotationAbout(Vec3::UnitX(), -part * 5e-8 / 0.6));
    centerOfMass(at.state(), 0).y() += part * 5e-8 / 2;
    EXPECT_EQ(at.island.resting.letSleep(0, contacts, at.state()).size(), part < 1 ? 1u : 0u) << part;
  }
}

}  // namespace
}  // namespace cradle
