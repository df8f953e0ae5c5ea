#include "simulate/events/active_contacts.h"

#include <gmock/gmock.h>

#include <set>

#include "dynamics/integrators/dop853.h"
#include "simulate/events/on_plane.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using Change = ContactChange::Kind;

TEST(ActiveContacts, RecordWhatBecomesOfThem) {
  const auto kindsOf = [](const std::vector<Event>& events) {
    std::vector<EventKind> kinds;
    for (const Event& event : events) kinds.push_back(event.kind);
    return kinds;
  };
  OnPlane at(std::string(kBall) + "}", slopeOf(0.2));
  at.classify();
  EXPECT_THAT(at.island.log.take(), IsEmpty());
  at.classify();  // it rolls on
  EXPECT_THAT(at.island.log.take(), IsEmpty());
  linearVelocity(at.state(), 0).x() = 0.5;
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::slip));
  linearVelocity(at.state(), 0).x() = -0.5;  // the other way
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::slip));
  angularVelocity(at.state(), 0).z() = 0.5 / 0.2;
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::roll));
  linearVelocity(at.state(), 0).x() = 0.5;
  at.classify();
  at.island.log.take();
  linearVelocity(at.state(), 0).setZero(), angularVelocity(at.state(), 0).setZero();
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::stick));
  at.mechanism().pushes = {{{0, Vec3::Zero()}, Vec3(0, 20, 0)}};
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::release));
}

// Where friction gives way, the contact slides against the friction that it had, though it does not move yet.
TEST(ActiveContacts, SlideAwayFromTheFrictionThatGaveWay) {
  OnPlane at(std::string(kBox) + "}", slopeOf(0.4));
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  at.acceleration(0);
  at.classify(ContactChange{Change::slip, 0, 2});
  ASSERT_THAT(at.contacts(), SizeIs(4));
  EXPECT_THAT(at.contacts()[2].motion, ContactMotion::sliding);
  EXPECT_LT((at.contacts()[2].slidingDirection - Vec3::UnitX()).norm(), 1e-12);
}

TEST(ActiveContacts, FollowTheDirectionOfSliding) {
  OnPlane at(std::string(kBox) + R"(, "linearVelocity": [1, 0, 0]})");
  at.classify();
  dop853(at.island.rightHandSide, at.state(), 0, 1e-3, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  ASSERT_FALSE(at.active.firstChange());  // which notes the forces at the step's end
  linearVelocity(at.state(), 0) = Vec3(0.8, 0, 0.6);
  at.active.followSliding();
  for (const ContactConstraint& contact : at.contacts())
    EXPECT_LT((contact.slidingDirection - Vec3(0.8, 0, 0.6)).norm(), 1e-15);
}

// Each corner of the box that stands on the floor, and no other, is held.
TEST(ActiveContacts, HoldTheFeaturesThatTouch) {
  OnPlane at(std::string(kBox) + "}");
  at.classify();
  std::set<std::size_t> features;
  for (const ActiveFeature& held : at.active.features()) {
    EXPECT_EQ(held.pair, 0u);
    features.insert(held.feature);
    EXPECT_NEAR(at.island.assembly.geometry.colliders[0].points[held.feature].y(), -0.1, 1e-15);
  }
  EXPECT_THAT(features, SizeIs(4));
}

// What rests is held as before, and released by nothing: if it slid, that has ended.
TEST(ActiveContacts, OfBodiesThatComeToRestRecordNoRelease) {
  for (const bool slides : {false, true}) {
    OnPlane at(std::string(kBall) + "}");
    linearVelocity(at.state(), 0).x() = slides ? 0.5 : 0;
    at.classify();
    ASSERT_THAT(at.contacts(), SizeIs(1));
    at.island.log.take();
    at.island.resting.bringToRest({0}, at.state());
    at.classify();
    const std::vector<Event> events = at.island.log.take();
    ASSERT_THAT(events, SizeIs(slides ? 1 : 0));
    EXPECT_TRUE(!slides || events[0].kind == EventKind::stick);
  }
}

TEST(ActiveContacts, OfBodiesThatHaveComeToRestAreReleased) {
  OnPlane at(std::string(kBall) +
             R"(}, {"name": "other", "shape": {"sphere": {"radius": 0.1}}, "position": [2, 0.1, 0]})");
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(2));
  at.island.resting.bringToRest({0}, at.state());
  at.active.releaseResting();
  ASSERT_THAT(at.contacts(), SizeIs(1));
  EXPECT_EQ(at.contacts()[0].centerA.body, 1);
  at.classify();
  EXPECT_THAT(at.contacts(), SizeIs(1));
}

}  // namespace
}  // namespace cradle
