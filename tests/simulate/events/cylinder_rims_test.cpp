#include "simulate/events/cylinder_rims.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "simulate/events/on_plane.h"

namespace cradle {
namespace {

constexpr double kRimRadius = 0.1, kHalfLength = 0.2;  // m

/// A cylinder whose axis is tilted from y towards x by an angle (rad), turned about its own axis, and whose lowest
/// point is at a height (m).
struct TiltedCylinder : OnPlane {
  TiltedCylinder(double tilt, double height)
      : OnPlane(R"({"name": "can", "shape": {"cylinder": {"radius": 0.1, "length": 0.4}}, "mass": 1,
          "material": "rough"})") {
    const Quat turn = rotationAbout(Vec3::UnitZ(), -tilt) * rotationAbout(Vec3::UnitY(), 0.4);
    setOrientation(state(), 0, turn);
    centerOfMass(state(), 0) =
        Vec3(0, kRimRadius * std::abs(std::sin(tilt)) + kHalfLength * std::abs(std::cos(tilt)) + height, 0);
  }
  Contact lowest() {
    const std::vector<Contact> contacts = contactsWithin(0.01);
    return *std::min_element(contacts.begin(), contacts.end(),
                             [](const Contact& a, const Contact& b) { return a.separation < b.separation; });
  }
};

// The lower disc's centre is -l (sin, cos) from the cylinder's, and its lowest point r (cos, -sin) from that; the
// contact is half of the gap below it. Its axis, radius and side do not depend on how the cylinder is turned.
TEST(CylinderRims, AreTouchedAtTheirLowestPoint) {
  for (const double tilt : {0.3, 1.2, 2.5}) {
    const double gap = 1e-4;
    TiltedCylinder at(tilt, gap);
    Contact contact = at.lowest();
    moveToRim(at.island.assembly.geometry, at.state(), contact);
    const Vec3 axis(std::sin(tilt), std::cos(tilt), 0), down = tilt < 1.5 ? Vec3(-axis) : axis;
    const Vec3 across = (-Vec3::UnitY() + axis.y() * axis).normalized();
    const Vec3 lowest = centerOfMass(at.state(), 0) + kHalfLength * down + kRimRadius * across;
    EXPECT_NEAR(lowest.y(), gap, 1e-15);
    EXPECT_LT((contact.point - lowest + gap / 2 * Vec3::UnitY()).norm(), 1e-14) << tilt;
    EXPECT_LT(contact.rimAxis.cross(axis).norm(), 1e-15);
    EXPECT_EQ(contact.radiusA, kRimRadius);
    EXPECT_FALSE(standsOnRim(at.island.assembly.geometry, contact));
    Contact same = contact, other = contact;
    EXPECT_TRUE(isSameRim(contact, same));
    same.pair = 7, other.point.x() += 1e-6;
    EXPECT_FALSE(isSameRim(contact, same) || isSameRim(contact, other));
  }
}

// Flatter than by a thousandth the lowest point would run around too fast; and other shapes have no rim.
TEST(CylinderRims, AreNotTouchedByFlatDiscsAndOtherShapes) {
  for (const double part : {0.99, 1.01}) {
    TiltedCylinder at(std::asin(part * kFlatRim), 0);
    Contact contact = at.lowest();
    contact.radiusA = kNotRound;
    moveToRim(at.island.assembly.geometry, at.state(), contact);
    EXPECT_EQ(contact.rimAxis.isZero(0), part < 1) << part;
    EXPECT_FALSE(isSameRim(contact, contact) && part < 1);
  }
  OnPlane at(std::string(kBox) + "}");
  Contact corner = at.contactsWithin(1e-3).at(0);
  const Vec3 before = corner.point;
  moveToRim(at.island.assembly.geometry, at.state(), corner);
  EXPECT_EQ(corner.point, before);
  EXPECT_FALSE(standsOnRim(at.island.assembly.geometry, corner));
}

// What stands rotates out of that by any turning across its axis; what lies does so by turning end over end alone, not
// by rolling nor by turning on the spot.
TEST(CylinderRims, TipWithTheRotationOutOfTheirPosition) {
  const double reach = std::hypot(kRimRadius, kHalfLength), pi = std::acos(-1);
  const Vec3 spin(0.3, 5, 0.4);  // x, z: across a cylinder that stands; z: end over end of one that lies along x
  for (const bool lies : {false, true}) {
    TiltedCylinder at(lies ? pi / 2 : 0, 0);
    const Contact contact = at.lowest();
    EXPECT_TRUE(standsOnRim(at.island.assembly.geometry, contact));
    angularVelocity(at.state(), 0) = spin;
    EXPECT_NEAR(tippingSpeed(at.island.assembly.geometry, at.state(), contact), reach * (lies ? 0.4 : 0.5), 1e-15);
  }
}

}  // namespace
}  // namespace cradle
