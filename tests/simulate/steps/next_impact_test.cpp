// Landings: ContactStepping::nextImpact and ContactStepping::strike.

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "math/rotation.h"
#include "simulate/one_island.h"
#include "simulate/steps/contact_stepping.h"

namespace cradle {
namespace {

using testing::SizeIs;

constexpr double kLandingStep = 0.01;  // s

std::string landing(double restitution, double friction, const std::string& bodies) {
  return fmt::format(R"("duration": 1, "materials": {{"stuff": {{"restitution": {}, "staticFriction": {},
      "dynamicFriction": {}}}}}, "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static",
      "material": "stuff"}}, {}])",
                     restitution, friction, friction / 2, bodies);
}

std::string ballOver(const std::string& name, double mass, double height, const Vec3& velocity) {
  return fmt::format(R"({{"name": "{}", "mass": {}, "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "stuff",
    "position": [0, {}, 0], "linearVelocity": {}}})",
                     name, mass, height, vectorText(velocity));
}

/// The part of a step of free motion after which something lands.
double landingPart(OneIsland& at, double landingSpeed) {
  VectorX state = at.state();
  for (Eigen::Index body = 0; body < bodyCount(state); ++body) {
    const Vec3 velocity = linearVelocity(state, body);
    linearVelocity(state, body) += kLandingStep * at.mechanism().gravity;
    centerOfMass(state, body) += kLandingStep * (velocity + kLandingStep / 2 * at.mechanism().gravity);
    turnBody(state, body, kLandingStep * angularVelocity(state, body));
  }
  ContactStepping stepping(at.island.assembly);
  return stepping.nextImpact(at.contactsWithin(0.1), at.state(), kLandingStep, state, landingSpeed).fraction;
}

// s = v t + g t^2 / 2
TEST(NextImpact, IsWhereAFallComesToTheFloor) {
  for (const double gap : {1e-4, 3e-3, 0.0103, 0.0107}) {
    OneIsland at(landing(0, 0, ballOver("ball", 2, 0.1 + gap, Vec3(0, -1, 0))));
    const double time = (-1 + std::sqrt(1 + 2 * kGravity * gap)) / kGravity;
    if (gap > 0.01 + kGravity * kLandingStep * kLandingStep / 2)
      EXPECT_EQ(landingPart(at, 0.1), INFINITY);
    else
      EXPECT_NEAR(landingPart(at, 0.1), time / kLandingStep, 1e-13) << gap;  // gaps are rounded to 1e-16 m
  }
}

// What is slower when the step begins is not worth ending it for; nor is what touches already.
TEST(NextImpact, IsOfWhatIsFastAndApart) {
  for (const double landingSpeed : {0.99, 1.01}) {
    OneIsland at(landing(0, 0, ballOver("ball", 2, 0.101, Vec3(0, -1, 0))));
    EXPECT_EQ(std::isfinite(landingPart(at, landingSpeed)), landingSpeed < 1);
  }
  OneIsland touching(landing(0, 0, ballOver("ball", 2, 0.1, Vec3(0, -1, 0))));
  EXPECT_EQ(landingPart(touching, 0.1), INFINITY);
}

// A box turns about the edge that it stands on, at w and with the angular acceleration of a pendulum: m g x / (I +
// m r^2), x the horizontal arm of its centre. The far edge comes down by its arm, 0.4 m, times the turn. The held edge
// is frozen over the step, so that the result is right to the turn, w h = 0.005, of the step's part.
TEST(NextImpact, IsOfTheFarEdgeWhileTheNearOneIsHeld) {
  const double turn = 0.004, spin = 0.5;
  OneIsland at(landing(0, 0.9, R"({"name": "box", "mass": 3, "shape": {"box": {"size": [0.4, 0.2, 0.6]}},
    "material": "stuff"})"));
  const Quat tilt = rotationAbout(Vec3::UnitZ(), turn);  // about the edge at x = -0.2
  setOrientation(at.state(), 0, tilt);
  const Vec3 arm = tilt * Vec3(0.2, 0.1, 0);
  centerOfMass(at.state(), 0) = arm;
  angularVelocity(at.state(), 0) = Vec3(0, 0, -spin);
  linearVelocity(at.state(), 0) = Vec3(0, 0, -spin).cross(arm);
  const double inertia = 3 / 12.0 * (0.16 + 0.04) + 3 * 0.05, pull = 3 * kGravity * arm.x() / inertia;
  const double time = (-spin + std::sqrt(spin * spin + 2 * pull * turn)) / pull;
  ASSERT_LT(time, kLandingStep);
  EXPECT_NEAR(landingPart(at, 0.01), time / kLandingStep, spin * kLandingStep * time / kLandingStep);
}

// Newton's restitution at the floor: p = m (1 + e) v. What that took is booked.
TEST(StepImpact, StrikesWithNewtonsRestitution) {
  for (const double restitution : {0.0, 0.6}) {
    OneIsland at(landing(restitution, 0, ballOver("ball", 2, 0.1, Vec3(0.5, -3, 0))));
    const std::vector<Contact> contacts = at.contactsWithin(1e-6);
    ContactStepping stepping(at.island.assembly);
    const std::vector<Vec3> impulses = stepping.resolveImpact(contacts, kLandingStep, at.state());
    ASSERT_THAT(impulses, SizeIs(1));
    EXPECT_NEAR(impulses[0].y(), -2 * (1 + restitution) * 3, 1e-13);  // on the floor
    EXPECT_LT((linearVelocity(at.state(), 0) - Vec3(0.5, restitution * 3, 0)).norm(), 1e-14);
    EXPECT_NEAR(impactEnergy(at.state()), 9 * (1 - restitution * restitution), 1e-13);
  }
}

// Friction of an impact is static while that stops the surfaces, and dynamic where they slide: a ball of 2/5 m r^2
// needs 2/7 of its speed along the floor to roll, a friction of 2/7 x 0.5 / 3 = 0.0476 of the normal impulse.
TEST(StepImpact, StrikesWithCoulombsFriction) {
  for (const double friction : {0.047, 0.048}) {
    OneIsland at(landing(0, friction, ballOver("ball", 2, 0.1, Vec3(0.5, -3, 0))));
    const std::vector<Contact> contacts = at.contactsWithin(1e-6);
    ContactStepping stepping(at.island.assembly);
    stepping.resolveImpact(contacts, kLandingStep, at.state());
    const double expected = friction > 0.0476 ? 5 / 7.0 * 0.5 : 0.5 - friction / 2 * 3;  // dynamic friction is half
    EXPECT_NEAR(linearVelocity(at.state(), 0).x(), expected, 1e-12);
    EXPECT_NEAR(angularVelocity(at.state(), 0).z(), -(0.5 - expected) / (0.4 * 0.1), 1e-11);
  }
}

// Closing slower than what accelerations explain does not rebound: e v < 0.01 g h for what touches.
TEST(StepImpact, DoesNotReboundFromWhatGravityGivesInAStep) {
  for (const double part : {0.99, 1.01}) {
    const double speed = part * 0.01 * kGravity * kLandingStep / 0.5;
    OneIsland at(landing(0.5, 0, ballOver("ball", 2, 0.1, Vec3(0, -speed, 0))));
    const std::vector<Contact> contacts = at.contactsWithin(1e-6);
    ContactStepping stepping(at.island.assembly);
    stepping.resolveImpact(contacts, kLandingStep, at.state());
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), part < 1 ? 0 : speed / 2, 1e-16);
  }
}

// A ball on another that lies on the floor: what strikes from above is passed on to the floor, and rebounds.
TEST(StepImpact, StrikesAllContactsAtOnce) {
  OneIsland at(
      landing(0.5, 0, ballOver("lower", 2, 0.1, Vec3::Zero()) + ", " + ballOver("upper", 1, 0.3, Vec3(0, -4, 0))));
  const std::vector<Contact> contacts = at.contactsWithin(1e-6);
  ASSERT_THAT(contacts, SizeIs(2));
  ContactStepping stepping(at.island.assembly);
  const std::vector<Vec3> impulses = stepping.resolveImpact(contacts, kLandingStep, at.state());
  EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 0, 1e-14);
  EXPECT_NEAR(linearVelocity(at.state(), 1).y(), 2, 1e-14);
  for (const Vec3& impulse : impulses) EXPECT_NEAR(std::abs(impulse.y()), 6, 1e-13);
}

}  // namespace
}  // namespace cradle
