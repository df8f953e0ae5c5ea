#include "simulate/events/event_impacts.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::SizeIs;

constexpr double kImpactRounding = 1e-14;  // m/s, N s, J: of speeds of some m/s and masses of some kg

/// Balls of 0.1 m, of one material with the plane y = 0, and the impacts of an event.
struct Impacts : OneIsland {
  Impacts(double restitution, double friction, const std::string& bodies, double gravity = kGravity,
          const std::string& more = "")
      : OneIsland(fmt::format(R"("duration": 1, "accuracy": 1e-6, "gravity": [0, {}, 0], "materials": {{"stuff":
          {{"restitution": {}, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
          {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "stuff"}}, {}]{})",
                              -gravity, restitution, friction, friction, bodies, more)),
        ropes(island),
        tolerances(eventTolerancesOf(eventScalesOf(island))),
        constraints(mechanism().constraints, mechanism().bodies),
        rest(island, ropes, constraints, tolerances),
        impacts(island, ropes, constraints, rest, tolerances) {
    island.findNearPairsNow(0.01);
    touching = findTouching(island, constraints, tolerances, std::nullopt);
  }
  double resolve() { return impacts.resolve(std::nullopt, touching); }

  LimitEvents ropes;
  EventTolerances tolerances;
  ConstraintSolver constraints;
  ComingToRest rest;
  EventImpacts impacts;
  std::vector<Contact> touching;
};

std::string fallingBall(const std::string& name, double mass, const Vec3& position, const Vec3& velocity) {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": {}, "material": "stuff",
    "position": {}, "linearVelocity": {}}})",
                     name, mass, vectorText(position), vectorText(velocity));
}

// v' = e v; the impulse is m (1 + e) v, and m (1 - e^2) v^2 / 2 is lost.
TEST(EventImpacts, ReboundAndBookWhatTheyTake) {
  Impacts at(0.6, 0, fallingBall("ball", 1.5, Vec3(0.2, 0.1, 0), Vec3(0.3, -2, 0.1)));
  at.island.time = 0.25;
  ASSERT_THAT(at.touching, SizeIs(1));
  EXPECT_EQ(at.resolve(), 0);
  EXPECT_LT((linearVelocity(at.state(), 0) - Vec3(0.3, 1.2, 0.1)).norm(), kImpactRounding);
  EXPECT_NEAR(impactEnergy(at.state()), 1.5 / 2 * (4 - 1.44), kImpactRounding);
  EXPECT_NEAR(numericalEnergy(at.state()), 0, kImpactRounding);
  const std::vector<Event> events = at.island.log.take();
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].kind, EventKind::impact);
  EXPECT_EQ(events[0].time, 0.25);
  EXPECT_NEAR(events[0].impulse, 1.5 * 1.6 * 2, kImpactRounding);
  EXPECT_THAT(at.touching, SizeIs(1));
  EXPECT_EQ(at.resolve(), 0);  // it opens
  EXPECT_TRUE(at.island.log.take().empty());
}

// Friction that slides takes mu (1 + e) v from the speed along the floor, and turns a ball by 5/2 of that over its
// radius.
TEST(EventImpacts, HaveFriction) {
  Impacts at(0.5, 0.1, fallingBall("ball", 2, Vec3(0, 0.1, 0), Vec3(3, -1, 4)));
  at.resolve();
  const Vec3 along(0.6, 0, 0.8);
  EXPECT_LT((linearVelocity(at.state(), 0) - ((5 - 0.15) * along + Vec3(0, 0.5, 0))).norm(), kImpactRounding);
  EXPECT_LT((angularVelocity(at.state(), 0) - 2.5 * 0.15 / 0.1 * Vec3(0.8, 0, -0.6)).norm(), 10 * kImpactRounding);
}

// Rebounds of v below 1e-7 sqrt(g size) are left out. They would take 2 v / g (1 + e + e^2 + ...).
TEST(EventImpacts, TellTheTimeOfReboundsThatAreLeftOut) {
  const double restitution = 0.75;
  for (const double part : {0.99, 1.01}) {
    const double rebound = part * 1e-7 * std::sqrt(kGravity * 0.1);
    Impacts at(restitution, 0, fallingBall("ball", 2, Vec3(0, 0.1, 0), Vec3(0, -rebound / restitution, 0)));
    const double zenoTime = at.resolve();
    EXPECT_NEAR(zenoTime, part < 1 ? 2 * rebound / (kGravity * (1 - restitution)) : 0, 1e-19);
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), part < 1 ? 0 : rebound, 1e-19);
  }
}

// A ball of 1 kg, `gap` over the floor, that one of 100 kg strikes at 1 m/s: within reach it goes back and forth, as
// often as the first digits of pi (G. Galperin, "Playing pool with pi", 2003), and each contact has one event with the
// sum of its impulses. Beyond reach the first impact is all.
TEST(EventImpacts, FollowBallsBetweenOthersWithinReach) {
  const double heavy = 100, light = 1;
  for (const double gap : {1e-10, 2e-9}) {
    Impacts at(1, 0,
               fallingBall("light", light, Vec3(0, 0.1 + gap, 0), Vec3::Zero()) + ", " +
                   fallingBall("heavy", heavy, Vec3(0, 0.3 + gap, 0), Vec3(0, -1, 0)),
               0);
    ASSERT_LT(1e-10, at.tolerances.reach);
    ASSERT_GT(2e-9, at.tolerances.reach);
    double above = -1, below = 0, onHeavy = 0, onFloor = 0;  // m/s, N s
    int count = 0;
    while (above < below || (below < 0 && gap < 1e-9)) {
      if (above < below) {
        const double impulse = 2 * (below - above) / (1 / light + 1 / heavy);
        above += impulse / heavy, below -= impulse / light, onHeavy += impulse;
      } else {
        onFloor -= 2 * light * below, below = -below;
      }
      ++count;
    }
    ASSERT_EQ(count, gap < 1e-9 ? 31 : 1);
    at.resolve();
    constexpr double kSum = 1e-11;  // N s: thirty impulses of up to 50 N s, each of the velocities that others leave
    EXPECT_NEAR(linearVelocity(at.state(), 1).y(), above, kSum / heavy);
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), below, kSum / light);
    const std::vector<Event> events = at.island.log.take();
    ASSERT_THAT(events, SizeIs(gap < 1e-9 ? 2 : 1));
    for (const Event& event : events) {
      EXPECT_EQ(event.kind, EventKind::impact);
      EXPECT_NEAR(event.impulse, std::min(event.bodyA, event.bodyB) == 0 ? onFloor : onHeavy, kSum);
    }
  }
}

// Of two balls one strikes. The other is over the floor by 9e-13 m, within the tolerance of touching, but no rounding:
// as it comes down its gap closes at an event of its own, later; as it goes up it touches.
TEST(EventImpacts, LeaveWhatClosesLaterToItsOwnEvent) {
  for (const double speed : {1e-4, -1e-4}) {
    Impacts at(1, 0,
               fallingBall("ball", 1, Vec3(0, 0.1, 0), Vec3(0, -1, 0)) + ", " +
                   fallingBall("other", 1, Vec3(1, 0.1 + 9e-13, 0), Vec3(0, speed, 0)));
    ASSERT_THAT(at.touching, SizeIs(2));
    at.resolve();
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 1, kImpactRounding);
    EXPECT_EQ(linearVelocity(at.state(), 1).y(), speed);
    ASSERT_THAT(at.touching, SizeIs(speed > 0 ? 2 : 1));
    EXPECT_EQ(at.touching[0].movingBody(), 0);
  }
}

// Between the floor and a ball of ten times the mass, impacts of e = 0.1 have no end: all speed is lost in a time of
// some 1e-10 s, and the impulses of all of them bring both balls to a stop.
TEST(EventImpacts, EndACollapseAtOnce) {
  const double gap = 1e-10;
  Impacts at(0.1, 0,
             fallingBall("light", 1, Vec3(0, 0.1 + gap, 0), Vec3::Zero()) + ", " +
                 fallingBall("heavy", 10, Vec3(0, 0.3 + gap, 0), Vec3(0, -1, 0)),
             0);
  at.resolve();
  EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 0, kImpactRounding);
  EXPECT_NEAR(linearVelocity(at.state(), 1).y(), 0, kImpactRounding);
  EXPECT_NEAR(impactEnergy(at.state()), 10 / 2.0, 10 * kImpactRounding);
  const std::vector<Event> events = at.island.log.take();
  ASSERT_THAT(events, SizeIs(2));
  for (const Event& event : events) EXPECT_NEAR(event.impulse, 10, 100 * kImpactRounding);
}

// A ball is tied to the floor by a rope at its length, and an equal one drives it from below: it takes the speed on,
// the rope turns it back, and it gives the speed back. Both impulses are 2 m v in all.
TEST(EventImpacts, HaveTautRopesAsMembers) {
  const double mass = 1.5, speed = 3;
  Impacts at(1, 0,
             fallingBall("tied", mass, Vec3(0, 1, 0), Vec3::Zero()) + ", " +
                 fallingBall("striker", mass, Vec3(0, 0.8, 0), Vec3(0, speed, 0)),
             kGravity, R"(, "ropes": [{"bodyA": "tied", "anchorB": [0, 0, 0], "maxLength": 1, "restitution": 1}])");
  at.resolve();
  EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 0, kImpactRounding);
  EXPECT_NEAR(linearVelocity(at.state(), 1).y(), -speed, kImpactRounding);
  const std::vector<Event> events = at.island.log.take();
  ASSERT_THAT(events, SizeIs(2));
  for (const Event& event : events) {
    EXPECT_NEAR(event.impulse, 2 * mass * speed, 10 * kImpactRounding);
    EXPECT_EQ(event.kind == EventKind::taut, std::min(event.bodyA, event.bodyB) < 1);  // of the world
  }
}

}  // namespace
}  // namespace cradle
