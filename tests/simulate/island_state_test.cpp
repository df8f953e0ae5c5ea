#include "simulate/island_state.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "core/error.h"
#include "dynamics/integrators/rk4.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string flyingBall(const std::string& name, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return fmt::format(
      R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "position": {}, "linearVelocity": {}}})", name,
      vectorText(position), vectorText(velocity));
}

/// Balls 5 m apart in a row, the first of which moves along it, at a step of half a second. (They might meet in 100 s.)
struct BallsInARow : OneIsland {
  explicit BallsInARow(double speed)
      : OneIsland(R"("duration": 100, "gravity": [0, 0, 0], "bodies": [)" +
                  flyingBall("a", Vec3::Zero(), Vec3(1, 0, 0)) + ", " + flyingBall("b", Vec3(5, 0, 0)) + ", " +
                  flyingBall("c", Vec3(10, 0, 0)) + "]") {
    linearVelocity(state(), 0).x() = speed;
    rk4(island.rightHandSide, state(), 0, 0.5, island.step);
    prepareInterpolant(island.rightHandSide, island.step);
  }
  bool isNear(std::size_t a, std::size_t b) {
    const std::vector<ColliderPair>& pairs = island.assembly.geometry.pairs;
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const ColliderPair& pair) { return pair.a == a && pair.b == b; });
  }
};

// In half a second the first ball goes 4.9 m: the second ball is touched at 4.8 m.
TEST(IslandState, FindsPairsThatComeNearWithinTheStep) {
  BallsInARow fast(9.8), slow(0.5);
  for (BallsInARow* at : {&fast, &slow}) at->island.findNearPairs(1e-3);
  EXPECT_TRUE(fast.isNear(0, 1));
  EXPECT_FALSE(fast.isNear(1, 2));
  EXPECT_FALSE(slow.isNear(0, 1));
}

TEST(IslandState, FindsPairsWithinTheMarginNow) {
  BallsInARow at(0);
  at.island.findNearPairsNow(1e-3);
  EXPECT_THAT(at.island.assembly.geometry.pairs, IsEmpty());
  at.island.findNearPairsNow(4.9);
  EXPECT_TRUE(at.isNear(0, 1));
  EXPECT_TRUE(at.isNear(1, 2));
}

// A push acts from its begin on, wakes its body and all that rests with it, and is no change between.
TEST(IslandState, WakesWhatAPushActsUpon) {
  OneIsland at(
      R"("duration": 9, "bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static"},)" +
      flyingBall("a", Vec3(0, 0.1, 0)) + ", " + flyingBall("b", Vec3(0.2, 0.1, 0)) + ", " +
      flyingBall("c", Vec3(3, 0.1, 0)) +
      R"(], "pushes": [{"body": "b", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0.5, "duration": 0.25}])");
  IslandState& island = at.island;
  island.resting.bringToRest({0, 1}, at.state());
  island.resting.bringToRest({2}, at.state());
  EXPECT_FALSE(island.makeChanges());
  EXPECT_THAT(at.mechanism().pushes, IsEmpty());
  island.time = 0.5;
  EXPECT_TRUE(island.makeChanges());
  ASSERT_EQ(at.mechanism().pushes.size(), 1u);
  EXPECT_EQ(at.mechanism().pushes[0].force, Vec3(1, 0, 0));
  EXPECT_FALSE(island.resting.isResting(0));
  EXPECT_FALSE(island.resting.isResting(1));
  EXPECT_TRUE(island.resting.isResting(2));
  std::vector<int> woken;
  for (const Event& event : island.log.take()) {
    if (event.kind != EventKind::wake) continue;
    woken.push_back(event.bodyA);
    EXPECT_EQ(event.time, 0.5);
    EXPECT_EQ(event.point, Vec3(event.bodyA == 1 ? 0 : 0.2, 0.1, 0));
  }
  EXPECT_THAT(woken, ElementsAre(1, 2));
  EXPECT_FALSE(island.makeChanges());
  island.time = 0.75;
  EXPECT_TRUE(island.makeChanges());
  EXPECT_THAT(at.mechanism().pushes, IsEmpty());
}

/// A hand that rests at (0, 2, 0) until 0.5 s and is at (1, 2, 0) at 1.5 s, and a ball beside it.
struct HandAndBall : OneIsland {
  HandAndBall()
      : OneIsland(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [
          {"name": "hand", "shape": {"sphere": {"radius": 0.1}}, "motion": "driven", "keyFrames":
            [{"time": 0.5, "position": [0, 2, 0]}, {"time": 1.5, "position": [1, 2, 0]}]}, )" +
                  flyingBall("ball", Vec3(3, 2, 0), Vec3(0, 1, 0)) + "]") {}
};

// Its place is not the integrator's, which knows it to the method's error alone: the middle of the way from rest to
// rest.
TEST(IslandState, PutsDrivenBodiesWhereTheyArePrescribed) {
  HandAndBall at;
  IslandState& island = at.island;
  ASSERT_TRUE(at.mechanism().bodies[0].isDriven());
  island.time = 0.5;
  island.integrate(rk4, 0.5);
  EXPECT_NEAR(centerOfMass(island.step.state, 0).x(), 0.5, 1e-15);
  EXPECT_NEAR(centerOfMass(island.step.state, 1).y(), 2.5, 1e-15);
  const VectorX integrated = [&] {
    rk4(island.rightHandSide, island.state, 0.5, 0.5, island.step);
    return island.step.state;
  }();
  EXPECT_GT(std::abs(centerOfMass(integrated, 0).x() - 0.5), 1e-3);
}

// A hand at rest wakes when its way begins: a change at a time that is known, before which no step ends.
TEST(IslandState, WakesWhatIsDrivenWhenItsWayBegins) {
  HandAndBall at;
  IslandState& island = at.island;
  EXPECT_EQ(island.nextChange(), 0.5);
  island.resting.bringToRest({0}, at.state());
  island.time = 0.25;
  EXPECT_FALSE(island.makeChanges());
  EXPECT_TRUE(island.resting.isResting(0));
  island.time = 0.5;
  EXPECT_TRUE(island.makeChanges());
  EXPECT_FALSE(island.resting.isResting(0));
  EXPECT_EQ(island.nextChange(), 1.5);
}

// Spheres around both bodies, of 0.1 m each, decide.
TEST(IslandState, EndsWhereContactCannotBeComputed) {
  OneIsland at(R"("duration": 9, "bodies": [{"name": "floor", "shape": {"plane": {}}, "motion": "static"},)" +
               flyingBall("a", Vec3(0, 5, 0)) + ", " + flyingBall("b", Vec3(1, 5, 0)) + "]");
  IslandState& island = at.island;
  island.assembly.geometry.unsolvedPairs.push_back({0, 1, false, {}});
  island.time = 0.25;
  centerOfMass(at.state(), 1).x() = 0.2 + 1e-9;
  EXPECT_NO_THROW(island.requireUnsolvedPairsApart());
  centerOfMass(at.state(), 1).x() = 0.2 - 1e-9;
  try {
    island.requireUnsolvedPairsApart();
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::scene);
    EXPECT_THAT(error.what(), AllOf(HasSubstr(R"("a" and "b")"), HasSubstr("0.25 s"), HasSubstr("experiment.json")));
  }
}

TEST(IslandState, MayTouchWhatHasColliders) {
  EXPECT_TRUE(BallsInARow(0).island.mayTouch());
  const std::string apart = fmt::format(R"("duration": 1, "bodies": [{}])", cradle::ball("a", Vec3::Zero()));
  EXPECT_FALSE(OneIsland(apart).island.mayTouch());
}

}  // namespace
}  // namespace cradle
