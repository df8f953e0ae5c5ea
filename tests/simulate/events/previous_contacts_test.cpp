#include "simulate/events/previous_contacts.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A ball of 0.2 m on a board whose top is the plane y = 0, and its contact before and after an event, with friction.
/// The ball is body A of its constraint.
struct BallOnBoard : OneIsland {
  BallOnBoard()
      : OneIsland(R"("duration": 1, "bodies": [
          {"name": "board", "shape": {"box": {"size": [2, 0.2, 2]}}, "mass": 5, "position": [0, -0.1, 0]},
          {"name": "ball", "shape": {"sphere": {"radius": 0.2}}, "mass": 1, "position": [0.3, 0.2, 0.1]}])") {
    setOrientation(state(), kBoard, rotationAbout(Vec3::UnitY(), std::numbers::pi / 2));
    now.contact = contactsWithin(1e-9).at(0);
    now.pair = island.assembly.geometry.pairs[now.contact.pair];
    before.record = now;
    before.constraint.centerA = {kBall, Vec3::Zero()}, before.constraint.radiusA = 0.2;
    before.constraint.surfaceB = {kBoard, Vec3(0, 0.1, 0)};
    island.time = 0.75;
  }
  /// The contact was in that motion, and slid along a direction of the world.
  void moved(ContactMotion motion, const Vec3& direction = Vec3::UnitX()) {
    before.constraint.motion = motion;
    setSlidingDirection(before.constraint, direction, state());
  }
  void slides(const Vec3& direction) { now.slides = true, now.sticks = false, now.direction = direction; }
  void sticks() { now.slides = false, now.sticks = true; }
  bool isPrevious(const ContactRecord& record) { return previousAt(record, {before}, frames(), island) != nullptr; }
  std::vector<Event> eventsWith(const std::vector<ContactRecord>& active) {
    recordContactEvents({before}, active, frames(), island, island.log);
    return island.log.take();
  }
  std::vector<EventKind> kinds() {
    std::vector<EventKind> kinds;
    for (const Event& event : eventsWith({now})) kinds.push_back(event.kind);
    return kinds;
  }
  std::vector<BodyFrame> frames() {
    std::vector<BodyFrame> found;
    findBodyFrames(mechanism().bodies, state(), found);
    return found;
  }

  static constexpr int kBoard = 0, kBall = 1;
  PreviousContact before;
  ContactRecord now;
};

// The point may be 1e-4 of the ball's 0.2 m away, and the normal turned by an angle whose cosine is 0.999.
TEST(PreviousContacts, AreThoseOfTheSamePairPlaceAndNormal) {
  BallOnBoard at;
  EXPECT_TRUE(at.isPrevious(at.now));
  for (const double part : {0.99, 1.01}) {
    ContactRecord moved = at.now, turned = at.now;
    moved.contact.point += part * 1e-4 * 0.2 * Vec3(2, 1, 2) / 3;
    EXPECT_EQ(at.isPrevious(moved), part < 1);
    const double angle = part * std::acos(0.999);
    turned.contact.normal = rotationAbout(Vec3(1, 0, 2), angle) * turned.contact.normal;
    EXPECT_EQ(at.isPrevious(turned), part < 1);
  }
  ContactRecord other = at.now;
  other.pair.b += 1;
  EXPECT_FALSE(at.isPrevious(other));
  EXPECT_EQ(previousAt(at.now, {}, at.frames(), at.island), nullptr);
}

TEST(ContactEvents, AreReleasesWhereNothingIsActiveAnyMore) {
  BallOnBoard at;
  const std::vector<Event> events = at.eventsWith({});
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::release);
  EXPECT_EQ(events[0].time, 0.75);
  EXPECT_THAT((std::vector{events[0].bodyA, events[0].bodyB}), testing::UnorderedElementsAre(0, 1));
  EXPECT_LT((events[0].point - Vec3(0.3, 0, 0.1)).norm(), 1e-15);
  EXPECT_EQ(events[0].normal, at.now.contact.normal);
}

TEST(ContactEvents, AreSlipsOfWhatStuckOrTurnsBack) {
  BallOnBoard at;
  at.slides(Vec3(0.8, 0, 0.6));
  at.moved(ContactMotion::sticking);
  EXPECT_THAT(at.kinds(), ElementsAre(EventKind::slip));
  at.moved(ContactMotion::frictionless);
  EXPECT_THAT(at.kinds(), IsEmpty());
  // The direction of before turns with the board.
  at.moved(ContactMotion::sliding, Vec3(0.1, 0, 1));
  EXPECT_THAT(at.kinds(), IsEmpty());
  setOrientation(at.state(), BallOnBoard::kBoard, rotationAbout(Vec3::UnitY(), -std::numbers::pi / 2));
  EXPECT_THAT(at.kinds(), ElementsAre(EventKind::slip));
}

// What does not slide rolls if the surfaces turn against each other by more than 1e-6 m/s times their size.
TEST(ContactEvents, AreSticksOrRollsWhereSlidingEnds) {
  BallOnBoard at;
  at.sticks();
  at.moved(ContactMotion::sticking);
  EXPECT_THAT(at.kinds(), IsEmpty());
  at.moved(ContactMotion::sliding);
  angularVelocity(at.state(), BallOnBoard::kBall) = angularVelocity(at.state(), BallOnBoard::kBoard) = Vec3(0, 3, 0);
  EXPECT_THAT(at.kinds(), ElementsAre(EventKind::stick));
  for (const double part : {0.99, 1.01}) {
    angularVelocity(at.state(), BallOnBoard::kBall).z() = -part * 1e-6 / 0.2;
    EXPECT_THAT(at.kinds(), ElementsAre(part < 1 ? EventKind::stick : EventKind::roll));
  }
}

// Bodies at rest stick, and are not released though nothing is active between them.
TEST(ContactEvents, OfBodiesAtRestAreSticks) {
  BallOnBoard at;
  at.island.equations.setResting(0, true), at.island.equations.setResting(1, true);
  at.moved(ContactMotion::sliding);
  const std::vector<Event> events = at.eventsWith({});
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, EventKind::stick);
  at.moved(ContactMotion::sticking);
  EXPECT_THAT(at.eventsWith({}), IsEmpty());
}

}  // namespace
}  // namespace cradle
