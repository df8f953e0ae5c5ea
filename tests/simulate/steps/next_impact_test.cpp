#include "simulate/steps/next_impact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "simulate/steps/contact_stepping.h"
#include "simulate/steps/landings.h"

namespace cradle {
namespace {

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

}  // namespace
}  // namespace cradle
