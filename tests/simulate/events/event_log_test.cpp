#include "simulate/events/event_log.h"

#include <gmock/gmock.h>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;
using testing::UnorderedElementsAre;

/// Scene bodies: floor 0, moving ball 1, wall 2, moving ball 3. Both touch the floor, and the second one the wall.
struct Logged : OneIsland {
  Logged()
      : OneIsland(R"("duration": 1, "bodies": [
          {"name": "floor", "shape": {"plane": {}}, "motion": "static"},
          {"name": "one", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.1, 0]},
          {"name": "wall", "shape": {"box": {"size": [1, 1, 1]}}, "position": [5.6, 0.5, 0], "motion": "static"},
          {"name": "other", "shape": {"sphere": {"radius": 0.1}}, "position": [5, 0.1, 0]}])") {}
  EventLog& log() { return island.log; }
};

TEST(EventLog, NamesTheScenesBodiesOfAContact) {
  Logged at;
  const std::vector<Contact> contacts = at.contactsWithin(1e-9);
  ASSERT_THAT(contacts, SizeIs(3));
  for (const Contact& contact : contacts) at.log().recordContact(0.5, EventKind::impact, contact, 2.5);
  const std::vector<Event> events = at.log().take();
  ASSERT_THAT(events, SizeIs(3));
  std::vector<std::pair<int, int>> bodies;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [time, kind, a, b, point, normal, impulse] = events[i];
    bodies.emplace_back(a, b);
    EXPECT_EQ(time, 0.5);
    EXPECT_EQ(kind, EventKind::impact);
    EXPECT_EQ(impulse, 2.5);
    EXPECT_EQ(point, contacts[i].point);
    // From A to B: down where the floor is B, and towards the wall from the ball.
    const Vec3 expected = a == 2 || b == 2 ? Vec3::UnitX() : Vec3(-Vec3::UnitY());
    EXPECT_LT((normal - (a == 1 || a == 3 ? expected : Vec3(-expected))).norm(), 1e-15);
  }
  for (auto& [a, b] : bodies)
    if (a > b) std::swap(a, b);
  EXPECT_THAT(bodies, UnorderedElementsAre(Pair(0, 1), Pair(0, 3), Pair(2, 3)));
  EXPECT_THAT(at.log().take(), IsEmpty());
}

TEST(EventLog, NamesTheScenesBodyOfAMovingOne) {
  Logged at;
  at.log().recordBody(0.25, EventKind::wake, 1, Vec3(1, 2, 3));
  const std::vector<Event> events = at.log().take();
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].bodyA, 3);
  EXPECT_EQ(events[0].bodyB, kWorld);
  EXPECT_EQ(events[0].point, Vec3(1, 2, 3));
  EXPECT_EQ(events[0].normal, Vec3(0, 0, 0));
}

// What happens to one body does not tell which bodies meet.
TEST(EventLog, KnowsTheLatestTwoBodies) {
  Logged at;
  EXPECT_THAT(at.log().latestBodies(), IsEmpty());
  at.log().recordBody(0.1, EventKind::wake, 0, Vec3::Zero());
  EXPECT_THAT(at.log().latestBodies(), IsEmpty());
  at.log().record({0.2, EventKind::taut, 3, 1});
  at.log().recordBody(0.3, EventKind::rest, 0, Vec3::Zero());
  EXPECT_THAT(at.log().latestBodies(), ElementsAre(3, 1));
  at.log().take();
  EXPECT_THAT(at.log().latestBodies(), ElementsAre(3, 1));
  at.log().record({0.35, EventKind::release, 1, kWorld});
  EXPECT_THAT(at.log().latestBodies(), ElementsAre(3, 1));
  at.log().record({0.35, EventKind::impact, 3, kWorld});  // at the stop of a joint
  EXPECT_THAT(at.log().latestBodies(), ElementsAre(3));
  at.log().record({0.4, EventKind::taut, 1, 0});
  EXPECT_THAT(at.log().latestBodies(), ElementsAre(1, 0));
}

// Each fault is a correction of its kind, of all moving bodies of the impact, each once.
TEST(EventLog, TellsTheFaultsOfAnImpactThatThereAre) {
  Logged at;
  std::vector<ImpactContact> impacts(4);
  impacts[0].contact.bodyA = 1, impacts[0].contact.bodyB = 0;
  impacts[1].contact.bodyA = 0;
  impacts[2].contact.bodyB = 1;
  at.log().recordFaults(0.5, impacts, {});
  EXPECT_THAT(at.log().corrections().takeFirst(), IsEmpty());
  at.log().recordFaults(0.5, impacts, {0.125, 0, 0});
  at.log().recordFaults(0.6, impacts, {0, 0.25, 0});
  at.log().recordFaults(0.7, impacts, {0, 0, 77});
  at.log().recordFaults(0.8, impacts, {0, 0, 78});
  const std::vector<Correction> found = at.log().corrections().takeFirst();
  ASSERT_THAT(found, SizeIs(3));
  const CorrectionKind kinds[] = {CorrectionKind::unsolvedContacts, CorrectionKind::scaledImpulses,
                                  CorrectionKind::endlessImpacts};
  const double amounts[] = {0.125, 0.25, 77}, times[] = {0.5, 0.6, 0.7};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found[i].kind, kinds[i]);
    EXPECT_EQ(found[i].amount, amounts[i]);
    EXPECT_EQ(found[i].time, times[i]);
    EXPECT_THAT(found[i].bodies, ElementsAre(1, 3));
  }
  std::map<std::string, long> counts;
  at.log().corrections().addCounts(counts);
  EXPECT_EQ(counts[correctionName(CorrectionKind::endlessImpacts)], 2);
}

TEST(EventLog, HandsOutWarningsOnce) {
  Logged at;
  at.log().warn("one");
  at.log().warn("two");
  EXPECT_THAT(at.log().takeWarnings(), ElementsAre("one", "two"));
  EXPECT_THAT(at.log().takeWarnings(), IsEmpty());
}

}  // namespace
}  // namespace cradle
