#include "simulate/events/contact_record.h"

#include <gmock/gmock.h>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Three balls in a row on the plane y = 0. In the scene they are bodies 0, 2 and 3; the plane is body 1.
struct BallsInARow : OneIsland {
  BallsInARow()
      : OneIsland(R"("duration": 1, "materials": {"rough": {"dynamicFriction": 0.3, "staticFriction": 0.3},
        "smooth": {"dynamicFriction": 0, "staticFriction": 0}}, "bodies": [)" +
                  ballAt("a", 0, "rough") + R"(,
        {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"},)" +
                  ballAt("b", 0.2, "rough") + ", " + ballAt("c", 0.4, "smooth") + "]") {
    contacts = contactsWithin(1e-9);
  }
  static std::string ballAt(const std::string& name, double x, const std::string& material) {
    return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "material": "{}",
      "position": [{}, 0.1, 0]}})",
                       name, material, x);
  }
  /// The contact of two bodies of the scene.
  const Contact& between(int one, int other) {
    for (const Contact& contact : contacts) {
      const auto [a, b] = bodiesOf(island.assembly, island.assembly.geometry.pairs[contact.pair]);
      if ((a == one && b == other) || (a == other && b == one)) return contact;
    }
    ADD_FAILURE() << one << " " << other;
    return contacts.at(0);
  }
  ContactRecord recordOf(const Contact& contact, bool slides) {
    ContactRecord record{contact, island.assembly.geometry.pairs[contact.pair]};
    record.slides = slides;
    return record;
  }
  std::vector<Contact> contacts;
};

TEST(ContactRecord, NamesTheScenesBodiesOfContactsOnce) {
  BallsInARow at;
  ASSERT_EQ(at.contacts.size(), 5u);
  EXPECT_THAT(sceneBodiesOf({&at.between(2, 3), &at.between(0, 2)}, at.island.assembly), ElementsAre(0, 2, 3));
  EXPECT_THAT(sceneBodiesOf({&at.between(3, 1)}, at.island.assembly), ElementsAre(1, 3));
  EXPECT_THAT(sceneBodiesOf({}, at.island.assembly), IsEmpty());
  const ContactFallback fallback = fallbackAt("too hard", {&at.between(3, 1)}, at.island.assembly);
  EXPECT_EQ(fallback.reason, "too hard");
  EXPECT_THAT(fallback.bodies, ElementsAre(1, 3));
}

// Friction can jam only where contacts slide, and have any.
TEST(ContactRecord, TellsWhereFrictionJams) {
  BallsInARow at;
  const ContactRecord rough = at.recordOf(at.between(0, 1), true), sticking = at.recordOf(at.between(2, 1), false),
                      smooth = at.recordOf(at.between(2, 3), true);
  ASSERT_EQ(smooth.pair.material.dynamicFriction, 0);
  ASSERT_GT(rough.pair.material.dynamicFriction, 0);
  const ContactFallback jam = jamAt({&rough, &sticking, &smooth}, at.island.assembly);
  EXPECT_FALSE(jam.reason.empty());
  EXPECT_THAT(jam.bodies, ElementsAre(0, 1));
  EXPECT_TRUE(jamAt({&sticking, &smooth}, at.island.assembly).reason.empty());
}

TEST(ContactRecord, IsOfTheSamePairIfAllColliderNumbersAre) {
  const ColliderPair pair{2, 3, false, {}}, other{2, 3, false, {0.5, 0.1, 0.1}};
  EXPECT_TRUE(isSamePair(pair, other));
  EXPECT_FALSE(isSamePair(pair, {1, 3, false, {}}));
  EXPECT_FALSE(isSamePair(pair, {2, 2, false, {}}));
  EXPECT_FALSE(isSamePair(pair, {2, 3, true, {}}));
}

TEST(ContactRecord, IsAwakeAsLongAsOneOfItsBodiesIs) {
  BallsInARow at;
  at.island.equations.setResting(0, true);  // a
  EXPECT_FALSE(isAwake(at.between(0, 1), at.island.resting));
  EXPECT_TRUE(isAwake(at.between(0, 2), at.island.resting));
  EXPECT_TRUE(isAwake(at.between(2, 1), at.island.resting));
  at.island.equations.setResting(1, true);  // b
  EXPECT_FALSE(isAwake(at.between(0, 2), at.island.resting));
  EXPECT_TRUE(isAwake(at.between(2, 3), at.island.resting));
}

}  // namespace
}  // namespace cradle
