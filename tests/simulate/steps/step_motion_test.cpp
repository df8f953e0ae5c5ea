#include "simulate/steps/step_motion.h"

#include <gmock/gmock.h>

#include <cmath>

#include "math/rotation.h"
#include "simulate/steps/landings.h"

namespace cradle {
namespace {

using testing::SizeIs;

constexpr double kMotionStep = 1e-3;  // s

/// A body on or over the floor with restitution 0.5, friction 0.6 and 0.3, and what a step asks of it.
struct MovingOver : OneIsland {
  explicit MovingOver(const std::string& body)
      : OneIsland(landing(0.5, 0.6, body)), tolerances(stepTolerancesOf(stepScalesOf(island.assembly))) {}

  /// The motion of the contacts within a margin (m) in a step that ends with other velocities.
  StepMotion motion(const VectorX& end, double margin = 0.02) {
    set.emplace(island.assembly, tolerances, contactsWithin(margin), std::vector<const Limit*>{}, state());
    group = set->findGroups().at(0);
    GroupProblem problem(island.assembly);
    return stepMotionOf(group, *set, FreeStep(mechanism().bodies, state(), kMotionStep, end), problem);
  }
  ContactProblem posed(double startSpeed, double endSpeed, double gap, bool strikesInside = false,
                       double fraction = 1) {
    centerOfMass(state(), 0).y() = 0.1 + gap;
    linearVelocity(state(), 0) = Vec3(along, startSpeed, 0);
    VectorX end = state();
    linearVelocity(end, 0) = Vec3(along, endSpeed, 0);
    const StepMotion found = motion(end);
    return posedStep(group, *set, found, strikesInside ? std::vector<char>{1} : std::vector<char>{}, fraction);
  }

  StepTolerances tolerances;
  std::optional<ContactSet> set;
  StepGroup group;
  double along = 0;  // m/s
};

const std::string kMovingBall = ballOver("ball", 2, 0.1, Vec3::Zero());

TEST(StepMotion, HasItsMiddleWhereVelocitiesOfTheStartLead) {
  MovingOver at(R"({"name": "box", "mass": 3, "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "position": [1, 2, 3],
    "linearVelocity": [4, -5, 6], "angularVelocity": [2, 0, 0]})");
  VectorX end = at.state();
  linearVelocity(end, 0).setZero();
  const FreeStep step(at.mechanism().bodies, at.state(), 0.1, end);
  EXPECT_LT((centerOfMass(step.middle, 0) - Vec3(1.2, 1.75, 3.3)).norm(), 1e-15);
  EXPECT_LT(orientation(step.middle, 0).angularDistance(rotationAbout(Vec3::UnitX(), 0.1)), 1e-15);
  EXPECT_EQ(linearVelocity(step.middle, 0), linearVelocity(at.state(), 0));
  EXPECT_EQ(step.end, end);
  EXPECT_LT((step.frames[0].rotation - rotationAbout(Vec3::UnitX(), 0.1).toRotationMatrix()).norm(), 1e-15);
}

TEST(StepMotion, CopiesPosesAndVelocitiesOfSomeBodies) {
  VectorX from(stateSize(3)), to = VectorX::Zero(stateSize(3));
  for (Eigen::Index i = 0; i < from.size(); ++i) from[i] = static_cast<double>(i + 1);
  copyBodies({1}, from, to);
  EXPECT_EQ(centerOfMass(to, 1), centerOfMass(from, 1));
  EXPECT_EQ(orientation(to, 1).coeffs(), orientation(from, 1).coeffs());
  EXPECT_EQ(linearVelocity(to, 1), linearVelocity(from, 1));
  EXPECT_EQ(angularVelocity(to, 1), angularVelocity(from, 1));
  EXPECT_EQ((to.array() != 0).count(), kPoseSize + kVelocitySize);
}

// The lowest corner of a box that spins and flies: J v -+ (h/2) (dJ/dt) v are its velocities at the ends of the step,
// but for (w h / 2)^2 / 2 of w r, with w r below 6 m/s: 5e-5 m/s. Without the product, h w^2 r / 2 = 0.05 m/s is
// lacking.
TEST(StepMotion, HasTheVelocitiesOfAContactAtBothEnds) {
  MovingOver at(R"({"name": "box", "mass": 3, "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "material": "stuff",
    "linearVelocity": [1, -2, 0.5], "angularVelocity": [3, 2, -12]})");
  const Quat turn = rotationAbout(Vec3(1, 2, 3), 0.7);
  setOrientation(at.state(), 0, turn);
  double lowest = 0;
  for (int corner = 0; corner < 8; ++corner)
    lowest =
        std::min(lowest, (turn * Vec3(corner & 1 ? 0.2 : -0.2, corner & 2 ? 0.1 : -0.1, corner & 4 ? 0.3 : -0.3)).y());
  centerOfMass(at.state(), 0).y() = -lowest;
  VectorX end = at.state();
  const Vec3 spin = angularVelocity(end, 0), velocity = linearVelocity(end, 0);
  const StepMotion motion = at.motion(end, 1e-9);
  ASSERT_THAT(at.group.contacts, SizeIs(1));
  const Vec3 arm = at.group.contacts[0].point - centerOfMass(at.state(), 0);
  const Vec3 armAtEnd = rotationAbout(spin.normalized(), spin.norm() * kMotionStep) * arm;
  // The floor relative to the body, along the contact's normal, which points down: the speed of opening.
  EXPECT_NEAR(motion.start[2] - motion.velocityProduct[2], (velocity + spin.cross(arm)).y(), 5e-5);
  EXPECT_NEAR(motion.free[2] + motion.velocityProduct[2], (velocity + spin.cross(armAtEnd)).y(), 5e-5);
  EXPECT_EQ(motion.closing(2), motion.velocityProduct[2] - motion.start[2]);
  EXPECT_GT(std::abs(motion.velocityProduct[2]), 0.005);
}

// A contact that is apart may close by its gap; one that strikes rebounds with e of its closing speed, and what forces
// add in the step is no part of that; one that strikes inside the step may close freely. A slow one, of less than two
// steps of gravity, does not rebound.
TEST(StepMotion, PosesWhatContactsMayDo) {
  MovingOver at(kMovingBall);
  const double pull = kGravity * kMotionStep;
  EXPECT_NEAR(at.posed(-1, -1 - pull, 0.01).free[2], -1 - pull + 0.01 / kMotionStep, 1e-11);
  const ContactProblem striking = at.posed(-1, -1 - pull, 0);
  EXPECT_NEAR(striking.free[2], -1.5, 1e-14);
  EXPECT_TRUE(striking.hasRebounds);
  EXPECT_NEAR(at.posed(-1, -1 - pull, 0, false, 0.2).free[2], -1.1, 1e-14);
  EXPECT_NEAR(at.posed(-1, -1 - pull, 0, true).free[2], 1 + pull, 1e-14);
  for (const double part : {0.99, 1.01}) {
    const double speed = part * 2.01 * pull / 0.5;
    EXPECT_EQ(at.posed(-speed, -speed - pull, 0).hasRebounds, part > 1);
  }
  // What opens and is pressed back may return as fast as it opened, at most as fast as it is pressed.
  EXPECT_NEAR(at.posed(0.4 * pull, -0.6 * pull, 0).free[2], -0.2 * pull, 1e-15);
  EXPECT_NEAR(at.posed(3 * pull, 2 * pull, 0).free[2], 3 * pull, 1e-15);
}

// Surfaces that slide when the step begins have dynamic friction, others static.
TEST(StepMotion, PosesTheFrictionOfSliding) {
  MovingOver at(kMovingBall);
  EXPECT_EQ(at.posed(0, -0.01, 0).frictions[0], 0.6);
  at.along = 1.1e-6;
  EXPECT_EQ(at.posed(0, -0.01, 0).frictions[0], 0.3);
  at.along = 0.9e-6;
  EXPECT_EQ(at.posed(0, -0.01, 0).frictions[0], 0.6);
}

}  // namespace
}  // namespace cradle
