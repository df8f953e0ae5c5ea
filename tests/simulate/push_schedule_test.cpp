#include "simulate/push_schedule.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kPi = 3.14159265358979324;
constexpr double kPlaceRounding = 1e-15;  // m: of some operations on places below 4 m

/// A box of 0.4 x 0.2 x 0.6 m whose centre of mass is beside its middle, and a ball.
std::string pushed(const std::string& pushes) {
  return R"("duration": 9, "bodies": [
    {"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 2, "centerOfMass": [0.05, -0.02, 0.1],
     "position": [1, 2, 3]},
    {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [-1, 0, 0]}], "pushes": [)" +
         pushes + "]";
}

std::vector<Vec3> forcesOf(const std::vector<PushForce>& acting) {
  std::vector<Vec3> forces;
  for (const PushForce& push : acting) forces.push_back(push.force);
  return forces;
}

TEST(PushSchedule, StopsStepsAtEachBeginAndEndOnce) {
  OneIsland at(pushed(R"(
    {"body": "ball", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0.5, "duration": 0.25},
    {"body": "box", "point": [0, 0, 0], "force": [0, 2, 0], "start": 0.625, "duration": 1}
  )"));
  PushSchedule& pushes = at.island.pushes;
  std::vector<PushForce> acting;
  const auto apply = [&](double time) { return pushes.apply(time, at.state(), acting); };
  EXPECT_EQ(pushes.nextChange(), 0.5);
  EXPECT_THAT(apply(0.25), IsEmpty());
  EXPECT_THAT(acting, IsEmpty());
  EXPECT_THAT(apply(0.5), ElementsAre(1));
  EXPECT_THAT(forcesOf(acting), ElementsAre(Vec3(1, 0, 0)));
  EXPECT_EQ(pushes.nextChange(), 0.625);
  EXPECT_THAT(apply(0.625), ElementsAre(0));
  EXPECT_THAT(forcesOf(acting), ElementsAre(Vec3(1, 0, 0), Vec3(0, 2, 0)));
  EXPECT_EQ(pushes.nextChange(), 0.75);
  EXPECT_THAT(apply(0.75), ElementsAre(1));
  EXPECT_THAT(forcesOf(acting), ElementsAre(Vec3(0, 2, 0)));
  EXPECT_EQ(pushes.nextChange(), 1.625);
  EXPECT_THAT(apply(1.625), ElementsAre(0));
  EXPECT_THAT(acting, IsEmpty());
  EXPECT_EQ(pushes.nextChange(), std::numeric_limits<double>::infinity());
  EXPECT_THAT(apply(5), IsEmpty());
}

// The later of two in the scene begins first; a third begins and ends before anybody asks.
TEST(PushSchedule, KeepsTheOrderOfTheScene) {
  OneIsland at(pushed(R"(
    {"body": "ball", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0.5, "duration": 1},
    {"body": "box", "point": [0, 0, 0], "force": [0, 2, 0], "start": 0.25, "duration": 1.25},
    {"body": "box", "point": [0, 0, 0], "force": [0, 0, 3], "start": 0.5, "duration": 0.125}
  )"));
  PushSchedule& pushes = at.island.pushes;
  std::vector<PushForce> acting;
  const auto apply = [&](double time) { return pushes.apply(time, at.state(), acting); };
  EXPECT_EQ(pushes.nextChange(), 0.25);
  EXPECT_THAT(apply(0.25), ElementsAre(0));
  EXPECT_THAT(apply(0.75), ElementsAre(1, 0));
  EXPECT_THAT(forcesOf(acting), ElementsAre(Vec3(1, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 3)));
  EXPECT_EQ(pushes.nextChange(), 0.625);
  EXPECT_THAT(apply(0.75), ElementsAre(0));
  EXPECT_THAT(forcesOf(acting), ElementsAre(Vec3(1, 0, 0), Vec3(0, 2, 0)));
  EXPECT_EQ(pushes.nextChange(), 1.5);
  EXPECT_THAT(apply(1.5), ElementsAre(1, 0));
  EXPECT_THAT(acting, IsEmpty());
}

TEST(PushSchedule, ActsAtAPointThatIsCountedFromTheCentreOfMass) {
  OneIsland at(pushed(R"({"body": "box", "point": [0.2, 0.1, -0.3], "force": [4, -2, 5], "start": 0, "duration": 1})"));
  std::vector<PushForce> acting;
  at.island.pushes.apply(0, at.state(), acting);
  ASSERT_THAT(acting, SizeIs(1));
  EXPECT_EQ(acting[0].point.body, 0);
  EXPECT_LT((acting[0].point.point - Vec3(0.15, 0.12, -0.4)).norm(), kPlaceRounding);
}

// The box has turned by 90 degrees about z, which makes it 0.2 m wide along x and 0.4 m along y, and its centre of mass
// is at (0, 1, 2): the middle of the box is at (0, 1, 2) - R (0.05, -0.02, 0.1) = (-0.02, 0.95, 1.9). A ray down x at
// the height 1.1 and depth 1.75 meets the face x = -0.02 + 0.1.
TEST(PushSchedule, FindsWhereARayHitsTheBodyAsItIsThen) {
  OneIsland at(
      pushed(R"({"body": "box", "ray": {"origin": [3, 1.1, 1.75], "direction": [-2, 0, 0]}, "force": [-1, 0, 0],
    "start": 0, "duration": 1})"));
  centerOfMass(at.state(), 0) = Vec3(0, 1, 2);
  setOrientation(at.state(), 0, rotationAbout(Vec3::UnitZ(), kPi / 2));
  std::vector<PushForce> acting;
  EXPECT_THAT(at.island.pushes.apply(0, at.state(), acting), ElementsAre(0));
  ASSERT_THAT(acting, SizeIs(1));
  const Vec3 hit(0.08, 1.1, 1.75);
  EXPECT_LT((motionOf(acting[0].point, at.state()).position - hit).norm(), kPlaceRounding);
  const std::vector<Event> events = at.island.log.take();
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].kind, EventKind::pushStart);
  EXPECT_LT((events[0].point - hit).norm(), kPlaceRounding);
}

// A ray above the box, 0.4 m high along y: it passes at 0.201 m over the middle.
TEST(PushSchedule, IsOverForARayThatMisses) {
  OneIsland at(pushed(R"({"body": "box", "ray": {"origin": [3, 1.151, 1.75], "direction": [-2, 0, 0]},
    "force": [-1, 0, 0], "start": 0, "duration": 1})"));
  centerOfMass(at.state(), 0) = Vec3(0, 1, 2);
  setOrientation(at.state(), 0, rotationAbout(Vec3::UnitZ(), kPi / 2));
  std::vector<PushForce> acting;
  EXPECT_THAT(at.island.pushes.apply(0, at.state(), acting), IsEmpty());
  EXPECT_THAT(acting, IsEmpty());
  EXPECT_EQ(at.island.pushes.nextChange(), std::numeric_limits<double>::infinity());
  const std::vector<Event> events = at.island.log.take();
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].kind, EventKind::pushMissed);
  EXPECT_THAT(at.island.log.takeWarnings(), ElementsAre(HasSubstr("[0, 1, 2]")));
}

TEST(PushSchedule, LeavesPushesOnBodiesOfOtherIslandsAlone) {
  OneIsland at(pushed(R"({"body": "box", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0, "duration": 1},
    {"body": "ball", "point": [0, 0, 0], "force": [0, 0, 3], "start": 2, "duration": 1})"));
  IslandPlan ballAlone;
  ballAlone.bodies = {1};
  ballAlone.pushes = {1};
  EXPECT_EQ(PushSchedule(at.scene, assemble(at.scene, ballAlone), at.island.log).nextChange(), 2);
}

}  // namespace
}  // namespace cradle
