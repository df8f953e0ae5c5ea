// Penetration correction: ContactStepping::correctPenetration.

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "math/rotation.h"
#include "simulate/one_island.h"
#include "simulate/steps/contact_stepping.h"

namespace cradle {
namespace {

std::string sunk(const std::string& bodies, const std::string& gravity = "[0, 0, 0]") {
  return R"("duration": 1, "gravity": )" + gravity + R"(, "bodies": [
    {"name": "floor", "shape": {"plane": {}}, "motion": "static"}, )" +
         bodies + "]";
}

std::string ballOf(const std::string& name, double mass, double radius, const Vec3& position) {
  return fmt::format(R"({{"name": "{}", "mass": {}, "shape": {{"sphere": {{"radius": {}}}}}, "position": {}}})", name,
                     mass, radius, vectorText(position));
}

void correct(OneIsland& at, double margin = 0) {
  ContactStepping(at.island.assembly).correctPenetration(at.contactsWithin(margin), {}, at.state());
}

// Overlaps d of three balls in a row, away from the floor: of all displacements x with J x = d the least in M is
// M^-1 J^T (J M^-1 J^T)^-1 d. So the centre of mass stays.
TEST(PenetrationCorrection, MovesABodyTheLessTheHeavierItIs) {
  OneIsland at(sunk(ballOf("a", 2, 0.1, Vec3(0, 5, 0)) + ", " + ballOf("b", 3, 0.1, Vec3(0.198, 5, 0)) + ", " +
                    ballOf("c", 7, 0.2, Vec3(0.497, 5, 0))));
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << -1, 1, 0, 0, -1, 1;
  const Mat3 inverse = Vec3(1 / 2.0, 1 / 3.0, 1 / 7.0).asDiagonal();
  const Vec3 expected = inverse * jacobian.transpose() * (jacobian * inverse * jacobian.transpose()).inverse() *
                        Eigen::Vector2d(0.002, 0.001);
  const VectorX before = at.state();
  correct(at);
  for (const Eigen::Index body : {0, 1, 2}) {
    const Vec3 moved = centerOfMass(at.state(), body) - centerOfMass(before, body);
    EXPECT_LT((moved - Vec3(expected[body], 0, 0)).norm(), 1e-15) << body;
  }
  EXPECT_TRUE(linearVelocity(at.state(), 0).isZero(0));
}

// A box that is d deep with one corner is lifted and turned by the push d / (1/m + (r x n).I^-1 (r x n)) there, up to
// the square of the turn, d^2 by its size.
TEST(PenetrationCorrection, TurnsABodyByTheLeverOfItsCorner) {
  const double depth = 1e-5;
  OneIsland at(sunk(R"({"name": "box", "mass": 3, "shape": {"box": {"size": [0.4, 0.2, 0.6]}}})"));
  const Quat turn = rotationAbout(Vec3(1, 2, 3), 0.9);
  Vec3 arm(0, 1, 0);
  for (const double x : {-0.2, 0.2})
    for (const double y : {-0.1, 0.1})
      for (const double z : {-0.3, 0.3})
        if (const Vec3 corner = turn * Vec3(x, y, z); corner.y() < arm.y()) arm = corner;
  setOrientation(at.state(), 0, turn);
  centerOfMass(at.state(), 0) = Vec3(0.3, -arm.y() - depth, 0.1);
  const Mat3 inverse = worldInertia(at.mechanism().bodies[0], 0, at.state()).inverse();
  const Vec3 lever = arm.cross(Vec3::UnitY());
  const double push = depth / (1 / 3.0 + lever.dot(inverse * lever));
  correct(at);
  const double error = 10 * depth * depth / 0.2;
  EXPECT_LT((centerOfMass(at.state(), 0) - Vec3(0.3, -arm.y() - depth + push / 3, 0.1)).norm(), 1e-15);
  const Quat turned = orientation(at.state(), 0) * turn.conjugate();
  EXPECT_LT((2 * turned.vec() - push * (inverse * lever)).norm(), error);
  EXPECT_LT(std::abs((orientation(at.state(), 0) * (turn.conjugate() * arm)).y() + centerOfMass(at.state(), 0).y()),
            error);
}

// What is lifted by d takes m g d from the velocity, v'^2 = v^2 - 2 g d, as far as there is any. The ledger has the
// rest.
TEST(PenetrationCorrection, TakesTheEnergyOfTheLiftFromTheMotion) {
  for (const double speed : {2.0, 0.01}) {
    OneIsland at(sunk(ballOf("ball", 2, 0.1, Vec3(0, 0.1 - 1e-4, 0)), "[0, -9.81, 0]"));
    linearVelocity(at.state(), 0) = Vec3(speed, 0, 0);
    const double constant = energyConstant(at.mechanism(), at.state());
    correct(at);
    EXPECT_NEAR(centerOfMass(at.state(), 0).y(), 0.1, 1e-15);
    const double left = std::sqrt(std::max(0.0, speed * speed - 2 * kGravity * 1e-4));
    EXPECT_NEAR(linearVelocity(at.state(), 0).x(), left, 1e-12);
    EXPECT_NEAR(energyConstant(at.mechanism(), at.state()), constant, 1e-14);
  }
}

// Where a far way would be needed it is gone in parts of 0.05 sizes.
TEST(PenetrationCorrection, GoesAPartOfAFarWay) {
  for (const double depth : {0.0049, 0.0051, 0.03}) {
    OneIsland at(sunk(ballOf("ball", 2, 0.1, Vec3(0, 0.1 - depth, 0))));
    correct(at);
    EXPECT_NEAR(centerOfMass(at.state(), 0).y(), 0.1 - depth + std::min(depth, 0.005), 1e-15);
  }
}

// A ball that is pushed up stops at another one that it does not touch yet, but is near: that goes with it.
TEST(PenetrationCorrection, PushesOnWhatIsNear) {
  OneIsland at(
      sunk(ballOf("lower", 2, 0.1, Vec3(0, 0.1 - 1e-3, 0)) + ", " + ballOf("upper", 1, 0.1, Vec3(0, 0.3 - 6e-4, 0))));
  correct(at, 1e-2);
  EXPECT_NEAR(centerOfMass(at.state(), 0).y(), 0.1, 1e-15);
  EXPECT_NEAR(centerOfMass(at.state(), 1).y(), 0.3, 1e-15);
}

// Overlaps below 1e-9 of the size are let be.
TEST(PenetrationCorrection, LetsOverlapsOfRoundingBe) {
  for (const double part : {0.9, 1.1}) {
    OneIsland at(sunk(ballOf("ball", 2, 0.1, Vec3(0, 0.1 - part * 1e-10, 0))));
    const double before = centerOfMass(at.state(), 0).y();
    correct(at);
    EXPECT_EQ(centerOfMass(at.state(), 0).y() == before, part < 1);
  }
}

// A ball on a hinge that is a = 0.3 mm beside its lowest point is turned by d / a, which moves its side by 333 d
// towards a wall: that has 1000 d, and hinders nothing.
TEST(PenetrationCorrection, KnowsWhatGapsAreFarFromAShortMomentArm) {
  const double depth = 1e-9, arm = 3e-4;
  OneIsland at(fmt::format(R"("duration": 1, "gravity": [0, 0, 0], "bodies": [
    {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static"}},
    {{"name": "wall", "shape": {{"plane": {{"normal": [1, 0, 0]}}}}, "position": [{}, 0, 0], "motion": "static"}}, {}],
    "hinges": [{{"bodyA": "ball", "anchorA": [{}, {}, 0], "anchorB": [{}, 0, 0], "axis": [0, 0, 1]}}])",
                           -0.1 - 1000 * depth, ballOf("ball", 2, 0.1, Vec3(0, 0.1 - depth, 0)), -arm, depth - 0.1,
                           -arm));
  correct(at, 1e-5);
  EXPECT_NEAR(2 * orientation(at.state(), 0).z(), depth / arm, 1e-3 * depth / arm);
  EXPECT_NEAR(centerOfMass(at.state(), 0).x(), -0.1 * depth / arm, 1e-3 * 0.1 * depth / arm);
}

}  // namespace
}  // namespace cradle
