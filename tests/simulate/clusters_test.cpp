#include "simulate/clusters.h"

#include <gmock/gmock.h>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// A ground (0), a led post (1), and five balls (2 to 6), of which a rod ties 3 to 5 and one hangs 6 from the post.
struct Tied {
  Scene scene = sceneWith(R"("duration": 1, "bodies": [
      {"name": "ground", "shape": {"plane": {}}, "motion": "static"},
      {"name": "post", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "motion": "driven", "position": [4, 2, 0],
       "collision": "none", "linearVelocity": [0.1, 0, 0]},
      {"name": "a", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 1, 0]},
      {"name": "b", "shape": {"sphere": {"radius": 0.1}}, "position": [1, 1, 0]},
      {"name": "c", "shape": {"sphere": {"radius": 0.1}}, "position": [2, 1, 0]},
      {"name": "d", "shape": {"sphere": {"radius": 0.1}}, "position": [3, 1, 0]},
      {"name": "e", "shape": {"sphere": {"radius": 0.1}}, "position": [4, 1, 0]}],
    "rods": [{"bodyA": "b", "bodyB": "d"}, {"bodyA": "e", "bodyB": "post"}, {"bodyA": "c", "anchorB": [2, 2, 0]}],
    "pushes": [{"body": "d", "torque": [1, 0, 0], "start": 0, "duration": 1},
               {"body": "a", "torque": [1, 0, 0], "start": 0, "duration": 1}])");
  Plan plan = planOf(scene);
  Clusters clusters{scene, plan.islands.at(0)};
};

// Links to what is fixed or driven tie nothing to each other.
TEST(Clusters, AreWhatLinksTie) {
  const Tied at;
  ASSERT_EQ(at.clusters.count(), 4u);
  EXPECT_EQ(at.clusters.of(2), 0);
  EXPECT_EQ(at.clusters.of(3), 1);
  EXPECT_EQ(at.clusters.of(4), 2);
  EXPECT_EQ(at.clusters.of(5), 1);
  EXPECT_EQ(at.clusters.of(6), 3);
  for (const int other : {kWorld, 0, 1}) EXPECT_EQ(at.clusters.of(other), -1);
}

// A part has the bodies, links and pushes of its clusters, what is fixed, and what is driven if it hangs from it.
TEST(Clusters, HaveTheirPartOfThePlan) {
  const Tied at;
  const IslandPlan tied = at.clusters.partOf({0, 1});
  EXPECT_THAT(tied.bodies, ElementsAre(2, 3, 5));
  EXPECT_THAT(tied.touching, ElementsAre(0, 2, 3, 5));
  EXPECT_THAT(tied.links, SizeIs(1));
  EXPECT_THAT(tied.pushes, ElementsAre(0u, 1u));
  EXPECT_THAT(tied.driven, IsEmpty());
  const IslandPlan hanging = at.clusters.partOf({3});
  EXPECT_THAT(hanging.bodies, ElementsAre(6));
  EXPECT_THAT(hanging.driven, ElementsAre(1));
  EXPECT_THAT(hanging.touching, ElementsAre(0, 6));
  EXPECT_THAT(hanging.links, SizeIs(1));
  EXPECT_THAT(hanging.pushes, IsEmpty());
}

}  // namespace
}  // namespace cradle
