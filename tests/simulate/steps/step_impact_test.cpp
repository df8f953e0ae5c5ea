#include "simulate/steps/step_impact.h"

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "math/rotation.h"
#include "simulate/steps/landings.h"

namespace cradle {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

std::vector<Vec3> strike(OneIsland& at, const std::vector<Contact>& contacts) {
  const Assembly& assembly = at.island.assembly;
  const StepTolerances tolerances = stepTolerancesOf(stepScalesOf(assembly));
  GroupProblem problem(assembly);
  problem.factorize(at.state());
  std::vector<SteppingFault> faults;
  const std::vector<Vec3> impulses =
      resolveStepImpact({assembly, tolerances, contacts, {}, at.state()}, kLandingStep, problem, at.state(), faults);
  EXPECT_THAT(faults, IsEmpty());
  return impulses;
}

// Newton's restitution at the floor: p = m (1 + e) v. What that took is booked.
TEST(StepImpact, StrikesWithNewtonsRestitution) {
  for (const double restitution : {0.0, 0.6}) {
    OneIsland at(landing(restitution, 0, ballOver("ball", 2, 0.1, Vec3(0.5, -3, 0))));
    const std::vector<Contact> contacts = at.contactsWithin(1e-6);
    const std::vector<Vec3> impulses = strike(at, contacts);
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
    strike(at, contacts);
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
    strike(at, contacts);
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), part < 1 ? 0 : speed / 2, 1e-16);
  }
}

// A ball on another that lies on the floor: what strikes from above is passed on to the floor, and rebounds.
TEST(StepImpact, StrikesAllContactsAtOnce) {
  OneIsland at(
      landing(0.5, 0, ballOver("lower", 2, 0.1, Vec3::Zero()) + ", " + ballOver("upper", 1, 0.3, Vec3(0, -4, 0))));
  const std::vector<Contact> contacts = at.contactsWithin(1e-6);
  ASSERT_THAT(contacts, SizeIs(2));
  const std::vector<Vec3> impulses = strike(at, contacts);
  EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 0, 1e-14);
  EXPECT_NEAR(linearVelocity(at.state(), 1).y(), 2, 1e-14);
  for (const Vec3& impulse : impulses) EXPECT_NEAR(std::abs(impulse.y()), 6, 1e-13);
}

// Two impacts apart from each other: impulses are in the order of the contacts, and each group keeps its own.
TEST(StepImpact, StrikesEachGroupAlone) {
  OneIsland at(
      landing(0.5, 0, ballOver("left", 2, 0.1, Vec3(0, -3, 0)) + ", " + ballOver("right", 1, 0.1, Vec3(0, -1, 0))));
  centerOfMass(at.state(), 1).x() = 5;
  std::vector<Contact> contacts = at.contactsWithin(1e-6);
  ASSERT_THAT(contacts, SizeIs(2));
  if (contacts[0].bodyA == 0) std::swap(contacts[0], contacts[1]);
  const std::vector<Vec3> impulses = strike(at, contacts);
  EXPECT_NEAR(impulses[0].y(), -1.5, 1e-14);
  EXPECT_NEAR(impulses[1].y(), -9, 1e-14);
  EXPECT_NEAR(impactEnergy(at.state()), 0.75 * (9 + 0.5), 1e-14);
}

// A tilted rod strikes with its lower end, which slides so slowly that the normal impulse alone would reverse its
// sliding: friction then works with the sliding before (T. R. Kane, D. A. Levinson, "Dynamics: Theory and
// Applications", 1985), and Newton's restitution would gain energy. The fraction of restitution that does not is taken,
// and what is lost is booked.
TEST(StepImpact, NeverGainsEnergy) {
  for (const double angle : {0.3, 0.6, 1.0}) {
    OneIsland at(landing(1, 1, R"({"name": "rod", "mass": 1, "shape": {"box": {"size": [0.02, 1, 0.02]}},
      "material": "stuff"})"));
    setOrientation(at.state(), 0, rotationAbout(Vec3::UnitZ(), angle));
    const double height = 0.5 * std::cos(angle) + 0.01 * std::sin(angle);
    centerOfMass(at.state(), 0) = Vec3(0, height, 0);
    linearVelocity(at.state(), 0) = Vec3(-0.3, -3, 0);
    const double before = energyConstant(at.mechanism(), at.state());
    const double kinetic = kineticEnergy(at.mechanism().bodies[0], 0, at.state());
    const std::vector<Contact> contacts = at.contactsWithin(1e-6);
    ASSERT_THAT(contacts, SizeIs(2));
    strike(at, contacts);
    const double ratio = kineticEnergy(at.mechanism().bodies[0], 0, at.state()) / kinetic;
    EXPECT_LE(ratio, 1 + 1e-12) << angle;
    EXPECT_GE(ratio, 1 - 1e-5) << angle;  // the fraction is found to 1e-6
    EXPECT_NEAR(energyConstant(at.mechanism(), at.state()), before, 1e-12);
    for (const Contact& contact : contacts) EXPECT_GE(openingSpeed(contact, at.state()), -1e-12);
  }
}

}  // namespace
}  // namespace cradle
