#include "simulate/steps/step_contacts.h"

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::Contains;
using testing::SizeIs;

constexpr double kStep = 1.0 / 960;  // s

struct Stepped : OneIsland {
  Stepped(double restitution, double friction, const std::string& bodies, const std::string& gravity = "[0, -9.81, 0]")
      : OneIsland(fmt::format(R"("duration": 1, "gravity": {}, "materials": {{"stuff": {{"restitution": {},
            "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [{{"name": "floor",
            "shape": {{"plane": {{}}}}, "motion": "static", "material": "stuff"}}, {}])",
                              gravity, restitution, friction, 0.6 * friction, bodies)),
        contacts(island, contactSteps(kStep)),
        ropes(island) {
    island.findNearPairsNow(0.1);
  }

  /// A step of free motion of bodies without spin, and what contact makes of it.
  void step(double time = 0) {
    const VectorX before = state();
    VectorX after = before;
    for (Eigen::Index body = 0; body < bodyCount(before); ++body) {
      if (island.resting.isResting(static_cast<int>(body))) continue;
      centerOfMass(after, body) += kStep * (linearVelocity(before, body) + kStep / 2 * mechanism().gravity);
      linearVelocity(after, body) += kStep * mechanism().gravity;
    }
    contacts.begin(time, before, after, kStep);
    contacts.solveContacts(before, kStep, ropes, after);
    state() = after;
    contacts.recordAndLetSleep(time + kStep, state());
  }
  std::vector<EventKind> kinds() {
    std::vector<EventKind> found;
    for (const Event& event : island.log.take()) found.push_back(event.kind);
    return found;
  }

  StepContacts contacts;
  LimitEvents ropes;
};

std::string boxOver(const std::string& name, double x, double bottom) {
  return fmt::format(R"({{"name": "{}", "mass": 3, "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}},
    "material": "stuff", "position": [{}, {}, 0]}})",
                     name, x, bottom + 0.1);
}
std::string smallBall(const std::string& name, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return fmt::format(R"({{"name": "{}", "mass": 2, "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "stuff",
    "position": {}, "linearVelocity": {}}})",
                     name, vectorText(position), vectorText(velocity));
}

const double kTangent = 0.4, kCosine = 1 / std::hypot(1, kTangent);
std::string slopeAlongX() {
  return vectorText(kGravity * kCosine * Vec3(kTangent, -1, 0));
}

TEST(StepContacts, TouchWithinPartsOfTheSmallestSize) {
  const Stepped at(0, 0.5, boxOver("box", 0, 0) + ", " + smallBall("ball", Vec3(3, 3, 3)));
  EXPECT_NEAR(at.contacts.tolerances().touch, 1e-10, 1e-24);
  EXPECT_NEAR(at.contacts.tolerances().margin(), 1e-7, 1e-20);
}

// tan = 0.4 and a friction of 0.5: the box stays where it is, to the error of the problem, 1e-7 of g h.
TEST(StepContacts, HoldABoxOnASlope) {
  Stepped at(0, 0.5, boxOver("box", 0, 0), slopeAlongX());
  const VectorX before = at.state();
  for (int i = 0; i < 5; ++i) at.step();
  EXPECT_LT(linearVelocity(at.state(), 0).norm(), 1e-7 * kGravity * kStep);
  EXPECT_LT((centerOfMass(at.state(), 0) - centerOfMass(before, 0)).norm(), 1e-7 * kGravity * kStep * kStep * 5);
  EXPECT_NEAR(frictionEnergy(at.state()), 0, 1e-12);
}

// A friction of 0.3 does not hold it. Dynamic, 0.18, it leaves a = g (sin - 0.18 cos) once it slides, and takes
// m 0.18 g cos a metre. The box begins with 0.1 m/s; bodies move with the mean of both velocities.
TEST(StepContacts, LetABoxSlideDownASlope) {
  Stepped at(0, 0.3, boxOver("box", 0, 0), slopeAlongX());
  linearVelocity(at.state(), 0).x() = 0.1;
  at.step();
  const double acceleration = kGravity * kCosine * (kTangent - 0.18), way = kStep * (0.1 + acceleration * kStep / 2);
  EXPECT_NEAR(linearVelocity(at.state(), 0).x(), 0.1 + acceleration * kStep, 1e-7 * kGravity * kStep);
  EXPECT_NEAR(centerOfMass(at.state(), 0).x(), way, 1e-7 * kGravity * kStep * kStep);
  EXPECT_NEAR(centerOfMass(at.state(), 0).y(), 0.1, 1e-10);
  const double taken = 3 * 0.18 * kGravity * kCosine * way;
  EXPECT_NEAR(frictionEnergy(at.state()), taken, 1e-6 * taken);
  EXPECT_NEAR(at.contacts.frictionWork().taken, taken, 1e-6 * taken);
  EXPECT_NEAR(at.contacts.frictionWork().atStart, taken * 0.1 * kStep / way, 1e-6 * taken);
}

// Of pairs that are apart nothing is held as long as impacts are searched for.
TEST(StepContacts, HoldThePairsThatTouch) {
  Stepped at(0, 0.5, boxOver("box", 0, 0) + ", " + smallBall("ball", Vec3(0.1, 0.3 + 1e-6, 0)));
  EXPECT_THAT(at.island.assembly.geometry.pairs, SizeIs(2));
  at.step();
  ASSERT_THAT(at.contacts.touching(), SizeIs(4));
  const std::vector<ColliderPair> apart = at.contacts.pairsWithoutContact();
  ASSERT_THAT(apart, SizeIs(1));
  EXPECT_FALSE(apart[0].againstPlane);
}

// A ball that has fallen for a step closes by g h more than a step before: twice as much does not rebound yet.
TEST(StepContacts, ReboundFromMoreThanTwoStepsExplain) {
  for (const double part : {0.99, 1.01}) {
    const double speed = part * 2 * kGravity * kStep;
    Stepped at(0.5, 0, smallBall("ball", Vec3(0, 0.1, 0)));
    VectorX before = at.state();
    linearVelocity(before, 0).y() = -speed + kGravity * kStep;
    centerOfMass(before, 0).y() += 1e-3;
    at.contacts.begin(0, before, at.state(), kStep);
    linearVelocity(at.state(), 0).y() = -speed;
    const double constant = energyConstant(at.mechanism(), at.state());
    at.contacts.resolveImpacts(kStep, before, at.ropes, at.state());
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), part < 1 ? 0 : speed / 2, 1e-15);
    EXPECT_NEAR(impactEnergy(at.state()), speed * speed * (part < 1 ? 1 : 0.75), 1e-15);
    EXPECT_NEAR(energyConstant(at.mechanism(), at.state()), constant, 1e-14);
    EXPECT_THAT(at.kinds(), Contains(EventKind::impact));
  }
}

// Half a step explains half as much: what it gained is counted for whole ones.
TEST(StepContacts, CountWhatAPartOfAStepGainedForTheWhole) {
  for (const double part : {0.99, 1.01}) {
    const double speed = part * 2 * kGravity * kStep;
    Stepped at(0.5, 0, smallBall("ball", Vec3(0, 0.1, 0)));
    VectorX before = at.state();
    linearVelocity(before, 0).y() = -speed + kGravity * kStep / 2;
    centerOfMass(before, 0).y() += 1e-3;
    at.contacts.begin(0, before, at.state(), kStep / 2);
    linearVelocity(at.state(), 0).y() = -speed;
    at.contacts.resolveImpacts(kStep / 2, before, at.ropes, at.state());
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), part < 1 ? 0 : speed / 2, 1e-15);
  }
}

// What is nearer than a thousandth of the fastest body's way in a step takes part: 1e-3 x 0.05 m/s x h = 5.2e-8 m.
TEST(StepContacts, StrikeTogetherWhatIsNearlyThere) {
  for (const double part : {0.9, 1.1}) {
    Stepped at(0, 0, smallBall("one", Vec3(0, 0.1, 0)) + ", " + smallBall("two", Vec3(0.2, 0.1, 0)));
    centerOfMass(at.state(), 1).x() += part * 5e-5 * kStep;
    linearVelocity(at.state(), 0) = Vec3(0.02, -0.05, 0);
    at.contacts.begin(0, at.state(), at.state(), kStep);
    at.contacts.resolveImpacts(kStep, at.state(), at.ropes, at.state());
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 0, 1e-14);
    EXPECT_NEAR(linearVelocity(at.state(), 1).x(), part < 1 ? 0.01 : 0, 1e-14);
  }
}

// More than eight contacts that act in a step are a crowd in the next one.
TEST(StepContacts, AreCrowdedByMoreThanEight) {
  for (const int boxes : {2, 3}) {
    std::string bodies;
    for (int i = 0; i < boxes; ++i) bodies += (i > 0 ? ", " : "") + boxOver(fmt::format("b{}", i), i, 0);
    Stepped at(0, 0.5, bodies);
    at.step();
    EXPECT_FALSE(at.contacts.usesTimeSteppingOnly());
    at.step();
    EXPECT_EQ(at.contacts.usesTimeSteppingOnly(), boxes > 2);
  }
}

// What lies is no part of a step until something closes on it within the step: the ball is 1 mm away, and goes 1 mm
// at 0.96 m/s.
TEST(StepContacts, WakeWhatIsReachedWithinTheStep) {
  for (const double speed : {0.95, 0.97}) {
    Stepped at(0, 0.5, boxOver("box", 0, 0) + ", " + smallBall("ball", Vec3(0.301, 0.1, 0)), "[0, -1e-9, 0]");
    at.island.resting.bringToRest({0}, at.state());
    linearVelocity(at.state(), 1).x() = -speed;
    at.contacts.useTimeSteppingOnly();
    at.step();
    EXPECT_EQ(at.island.resting.isResting(0), speed < 0.96);
  }
}

TEST(StepContacts, TakeOutWhatOverlapsAtTheEnd) {
  Stepped at(0, 0, smallBall("ball", Vec3(0, 0.1 - 1e-4, 0)));
  at.step();
  EXPECT_NEAR(centerOfMass(at.state(), 0).y(), 0.1, 1e-8);  // a tenth of the margin is let be
}

// What was no contact when the step began, as points that rotate into the floor are not, is taken out at its end as
// well: each round leaves about the square of the relative overlap.
TEST(StepContacts, TakeOutWhatCameToOverlapInTheStep) {
  Stepped at(0, 0, smallBall("ball", Vec3(0, 0.2, 0)));
  VectorX end = at.state();
  at.contacts.begin(0, at.state(), end, kStep);
  ASSERT_TRUE(at.contacts.touching().empty());
  centerOfMass(end, 0).y() = 0.1 - 1e-4;
  at.contacts.solveContacts(at.state(), kStep, at.ropes, end);
  EXPECT_NEAR(centerOfMass(end, 0).y(), 0.1, 1e-8);
}

}  // namespace
}  // namespace cradle
