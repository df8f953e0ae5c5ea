#include "simulate/steps/group_problem.h"

#include <gmock/gmock.h>

#include <cmath>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double kGroupFriction = 0.4;

/// Boxes on each other on the floor, with the contacts of all of them as one group.
struct BoxTower : OneIsland {
  explicit BoxTower(int boxes, const std::string& more = "", const std::string& rotor = "")
      : OneIsland(R"("duration": 1, "materials": {"stuff": {"restitution": 0, "staticFriction": 0.4,
          "dynamicFriction": 0.4}}, "bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static",
          "material": "stuff"})" +
                  boxesOf(boxes) + rotor + "]" + more),
        tolerances(stepTolerancesOf(stepScalesOf(island.assembly))),
        group(ContactSet(island.assembly, tolerances, contactsWithin(1e-9), {}, state()).findGroups().at(0)),
        problem(island.assembly) {
    problem.factorize(state());
    problem.set(group, state());
  }
  static std::string boxesOf(int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += fmt::format(R"(, {{"name": "b{}", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "mass": {},
        "material": "stuff", "position": [0, {}, 0]}})",
                          i, 3 - 0.5 * i, 0.1 + 0.2 * i);
    return text;
  }
  ContactProblem posed() const {
    return {problem.velocitiesIn(island.state), std::vector<double>(group.contacts.size(), kGroupFriction)};
  }
  void setVelocities(const Vec3& velocity) {
    for (int body = 0; body < std::ssize(mechanism().bodies); ++body) linearVelocity(state(), body) = velocity;
  }

  StepTolerances tolerances;
  StepGroup group;
  GroupProblem problem;
  std::vector<SteppingFault> faults;
};

// All boxes move with v along the floor and u towards it: friction takes mu u of v, or all of it. Four contacts are
// solved densely, to rounding; twelve by iterations, to 1e-7 of the velocities.
TEST(GroupProblem, StopsWhatClosesWithCoulombsFriction) {
  for (const int boxes : {1, 3})
    for (const double along : {0.3, 0.003}) {
      BoxTower at(boxes);
      ASSERT_THAT(at.group.contacts, SizeIs(4 * boxes));
      at.setVelocities(Vec3(along, -0.02, 0));
      const VectorX impulses = at.problem.solve(at.group, at.posed(), at.faults);
      at.problem.apply(impulses, at.state());
      const double left = std::max(0.0, along - kGroupFriction * 0.02);
      const double tolerance = (boxes == 1 ? 1e-12 : 1e-6) * along;
      for (int body = 0; body < boxes; ++body)
        EXPECT_LT((linearVelocity(at.state(), body) - Vec3(left, 0, 0)).norm(), tolerance) << boxes << ' ' << along;
      EXPECT_THAT(at.faults, IsEmpty());
    }
}

TEST(GroupProblem, SolvesWithoutFriction) {
  for (const int boxes : {1, 3}) {
    BoxTower at(boxes);
    at.setVelocities(Vec3(0.3, -0.02, 0.1));
    at.problem.apply(at.problem.solveFrictionless(at.problem.velocitiesIn(at.state()), 1e-10), at.state());
    for (int body = 0; body < boxes; ++body)
      EXPECT_LT((linearVelocity(at.state(), body) - Vec3(0.3, 0, 0.1)).norm(), 1e-9) << boxes;
  }
}

// Loads of twelve contacts are not unique. Those of the step before are where the search begins, and where it ends, if
// they solve the problem: here with more on two corners of the floor, and less on the others. Contacts are found by the
// nearest of the same bodies, in whatever order they are; forces that have doubled are told.
TEST(GroupProblem, BeginsWithTheStepBefore) {
  BoxTower at(3);
  at.setVelocities(Vec3(0, -0.02, 0));
  VectorX impulses = at.problem.solve(at.group, at.posed(), at.faults);
  const double more = 0.1 * impulses.maxCoeff();
  for (std::size_t i = 0; i < at.group.contacts.size(); ++i) {
    const Vec3& point = at.group.contacts[i].point;
    if (point.y() < 0.1) impulses[3 * static_cast<Eigen::Index>(i) + 2] += point.x() * point.z() > 0 ? more : -more;
  }
  for (const double ratio : {1.0, 2.0}) {
    StepMemory memory;
    memory.ratio = ratio;
    for (std::size_t i = at.group.contacts.size(); i-- > 0;) {
      Contact near = at.group.contacts[i];
      near.point += Vec3(0.01, 0, -0.02);
      const Vec3 impulse = at.problem.axes(i) * impulses.segment<3>(3 * static_cast<Eigen::Index>(i));
      memory.contacts.push_back({near, impulse / ratio, false});
      memory.slips.emplace_back(Vec3::Zero());
    }
    at.problem.warmStartFrom(memory);
    const VectorX again = at.problem.solve(at.group, at.posed(), at.faults);
    EXPECT_LT((again - impulses).norm(), 1e-5 * impulses.norm()) << ratio;
  }
  EXPECT_EQ(at.problem.iterations(), 0);
}

// A joint beside a contact leaves it little inverse mass; bodies without constraints have all of theirs. Impulses are
// answered by the joint: its anchor stays.
TEST(GroupProblem, HasTheResponseOfConstraints) {
  BoxTower at(1, R"(, "ballJoints": [{"bodyA": "b0", "anchorA": [0, 0, 0], "anchorB": [0, 0.1, 0]}])");
  ASSERT_TRUE(at.group.isConstrained);
  angularVelocity(at.state(), 0) = Vec3(0.1, 0.2, -0.3);
  at.problem.apply(at.problem.solve(at.group, at.posed(), at.faults), at.state());
  EXPECT_LT(linearVelocity(at.state(), 0).norm(), 1e-14);
  for (const Contact& contact : at.group.contacts) EXPECT_GE(openingSpeed(contact, at.state()), -1e-13);
  EXPECT_LT(at.problem.mobility(0), 0.9);
  EXPECT_EQ(BoxTower(1).problem.mobility(0), 1);
}

// The same of sixteen contacts, which are solved by iterations, to 1e-7 of the velocities.
TEST(GroupProblem, HasTheResponseOfConstraintsWithManyContacts) {
  BoxTower at(5, R"(, "ballJoints": [{"bodyA": "b0", "anchorA": [0, 0, 0], "anchorB": [0, 0.1, 0]},
      {"bodyA": "b2", "bodyB": "b3", "anchorA": [0.1, 0.1, 0], "anchorB": [0.1, -0.1, 0]}])");
  ASSERT_THAT(at.group.contacts, SizeIs(16));
  for (int body = 1; body < 5; ++body) linearVelocity(at.state(), body) = Vec3(0.1, -0.02 * body, 0.01);
  at.problem.constraints().constrainVelocities(at.state());
  at.problem.apply(at.problem.solve(at.group, at.posed(), at.faults), at.state());
  EXPECT_THAT(at.faults, IsEmpty());
  EXPECT_LT(linearVelocity(at.state(), 0).norm(), 1e-14);
  EXPECT_LT(at.problem.constraints().largestRate(at.state()).rate, 1e-14);
  for (const Contact& contact : at.group.contacts) EXPECT_GE(openingSpeed(contact, at.state()), -1e-8);
  EXPECT_LT(at.problem.mobility(0), 0.9);
}

/// A wheel of 1 kg and inertia I on a fixed axle over the floor, with its lowest point on it.
struct DrivenWheel : OneIsland {
  DrivenWheel()
      : OneIsland(R"("duration": 1, "materials": {"stuff": {"staticFriction": 0.4, "dynamicFriction": 0.4}}, "bodies": [
          {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "stuff"},
          {"name": "wheel", "shape": {"sphere": {"radius": 0.5}}, "mass": 1, "material": "stuff", "position": [0, 0.5, 0]},
          {"name": "cart", "shape": {"sphere": {"radius": 0.1}}, "mass": 3, "collision": "none", "position": [0, 0.5, 0]}],
        "hinges": [{"bodyA": "wheel", "bodyB": "cart", "anchorB": [0, 0, 0], "motor": {"targetVelocity": -2, "maxTorque": 9}}],
        "sliders": [{"bodyA": "cart", "anchorB": [0, 0.5, 0], "axis": [1, 0, 0]}])"),
        tolerances(stepTolerancesOf(stepScalesOf(island.assembly))),
        group(ContactSet(island.assembly, tolerances, contactsWithin(1e-9), {}, state()).findGroups().at(0)),
        problem(island.assembly) {}
  void set(const std::vector<std::size_t>& held) {
    problem.hold(held);
    problem.factorize(state());
    problem.set(group, state());
  }

  StepTolerances tolerances;
  StepGroup group;
  GroupProblem problem;
};

// An impulse p along the floor at a wheel whose motor holds moves wheel and cart together, by p / 4 kg, and the motor
// gives p r against it. Without the motor it turns the wheel besides. Motors give way by a thousandth of that.
TEST(GroupProblem, MotorsThatHoldAnswerContacts) {
  DrivenWheel at;
  ASSERT_THAT(at.group.contacts, SizeIs(1));
  const double inertia = 0.4 * 0.5 * 0.5, impulse = 0.3;
  for (const bool holds : {true, false}) {
    at.set(holds ? std::vector<std::size_t>{0} : std::vector<std::size_t>{});
    const Vec3 along = at.problem.axes(0).transpose() * Vec3::UnitX();
    const double sign = at.group.contacts[0].bodyB == 0 ? 1 : -1;  // impulses are on B
    VectorX changed = at.state();
    changed.tail(changed.size() - poseComponents(changed)).setZero();
    at.problem.apply(sign * impulse * along, changed);
    EXPECT_NEAR(linearVelocity(changed, 1).x(), impulse / 4, 1e-12);
    const double turned = angularVelocity(changed, 0).z(), free = impulse * 0.5 / inertia;
    if (!holds) {
      EXPECT_NEAR(turned, free, 1e-12);
      continue;
    }
    EXPECT_NEAR(turned, 0, 2 * GroupProblem::kCompliance * free);
    const VectorX given = at.problem.motorImpulses(sign * impulse * along, at.state());
    ASSERT_EQ(given.size(), 1);
    EXPECT_NEAR(given[0], -impulse * 0.5, 2 * GroupProblem::kCompliance * impulse);
  }
}

// Of the loads that four corners may have, which one number leaves open, the least: of a box that falls flat all the
// same, W = 1/3 + 0.3^2/0.1 + 0.2^2/0.05 per kg at a corner and 4 / 4 kg for all four together. Two steps of the
// proximal point method leave the square of kCompliance W. Without motors the loads are one of many.
TEST(GroupProblem, LoadsOfBodiesWithMotorsAreShared) {
  BoxTower at(1, R"(, "hinges": [{"bodyA": "b0", "bodyB": "rotor", "anchorB": [0, 0, 0], "motor": {"targetVelocity": 1,
      "maxTorque": 1}}])",
              R"(, {"name": "rotor", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "collision": "none",
      "position": [0, 0.1, 0]})");
  at.setVelocities(Vec3(0, -0.02, 0));
  const VectorX impulses = at.problem.solve(at.group, at.posed(), at.faults);
  const double left = std::pow(GroupProblem::kCompliance * (1.0 / 3 + 0.9 + 0.8), 2);
  for (Eigen::Index i = 2; i < impulses.size(); i += 3) EXPECT_NEAR(impulses[i], 0.02, 0.02 * left);
  EXPECT_THAT(at.faults, IsEmpty());
}

// Energy above a limit is taken, and told as a fault with the bodies it was taken from; nothing below it.
TEST(GroupProblem, TellsOfEnergyThatIsTaken) {
  BoxTower at(2);
  at.setVelocities(Vec3(1, 0, 0));
  const double energy = energyOf(at.group.moved.bodies, at.mechanism(), at.state());
  clampEnergyWithFault(at.group.moved, energy, at.mechanism(), at.state(), at.faults);
  EXPECT_THAT(at.faults, IsEmpty());
  clampEnergyWithFault(at.group.moved, energy - 0.5, at.mechanism(), at.state(), at.faults);
  ASSERT_THAT(at.faults, SizeIs(1));
  EXPECT_EQ(at.faults[0].kind, CorrectionKind::clampedEnergy);
  EXPECT_EQ(at.faults[0].bodies, at.group.moved.bodies);
  EXPECT_NEAR(at.faults[0].amount, 0.5, 1e-12);
  EXPECT_NEAR(energyOf(at.group.moved.bodies, at.mechanism(), at.state()), energy - 0.5, 1e-12);
}

}  // namespace
}  // namespace cradle
