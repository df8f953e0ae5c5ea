#include "collision/broad_phase.h"

#include <gmock/gmock.h>

#include <random>
#include <set>

#include "collision/separation.h"

namespace cradle {
namespace {

using Pairs = std::set<std::tuple<bool, std::size_t, std::size_t>>;

struct Crowd {
  ContactGeometry geometry;
  VectorX state;
};

Vec3 randomPoint(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> coordinate(-size, size);
  const double x = coordinate(random), y = coordinate(random);
  return {x, y, coordinate(random)};
}

/// Balls and long capsules that lie anyhow, a fixed ball and a plane.
Crowd crowdOf(int bodies, double space, std::mt19937& random) {
  Crowd crowd{{}, VectorX::Zero(stateSize(bodies))};
  for (int body = 0; body < bodies; ++body) {
    const double length = body % 2 ? 0.5 : 0;
    Collider collider{body, {Vec3(length, 0, 0), Vec3(-length, 0, 0)}, 0.1, length + 0.1, {}};
    collider.bounds = {Vec3(-length - 0.1, -0.1, -0.1), Vec3(length + 0.1, 0.1, 0.1)};
    crowd.geometry.colliders.push_back(collider);
    centerOfMass(crowd.state, body) = randomPoint(random, space);
    const Vec3 axis = randomPoint(random, 1);
    setOrientation(crowd.state, body, Quat(0.3, axis.x(), axis.y(), axis.z()).normalized());
  }
  Collider fixed{kFixed, {Vec3::Zero()}, 0.3, 0.3, {}};
  fixed.bounds = {Vec3::Constant(-0.3), Vec3::Constant(0.3)};
  crowd.geometry.colliders.push_back(fixed);
  crowd.geometry.planes = {{Vec3::Zero(), Vec3(0.6, 0.8, 0)}};
  crowd.geometry.materials = {{ContactMaterial{}}};
  return crowd;
}

Pairs pairsOf(const ContactGeometry& geometry) {
  Pairs pairs;
  for (const ColliderPair& pair : geometry.pairs) pairs.emplace(pair.againstPlane, pair.a, pair.b);
  return pairs;
}

/// Lower bounds of the distance by sampling the axes of both: balls of 0.1 m along them.
double distanceOf(const Crowd& crowd, std::size_t a, std::size_t b) {
  double least = INFINITY;
  const Collider &first = crowd.geometry.colliders[a], &second = crowd.geometry.colliders[b];
  const Vec3 between = poseOf(crowd.state, first.body).translation - poseOf(crowd.state, second.body).translation;
  if (between.norm() > 2 * (first.boundingRadius + second.boundingRadius)) return least;
  const auto pointAt = [&](std::size_t i, double part) -> Vec3 {
    const Collider& collider = crowd.geometry.colliders[i];
    const RigidTransform pose = poseOf(crowd.state, collider.body);
    return pose * Vec3(part * collider.points.front() + (1 - part) * collider.points.back());
  };
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) least = std::min(least, (pointAt(a, i / 10.0) - pointAt(b, j / 10.0)).norm());
  return least - first.radius - second.radius;
}

/// All pairs nearer than `distance`, by brute force.
Pairs nearPairsOf(const Crowd& crowd, double distance) {
  Pairs pairs;
  const std::size_t count = crowd.geometry.colliders.size();
  for (std::size_t a = 0; a < count; ++a) {
    const Collider& collider = crowd.geometry.colliders[a];
    if (collider.body == kFixed) continue;
    for (const Vec3& point : collider.points) {
      const double height = crowd.geometry.planes[0].normal.dot(poseOf(crowd.state, collider.body) * point);
      if (height - collider.radius < distance) pairs.emplace(true, a, 0);
    }
    for (std::size_t b = a + 1; b < count; ++b)
      if (distanceOf(crowd, a, b) < distance) pairs.emplace(false, a, b);
  }
  return pairs;
}

bool includes(const Pairs& all, const Pairs& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

// Two bodies that each go by 0.005 m, and 0.02 m of margin: all that is nearer than 0.03 m must be there; nothing is
// missed while bodies go on, whether the list is a new one or not.
TEST(BroadPhase, MissesNoPairThatMayMeetWhileBodiesMove) {
  std::mt19937 random(1);
  Crowd crowd = crowdOf(40, 2, random);
  BroadPhase broadPhase;
  int newLists = 0;
  for (int step = 0; step < 60; ++step) {
    newLists += broadPhase.update(crowd.state, std::vector<double>(40, 0.005), 0.02, crowd.geometry);
    const Pairs near = nearPairsOf(crowd, 0.03);
    ASSERT_FALSE(near.empty());
    EXPECT_TRUE(includes(pairsOf(crowd.geometry), near)) << step;
    for (int body = 0; body < 40; ++body) {
      centerOfMass(crowd.state, body) += randomPoint(random, 0.002);
      turnBody(crowd.state, body, randomPoint(random, 0.004));
    }
  }
  EXPECT_GT(newLists, 1);
  EXPECT_LT(newLists, 60);
}

// What no force moves meets nothing else that none does: of driven bodies there are pairs with others alone.
TEST(BroadPhase, LeavesOutPairsOfWhatNoForceMoves) {
  std::mt19937 random(5);
  Crowd crowd = crowdOf(40, 0.7, random);
  const auto isDriven = [](std::size_t collider) { return collider % 3 == 0; };
  for (std::size_t i = 0; i < 40; ++i) crowd.geometry.colliders[i].isDriven = isDriven(i);
  BroadPhase broadPhase;
  broadPhase.update(crowd.state, std::vector<double>(40, 0.0), 0.02, crowd.geometry);
  int ofDriven = 0;
  for (const ColliderPair& pair : crowd.geometry.pairs) {
    const bool aMoves = pair.a < 40 && !isDriven(pair.a),
               bMoves = !pair.againstPlane && pair.b < 40 && !isDriven(pair.b);
    EXPECT_TRUE(aMoves || bMoves) << pair.a << ' ' << pair.b;
    ofDriven += !pair.againstPlane && (pair.a < 40 && pair.b < 40) && aMoves != bMoves;
  }
  EXPECT_GT(ofDriven, 10);
  const Pairs found = pairsOf(crowd.geometry);
  for (const auto& [againstPlane, a, b] : nearPairsOf(crowd, 0.02))
    if ((a < 40 && !isDriven(a)) || (!againstPlane && b < 40 && !isDriven(b))) {
      EXPECT_TRUE(found.contains({againstPlane, a, b})) << a << ' ' << b;
    }
}

// Each goes 0.5 m on a way of its own, stops anywhere on it, and is pushed aside by up to 0.01 m: a new list is made
// only where this was not predicted.
TEST(BroadPhase, MissesNoPairThatMayMeetOnTheirWays) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> part(0, 1);
  for (int run = 0; run < 20; ++run) {
    Crowd crowd = crowdOf(40, 2, random);
    std::vector<Vec3> drifts;
    for (int body = 0; body < 40; ++body) drifts.push_back(0.5 * randomPoint(random, 1).normalized());
    const std::vector<double> beside(40, 0.02);
    BroadPhase broadPhase;
    EXPECT_TRUE(broadPhase.update({crowd.state, beside, drifts}, 0.02, crowd.geometry));
    for (int body = 0; body < 40; ++body) {
      const double gone = part(random);
      centerOfMass(crowd.state, body) += gone * drifts[static_cast<std::size_t>(body)] + randomPoint(random, 0.005);
    }
    EXPECT_TRUE(includes(pairsOf(crowd.geometry), nearPairsOf(crowd, 0.02))) << run;
    const std::vector<Vec3> still(40, Vec3(Vec3::Zero()));
    EXPECT_FALSE(broadPhase.update({crowd.state, std::vector<double>(40, 0.0), still}, 0.02, crowd.geometry));
    EXPECT_TRUE(broadPhase.update({crowd.state, std::vector<double>(40, 0.0), drifts}, 0.02, crowd.geometry));
  }
}

// A list for four steps along ways of (0.3, 0.4) m: bodies may also go a quarter of these 2 m aside, or further. It
// serves while 0.4 n <= 1.6 + 0.5: five steps.
TEST(BroadPhase, KeepsItsListAsFarAheadAsItWasMadeFor) {
  std::mt19937 random(6);
  Crowd crowd = crowdOf(40, 2, random);
  const std::vector<Vec3> drifts(40, Vec3(0.3, -0.4, 0));
  const std::vector<double> beside(40, 0.0);
  BroadPhase broadPhase;
  for (int step = 0; step < 6; ++step) {
    const bool isNew = broadPhase.update({crowd.state, beside, drifts, 4.0}, 0.02, crowd.geometry);
    EXPECT_EQ(isNew, step == 0 || step == 5) << step;
    for (int body = 0; body < 40; ++body) centerOfMass(crowd.state, body) += drifts[static_cast<std::size_t>(body)];
  }
}

TEST(BroadPhase, HasTheSameListForAnyNumberOfThreads) {
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> lists;
  for (const int count : {1, 3}) {
    std::mt19937 random(5);
    Crowd crowd = crowdOf(600, 4, random);
    WorkerThreads threads(count);
    BroadPhase(threads).update(crowd.state, std::vector<double>(600, 0.0), 0.1, crowd.geometry);
    lists.emplace_back();
    for (const ColliderPair& pair : crowd.geometry.pairs) lists.back().emplace_back(pair.a, pair.b);
  }
  EXPECT_GT(lists[0].size(), 600u);
  EXPECT_EQ(lists[1], lists[0]);
}

TEST(BroadPhase, KeepsItsListWhileNothingMoves) {
  std::mt19937 random(2);
  Crowd crowd = crowdOf(10, 1, random);
  BroadPhase broadPhase;
  EXPECT_TRUE(broadPhase.update(crowd.state, std::vector<double>(10, 0.0), 1e-6, crowd.geometry));
  EXPECT_FALSE(broadPhase.update(crowd.state, std::vector<double>(10, 0.0), 1e-6, crowd.geometry));
}

TEST(BroadPhase, LeavesOutExcludedPairsAndPairsOfFixedBodies) {
  std::mt19937 random(3);
  Crowd crowd = crowdOf(6, 0.1, random);
  crowd.geometry.colliders.push_back(crowd.geometry.colliders.back());
  crowd.geometry.excluded = {{1, 4}};
  BroadPhase().update(crowd.state, std::vector<double>(6, 0.0), 0, crowd.geometry);
  const Pairs pairs = pairsOf(crowd.geometry);
  EXPECT_FALSE(pairs.contains({false, 1, 4}));
  EXPECT_FALSE(pairs.contains({false, 6, 7}));
  EXPECT_TRUE(pairs.contains({false, 1, 6}));
}

// Balls in a plane grid, each near its four neighbours: pairs grow like their number.
TEST(BroadPhase, ListsAFewPairsABody) {
  const int side = 30;
  Crowd crowd{{}, VectorX::Zero(stateSize(side * side))};
  for (int body = 0; body < side * side; ++body) {
    Collider ball{body, {Vec3::Zero()}, 0.1, 0.1, {}};
    ball.bounds = {Vec3::Constant(-0.1), Vec3::Constant(0.1)};
    crowd.geometry.colliders.push_back(ball);
    centerOfMass(crowd.state, body) = Vec3(0.2 * (body % side), 0, 0.2 * (body / side));
    setOrientation(crowd.state, body, Quat::Identity());
  }
  crowd.geometry.materials = {{ContactMaterial{}}};
  BroadPhase().update(crowd.state, std::vector<double>(side * side, 0.0), 1e-3, crowd.geometry);
  EXPECT_GE(crowd.geometry.pairs.size(), 2u * side * (side - 1));
  EXPECT_LE(crowd.geometry.pairs.size(), 4u * side * side);
}

}  // namespace
}  // namespace cradle
