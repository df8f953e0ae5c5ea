#include "collision/contact_reduction.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/random_poses.h"
#include "rounding.h"

namespace cradle {
namespace {

std::vector<ContactPoint> reducedFrom(std::size_t first, std::vector<ContactPoint> contacts, double size = 1) {
  reduceContacts(first, size, contacts);
  return contacts;
}

ContactPoint contactAt(const Vec3& point, const Vec3& normal, double separation = 0) {
  return {point, normal, separation};
}

bool hasPointAt(const std::vector<ContactPoint>& contacts, const Vec3& point) {
  return std::any_of(contacts.begin(), contacts.end(), [&](const auto& contact) { return contact.point == point; });
}

/// Corners of a regular polygon on a circle of radius `size` (m), and many points inside, in a pose whose z is the
/// normal; in any order.
std::vector<ContactPoint> filledPolygon(int corners, double size, RandomPoses& random) {
  const RigidTransform pose{random.turn(), random.vector(size)};
  const Vec3 normal = pose.rotation * Vec3::UnitZ();
  std::vector<ContactPoint> contacts;
  for (int i = 0; i < 60; ++i) {
    const double radius = random.number(0, 0.4) * size, angle = random.number(0, 7);
    contacts.push_back(contactAt(pose * Vec3(radius * std::cos(angle), radius * std::sin(angle), 0), normal));
  }
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * M_PI * i / corners;
    const auto place = contacts.begin() + static_cast<std::ptrdiff_t>(random.number(0, 59));
    contacts.insert(place, contactAt(pose * (size * Vec3(std::cos(angle), std::sin(angle), 0)), normal));
  }
  return contacts;
}

// A corner sharper than 120 degrees is the farthest along one of six directions, however these lie to it.
TEST(ContactReduction, KeepsAllCornersSharperThan120DegreesAndNothingElse) {
  RandomPoses random(1);
  for (const double size : {1.0, 1e-6, 1e6})
    for (const int corners : {3, 4, 5})
      for (int i = 0; i < 30; ++i) {
        const std::vector<ContactPoint> contacts = filledPolygon(corners, size, random);
        const std::vector<ContactPoint> kept = reducedFrom(0, contacts, size);
        EXPECT_EQ(kept.size(), static_cast<std::size_t>(corners));
        for (const ContactPoint& contact : kept) EXPECT_TRUE(hasPointAt(contacts, contact.point));
      }
}

// Corners, and points on the sides between them, which are as far to that side.
TEST(ContactReduction, KeepsCornersBeforePointsOfASide) {
  const Vec3 normal = Vec3::UnitY(), across = normal.unitOrthogonal(), other = normal.cross(across);
  std::vector<ContactPoint> contacts;
  for (const auto& [x, y] : {std::pair(0, -1), {0, 1}, {1, 0}, {-1, 0}, {-1, -1}, {1, 1}, {1, -1}, {-1, 1}})
    contacts.push_back(contactAt(x * across + y * other, normal));
  const std::vector<ContactPoint> kept = reducedFrom(0, contacts);
  EXPECT_EQ(kept.size(), 4u);
  for (const ContactPoint& contact : kept) EXPECT_NEAR(contact.point.squaredNorm(), 2, 4 * kEpsilon);
}

// Any outline: what is left reaches as far to all sides but for a triangle with 120 degrees between two kept corners,
// whose height is less than 1 / sqrt(12) of their distance.
TEST(ContactReduction, EnclosesWhatItDrops) {
  RandomPoses random(2);
  for (int i = 0; i < 50; ++i) {
    const RigidTransform pose = random.pose(1);
    std::vector<ContactPoint> contacts;
    for (int k = 0; k < 80; ++k)
      contacts.push_back(contactAt(pose * Vec3(random.number(-1, 1), random.number(-0.3, 0.3), 0),
                                   pose.rotation * Vec3::UnitZ(), random.number(-1e-3, 0)));
    const std::vector<ContactPoint> kept = reducedFrom(0, contacts);
    EXPECT_LE(kept.size(), 7u);
    double longest = 0;
    for (const ContactPoint& one : kept)
      for (const ContactPoint& other : kept) longest = std::max(longest, (one.point - other.point).norm());
    const auto reach = [](const std::vector<ContactPoint>& all, const Vec3& direction) {
      double farthest = -INFINITY;
      for (const ContactPoint& contact : all) farthest = std::max(farthest, direction.dot(contact.point));
      return farthest;
    };
    for (int k = 0; k < 12; ++k) {
      const Vec3 direction = pose.rotation * Vec3(std::cos(k * M_PI / 6), std::sin(k * M_PI / 6), 0);
      EXPECT_GE(reach(kept, direction), reach(contacts, direction) - longest / std::sqrt(12)) << k;
    }
    const auto deepest = [](const std::vector<ContactPoint>& all) {
      double least = 0;
      for (const ContactPoint& contact : all) least = std::min(least, contact.separation);
      return least;
    };
    EXPECT_EQ(deepest(kept), deepest(contacts));
  }
}

// Normals 0.5 degrees apart are of one cluster, 1 degree apart of two; the deepest of each stays.
TEST(ContactReduction, TellsFacesApartByTheirNormals) {
  const Vec3 up = Vec3::UnitY();
  const auto tilted = [&](double degrees) { return Vec3(rotationAbout(Vec3::UnitX(), degrees * M_PI / 180) * up); };
  for (const double degrees : {0.5, 1.0, 30.0}) {
    std::vector<ContactPoint> contacts;
    for (const Vec3& normal : {up, tilted(degrees)})
      for (const double z : {-1.0, 0.0, 1.0}) contacts.push_back(contactAt(Vec3(0, 0, z), normal, z == 0 ? -0.1 : 0));
    for (std::size_t i = 3; i < 6; ++i) contacts[i].point.x() = 0.01;
    EXPECT_EQ(reducedFrom(0, contacts).size(), degrees < 0.8 ? 5u : 6u) << degrees;  // four corners and one deepest
  }
}

// Two edges that meet at one place with normals of their own: one contact with the mean of both. Contacts before the
// first stay.
TEST(ContactReduction, JoinsWhatIsAtOnePlace) {
  const Vec3 one = rotationAbout(Vec3::UnitX(), 1e-3) * Vec3::UnitY(), other(one.x(), one.y(), -one.z());
  const std::vector<ContactPoint> contacts{contactAt(Vec3::Zero(), one), contactAt(Vec3::Zero(), one),
                                           contactAt(Vec3(1, 0, 0), one), contactAt(Vec3(-1, 0, 0), one),
                                           contactAt(Vec3(1 + 1e-10, 0, 0), other)};
  const std::vector<ContactPoint> kept = reducedFrom(2, contacts);
  ASSERT_EQ(kept.size(), 4u);
  EXPECT_EQ(kept[0].normal, one);
  EXPECT_EQ(kept[1].point, Vec3::Zero());
  EXPECT_EQ(kept[2].point, Vec3(1, 0, 0));
  EXPECT_LT((kept[2].normal - Vec3::UnitY()).norm(), 4 * kEpsilon);
  EXPECT_EQ(kept[3].normal, one);
  EXPECT_TRUE(reducedFrom(0, {}).empty());
}

}  // namespace
}  // namespace cradle
