#include "simulate/rows_of_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace cradle {
namespace {

constexpr double kFlat = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Two bodies that touch in the middle between them.
struct Touching {
  VectorX state = VectorX::Zero(stateSize(2));
  std::vector<RigidBody> bodies = std::vector<RigidBody>(2);
  std::vector<BodyFrame> frames;
  Contact contact;

  Touching() {
    centerOfMass(state, 0) = Vec3(0, 1, 0);
    for (const Eigen::Index body : {0, 1}) setOrientation(state, body, Quat(1, 0, 0, 0));
    linearVelocity(state, 0) = Vec3(0.3, -0.1, 0.2), angularVelocity(state, 1) = Vec3(1, 2, -1);
    contact.bodyA = 0, contact.bodyB = 1;
    contact.point = Vec3(0.02, 0.5, 0.1), contact.normal = -Vec3::UnitY();
    findBodyFrames(bodies, state, frames);
  }
};

// A corner on a corner, or on an edge, has no normal once they meet: whatever presses there is for one instant.
TEST(ContactsThatLast, HaveASurfaceThatIsRoundOrFlat) {
  Contact contact;
  for (const double radiusA : {0.0, 0.1, kFlat, kNone})
    for (const double radiusB : {0.0, 0.1, kFlat, kNone})
      for (const bool isEdge : {false, true}) {
        contact.radiusA = radiusA, contact.radiusB = radiusB;
        contact.lineB = (isEdge ? 1.0 : 0.0) * Vec3::UnitX();
        const bool hasNormal = radiusA > 0 || radiusB > 0;
        EXPECT_FALSE(canLast(contact) && !hasNormal) << radiusA << " " << radiusB << " " << isEdge;
      }
  contact.lineB.setZero();
  contact.radiusA = 0, contact.radiusB = kFlat;
  EXPECT_TRUE(canLast(contact));
  contact.radiusB = 0.1;
  EXPECT_TRUE(canLast(contact));
  contact.radiusB = 0, contact.radiusA = 0.1, contact.lineB = Vec3::UnitX();
  EXPECT_TRUE(canLast(contact));
}

TEST(RowsOfContacts, AreFiniteWhateverTouches) {
  for (const double radiusA : {0.0, 0.1, kFlat, kNone})
    for (const double radiusB : {0.0, 0.1, kFlat, kNone})
      for (const bool isEdge : {false, true}) {
        Touching touching;
        touching.contact.radiusA = radiusA, touching.contact.radiusB = radiusB;
        touching.contact.lineB = (isEdge && radiusB == 0 ? 1.0 : 0.0) * Vec3::UnitX();
        const ContactRows rows = rowsOf(touching.contact, touching.state, touching.frames);
        SCOPED_TRACE(::testing::Message() << radiusA << " " << radiusB << " " << isEdge);
        EXPECT_TRUE(rows.place.normal.allFinite());
        EXPECT_NEAR(std::abs(rows.place.normal.y()), 1, 1e-12);
        for (std::size_t row = 0; row < 3; ++row) EXPECT_TRUE(std::isfinite(rows.block.velocityProduct[row]));
      }
}

// Which body is A and which is B says nothing: what the velocities alone do to the gap, the row's curvature, is the
// same, and tangents apart so are the rows. Bodies of two inertias, and of one that turn at two rates.
TEST(RowsOfContacts, DoNotDependOnTheOrderOfTheBodies) {
  for (const double ease : {1.0, 3.0})
    for (const auto& [radiusA, radiusB] :
         std::vector<std::pair<double, double>>{{kNone, kNone}, {0, 0}, {0, kNone}, {kFlat, kFlat}, {0.1, kNone}}) {
      Touching touching;
      touching.bodies[1].inverseInertia *= ease;
      touching.frames.clear();
      findBodyFrames(touching.bodies, touching.state, touching.frames);
      angularVelocity(touching.state, 0) = Vec3(-0.5, 0.2, 0.7);
      touching.contact.radiusA = radiusA, touching.contact.radiusB = radiusB;
      Contact swapped = touching.contact;
      std::swap(swapped.bodyA, swapped.bodyB), std::swap(swapped.radiusA, swapped.radiusB);
      swapped.normal = -swapped.normal;
      const ContactRows rows = rowsOf(touching.contact, touching.state, touching.frames),
                        other = rowsOf(swapped, touching.state, touching.frames);
      SCOPED_TRACE(::testing::Message() << radiusA << " " << radiusB << " " << ease);
      EXPECT_NEAR(rows.block.velocityProduct[2], other.block.velocityProduct[2], 1e-12);
    }
}

// Nor does it say how a contact moves on, and how fast the material there is accelerated by rolling, while a gap
// closes.
TEST(RowsOfContacts, FollowAContactInEitherOrderOfTheBodies) {
  for (const auto& [radiusA, radiusB] : std::vector<std::pair<double, double>>{{0.1, 0.2}, {0, kFlat}, {0.1, kFlat}}) {
    Touching touching;
    angularVelocity(touching.state, 0) = Vec3(-0.5, 0.2, 0.7);
    Contact contact = touching.contact;
    contact.radiusA = radiusA, contact.radiusB = radiusB, contact.separation = 0.01;
    Contact swapped = contact;
    std::swap(swapped.bodyA, swapped.bodyB), std::swap(swapped.radiusA, swapped.radiusB);
    swapped.normal = -swapped.normal;
    const Vec3 drift = followContact(touching.state, touching.state, touching.frames, contact),
               other = followContact(touching.state, touching.state, touching.frames, swapped);
    SCOPED_TRACE(::testing::Message() << radiusA << " " << radiusB);
    EXPECT_LT((contact.point - swapped.point).norm(), 1e-15);
    EXPECT_LT((drift + other).norm(), 1e-12);
    EXPECT_GT(drift.norm(), 0.1);
  }
}

// Two balls, mirror images of each other, that spin and meet: their common point does not slide, and that stays so.
TEST(RowsOfContacts, OfMirrorImagesThatMeetDoNotSlide) {
  Touching touching;
  const Vec3 velocity(0.4, -0.3, 0.2), spin(2, 5, -3);
  for (const Eigen::Index body : {0, 1}) {
    const double side = body == 0 ? 1 : -1;  // of the mirror y = 0.5
    centerOfMass(touching.state, body) = Vec3(0, 0.5 + side * 0.11, 0);
    linearVelocity(touching.state, body) = Vec3(velocity.x(), side * velocity.y(), velocity.z());
    angularVelocity(touching.state, body) = Vec3(side * spin.x(), spin.y(), side * spin.z());
  }
  touching.contact.point = Vec3(0, 0.5, 0), touching.contact.separation = 0.02;
  touching.contact.radiusA = touching.contact.radiusB = 0.1;
  const Vec3 drift = followContact(touching.state, touching.state, touching.frames, touching.contact);
  EXPECT_LT(Vec3(drift.x(), 0, drift.z()).norm(), 1e-14);
  EXPECT_LT((touching.contact.point - Vec3(0, 0.5, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace cradle
