#include "simulate/events/event_contacts.h"

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kSpeedRounding = 1e-14;  // m/s: of velocities below 5 m/s, after some operations

/// Bodies of one material on the plane y = 0, with the contacts of their events.
struct Struck : OneIsland {
  Struck(const std::string& material, const std::string& bodies, double accuracy = 1e-6,
         const std::string& more = R"("gravity": [0, -9.81, 0])")
      : OneIsland(fmt::format(R"("duration": 1, "accuracy": {}, "materials": {{"stuff": {{{}}}}}, "bodies": [
          {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "stuff"}}, {}], {})",
                              accuracy, material, bodies, more)),
        ropes(island),
        tolerances(eventTolerancesOf(eventScalesOf(island))),
        contacts(island, ropes, tolerances, false) {
    island.findNearPairsNow(0.01);
  }
  std::vector<Event> eventsOf(EventKind kind) {
    std::vector<Event> events;
    for (const Event& event : island.log.take())
      if (event.kind == kind) events.push_back(event);
    return events;
  }

  LimitEvents ropes;
  EventTolerances tolerances;
  EventContacts contacts;
};

std::string material(double restitution, double friction = 0) {
  return fmt::format(R"("restitution": {0}, "staticFriction": {1}, "dynamicFriction": {1})", restitution, friction);
}

std::string ballAt(const std::string& name, const Vec3& position, const Vec3& velocity, double mass = 1) {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": {}, "material": "stuff",
    "position": {}, "linearVelocity": {}}})",
                     name, mass, vectorText(position), vectorText(velocity));
}

std::string boxAt(double x, double bottom, const std::string& more = "") {
  return fmt::format(R"({{"name": "box", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "mass": 3,
    "material": "stuff", "position": [{}, {}, 0]{}}})",
                     x, bottom + 0.1, more);
}

// p = (1 + e) v / (1/m + (r x n).I^-1 (r x n)) at the lowest corner of a turned box.
TEST(EventContacts, ReboundWithTheImpulseOfNewtonsRestitution) {
  Struck at(material(0.6), boxAt(0, 1, R"(, "linearVelocity": [0.3, -2, 0.1], "angularVelocity": [1, -0.5, 0.7])"));
  const Quat turn = rotationAbout(Vec3(1, 2, 3), 0.9);
  setOrientation(at.state(), 0, turn);
  Vec3 arm(0, 1, 0);
  for (const double x : {-0.2, 0.2})
    for (const double y : {-0.1, 0.1})
      for (const double z : {-0.3, 0.3})
        if (const Vec3 corner = turn * Vec3(x, y, z); corner.y() < arm.y()) arm = corner;
  centerOfMass(at.state(), 0) = Vec3(0.2, -arm.y(), 0.5);
  const VectorX before = at.state();
  const Mat3 inverse = worldInertia(at.mechanism().bodies[0], 0, before).inverse();
  const Vec3 lever = arm.cross(Vec3::UnitY());
  const double closing = -(Vec3(linearVelocity(before, 0)) + Vec3(angularVelocity(before, 0)).cross(arm)).y();
  ASSERT_GT(closing, 1);
  const double impulse = 1.6 * closing / (1 / 3.0 + lever.dot(inverse * lever));

  at.island.findNearPairsNow(0.01);
  at.island.time = 0.25;
  at.contacts.resolve();
  EXPECT_LT((linearVelocity(at.state(), 0) - linearVelocity(before, 0) - Vec3(0, impulse / 3, 0)).norm(),
            kSpeedRounding);
  EXPECT_LT((angularVelocity(at.state(), 0) - angularVelocity(before, 0) - inverse * lever * impulse).norm(),
            10 * kSpeedRounding);
  EXPECT_NEAR(impactEnergy(at.state()),
              kineticEnergy(at.mechanism().bodies, before) - kineticEnergy(at.mechanism().bodies, at.state()), 1e-14);
  EXPECT_TRUE(at.mechanism().contacts.empty());
  const std::vector<Event> impacts = at.eventsOf(EventKind::impact);
  ASSERT_THAT(impacts, SizeIs(1));
  EXPECT_EQ(impacts[0].time, 0.25);
  EXPECT_EQ(std::pair(impacts[0].bodyA, impacts[0].bodyB), std::pair(1, 0));
  EXPECT_NEAR(impacts[0].impulse, impulse, 1e-13);
  EXPECT_NEAR(impacts[0].normal.y(), -1, 1e-15);
  EXPECT_LT((impacts[0].point - Vec3(0.2 + arm.x(), 0, 0.5 + arm.z())).norm(), 1e-11);
}

// Rebounds of v below max(1e-7, 0.01 A, 100 A^2) sqrt(g size) are left out, with all that come after them: they would
// last 2 v / g (1 + e + e^2 + ...). g is the acceleration of closing.
TEST(EventContacts, EndAZenoSequenceBeforeItIsTooFastToBeSeen) {
  for (const double accuracy : {1e-6, 2e-5, 1e-3})
    for (const double part : {0.99, 1.01}) {
      const double last = std::max({1e-7, 0.01 * accuracy, 100 * accuracy * accuracy}) * std::sqrt(kGravity * 0.1);
      const double rebound = part * last, restitution = 0.75;
      Struck at(material(restitution), ballAt("ball", Vec3(0, 0.1, 0), Vec3(0, -rebound / restitution, 0)), accuracy);
      at.contacts.resolve();
      SCOPED_TRACE(testing::Message() << accuracy << " " << part);
      const std::vector<Event> rests = at.eventsOf(EventKind::rest);
      if (part > 1) {
        EXPECT_NEAR(linearVelocity(at.state(), 0).y(), rebound, 1e-15);
        EXPECT_THAT(rests, IsEmpty());
        continue;
      }
      EXPECT_EQ(linearVelocity(at.state(), 0).y(), 0);
      ASSERT_THAT(rests, SizeIs(1));
      EXPECT_NEAR(rests[0].time, 2 * rebound / (kGravity * (1 - restitution)), 1e-15);
      EXPECT_TRUE(at.island.resting.isResting(0));
    }
}

// At this accuracy rebounds below 1e-4 m/s would be left out.
TEST(EventContacts, NeverEndBouncesWithoutLoss) {
  Struck at(material(1), ballAt("ball", Vec3(0, 0.1, 0), Vec3(0, -1e-5, 0)), 1e-3);
  at.contacts.resolve();
  EXPECT_EQ(linearVelocity(at.state(), 0).y(), 1e-5);
}

/// Three balls of those masses in a row on the x axis, far above the floor; the first comes with 2 m/s.
std::string row(double gap, double first, double second, double third) {
  return ballAt("a", Vec3(0, 5, 0), Vec3(2, 0, 0), first) + ", " + ballAt("b", Vec3(0.2, 5, 0), Vec3::Zero(), second) +
         ", " + ballAt("c", Vec3(0.4 + gap, 5, 0), Vec3::Zero(), third);
}

// A gap far below what events could tell apart, but no rounding: pairs collide one after the other, elastically. (The
// first impact leaves 2 m/s x 2 m / (m + m') to ball b.)
TEST(EventContacts, FollowGapsThatAreNoRounding) {
  Struck at(material(1), row(5e-11, 1, 2, 4), 1e-6, R"("gravity": [0, 0, 0])");
  at.contacts.resolve();
  const double b = 2 * 2 * 1 / 3.0, a = b - 2;   // m/s: of the first impact
  const double c = 2 * b * 2 / 6.0, b2 = c - b;  // m/s: of the second
  EXPECT_NEAR(linearVelocity(at.state(), 0).x(), a, kSpeedRounding);
  EXPECT_NEAR(linearVelocity(at.state(), 1).x(), b2, kSpeedRounding);
  EXPECT_NEAR(linearVelocity(at.state(), 2).x(), c, kSpeedRounding);
  // The balls have moved by what passed until the second impact, 5e-11 m / b: places are rounded to 1e-16 m.
  EXPECT_NEAR(centerOfMass(at.state(), 1).x() - 0.2, 5e-11, 2e-16);
  EXPECT_THAT(at.eventsOf(EventKind::impact), SizeIs(2));
}

// All that touches takes part in one impact: equal balls pass the speed on to the last (Newton's cradle).
TEST(EventContacts, PassAnImpactOnThroughWhatTouches) {
  Struck at(material(1), row(0, 1, 1, 1), 1e-6, R"("gravity": [0, 0, 0])");
  at.contacts.resolve();
  EXPECT_NEAR(linearVelocity(at.state(), 0).x(), 0, kSpeedRounding);
  EXPECT_NEAR(linearVelocity(at.state(), 1).x(), 0, kSpeedRounding);
  EXPECT_NEAR(linearVelocity(at.state(), 2).x(), 2, kSpeedRounding);
}

// A box that falls flat and does not rebound is pressed by its weight: on a smooth floor it slides on, on rough ones it
// is put to rest if the friction of the impact, mu m v, stops it: mu 1 m/s, compared with 0.3 m/s along the floor.
TEST(EventContacts, LastWhereForcesPressWhatAnImpactStopped) {
  const std::string falling = boxAt(0, 0, R"(, "linearVelocity": [0.3, -1, 0])");
  Struck smooth(material(0), falling);
  smooth.contacts.resolve();
  EXPECT_THAT(smooth.mechanism().contacts, SizeIs(4));
  EXPECT_LT((linearVelocity(smooth.state(), 0) - Vec3(0.3, 0, 0)).norm(), kSpeedRounding);
  Struck rough(material(0, 0.5), falling);
  rough.contacts.resolve();
  EXPECT_TRUE(rough.island.resting.isResting(0));
  EXPECT_THAT(rough.mechanism().contacts, IsEmpty());
  Struck hardlyRough(material(0, 0.2), falling);
  hardlyRough.contacts.resolve();
  EXPECT_THAT(hardlyRough.mechanism().contacts, SizeIs(4));
  // It tips forward, too: the friction has a lever of 0.1 m, and the four corners press differently.
  EXPECT_NEAR(linearVelocity(hardlyRough.state(), 0).x(), 0.1, 1e-12);
}

// Slower than min(1e-7, A) sqrt(g size) is still. On a smooth floor nothing else ends a turning about the vertical.
TEST(EventContacts, BringToRestWhatIsStillAndCanBeHeld) {
  for (const double accuracy : {1e-6, 1e-9})
    for (const double part : {0.99, 1.01}) {
      Struck at(material(0), boxAt(0, 0), accuracy);
      const double size = at.island.assembly.radii[0];
      const double most = 1e-12 + std::min(1e-7, accuracy) * std::sqrt(kGravity * size);
      angularVelocity(at.state(), 0).y() = part * most / size;
      at.contacts.resolve();
      EXPECT_EQ(at.island.resting.isResting(0), part < 1) << accuracy << " " << part;
      EXPECT_THAT(at.eventsOf(EventKind::rest), SizeIs(part < 1 ? 1 : 0));
    }
}

TEST(EventContacts, BringToRestOnlyWhatFrictionCanHold) {
  for (const double tangent : {0.49, 0.51}) {
    Struck at(material(0, 0.5), boxAt(0, 0), 1e-6, fmt::format(R"("gravity": [{}, -9, 0])", 9 * tangent));
    at.contacts.resolve();
    EXPECT_EQ(at.island.resting.isResting(0), tangent < 0.5);
    EXPECT_THAT(at.mechanism().contacts, SizeIs(tangent < 0.5 ? 0 : 4));
  }
}

TEST(EventContacts, WakeWhatIsStruckWithAllThatRestsWithIt) {
  Struck at(material(0.5, 0.5), boxAt(0, 0) + ", " + ballAt("on", Vec3(0.1, 0.3, 0), Vec3::Zero()) + ", " +
                                    ballAt("apart", Vec3(3, 0.1, 0), Vec3::Zero()) + ", " +
                                    ballAt("missile", Vec3(0.3, 0.1, 0), Vec3(1, 0, 0)));
  at.island.findNearPairsNow(0.01);
  at.contacts.resolve();
  EXPECT_TRUE(at.island.resting.isResting(0) && at.island.resting.isResting(1) && at.island.resting.isResting(2));
  at.island.log.take();
  linearVelocity(at.state(), 3) = Vec3(-1, 0, 0);  // it touches the box's side at x = 0.2
  at.contacts.resolve();
  EXPECT_FALSE(at.island.resting.isResting(0));
  EXPECT_FALSE(at.island.resting.isResting(1));
  EXPECT_TRUE(at.island.resting.isResting(2));
  EXPECT_THAT(at.eventsOf(EventKind::wake), SizeIs(2));
}

// A joint at the height of the floor's contact, 2e-4 sizes beside it and 4e-4: forces there have hardly a lever.
TEST(EventContacts, DoNotServeContactsBesideJoints) {
  for (const double beside : {2e-4, 4e-4}) {
    Struck at(material(0, 0.3), ballAt("ball", Vec3(0, 0.1, 0), Vec3::Zero()), 1e-6,
              fmt::format(R"("gravity": [0, -9.81, 0], "ballJoints": [{{"bodyA": "ball", "anchorA": [{0}, -0.05, 0],
                "anchorB": [{0}, 0.05, 0]}}])",
                          0.1 * beside));
    at.contacts.resolve();
    EXPECT_EQ(at.contacts.fallbackReason().empty(), beside > 3e-4) << at.contacts.fallbackReason();
  }
}

// Ropes at their length take part: what drives the ball up is stopped by the rope to the floor in the same impact.
TEST(EventContacts, TakeTautRopesIntoTheImpact) {
  Struck at(material(1),
            ballAt("ball", Vec3(0, 1, 0), Vec3(0, 0, 0)) + ", " + ballAt("missile", Vec3(0, 0.8, 0), Vec3(0, 3, 0)),
            1e-6, R"("gravity": [0, -9.81, 0], "ropes": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0],
      "maxLength": 1, "restitution": 1}])");
  at.contacts.resolve();
  // As against a wall: the ball stays, and the missile goes back.
  EXPECT_LE(linearVelocity(at.state(), 0).y(), kSpeedRounding);
  EXPECT_NEAR(3 * 3, linearVelocity(at.state(), 0).squaredNorm() + linearVelocity(at.state(), 1).squaredNorm(), 1e-13);
  EXPECT_THAT(at.eventsOf(EventKind::taut), SizeIs(1));
}

// Flat, a cylinder rebounds as it came. One that tips strikes by one point of its rim, of which angles tell that are
// smaller than rounding of gaps.
TEST(EventContacts, DoNotServeImpactsOfCylindersThatTip) {
  for (const double spin : {0.0, 1e-8, 0.1})
    for (const double rise : {-1.0, 1.0}) {
      Struck at(material(1, 0.1), fmt::format(R"({{"name": "can", "shape": {{"cylinder": {{"radius": 0.1,
          "length": 0.2}}}}, "mass": 1, "material": "stuff", "position": [0, 0.1, 0], "linearVelocity": [0, {}, 0],
          "angularVelocity": [{}, 3, 0]}})",
                                              rise, spin));
      at.contacts.resolve();
      EXPECT_EQ(at.contacts.fallbackReason(), spin > 1e-6 && rise < 0 ? "a cylinder tips over its rim" : "");
      EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 1, spin == 0 ? kSpeedRounding : 1);
    }
}

}  // namespace
}  // namespace cradle
