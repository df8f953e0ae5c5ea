#include "simulate/steps/contact_set.h"

#include <gmock/gmock.h>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// Balls of 0.1 m: 0 and 1 touch on a rough floor; 2 is smooth, and 6 as well, on a rod to the world; 3 hangs on a rod
/// to 4, which touches 5; 7 is on a rope to 1, and touches nothing.
struct Gathered : OneIsland {
  Gathered()
      : OneIsland(R"("duration": 1, "materials": {
          "rough": {"restitution": 0.3, "staticFriction": 0.5, "dynamicFriction": 0.4},
          "smooth": {"restitution": 0, "staticFriction": 0, "dynamicFriction": 0}}, "bodies": [
          {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"}, )" +
                  bodies() + R"(], "rods": [
          {"bodyA": "b3", "anchorA": [0, 0, 0], "bodyB": "b4", "anchorB": [0, 0, 0]},
          {"bodyA": "b6", "anchorA": [0, 0, 0], "anchorB": [9, 3, 0]}],
          "ropes": [{"bodyA": "b1", "anchorA": [0, 0, 0], "bodyB": "b7", "anchorB": [0, 0, 0], "maxLength": 2,
                     "restitution": 0.7}])") {}

  static std::string bodies() {
    const Vec3 places[] = {{0, 0.1, 0}, {0.2, 0.1, 0}, {1, 0.1, 0}, {5, 3, 0},
                           {5.5, 3, 0}, {5.7, 3, 0},   {9, 0.1, 0}, {0.2, 2, 0}};
    std::string text;
    for (int i = 0; i < 8; ++i)
      text += fmt::format(R"({}{{"name": "b{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "position": {},
        "material": "{}"}})",
                          i > 0 ? ", " : "", i, vectorText(places[i]), i == 2 || i == 6 ? "smooth" : "rough");
    return text;
  }
  ContactSet set(bool withRope) {
    std::vector<const Limit*> ropes;
    if (withRope) ropes.push_back(&island.assembly.limits.at(0));
    return {island.assembly, tolerances, contactsWithin(1e-9), ropes, state()};
  }

  StepTolerances tolerances = stepTolerancesOf(stepScalesOf(island.assembly));
};

// Contacts and constraints join bodies; groups are in the order of their first bodies, and have all bodies that are
// joined, touched or not.
TEST(ContactSet, HasAGroupForAllThatIsJoined) {
  Gathered at;
  const ContactSet set = at.set(false);
  ASSERT_EQ(set.size(), 6u);
  const std::vector<StepGroup> groups = set.findGroups();
  ASSERT_THAT(groups, SizeIs(4));
  const std::vector<int> bodies[] = {{0, 1}, {2}, {3, 4, 5}, {6}};
  std::size_t members = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const StepGroup& group = groups[i];
    EXPECT_EQ(group.moved.bodies, bodies[i]);
    EXPECT_EQ(group.firstBody, bodies[i][0]);
    EXPECT_EQ(group.isConstrained, i >= 2);
    EXPECT_TRUE(std::is_sorted(group.members.begin(), group.members.end()));
    ASSERT_EQ(group.contacts.size(), group.members.size());
    for (std::size_t k = 0; k < group.members.size(); ++k) {
      EXPECT_EQ(group.contacts[k].point, set[group.members[k]].point);
      EXPECT_THAT(bodies[i], testing::Contains(group.contacts[k].movingBody()));
    }
    members += group.members.size();
  }
  EXPECT_EQ(members, 6u);
}

// Friction with something fixed hinders all common motions, as a rod to it does; a smooth plane leaves three; bodies in
// the air have all six.
TEST(ContactSet, KnowsTheMotionsThatNothingFixedHinders) {
  Gathered at;
  const std::vector<StepGroup> groups = at.set(false).findGroups();
  ASSERT_THAT(groups, SizeIs(4));
  const Eigen::Index kept[] = {0, 3, 6, 0};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(groups[i].moved.kept.cols(), kept[i]) << i;
  EXPECT_TRUE(groups[1].moved.kept.row(1).isZero(1e-15));  // none across the plane
}

// A rope is a contact of the bodies at its ends that may close by its slack, and has its restitution. Without contacts
// it is none.
TEST(ContactSet, HasRopesAsContacts) {
  Gathered at;
  const ContactSet set = at.set(true);
  ASSERT_EQ(set.size(), 7u);
  EXPECT_EQ(set.ropeOf(5), nullptr);
  EXPECT_EQ(set.ropeOf(6), &at.island.assembly.limits[0]);
  EXPECT_EQ(set.materialOf(6).restitution, 0.7);
  EXPECT_EQ(set.materialOf(6).staticFriction, 0);
  EXPECT_EQ(set.materialOf(0).staticFriction, at.island.assembly.geometry.pairs[set[0].pair].material.staticFriction);
  EXPECT_NEAR(set[6].separation, 0.1, 1e-15);  // 2 m, less the 1.9 m between the balls
  EXPECT_LT((set[6].normal + Vec3::UnitY()).norm(), 1e-15);
  EXPECT_THAT(set.findGroups().at(0).moved.bodies, ElementsAre(0, 1, 7));
  const ContactSet ropeAlone(at.island.assembly, at.tolerances, {}, {&at.island.assembly.limits[0]}, at.state());
  EXPECT_EQ(ropeAlone.size(), 0u);
  EXPECT_THAT(ropeAlone.findGroups(), IsEmpty());
}

}  // namespace
}  // namespace cradle
