#include "simulate/island_group.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>

#include "core/error.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kGroupAccuracy = 1e-8;

/// A scene whose first island is a group.
struct Grouped {
  explicit Grouped(const std::string& members, double duration = 1, int threadCount = 1)
      : scene(sceneWith(fmt::format(R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 100}},
    "materials": {{"elastic": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}},
                   "ivory": {{"restitution": 0.95, "staticFriction": 0.2, "dynamicFriction": 0.2}},
                   "rubber": {{"restitution": 0.6, "staticFriction": 0.5, "dynamicFriction": 0.4}}}}, {})",
                                    duration, kGroupAccuracy, members))),
        plan(planOf(scene)),
        threads(threadCount),
        group(scene, plan.islands.at(0), assemble(scene, plan.islands.at(0)), threads) {}

  VectorX stateAt(long frame) { return group.stateAt(frameTime(scene, frame)); }

  Scene scene;
  Plan plan;
  WorkerThreads threads;
  IslandGroup group;
};

std::string groundText(const std::string& material) {
  return fmt::format(R"({{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static", "material": "{}"}})",
                     material);
}

/// An elastic ball of 1 kg and 0.1 m that spins, on a level ground without friction.
std::string rollingBall(const std::string& name, double place, double velocity, double beside = 0) {
  return fmt::format(R"(, {{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "material": "elastic",
    "position": [{}, 0.1, {}], "linearVelocity": [{}, 0, 0], "angularVelocity": [0, 3, 0]}})",
                     name, place, beside, velocity);
}

/// Balls on that ground and one above it, which stays there: not all are few spheres in one plane.
std::string withBox(const std::string& balls) {
  return R"("bodies": [)" + groundText("elastic") + balls +
         R"(, {"name": "box", "shape": {"box": {"size": [0.2, 0.1, 0.3]}}, "mass": 2, "material": "rubber",
    "position": [0, 0.05, 9]}])";
}

/// A tumbling box at x, h above a rough ground.
std::string tumblingBox(const std::string& name, double x, double h) {
  return fmt::format(R"(, {{"name": "{}", "shape": {{"box": {{"size": [0.1, 0.2, 0.15]}}}}, "mass": 1,
    "material": "rubber", "position": [{}, {}, 0], "linearVelocity": [0.2, 0, 0.3], "angularVelocity": [3, 2, 7]}})",
                     name, x, h);
}

// Links between moving bodies make one cluster of them, those to the world none; a group has two clusters or more, and
// steps that follow the error.
TEST(IslandGroup, DividesWhatIsNotTied) {
  const auto mayDivide = [](const std::string& members) {
    const Scene scene = sceneWith(R"("duration": 1, )" + members);
    return IslandGroup::mayDivide(scene, planOf(scene).islands.at(0));
  };
  const std::string boxes = R"("accuracy": 1e-6, "bodies": [)" + groundText("rubber") + tumblingBox("a", 0, 0.5) +
                            tumblingBox("b", 0.3, 0.5) +
                            R"(], "materials": {"rubber": {"restitution": 0.6, "staticFriction": 0.5}})";
  EXPECT_TRUE(mayDivide(boxes));
  EXPECT_TRUE(mayDivide(boxes + R"(, "springs": [{"bodyA": "a", "anchorB": [0, 1, 0], "stiffness": 10}])"));
  EXPECT_FALSE(mayDivide(boxes + R"(, "springs": [{"bodyA": "a", "bodyB": "b", "stiffness": 10}])"));
  EXPECT_FALSE(mayDivide(boxes + R"(, "ropes": [{"bodyA": "a", "bodyB": "b", "maxLength": 3}])"));
  EXPECT_TRUE(mayDivide(boxes + R"(, "pushes": [{"body": "a", "point": [0, 0, 0], "force": [1, 0, 0],
      "start": 0.1, "duration": 0.1}])"));
  EXPECT_FALSE(mayDivide(boxes + R"(, "method": {"name": "rk4", "timeStep": 0.001})"));
}

// Bodies far away change no bit: three boxes that fall, bounce and roll apart from each other move as each of them
// alone.
TEST(IslandGroup, BodiesApartMoveAsIfAlone) {
  const double heights[] = {0.5, 0.53, 0.61};
  std::string all = R"("bodies": [)" + groundText("rubber");
  for (int i = 0; i < 3; ++i) all += tumblingBox(fmt::format("box{}", i), 5 * i, heights[i]);
  Grouped together(all + "]");
  EXPECT_EQ(together.group.islandCount(), 3u);
  std::vector<VectorX> states;
  for (long frame = 0; frame <= 100; ++frame) states.push_back(together.stateAt(frame));
  std::vector<Event> alone;
  for (int i = 0; i < 3; ++i) {
    const Scene scene =
        sceneWith(fmt::format(R"("duration": 1, "accuracy": {}, "materials": {{"rubber":
        {{"restitution": 0.6, "staticFriction": 0.5, "dynamicFriction": 0.4}}}}, "bodies": [{}{}])",
                              kGroupAccuracy, groundText("rubber"), tumblingBox("box", 5 * i, heights[i])));
    const IslandPlan island = planOf(scene).islands.at(0);
    IslandSolver solver(scene, assemble(scene, island), island.method);
    for (long frame = 0; frame <= 100; ++frame) {
      const VectorX single = solver.stateAt(frameTime(together.scene, frame)),
                    group = states[static_cast<std::size_t>(frame)];
      EXPECT_EQ(group.segment<kPoseSize>(i * kPoseSize), single.head<kPoseSize>()) << i << " at frame " << frame;
      EXPECT_EQ(group.segment<kVelocitySize>(velocityOffset(group, i)),
                single.segment<kVelocitySize>(velocityOffset(single, 0)));
    }
    const std::vector<Event> events = solver.takeEvents();
    alone.insert(alone.end(), events.begin(), events.end());
  }
  EXPECT_EQ(together.group.takeEvents().size(), alone.size());
  EXPECT_EQ(together.group.islandCount(), 3u);
}

// Two boxes that begin side by side and tumble away from each other are one island until they are apart; from then on
// each has a clock of its own, and moves as if alone, to the accuracy (times 100, what bounces amplify). A table far
// above, which is of no island, comes to rest meanwhile.
TEST(IslandGroup, PartsWhatStaysApart) {
  const auto box = [](const std::string& name, double side) {
    return fmt::format(R"(, {{"name": "{}", "shape": {{"box": {{"size": [0.1, 0.2, 0.15]}}}}, "mass": 1,
    "material": "rubber", "position": [{}, 0.3, 0], "linearVelocity": [{}, 0, 0.1], "angularVelocity": [1, 2, {}]}})",
                       name, 0.14 * side, 1.5 * side, 3 * side);
  };
  Grouped at(R"("bodies": [)" + groundText("rubber") + box("left", -1) + box("right", 1.1) + R"(,
      {"name": "table", "shape": {"box": {"size": [1, 0.1, 1]}}, "material": "rubber", "motion": "driven",
       "position": [0, 3, 0], "keyFrames": [{"time": 0}, {"time": 0.9, "position": [0.1, 3, 0]}]}])");
  EXPECT_EQ(at.group.islandCount(), 1u);
  std::vector<VectorX> states;
  for (long frame = 0; frame <= 100; ++frame) states.push_back(at.stateAt(frame));
  EXPECT_EQ(at.group.islandCount(), 2u);
  for (const double side : {-1.0, 1.1}) {
    const Scene scene = sceneWith(fmt::format(R"("duration": 1, "accuracy": {}, "materials": {{"rubber":
        {{"restitution": 0.6, "staticFriction": 0.5, "dynamicFriction": 0.4}}}}, "bodies": [{}{}])",
                                              kGroupAccuracy, groundText("rubber"), box("box", side)));
    const IslandPlan island = planOf(scene).islands.at(0);
    IslandSolver solver(scene, assemble(scene, island), island.method);
    for (long frame = 0; frame <= 100; ++frame) {
      const VectorX single = solver.stateAt(frameTime(at.scene, frame)),
                    group = states[static_cast<std::size_t>(frame)];
      const Eigen::Index body = side < 0 ? 0 : 1;
      EXPECT_LT((group.segment<kPoseSize>(body * kPoseSize) - single.head<kPoseSize>()).norm(), 100 * kGroupAccuracy)
          << side << " at frame " << frame;
    }
  }
}

// A break of balls, with its mirror image on the other side of z = 0, as one island's clock sees it: at one instant.
// Apart, each side finds the instants of its events for itself, and rounding between them grows tenfold at each
// impact, until a ball of the middle is struck by one side before the other one.
TEST(IslandGroup, MirrorImagesStayOne) {
  std::string balls;
  const double radius = 0.03, across = radius * std::sqrt(3.0);
  const auto add = [&](double x, double z, double velocity) {
    balls += fmt::format(R"(, {{"name": "ball{}", "shape": {{"sphere": {{"radius": {}}}}}, "mass": 0.2,
    "material": "ivory", "position": [{}, {}, {}], "linearVelocity": [{}, 0, 0]}})",
                         balls.size(), radius, x, radius, z, velocity);
  };
  add(-0.5, 0, 6);
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i <= row; ++i) add(row * across, (2 * i - row) * radius, 0);
  add(0.9, 0, 0);
  const auto wall = [](const std::string& name, double x, double z, double length, double width) {
    return fmt::format(R"(, {{"name": "{}", "shape": {{"box": {{"size": [{}, 0.2, {}]}}}}, "motion": "static",
    "material": "ivory", "position": [{}, 0, {}]}})",
                       name, length, width, x, z);
  };
  Grouped at(R"("bodies": [)" + groundText("ivory") + balls + wall("a", 0.2, 0.5, 2, 0.1) +
                 wall("b", 0.2, -0.5, 2, 0.1) + wall("c", 1.2, 0, 0.1, 1) + wall("d", -0.8, 0, 0.1, 1) + "]",
             2);
  const auto places = [&](const VectorX& state, double side) {
    std::vector<std::array<double, 3>> all;
    for (Eigen::Index i = 0; i < bodyCount(state); ++i) {
      const Vec3 place = centerOfMass(state, i);
      all.push_back({std::round(1e6 * place.x()), std::round(1e6 * side * place.z() + 0.5), place.y()});
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  std::size_t most = 0;
  for (long frame = 0; frame <= 200; frame += 10) {
    const VectorX state = at.stateAt(frame);
    most = std::max(most, at.group.islandCount());
    const auto here = places(state, 1), there = places(state, -1);
    for (std::size_t i = 0; i < here.size(); ++i) {
      EXPECT_NEAR(here[i][0], there[i][0], 1) << "frame " << frame;
      EXPECT_NEAR(here[i][1], there[i][1], 1) << "frame " << frame;
    }
  }
  EXPECT_GT(most, 2u);
}

// A push that is under way where an island becomes another one goes on, at the point where its ray has struck, and ends
// once: 1 N for 0.4 s on 1 kg, across the way of a ball that passes by so near that both are one island meanwhile.
TEST(IslandGroup, PushesGoOn) {
  for (const char* target :
       {R"("ray": {"origin": [0, 0.1, -5], "direction": [0, 0, 1]})", R"("point": [0, 0, -0.1])"}) {
    Grouped at(
        withBox(rollingBall("a", 0, 0) + rollingBall("b", -0.5, 2, -0.206)) +
        fmt::format(R"(, "pushes": [{{"body": "a", {}, "force": [0, 0, 1], "start": 0.1, "duration": 0.4}}])", target));
    std::size_t fewest = 3;
    for (long frame = 0; frame <= 100; ++frame) {
      const VectorX state = at.stateAt(frame);
      fewest = std::min(fewest, at.group.islandCount());
      EXPECT_NEAR(linearVelocity(state, 0).z(), std::clamp(frameTime(at.scene, frame) - 0.1, 0.0, 0.4), 1e-9) << frame;
    }
    EXPECT_EQ(fewest, 2u);
    std::vector<EventKind> kinds;
    for (const Event& event : at.group.takeEvents())
      if (event.kind == EventKind::pushStart || event.kind == EventKind::pushEnd) kinds.push_back(event.kind);
    EXPECT_THAT(kinds, ElementsAre(EventKind::pushStart, EventKind::pushEnd)) << target;
  }
}

// Threads change no bit.
TEST(IslandGroup, IsTheSameForAnyNumberOfThreads) {
  std::string boxes = R"("bodies": [)" + groundText("rubber");
  for (int i = 0; i < 40; ++i) boxes += tumblingBox(fmt::format("box{}", i), 0.4 * i, 0.4 + 0.013 * i);
  const auto statesWith = [&](int threads) {
    Grouped at(boxes + "]", 1, threads);
    std::vector<double> states;
    for (long frame = 0; frame <= 100; frame += 5) {
      const VectorX state = at.stateAt(frame);
      states.insert(states.end(), state.begin(), state.end());
    }
    for (const Event& event : at.group.takeEvents()) states.push_back(event.time);
    return states;
  };
  const std::vector<double> one = statesWith(1);
  EXPECT_EQ(statesWith(2), one);
  EXPECT_EQ(statesWith(3), one);
}

// A ball at v strikes one at rest and passes its velocity on, and that one the next; whatever a window is, and however
// many places a ball goes through in one. The ground is frictionless. Each hit is one event.
TEST(IslandGroup, BallsMeetInEveryWindow) {
  for (const double velocity : {0.3, 2.0, 40.0, 700.0}) {
    const double gap = 0.4 * velocity, duration = 1;
    Grouped at(
        withBox(rollingBall("a", 0, velocity) + rollingBall("b", gap + 0.2, 0) + rollingBall("c", 1.5 * gap + 0.4, 0)),
        duration);
    for (long frame = 0; frame <= 100; ++frame) {
      const double t = frameTime(at.scene, frame);
      const VectorX state = at.stateAt(frame);
      const double places[] = {velocity * std::min(t, 0.4), gap + 0.2 + velocity * std::clamp(t - 0.4, 0.0, 0.2),
                               1.5 * gap + 0.4 + velocity * std::max(t - 0.6, 0.0)};
      for (int ball = 0; ball < 3; ++ball) {
        EXPECT_NEAR(centerOfMass(state, ball).x(), places[ball], 1e-9 * velocity + 1e-12) << velocity << " at " << t;
        EXPECT_NEAR(std::abs(orientation(state, ball).dot(Quat(Eigen::AngleAxisd(3 * t, Vec3::UnitY())))), 1, 1e-12);
      }
    }
    std::vector<double> times;
    for (const Event& event : at.group.takeEvents())
      if (event.kind == EventKind::impact) times.push_back(event.time);
    EXPECT_THAT(times, ElementsAre(testing::DoubleNear(0.4, 1e-12), testing::DoubleNear(0.6, 1e-12))) << velocity;
  }
}

// A ball flies to a wall and back to one behind its start within one window, which is as long as slower bodies ask for:
// nothing foretells that they meet, and the window is gone through again.
TEST(IslandGroup, WhatNothingForetellsIsGoneThroughAgain) {
  std::string slow;
  for (int i = 0; i < 7; ++i) slow += rollingBall(fmt::format("slow{}", i), 40 + i, 0.5, 20);
  Grouped at(withBox(rollingBall("fast", 0, 700) + rollingBall("behind", -20, 0) + slow +
                     R"(, {"name": "wall", "shape": {"box": {"size": [1, 9, 9]}}, "motion": "static",
                         "material": "elastic", "position": [5.6, 0, 0]})"));
  EXPECT_EQ(at.group.islandCount(), 10u);
  const double met = (5 + 5 + 19.8) / 700;
  for (long frame = 0; frame <= 100; ++frame) {
    const double t = frameTime(at.scene, frame);
    const VectorX state = at.stateAt(frame);
    EXPECT_NEAR(centerOfMass(state, 1).x(), -20 - 700 * std::max(t - met, 0.0), 1e-6) << t;
  }
}

// Two balls strike one between them at one instant, and come back with their velocities: three islands meet at once.
TEST(IslandGroup, ThreeMeetAtOnce) {
  for (const double velocity : {1.0, 30.0}) {
    const double way = 0.5 * velocity;
    Grouped at(withBox(rollingBall("left", -0.2 - way, velocity) + rollingBall("middle", 0, 0) +
                       rollingBall("right", 0.2 + way, -velocity)));
    const VectorX state = at.stateAt(100);
    EXPECT_NEAR(centerOfMass(state, 0).x(), -0.2 - way, 1e-9 * velocity);
    EXPECT_NEAR(centerOfMass(state, 1).x(), 0, 1e-12);
    EXPECT_NEAR(centerOfMass(state, 2).x(), 0.2 + way, 1e-9 * velocity);
  }
}

// Islands that met move as one island from the start does, to the accuracy: boxes that fall on each other, with
// friction. They part again when they are far from each other.
TEST(IslandGroup, MetIslandsMoveAsOne) {
  const std::string bodies = R"("bodies": [)" + groundText("rubber") + tumblingBox("low", 0, 0.3) +
                             R"(, {"name": "high", "shape": {"box": {"size": [0.1, 0.1, 0.12]}}, "mass": 2,
      "material": "rubber", "position": [0.02, 9, 0.03], "linearVelocity": [0, -25, 0], "angularVelocity": [1, 0, 2]}])";
  Grouped at(bodies, 0.5);
  EXPECT_EQ(at.group.islandCount(), 2u);
  IslandSolver one(at.scene, assemble(at.scene, at.plan.islands[0]), at.plan.islands[0].method);
  std::size_t fewest = 2;
  for (long frame = 0; frame <= 50; ++frame) {
    const VectorX group = at.stateAt(frame), single = one.stateAt(frameTime(at.scene, frame));
    EXPECT_LT((group - single).head(poseComponents(group)).cwiseAbs().maxCoeff(), 1e-6) << frame;
    fewest = std::min(fewest, at.group.islandCount());
  }
  EXPECT_EQ(fewest, 1u);
}

// Energy that was taken stays in the ledger when islands merge and part, and there is no energy from nowhere.
TEST(IslandGroup, KeepsItsLedger) {
  Grouped at(R"("bodies": [)" + groundText("rubber") + tumblingBox("a", 0, 0.4) + tumblingBox("b", 0.05, 1) +
                 tumblingBox("c", 3, 0.5) + "]",
             0.8);
  double impact = 0, friction = 0;
  const double constant = energyConstant(at.group.assembly().mechanism, at.stateAt(0));
  for (long frame = 0; frame <= 80; ++frame) {
    VectorX state = at.stateAt(frame);
    EXPECT_GE(impactEnergy(state), impact - 1e-9) << frame;
    EXPECT_GE(frictionEnergy(state), friction - 1e-9) << frame;
    EXPECT_NEAR(energyConstant(at.group.assembly().mechanism, state), constant, 1e-9);
    EXPECT_NEAR(numericalEnergy(state), 0, 10 * kGroupAccuracy) << frame;
    impact = impactEnergy(state), friction = frictionEnergy(state);
  }
  EXPECT_GT(impact, 1);
  at.group.finish();
  EXPECT_FALSE(at.group.promiseEnd());
}

// A rotor turns several times, and its stop is 30 rad away: a ball that strikes it changes its rate, but not what was
// counted.
TEST(IslandGroup, JointsCountTheirTurnsOn) {
  Grouped at(R"("gravity": [0, 0, 0], "bodies": [
      {"name": "rotor", "shape": {"box": {"size": [1, 0.1, 0.1]}}, "mass": 3, "material": "elastic",
       "angularVelocity": [0, 0, 20]},
      {"name": "ball", "shape": {"sphere": {"radius": 0.05}}, "mass": 1, "material": "elastic", "position": [0.3, 6, 0],
       "linearVelocity": [0, -6, 0]}], "hinges": [{"name": "axle", "bodyA": "rotor", "anchorB": [0, 0, 0],
       "axis": [0, 0, 1], "limits": {"upper": 30}}])",
             3);
  EXPECT_EQ(at.group.islandCount(), 2u);
  double last = 0, most = 0;
  std::size_t fewest = 2;
  for (long frame = 0; frame <= 300; ++frame) {
    at.stateAt(frame);
    const JointState joint = at.group.jointStates()[0];
    EXPECT_LT(std::abs(joint.coordinate - last), 0.5) << frame;
    last = joint.coordinate, most = std::max(most, last);
    fewest = std::min(fewest, at.group.islandCount());
  }
  EXPECT_EQ(fewest, 1u);
  EXPECT_GT(most, 4 * std::numbers::pi);
  EXPECT_LE(most, 30 + 1e-9);
}

// A ball that a spring holds at its centre turns by w t, whatever its other end, a box, meets.
TEST(IslandGroup, HeldBallsTurnOn) {
  Grouped at(R"("bodies": [)" + groundText("rubber") + tumblingBox("a", 0, 0.4) + tumblingBox("b", 0.05, 2) +
                 R"(, {"name": "held", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "collision": "none",
      "position": [0.5, 0.5, 0], "angularVelocity": [1, 2, 2]}],
      "springs": [{"bodyA": "held", "anchorA": [0, 0, 0], "bodyB": "a", "stiffness": 20}])",
             0.8);
  ASSERT_THAT(at.plan.islands[0].nonRotating, SizeIs(1));
  std::size_t fewest = 2;
  for (long frame = 0; frame <= 80; ++frame) {
    const VectorX state = at.stateAt(frame);
    const Quat turned(Eigen::AngleAxisd(3 * frameTime(at.scene, frame), Vec3(1, 2, 2) / 3));
    EXPECT_NEAR(std::abs(orientation(state, 2).dot(turned)), 1, 1e-12) << frame;
    fewest = std::min(fewest, at.group.islandCount());
  }
  EXPECT_EQ(fewest, 1u);
}

// A box at rest stays so, and a rope taut, with no further event, until a ball that comes near strikes them: then the
// box wakes once.
TEST(IslandGroup, RestAndTautRopesStayWithTheirBodies) {
  Grouped at(R"("bodies": [)" + groundText("rubber") + R"(,
      {"name": "box", "shape": {"box": {"size": [0.3, 0.2, 0.3]}}, "mass": 2, "material": "rubber",
       "position": [0, 0.1, 0]},
      {"name": "bob", "shape": {"sphere": {"radius": 0.05}}, "mass": 1, "material": "rubber", "position": [0.1, 0.9, 0]},
      {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "rubber", "position": [-3, 0.1, 0],
       "linearVelocity": [4, 0, 0], "angularVelocity": [0, 0, -40]}],
      "ropes": [{"name": "rope", "bodyA": "bob", "anchorB": [0.1, 1.9, 0], "maxLength": 1}])",
             1.2);
  std::map<EventKind, int> before, all;
  for (long frame = 0; frame <= 120; ++frame) {
    const VectorX state = at.stateAt(frame);
    if (frame < 65) {
      EXPECT_TRUE(state.segment<kVelocitySize>(velocityOffset(state, 0)).isZero(0)) << frame;
    }
    for (const Event& event : at.group.takeEvents()) {
      if (event.time < 0.687) ++before[event.kind];
      ++all[event.kind];
    }
  }
  EXPECT_EQ(before[EventKind::rest], 2);
  EXPECT_EQ(before[EventKind::taut], 1);
  EXPECT_EQ(all[EventKind::taut], 1);
  EXPECT_EQ(all[EventKind::wake], 1);
}

// Wherever frames are, islands meet and part in the same windows: the bits of common frames are the same.
TEST(IslandGroup, MovesAlikeForAllFrames) {
  const std::string bodies = R"("bodies": [)" + groundText("rubber") + tumblingBox("a", 0, 0.4) +
                             tumblingBox("b", 0.05, 1) + tumblingBox("c", 3, 0.5) + "]";
  const auto endOf = [&](int framesPerSecond) {
    const Scene scene = sceneWith(fmt::format(R"("duration": 1, "accuracy": 1e-6, "output": {{"framesPerSecond": {}}},
        "materials": {{"rubber": {{"restitution": 0.6, "staticFriction": 0.5, "dynamicFriction": 0.4}}}}, {})",
                                              framesPerSecond, bodies));
    const IslandPlan island = planOf(scene).islands.at(0);
    WorkerThreads threads(1);
    IslandGroup group(scene, island, assemble(scene, island), threads);
    return VectorX(group.stateAt(1));
  };
  EXPECT_EQ(endOf(7), endOf(200));
}

// Steps go beyond a window; what they come to there may never happen. A press comes down on a ball at 2.17 s with no
// room for it, but a heavy ball knocks it away at 1 s: as one island, tied by a spring of no force.
TEST(IslandGroup, IsNotEndedByWhatOthersPrevent) {
  const std::string bodies = R"("bodies": [)" + groundText("rubber") + R"(,
      {"name": "press", "shape": {"box": {"size": [0.5, 0.2, 0.5]}}, "material": "rubber", "motion": "driven",
       "position": [0, 2, 0], "keyFrames": [{"time": 0}, {"time": 2.62, "position": [0, 0.69, 0]}]},
      {"name": "ball", "shape": {"sphere": {"radius": 0.3}}, "mass": 1, "material": "rubber", "position": [0, 0.3, 0]},
      {"name": "knock", "shape": {"sphere": {"radius": 0.3}}, "mass": 3000, "material": "rubber",
       "position": [-3.6, 0.3, 0], "linearVelocity": [3, 0, 0], "angularVelocity": [0, 0, -10]}])";
  Grouped apart(bodies, 4),
      tied(bodies + R"(, "springs": [{"bodyA": "knock", "bodyB": "ball", "stiffness": 1e-12}])", 4);
  EXPECT_EQ(apart.group.islandCount(), 2u);
  for (long frame = 0; frame <= 400; ++frame) {
    const VectorX state = apart.stateAt(frame), one = tied.stateAt(frame);
    for (Eigen::Index body = 0; body < 3; ++body)
      EXPECT_LT((centerOfMass(state, body) - centerOfMass(one, body)).norm(), 100 * kGroupAccuracy) << frame;
  }
  EXPECT_FALSE(apart.group.promiseEnd());
}

// The fault that comes first is told, whichever island's it is, after the frames before it.
TEST(IslandGroup, TellsTheFirstFaultAfterTheFramesBefore) {
  const auto pressed = [](const std::string& name, double x, double speed) {
    return fmt::format(R"(, {{"name": "plate of {}", "shape": {{"box": {{"size": [1, 0.1, 1]}}}}, "motion": "driven",
       "position": [{}, 1, 0], "linearVelocity": [0, {}, 0], "material": "rubber"}},
      {{"name": "{}", "shape": {{"box": {{"size": [0.3, 0.2, 0.3]}}}}, "mass": 2, "material": "rubber",
       "position": [{}, 0.1, 0]}})",
                       name, x, -speed, name, x);
  };
  // The plate's lower side is at 0.95 m, the box's upper one at 0.2: it is pressed after 0.75 m.
  Grouped at(R"("bodies": [)" + groundText("rubber") + pressed("slow", 0, 2.25) + pressed("fast", 5, 2.5) + "]");
  long frame = 0;
  try {
    for (; frame <= 100; ++frame) at.stateAt(frame);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("unstable at 0.3 s: \"fast\" is pressed"));
  }
  EXPECT_GE(frame, 15);  // up to the last step of one of the islands
}

// What is driven stops for all islands at once, and is told to rest once; a box that rests does so until it is struck,
// however small what flies by, and once.
TEST(IslandGroup, TellsRestOnce) {
  Grouped at(R"("bodies": [)" + groundText("rubber") + R"(,
      {"name": "table", "shape": {"box": {"size": [20, 0.2, 2]}}, "material": "rubber", "motion": "driven",
       "position": [0, 2, 9], "keyFrames": [{"time": 0}, {"time": 0.5, "position": [0.1, 2, 9]}]},
      {"name": "box", "shape": {"box": {"size": [1, 1, 1]}}, "mass": 2, "material": "rubber",
       "position": [0, 0.5, 0]},
      {"name": "left", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "mass": 2, "material": "rubber",
       "position": [-6, 2.2, 9]},
      {"name": "right", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "mass": 2, "material": "rubber",
       "position": [6, 2.2, 9]},
      {"name": "fly", "shape": {"sphere": {"radius": 0.01}}, "mass": 0.01, "material": "rubber",
       "position": [-6, 3, 0.56], "linearVelocity": [6, 2.7, 0]}])",
             1.5);
  std::map<int, int> rests;
  std::map<int, EventKind> last;
  for (long frame = 0; frame <= 150; ++frame) {
    at.stateAt(frame);
    for (const Event& event : at.group.takeEvents()) {
      EXPECT_FALSE(event.kind == EventKind::impact && event.bodyA != 5 && event.bodyB != 5) << event.time;
      if (event.kind != EventKind::rest && event.kind != EventKind::wake) continue;
      EXPECT_TRUE(!last.contains(event.bodyA) || last[event.bodyA] != event.kind) << event.bodyA << " " << event.time;
      last[event.bodyA] = event.kind;
      if (event.kind == EventKind::rest) ++rests[event.bodyA];
    }
  }
  for (const auto& [body, kind] : last) EXPECT_EQ(kind, EventKind::rest) << body;
  EXPECT_EQ(rests[1], 1);  // the table
  EXPECT_EQ(rests[2], 1);  // the box
}

// An error names its bodies and time as that of a single island.
TEST(IslandGroup, RaisesTheErrorsOfItsIslands) {
  Grouped at(R"("bodies": [)" + groundText("rubber") + tumblingBox("far", 9, 0.4) + R"(,
      {"name": "plate", "shape": {"box": {"size": [1, 0.1, 1]}}, "motion": "driven", "position": [0, 1, 0],
       "linearVelocity": [0, -5, 0], "material": "rubber"},
      {"name": "box", "shape": {"box": {"size": [0.3, 0.2, 0.3]}}, "mass": 2, "material": "rubber",
       "position": [0, 0.1, 0]}])");
  try {
    for (long frame = 0; frame <= 100; ++frame) at.stateAt(frame);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    EXPECT_THAT(error.what(), HasSubstr("\"box\" is pressed into"));
  }
}

}  // namespace
}  // namespace cradle
