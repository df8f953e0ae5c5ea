// Sketches of scenes, their twins, and places in touch.

#include "experiments/scene_sketch.h"

#include <gmock/gmock.h>

#include <cmath>

#include "experiments/experiment.h"
#include "experiments/random_sketch.h"
#include "experiments/scene_twins.h"
#include "experiments/sketch_oracles.h"
#include "experiments/squeezed_balls.h"
#include "experiments/touching_places.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using testing::Contains;
using testing::Field;
using testing::IsEmpty;

SketchBody levelFloor() {
  SketchBody floor;
  floor.shape = SketchShape::plane, floor.isStatic = true;
  return floor;
}

/// A prism that flies and turns over a floor, a box on a hinge beside it.
SceneSketch flyingSketch() {
  SceneSketch sketch;
  sketch.name = "Flying", sketch.accuracy = 1e-9;
  sketch.materials.push_back({0.5, 0.3, 0.3});
  SketchBody prism;
  prism.shape = SketchShape::prism, prism.mass = 2;
  prism.worldFromBody = {rotationAbout(Vec3(1, 2, 3), 0.7), Vec3(0.2, 0.8, -0.1)};
  prism.linearVelocity = Vec3(0.3, -0.2, 0.4), prism.angularVelocity = Vec3(2, -3, 1);
  SketchBody box;
  box.shape = SketchShape::box, box.size = Vec3(0.1, 0.3, 0.2);
  box.worldFromBody = {rotationAbout(Vec3(3, -1, 1), 1.1), Vec3(-0.6, 0.9, 0.3)};
  sketch.bodies = {levelFloor(), prism, box};
  SketchLink hinge;
  hinge.kind = SketchLinkKind::hinge, hinge.bodyA = 2, hinge.axis = Vec3(1, 2, -1);
  hinge.anchorA = Vec3(0.05, 0.15, 0.1), hinge.anchorB = anchorInWorld(sketch, 2, hinge.anchorA);
  SketchLink spring;
  spring.kind = SketchLinkKind::spring, spring.bodyA = 1, spring.bodyB = 2, spring.stiffness = 50, spring.length = 0.5;
  spring.anchorA = Vec3(0.1, 0.05, 0), spring.anchorB = Vec3(0, -0.15, 0.02);
  sketch.links = {hinge, spring};
  return sketch;
}

// Twins of a motion without impacts agree to the accuracy; a twin seen the wrong way would be off by its size.
TEST(SceneTwin, OfASmoothMotionIsTheSameMotion) {
  const SceneSketch sketch = flyingSketch();
  EXPECT_THAT(checkSketch(sketch, [](const std::string&) {}), IsEmpty());
  SceneTwin twin = mirroredTwin(sketch, 0);
  const Vec3 there = twin.sketch.bodies[1].worldFromBody * Vec3(0.1, 0.05, 0.1);  // z = 0.1 is the image of 0
  const Vec3 here = sketch.bodies[1].worldFromBody * Vec3(0.1, 0.05, 0);
  EXPECT_LT((there - Vec3(-here.x(), here.y(), here.z())).norm(), 1e-8);  // the model's single precision
}

/// A slider with a motor and stops on a box that is led along key frames, a hinge with a motor to a wheel, and a ball
/// that swings on a hand.
SceneSketch ledSketch() {
  SceneSketch sketch;
  sketch.name = "Led", sketch.accuracy = 1e-9, sketch.duration = 0.3;
  sketch.materials.push_back({});
  SketchBody table, sled, wheel, hand, bob;
  table.shape = SketchShape::box, table.collides = false;
  table.worldFromBody = {rotationAbout(Vec3(1, 2, 3), 0.4), Vec3(0.3, 1, -0.2)};
  table.drive.emplace().keys = {{0, table.worldFromBody},
                                {0.4, {rotationAbout(Vec3(1, 0, 3), 0.9), Vec3(0.5, 1.2, 0.1)}}};
  sled.shape = SketchShape::box, sled.size = Vec3(0.1, 0.2, 0.3), sled.collides = false;
  sled.worldFromBody = {rotationAbout(Vec3(3, -1, 1), 1.1), Vec3(0.3, 1.4, -0.2)};
  wheel.shape = SketchShape::cylinder, wheel.size = Vec3(0.2, 0.1, 0), wheel.collides = false, wheel.mass = 0.5;
  wheel.worldFromBody = {rotationAbout(Vec3(1, -1, 2), 2), Vec3(0.5, 1.4, -0.2)};
  hand.collides = false, hand.worldFromBody.translation = Vec3(-1, 0, 0);
  hand.drive.emplace(SketchDrive{{}, Vec3(0.1, 0.2, -0.1), 1.5, 0.7});
  bob.collides = false, bob.size = Vec3::Constant(0.1);
  bob.worldFromBody.translation = Vec3(-0.5, 0, 0);
  sketch.bodies = {table, sled, wheel, hand, bob};
  SketchLink slider, hinge, rod;
  slider.kind = SketchLinkKind::slider, slider.bodyA = 1, slider.bodyB = 0, slider.axis = Vec3(1, 2, -1).normalized();
  slider.anchorA = Vec3(0.05, 0.1, 0),
  slider.anchorB = anchorInBody(sketch, 0, anchorInWorld(sketch, 1, slider.anchorA));
  slider.limits = JointRange{-0.05, 0.02, 0.5}, slider.motor = JointDrive{0.3, 20};
  hinge.kind = SketchLinkKind::hinge, hinge.bodyA = 2, hinge.bodyB = 1, hinge.axis = Vec3(1, 1, 0).normalized();
  hinge.anchorB = anchorInBody(sketch, 1, anchorInWorld(sketch, 2, hinge.anchorA));
  hinge.motor = JointDrive{std::nullopt, 0.1};
  rod.kind = SketchLinkKind::rod, rod.bodyA = 4, rod.bodyB = 3;
  rod.length = (anchorInWorld(sketch, 4, rod.anchorA) - anchorInWorld(sketch, 3, rod.anchorB)).norm();
  sketch.links = {slider, hinge, rod};
  return sketch;
}

TEST(SceneTwin, OfLedBodiesIsTheSameMotion) {
  EXPECT_THAT(checkSketch(ledSketch(), [](const std::string&) {}), IsEmpty());
}

TEST(TouchingPlaces, LeaveTheGapAskedFor) {
  for (const double gap : {0.0, 1e-12, 1e-6}) {
    SceneSketch sketch;
    sketch.name = "Touching";
    sketch.materials.push_back({});
    SketchBody ball, box;
    ball.size = Vec3::Constant(0.1), box.size = Vec3(0.1, 0.2, 0.3), box.shape = SketchShape::box;
    box.worldFromBody = {rotationAbout(Vec3(1, 1, 0), 0.4), Vec3(0.03, 0, 0)};
    sketch.bodies = {levelFloor(), ball};
    ASSERT_TRUE(moveToTouch(sketch, -Vec3::UnitY(), gap));
    EXPECT_NEAR(sketch.bodies.back().worldFromBody.translation.y() - 0.1, gap, 1e-15);
    sketch.bodies.push_back(box);
    ASSERT_TRUE(moveToTouch(sketch, -Vec3::UnitY(), gap));
    const std::optional<NearestPlace> nearest = nearestPlace(sketch);
    ASSERT_TRUE(nearest);
    EXPECT_EQ(nearest->other, 1);
    EXPECT_NEAR(nearest->separation, gap, 1e-14);
    // On the ball: its middle lies along the normal.
    const Vec3 middle = sketch.bodies[1].worldFromBody.translation;
    EXPECT_LT((nearest->point + (0.1 + gap / 2) * nearest->normal - middle).norm(), 1e-12);
  }
}

TEST(RandomSketch, IsTheSameForTheSameNumber) {
  for (const SketchFamily family : {SketchFamily::touch, SketchFamily::threshold}) {
    EXPECT_EQ(textOf(randomSketch(family, 7)), textOf(randomSketch(family, 7)));
    EXPECT_NE(textOf(randomSketch(family, 7)), textOf(randomSketch(family, 8)));
  }
}

// One ball on a floor that gives back all, one far above: T = 2 v / g for a bounce, which is at the same place then.
TEST(SqueezedBalls, BounceAsOneBallAloneDoes) {
  const SqueezedBalls balls{{1, 1}, {0.5, 100}, {0, 0}, 1, 9.81};
  const double fall = std::sqrt(2 * 0.5 / 9.81);
  const auto ways = waysOf(balls, 2 * fall);
  ASSERT_TRUE(ways);
  EXPECT_NEAR((*ways)[0], 0, 1e-12);
  EXPECT_NEAR((*ways)[1], -9.81 * 2 * fall * fall, 1e-12);
}

// A light ball thrown at the floor under a heavy one, e = 0.3: infinitely many impacts take all speed, and both rest.
TEST(SqueezedBalls, ComeToRestAfterInfinitelyManyImpacts) {
  const SqueezedBalls balls{{0.1, 10}, {0.01, 0.02}, {-1, -1}, 0.3, 9.81};
  for (const double time : {0.3, 0.6}) {
    const auto ways = waysOf(balls, time);
    ASSERT_TRUE(ways);
    EXPECT_NEAR((*ways)[0], -0.01, 1e-9);
    EXPECT_NEAR((*ways)[1], -0.03, 1e-9);
  }
}

// The lower one's bounces are over after (2 / 9.81) 0.1 / (1 - 0.1) s = 0.023 s; the upper one comes 1.3 s later.
TEST(SqueezedBalls, AreNotKnownWhereTheLowerOneRestsBeforeTheUpperOneComes) {
  EXPECT_FALSE(waysOf({{0.1, 10}, {0, 10}, {-1, -1}, 0.1, 9.81}, 0.5));
}

/// What a run shows if it is changed afterwards.
template <class Change>
std::vector<SketchFault> faultsOfChanged(const Change& change) {
  SceneSketch sketch = flyingSketch();
  SceneRun run = runSketch(sketch);
  EXPECT_THAT(faultsOfRun(sketch, run), IsEmpty());
  change(sketch, run);
  return faultsOfRun(sketch, run);
}

void expectFault(const std::vector<SketchFault>& faults, const std::string& oracle) {
  EXPECT_THAT(faults, Contains(Field(&SketchFault::oracle, oracle)));
}

TEST(SketchOracles, ShowWhatIsWrong) {
  expectFault(faultsOfChanged(
                  [](SceneSketch&, SceneRun& run) { run.frames.back().states[0].angularVelocity.x() = std::nan(""); }),
              "finite");
  expectFault(faultsOfChanged([](SceneSketch&, SceneRun& run) { run.frames.back().energy.kinetic *= 1.001; }), "gain");
  expectFault(faultsOfChanged([](SceneSketch&, SceneRun& run) { run.frames.back().energy.dissipated += 1e-3; }),
              "balance");
  expectFault(faultsOfChanged([](SceneSketch&, SceneRun& run) { run.frames[3].energy.dissipated += 1e-3; }), "ledger");
  expectFault(faultsOfChanged([](SceneSketch&, SceneRun& run) { run.frames.back().states[0].position.y() = 0.01; }),
              "penetration");
  expectFault(faultsOfChanged([](SceneSketch&, SceneRun& run) { run.frames.back().states[1].position.x() += 1e-6; }),
              "ties");
  expectFault(faultsOfChanged([](SceneSketch& sketch, SceneRun&) { sketch.images = {0, 1, 2}; }), "symmetry");
  expectFault(faultsOfChanged([](SceneSketch& sketch, SceneRun&) {
                sketch.displacements.push_back({1, Vec3(1, 0, 0)});
              }),
              "closed form");
  expectFault(faultsOfChanged([](SceneSketch&, SceneRun& run) { run.cpuSeconds = 3; }), "cpu");
  for (const auto& [change, oracle] :
       {std::pair{+[](JointState& joint) { joint.coordinate = 0.021; }, "stops"},
        std::pair{+[](JointState& joint) { joint.force = 21; }, "motors"},
        std::pair{+[](JointState& joint) { joint.velocity = 0.2, joint.force = 10; }, "motors"}}) {
    const SceneSketch sketch = ledSketch();
    SceneRun run = runSketch(sketch);
    change(run.frames.back().joints[1]);
    expectFault(faultsOfRun(sketch, run), oracle);
  }
  expectFault(faultsOfChanged([](SceneSketch& sketch, SceneRun& run) {
                sketch.links.clear(), sketch.materials[0].staticFriction = 0;
                run.frames.back().energy.momentum.x() += 1e-3;
              }),
              "momentum");
}

}  // namespace
}  // namespace cradle
