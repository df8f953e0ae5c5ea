// When balls on parabolas touch: closed forms, and a search by brute force on distances found in another way.

#include "collision/time_to_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr ContactSearch kSearch{0, 100};

TEST(TimeToClose, IsTheFirstRootAtWhichTheGapFalls) {
  EXPECT_DOUBLE_EQ(timeToClose(2, -4, 0), 0.5);
  EXPECT_DOUBLE_EQ(timeToClose(2, 0, -4), 1);
  EXPECT_DOUBLE_EQ(timeToClose(0, 3, -2), 3);  // thrown up from the ground
  EXPECT_DOUBLE_EQ(timeToClose(6, 1, -2), 3);  // 6 + t - t^2
  EXPECT_DOUBLE_EQ(timeToClose(6, -7, 2), 1);  // 6 - 7 t + t^2: 1, and opening at 6
  EXPECT_DOUBLE_EQ(timeToClose(-1e-17, -1, 5), 0);
}

TEST(TimeToClose, IsNeverIfTheGapOpensOrTurnsBefore) {
  EXPECT_EQ(timeToClose(1, 2, 3), kNever);
  EXPECT_EQ(timeToClose(1, 0, 0), kNever);
  EXPECT_EQ(timeToClose(1, -1, 0.6), kNever);  // turns at 1 - 1 / 1.2
  EXPECT_EQ(timeToClose(-1e-17, 1, 0), kNever);
}

// A lever of b between the path and the centre: they touch when the path has sqrt(s^2 - b^2) to go.
TEST(TimeToDistance, OfAStraightPathIsThatOfItsLever) {
  for (const double lever : {0.0, 0.3, 0.499999}) {
    const UniformMotion motion{Vec3(-3, lever, 0), Vec3(2, 0, 0), Vec3::Zero()};
    const double expected = (3 - std::sqrt(0.25 - lever * lever)) / 2;
    EXPECT_NEAR(timeToDistance(motion, 0.5, kSearch), expected, 1e-15 / std::sqrt(0.25 - lever * lever)) << lever;
  }
  EXPECT_EQ(timeToDistance({Vec3(-3, 0.500001, 0), Vec3(2, 0, 0), Vec3::Zero()}, 0.5, kSearch), kNever);
  EXPECT_EQ(timeToDistance({Vec3(-3, 0, 0), Vec3(-2, 0, 0), Vec3::Zero()}, 0.5, kSearch), kNever);
}

// Dropped from rest it falls 3 m - 0.5 m; thrown up from a touch it is back after 2 v / g.
TEST(TimeToDistance, OfAVerticalThrowIsThatOfItsParabola) {
  const Vec3 gravity(0, -10, 0);
  EXPECT_NEAR(timeToDistance({Vec3(0, 3, 0), Vec3::Zero(), gravity}, 0.5, kSearch), std::sqrt(2 * 2.5 / 10), 1e-15);
  EXPECT_NEAR(timeToDistance({Vec3(0, 0.5, 0), Vec3(0, 4, 0), gravity}, 0.5, kSearch), 0.8, 1e-15);
}

// What touches and closes by rounding alone would stop time.
TEST(TimeToContact, LeavesOutWhatClosesByRounding) {
  const ContactSearch search{1e-14, 100};
  const PlaneCollider plane{Vec3::Zero(), Vec3::UnitY()};
  const RoundedBox box{{}, Vec3(5, 1, 5), 0};
  const Vec3 sliding(1, -1e-16, 0);
  EXPECT_EQ(timeToContact({Vec3(0, 0.1, 0), sliding, Vec3::Zero()}, 0.1, plane, search), kNever);
  EXPECT_EQ(timeToContact({Vec3(0, 1.125, 0), sliding, Vec3::Zero()}, 0.125, box, search), kNever);
  EXPECT_EQ(timeToDistance({Vec3(0, 0.1, 0), sliding, Vec3::Zero()}, 0.1, search), kNever);
  EXPECT_EQ(timeToContact({Vec3(0, 0.1, 0), Vec3(1, -1e-6, 0), Vec3::Zero()}, 0.1, plane, search), 0);
}

// Towards the middle of a face, an edge and a corner of a cube of 2 m: a ball of 0.1 m comes from 3 m outside.
TEST(TimeToContact, OfABoxIsThatOfFaceEdgeAndCorner) {
  const RoundedBox box{{}, Vec3::Ones(), 0};
  for (const Vec3& nearest : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(-1, 1, -1)}) {
    const Vec3 direction = nearest.normalized();
    const UniformMotion motion{nearest + 3 * direction, -2 * direction, Vec3::Zero()};
    EXPECT_NEAR(timeToContact(motion, 0.1, box, kSearch), 2.9 / 2, 1e-15);
  }
}

// Past a corner at less than the radius beside one face, more than it from both: no contact. The path crosses the
// corner's diagonal at 0.08 m sqrt(2) = 0.113 m.
TEST(TimeToContact, PassesACornerThatABoundingBoxWouldHit) {
  const RoundedBox box{{}, Vec3::Ones(), 0};
  const auto pastAt = [&](double excess) {
    return timeToContact({Vec3(1 + 2 * excess + 3, 1 - 3, 0), Vec3(-1, 1, 0), Vec3::Zero()}, 0.1, box, kSearch);
  };
  EXPECT_EQ(pastAt(0.08), kNever);
  EXPECT_LT(pastAt(0.0707), kNever);
}

/// Distance of a point from a box of `half` sizes about the origin: to the nearest of finely chosen cases.
double distanceByCases(const Vec3& point, const Vec3& half) {
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) square += std::pow(std::max(0.0, std::abs(point[axis]) - half[axis]), 2);
  return std::sqrt(square);
}

/// First fall of `gap` to 0 in fine steps, bisected; kNever if there is none until `until`.
double firstByBruteForce(const std::function<double(double)>& gap, double until) {
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    double early = until * i / kSteps, late = until * (i + 1) / kSteps;
    if (!(gap(early) > 0) || gap(late) > 0) continue;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = (early + late) / 2;
      (gap(middle) > 0 ? early : late) = middle;
    }
    return late;
  }
  return kNever;
}

// Parabolas of some 3 m/s and 10 m/s^2 around boxes that are turned and rounded. A step of 0.5 ms passes over visits of
// a corner that are shorter, down to a depth of a t^2 / 8 = 1e-6 m: those are looked at with a radius that much
// smaller. At a closing speed of 1e-3 m/s or more, where 1e-15 m of rounding makes 1e-12 s.
TEST(TimeToContact, AgreesWithBruteForceAroundTurnedBoxes) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  int hits = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 half = (vector() + Vec3::Ones()) / 2;
    const Vec3 axis = vector();
    const Quat turn = rotationAbout(axis, 3 * uniform(random));
    const RigidTransform boxFromWorld{turn, vector()};
    const RoundedBox box{boxFromWorld, trial % 3 ? half : Vec3(0, half.y(), 0), trial % 2 ? 0.2 : 0.0};
    UniformMotion motion{3 * vector(), Vec3::Zero(), trial % 4 ? Vec3(10 * vector()) : Vec3::Zero()};
    motion.velocity = boxFromWorld.inverse().translation - motion.position + vector();
    const auto gap = [&](double time) {
      return distanceByCases(boxFromWorld * motion.positionAfter(time), box.halfSize) - 0.3 - box.radius;
    };
    if (gap(0) <= 0) continue;
    const double found = timeToContact(motion, 0.3, box, {0, 2}), expected = firstByBruteForce(gap, 2);
    if (expected == kNever) {
      const auto smaller = [&](double time) { return gap(time) + 1e-6; };
      EXPECT_TRUE(found > 2 || firstByBruteForce(smaller, 2) == kNever) << trial;
      continue;
    }
    ++hits;
    EXPECT_NEAR(found, expected, 1e-12) << trial;
  }
  EXPECT_GT(hits, 50);
}

TEST(NearnessOf, ABoxIsThatOfItsNearestPoint) {
  const Quat turn = rotationAbout(Vec3(1, 2, 3), 0.7);
  const RigidTransform worldFromBox{turn, Vec3(4, 5, 6)};
  const RoundedBox box{worldFromBox.inverse(), Vec3(1, 2, 3), 0.25};
  const Nearness corner = nearnessOf(worldFromBox * Vec3(2, 4, 5), box);  // (1, 2, 2) from the corner
  EXPECT_NEAR(corner.distance, 2.75, 1e-14);
  EXPECT_LT((corner.outward - turn * Vec3(1, 2, 2) / 3).norm(), 1e-14);
  const Nearness face = nearnessOf(worldFromBox * Vec3(0.3, -2.5, 1), box);
  EXPECT_NEAR(face.distance, 0.25, 1e-14);
  EXPECT_LT((face.outward + turn * Vec3::UnitY()).norm(), 1e-14);
}

}  // namespace
}  // namespace cradle
