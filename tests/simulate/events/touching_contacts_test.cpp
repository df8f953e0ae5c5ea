#include "simulate/events/touching_contacts.h"

#include <gmock/gmock.h>

#include <cmath>

#include "math/rotation.h"
#include "simulate/events/on_plane.h"

namespace cradle {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

struct TouchingOnPlane : OnPlane {
  explicit TouchingOnPlane(const std::string& bodies, const std::string& more = R"("gravity": [0, -9.81, 0])")
      : OnPlane(bodies, more) {}
  std::vector<Contact> find(const std::optional<std::size_t>& closing = std::nullopt) {
    island.findNearPairsNow(0.1);
    if (solver.hasConstraints()) solver.factorize(state());
    return findTouching(island, solver, tolerances, closing);
  }
};

// Corners within the touch tolerance; of the pair whose gap an event has closed the nearest, a little farther.
TEST(TouchingContacts, AreWithinTheToleranceOrOfTheClosingPair) {
  TouchingOnPlane at(std::string(kBox) + "}");
  const auto lift = [&](double height) { centerOfMass(at.state(), 0).y() = 0.1 + height; };
  for (const double part : {0.9, 1.1}) {
    lift(part * at.tolerances.touch);
    EXPECT_THAT(at.find(), SizeIs(part < 1 ? 4 : 0));
    EXPECT_THAT(at.find(0), SizeIs(part < 1 ? 4 : 1));
    lift(part * at.tolerances.closingPairGap);
    EXPECT_THAT(at.find(0), SizeIs(part < 1 ? 1 : 0));
  }
  setOrientation(at.state(), 0, rotationAbout(Vec3(0, 0, 1), 1e-8));  // the corners at x = -0.2 are lower
  lift(1e-8);
  const std::vector<Contact> nearest = at.find(0);
  ASSERT_THAT(nearest, SizeIs(1));
  EXPECT_LT(nearest[0].point.x(), 0);
}

// A box turned on another: four corners of the smaller face are on the larger one. Where edges cross these are lines,
// the one along x and the other along z, in the plane of the faces.
TEST(TouchingContacts, OfFlatFacesAreCornersOfEither) {
  for (const bool isUpperSmall : {true, false}) {
    const double lower = isUpperSmall ? 0.8 : 0.3, upper = isUpperSmall ? 0.3 : 0.8;
    TouchingOnPlane at(
        fmt::format(R"({{"name": "lower", "shape": {{"box": {{"size": [{0}, 0.2, {0}]}}}}, "motion": "static",
        "position": [0, 0.5, 0]}}, {{"name": "upper", "shape": {{"box": {{"size": [{1}, 0.2, {1}]}}}}, "mass": 1,
        "position": [0, 0.7, 0]}})",
                    lower, upper));
    setOrientation(at.state(), 0, rotationAbout(Vec3::UnitY(), 0.3));
    const std::vector<Contact> contacts = at.find();
    ASSERT_THAT(contacts, SizeIs(4));
    for (const Contact& contact : contacts) {
      const double ofUpper = contact.bodyA == 0 ? contact.radiusA : contact.radiusB;
      const double ofLower = contact.bodyA == 0 ? contact.radiusB : contact.radiusA;
      EXPECT_EQ(ofUpper, isUpperSmall ? 0 : INFINITY);
      EXPECT_EQ(ofLower, isUpperSmall ? INFINITY : 0);
      EXPECT_NEAR(std::hypot(contact.point.x(), contact.point.z()), 0.15 * std::sqrt(2), 1e-12);
    }
  }
  TouchingOnPlane crossing(R"({"name": "lower", "shape": {"box": {"size": [1, 0.2, 0.2]}}, "motion": "static",
      "position": [0, 0.5, 0]}, {"name": "upper", "shape": {"box": {"size": [0.2, 0.2, 1]}}, "mass": 1,
      "position": [0, 0.7, 0]})");
  const std::vector<Contact> contacts = crossing.find();
  ASSERT_THAT(contacts, SizeIs(4));
  for (const Contact& contact : contacts) {
    EXPECT_EQ(contact.radiusA + contact.radiusB, 0);
    EXPECT_NEAR(std::abs(contact.lineA.cross(contact.lineB).y()), 1, 1e-15);
    EXPECT_LT((contact.point.cwiseAbs() - Vec3(0.1, 0.6, 0.1)).norm(), 1e-15);
    EXPECT_NEAR(contact.separation, 0, 1e-15);
  }
}

// A rod along the normal leaves a contact no motion: whatever acts, it stays as it is.
TEST(TouchingContacts, LeaveOutWhatConstraintsHold) {
  const std::string ball = R"({"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0, 0.1, 0],
    "material": "rough"})";
  TouchingOnPlane free(ball), held(ball, R"("gravity": [0, -9.81, 0], "rods": [{"bodyA": "ball", "anchorA": [0, 0, 0],
      "anchorB": [0, 1.1, 0]}])");
  EXPECT_THAT(free.find(), SizeIs(1));
  EXPECT_THAT(held.find(), IsEmpty());
}

// A cylinder that is tilted touches at one point of its rim, one that stands or lies at several.
TEST(TouchingContacts, OfATiltedCylinderAreOnePointOfItsRim) {
  const double tilt = 0.3, pi = std::acos(-1);
  for (const double angle : {0.0, tilt, pi / 2}) {
    TouchingOnPlane at(R"({"name": "can", "shape": {"cylinder": {"radius": 0.1, "length": 0.4}}, "mass": 1,
      "material": "rough"})");
    setOrientation(at.state(), 0, rotationAbout(Vec3::UnitZ(), -angle));
    centerOfMass(at.state(), 0).y() = 0.1 * std::sin(angle) + 0.2 * std::cos(angle);
    const std::vector<Contact> contacts = at.find();
    ASSERT_THAT(contacts, SizeIs(angle == tilt ? 1 : angle == 0 ? 8 : 2));
    EXPECT_EQ(contacts[0].rimAxis.isZero(0), angle != tilt);
  }
}

// Of the polygon in its end, a corner may be as near to the plane as touches, beside the lowest point: at an angle a
// around the rim it is r sin(tilt) a^2 / 2 higher. Both are the one point that rolls.
TEST(TouchingContacts, OfARimAreOnePointWhereACornerOfItsPolygonTouchesToo) {
  constexpr double kTilt = 0.3;
  for (const double height : {5e-10, 1e-9, 2e-9}) {
    TouchingOnPlane at(R"({"name": "can", "shape": {"cylinder": {"radius": 0.1, "length": 0.4}}, "mass": 1,
      "material": "rough"})",
                       R"("gravity": [0, -9.81, 0], "accuracy": 1e-3)");
    const double angle = std::sqrt(2 * height / (0.1 * std::sin(kTilt)));
    setOrientation(at.state(), 0, rotationAbout(Vec3::UnitZ(), -kTilt) * rotationAbout(Vec3::UnitY(), angle));
    centerOfMass(at.state(), 0).y() = 0.1 * std::sin(kTilt) + 0.2 * std::cos(kTilt);
    EXPECT_THAT(at.contactsWithin(at.tolerances.touch), SizeIs(2));
    EXPECT_THAT(at.find(), SizeIs(1));
  }
}

}  // namespace
}  // namespace cradle
