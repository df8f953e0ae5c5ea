#include "impact/soft_contacts.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <set>

#include "impact/posed_bodies.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double kSinglePrecision = 1e-7;  // of a size: anchors are floats

/// Bodies and the contacts between them.
struct Touched : PosedBodies {
  void begin() {
    place();
    contacts.emplace(geometry);
    contacts->takePairs();
  }
  void update() { contacts->update(stepStart(), threads); }
  PersistentManifold& manifold(std::size_t active) {
    return contacts->manifolds()[static_cast<std::size_t>(contacts->active()[active].manifold)];
  }
  double leastSeparation(std::size_t active) {
    const PersistentManifold& found = manifold(active);
    return *std::min_element(found.separations.begin(), found.separations.begin() + found.count);
  }

  WorkerThreads threads{1};
  std::optional<SoftContacts> contacts;
};

/// Two boxes, the upper one turned by 0.3 rad, with a gap between their faces.
Touched& twoBoxes(Touched& bodies, double gap) {
  bodies.add(colliderOf(Box{Vec3(0.4, 0.2, 0.6)}, {}), Vec3::Zero());
  bodies.add(colliderOf(Box{Vec3(0.2, 0.3, 0.2)}, {}), Vec3(0.02, 0.25 + gap, 0.03), rotationAbout(Vec3::UnitY(), 0.3));
  bodies.geometry.pairs = {{0, 1, false, {}}};
  bodies.begin();
  bodies.update();
  return bodies;
}

TEST(SoftContacts, HaveTheCornersThatTouch) {
  Touched bodies;
  twoBoxes(bodies, 1e-3);
  ASSERT_THAT(bodies.contacts->active(), SizeIs(1));
  const PersistentManifold& manifold = bodies.manifold(0);
  EXPECT_EQ(manifold.count, 4);
  EXPECT_EQ(bodies.contacts->active()[0].count, 4);
  EXPECT_EQ(std::pair(manifold.bodyA, manifold.bodyB), std::pair(0, 1));
  EXPECT_LT((manifold.normal - Vec3::UnitY()).norm(), 1e-12);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(manifold.separations[i], 1e-3, 1e-12);
  int touching = 0;
  bodies.contacts->forEachTouching([&](int a, int b) { touching += a == 0 && b == 1; });
  EXPECT_EQ(touching, 1);
}

// Within 1 mm and 0.01 rad a manifold is followed: points stay on their bodies, and gaps are those between them along
// the lower box's normal. The upper box sinks by 0.3 mm and tilts by 1 mrad about z.
TEST(SoftContacts, FollowSmallMotions) {
  Touched bodies;
  twoBoxes(bodies, 1e-3);
  const PersistentManifold before = bodies.manifold(0);
  bodies.manifold(0).forces = {1, 2, 3, 4};
  const Quat tilt = rotationAbout(Vec3::UnitZ(), 1e-3);
  bodies.move(1, Vec3(2e-4, -3e-4, 1e-4), tilt, 1e-3);
  bodies.update();
  const PersistentManifold& after = bodies.manifold(0);
  ASSERT_EQ(after.count, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 onB = bodies.poses[1].position + bodies.poses[1].rotation * before.onB[i].cast<double>();
    EXPECT_NEAR(after.separations[i], onB.y() - 0.1, kSinglePrecision) << i;
    EXPECT_EQ(after.onB[i], before.onB[i]);
    EXPECT_EQ(after.forces[i], static_cast<double>(i + 1));
  }
}

// The normal goes with body A, which lies askew then.
TEST(SoftContacts, TurnTheirNormalWithTheFirstBody) {
  Touched bodies;
  twoBoxes(bodies, 1e-3);
  bodies.move(0, Vec3::Zero(), rotationAbout(Vec3::UnitX(), 5e-3), 5e-3);
  bodies.update();
  EXPECT_LT((bodies.manifold(0).normal - Vec3(0, std::cos(5e-3), std::sin(5e-3))).norm(), kSinglePrecision);
}

// Farther, it is found anew: the upper box has gone by a quarter of its width. Points within a tenth of the radius of
// body A keep their forces, others begin without.
TEST(SoftContacts, AreFoundAnewAfterLargeMotionsAndKeepTheirForces) {
  for (const double way : {2e-3, 0.06}) {  // body A's radius is 0.374 m
    Touched bodies;
    twoBoxes(bodies, 0);
    bodies.manifold(0).forces = {1, 2, 3, 4};
    bodies.manifold(0).frictionForce = Vec3(1, 0, 2), bodies.manifold(0).twist = 3;
    bodies.move(1, Vec3(way, 0, 0));
    bodies.update();
    const PersistentManifold& manifold = bodies.manifold(0);
    ASSERT_EQ(manifold.count, 4);
    double sum = 0;
    for (const double force : manifold.forces) sum += force;
    EXPECT_EQ(sum, way < 0.0374 ? 10 : 0) << way;
    EXPECT_EQ(manifold.frictionForce, Vec3(1, 0, 2));
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 onB = bodies.poses[1].rotation * manifold.onB[i].cast<double>();
      EXPECT_NEAR(onB.y(), -0.15, kSinglePrecision);
    }
  }
}

TEST(SoftContacts, AreThoseOfThePairsThatStay) {
  Touched bodies;
  for (int i = 0; i < 3; ++i) bodies.add(colliderOf(Sphere{0.1}, {}), Vec3(0.2 * i, 0, 0));
  bodies.geometry.pairs = {{0, 1, false, {}}, {1, 2, false, {}}};
  bodies.begin();
  bodies.update();
  ASSERT_THAT(bodies.contacts->active(), SizeIs(2));
  bodies.manifold(1).forces[0] = 7;
  bodies.geometry.pairs = {{0, 2, false, {}}, {1, 2, false, {}}};  // the first one has gone, another has come
  bodies.contacts->takePairs();
  bodies.update();
  ASSERT_THAT(bodies.contacts->active(), SizeIs(1));
  EXPECT_EQ(bodies.manifold(0).forces[0], 7);
  EXPECT_EQ(bodies.manifold(0).bodyA, 1);
  EXPECT_EQ(bodies.manifold(0).bodyB, 2);
}

// The brute force are all pairs of spheres at random. Those that are within the margin, or in each other when the group
// of sub-steps ends, have a contact.
TEST(SoftContacts, MissNoPairThatMayTouch) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 1), speed(-4, 4);
  Touched bodies;
  std::vector<Vec3> centers;
  for (std::size_t i = 0; i < 60; ++i) {
    centers.push_back(Vec3{place(random), place(random), place(random)});
    bodies.add(colliderOf(Sphere{0.08}, {}), centers.back(), Quat::Identity(),
               Vec3{speed(random), speed(random), speed(random)});
    for (std::size_t k = 0; k < i; ++k) bodies.geometry.pairs.push_back({k, i, false, {}});
  }
  std::sort(bodies.geometry.pairs.begin(), bodies.geometry.pairs.end(),
            [](const ColliderPair& a, const ColliderPair& b) { return std::pair(a.a, a.b) < std::pair(b.a, b.b); });
  bodies.begin();
  bodies.update();
  std::set<std::pair<int, int>> found;
  for (const ManifoldLink& link : bodies.contacts->active()) found.insert({link.bodyA, link.bodyB});
  std::size_t expected = 0;
  for (const ColliderPair& pair : bodies.geometry.pairs) {
    const Vec3 apart = centers[pair.b] - centers[pair.a],
               ahead = apart + PosedBodies::kTimeStep *
                                   (bodies.poses[pair.b].linearVelocity - bodies.poses[pair.a].linearVelocity);
    const bool isFound = found.contains({static_cast<int>(pair.a), static_cast<int>(pair.b)});
    if (apart.norm() < 0.16 + PosedBodies::kMargin || ahead.norm() < 0.16) {
      EXPECT_TRUE(isFound) << pair.a << " " << pair.b;
      ++expected;
    }
    // Nearer than the margin and 14 m/s for the step they are not looked at otherwise.
    if (apart.norm() - 0.16 > PosedBodies::kMargin + 14 * PosedBodies::kTimeStep) {
      EXPECT_FALSE(isFound);
    }
  }
  EXPECT_GT(expected, 20u);
}

// What was not pressed before and closes faster than a speed is a meeting.
TEST(SoftContacts, MeetWhereTheyCloseFasterThanASpeed) {
  Touched bodies;
  const int a = bodies.add(colliderOf(Sphere{0.1}, {}), Vec3::Zero(), Quat::Identity(), Vec3(2, 0, 0));
  bodies.add(colliderOf(Sphere{0.1}, {}), Vec3(0.12, 0.16, 0), Quat::Identity(), Vec3::Zero(), Vec3(0, 0, 5));
  bodies.geometry.pairs = {{0, 1, false, {}}};
  bodies.begin();
  bodies.update();
  EXPECT_THAT(bodies.contacts->meetings(1.19), SizeIs(1));  // 2 m/s x 0.6; turning does not close spheres
  EXPECT_THAT(bodies.contacts->meetings(1.21), IsEmpty());
  bodies.manifold(0).forces[0] = 1;  // pressed in the step before
  bodies.move(a, Vec3(1e-4, 0, 0));
  bodies.update();
  EXPECT_THAT(bodies.contacts->meetings(1), IsEmpty());
}

// Sliding slower than 0.1 m/s is held by static friction, 0.6, and faster by dynamic, 0.4. The surface of a turning
// body slides by w r.
TEST(SoftContacts, HaveTheFrictionOfTheirSliding) {
  for (const double slip : {0.09, 0.11}) {
    Touched bodies;
    bodies.geometry.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
    bodies.add(colliderOf(Sphere{0.2}, {}), Vec3(0, 0.2, 0), Quat::Identity(), Vec3(3, 0, 0),
               Vec3(0, 0, (slip - 3) / 0.2));
    bodies.geometry.pairs = {{0, 0, true, {}}};
    bodies.begin();
    bodies.update();
    ASSERT_THAT(bodies.contacts->active(), SizeIs(1));
    EXPECT_EQ(bodies.manifold(0).friction, slip < 0.1 ? 0.6 : 0.4);
    EXPECT_EQ(bodies.manifold(0).material->restitution, 0.25);
  }
}

TEST(SoftContacts, OfSleepersStayAsTheyAre) {
  Touched bodies;
  twoBoxes(bodies, 1e-3);
  for (MovingPose& pose : bodies.poses) pose.isAsleep = true;
  bodies.contacts->beginStep();
  bodies.update();
  EXPECT_THAT(bodies.contacts->active(), IsEmpty());
  int touching = 0;
  bodies.contacts->forEachTouching([&](int, int) { ++touching; });
  EXPECT_EQ(touching, 1);
}

// How often bodies are looked at follows from the fastest approach: 0.8 of it for spheres; of others what is faster
// than 1.5 m/s by half, and half the speed of their farthest points. What does not come near does not count.
TEST(SoftContacts, KnowTheFastestApproach) {
  Touched spheres;
  spheres.add(colliderOf(Sphere{0.1}, {}), Vec3::Zero(), Quat::Identity(), Vec3(3, 0, 0));
  spheres.add(colliderOf(Sphere{0.1}, {}), Vec3(0.12, 0.161, 0));
  spheres.add(colliderOf(Sphere{0.1}, {}), Vec3(0, -1, 0), Quat::Identity(), Vec3(0, 8, 0));
  spheres.geometry.pairs = {{0, 1, false, {}}, {0, 2, false, {}}};
  spheres.begin();
  EXPECT_NEAR(spheres.contacts->fastestApproach(spheres.stepStart(), spheres.threads),
              0.8 * 3 * 0.12 / std::hypot(0.12, 0.161), 1e-14);
  Touched box;
  box.geometry.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
  box.add(colliderOf(Box{Vec3(0.4, 0.2, 0.6)}, {}), Vec3(0, 0.101, 0), Quat::Identity(), Vec3(1, -3.5, 0),
          Vec3(0, 2, 0));
  box.geometry.pairs = {{0, 0, true, {}}};
  box.begin();
  EXPECT_NEAR(box.contacts->fastestApproach(box.stepStart(), box.threads),
              1.5 + 0.5 * 2 + 0.5 * 2 * Vec3(0.2, 0.1, 0.3).norm(), 1e-14);
}

}  // namespace
}  // namespace cradle
