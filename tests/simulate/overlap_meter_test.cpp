#include "simulate/overlap_meter.h"

#include <gmock/gmock.h>

#include <map>
#include <random>

#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

struct PlacedBall {
  std::string name;
  Vec3 center;
  double radius;
  bool moves;
};

// Spheres at random, every fourth fixed, behind a floor in the list of bodies: a sphere of two is as deep in the other
// as the sum of the radii exceeds the distance, and in the floor as its radius exceeds the height.
TEST(OverlapMeter, FindsAllThatBruteForceDoes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0.05, 1.1), size(0.03, 0.17);
  std::string bodies = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static"})";
  std::vector<PlacedBall> balls{{"floor", Vec3::Zero(), 0, false}};
  for (int i = 1; i <= 60; ++i) {
    const PlacedBall ball{
        fmt::format("b{}", i), {place(random), place(random), place(random)}, size(random), i % 4 != 0};
    balls.push_back(ball);
    bodies +=
        fmt::format(R"(, {{"name": "{}", "shape": {{"sphere": {{"radius": {}}}}}, "position": {}, "motion": "{}"}})",
                    ball.name, ball.radius, vectorText(ball.center), ball.moves ? "dynamic" : "static");
  }
  std::map<std::pair<int, int>, double> expected;  // m, by scene bodies
  for (int i = 1; i <= 60; ++i) {
    const PlacedBall& a = balls[static_cast<std::size_t>(i)];
    if (a.moves && a.center.y() <= a.radius) expected[{0, i}] = a.center.y() - a.radius;
    for (int j = i + 1; j <= 60; ++j) {
      const PlacedBall& b = balls[static_cast<std::size_t>(j)];
      const double separation = (b.center - a.center).norm() - a.radius - b.radius;
      if (separation <= 0 && (a.moves || b.moves)) expected[{i, j}] = separation;
    }
  }
  ASSERT_GT(expected.size(), 30u);

  OneIsland at("\"duration\": 1, \"bodies\": [" + bodies + "]");
  OverlapMeter meter(at.island.assembly);
  std::map<std::pair<int, int>, double> found;
  for (const Contact& contact : meter.overlapsOf(at.state())) {
    const auto [a, b] = meter.bodiesOf(contact);
    EXPECT_TRUE(found.insert({std::minmax(a, b), contact.separation}).second);
  }
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [bodies_, separation] : expected) {
    ASSERT_TRUE(found.contains(bodies_)) << bodies_.first << " " << bodies_.second;
    EXPECT_NEAR(found[bodies_], separation, 1e-15);  // of lengths below 3 m
  }
}

const char* const kBoxOnStilts = R"("duration": 1, "bodies": [
  {"name": "stilt", "shape": {"box": {"size": [0.1, 1, 0.02]}}, "motion": "static", "position": [0, -0.5, 0]},
  {"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "position": [0, 0.099, 0], "linearVelocity": [1, 2, 3]},
  {"name": "ball", "shape": {"sphere": {"radius": 0.07}}, "position": [0, 0.26, 0]}])";

// The stilt is thinner than the box, but it is fixed: half the box's height counts. The ball is smaller than that.
TEST(OverlapMeter, MeasuresByTheSmallestHalfExtentOfWhatMoves) {
  OneIsland at(kBoxOnStilts);
  OverlapMeter meter(at.island.assembly);
  const std::vector<Contact>& overlaps = meter.overlapsOf(at.state());
  ASSERT_FALSE(overlaps.empty());
  for (const Contact& contact : overlaps) {
    const auto [a, b] = meter.bodiesOf(contact);
    const bool isOfBall = a == 2 || b == 2;
    EXPECT_NEAR(meter.halfExtent(contact), isOfBall ? 0.07 : 0.1, 1e-15) << a << " " << b;
    EXPECT_NEAR(contact.separation, isOfBall ? -0.009 : -0.001, 1e-15);
  }
}

// Where bodies were at the start says nothing of a frame: what overlapped has parted, and turned.
TEST(OverlapMeter, SeesAFrameAndNotTheStart) {
  OneIsland at(kBoxOnStilts);
  OverlapMeter meter(at.island.assembly);
  Frame frame;
  frame.states.resize(2);
  frame.states[0].position = Vec3(0, 0.299, 0);
  frame.states[0].orientation = rotationAbout(Vec3::UnitX(), 1.5707963267948966);  // 0.6 m high
  frame.states[1].position = Vec3(0, 0.67, 0);
  const VectorX state = stateOf(at.island.assembly, frame);
  EXPECT_EQ(centerOfMass(state, 1), Vec3(0, 0.67, 0));
  EXPECT_EQ(linearVelocity(state, 0), Vec3(1, 2, 3));
  const std::vector<Contact>& overlaps = meter.overlapsOf(state);
  ASSERT_FALSE(overlaps.empty());
  for (const Contact& contact : overlaps) {
    EXPECT_EQ(meter.bodiesOf(contact), std::pair(0, 1));
    EXPECT_NEAR(contact.separation, -0.001, 1e-15);
  }
  frame.states[0].position.y() = 0.301;
  EXPECT_THAT(meter.overlapsOf(stateOf(at.island.assembly, frame)), SizeIs(1));  // the ball, by 1 mm
  frame.states[1].position.y() = 0.68;
  EXPECT_THAT(meter.overlapsOf(stateOf(at.island.assembly, frame)), IsEmpty());
}

}  // namespace
}  // namespace cradle
