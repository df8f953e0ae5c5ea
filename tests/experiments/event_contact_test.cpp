// Contact as events, on the default method: closed forms of references.json, invariances, energy in heaps of shapes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "experiments/experiment.h"

namespace cradle {
namespace {

std::string sceneText(double accuracy, double duration, double framesPerSecond, const std::string& material,
                      const std::string& bodies, const std::string& more = "") {
  return fmt::format(R"({{"schema": "cradle-scene/1", "name": "Events", "accuracy": {}, "duration": {},
    "output": {{"framesPerSecond": {}}}, "materials": {{"m": {}}}, "bodies": [{}]{}}})",
                     accuracy, duration, framesPerSecond, material, bodies, more);
}

std::string materialText(double restitution, double friction) {
  return fmt::format(R"({{"restitution": {0}, "staticFriction": {1}, "dynamicFriction": {1}}})", restitution, friction);
}

const std::string kFloor =
    R"({"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static", "material": "m"})";
const std::string kSlab =
    R"({"name": "floor", "shape": {"box": {"size": [20, 1, 20]}}, "motion": "static", "position": [0, -0.5, 0],
        "material": "m"})";

const std::string kTable =
    R"({"name": "table", "shape": {"box": {"size": [1, 0.2, 1]}}, "motion": "static", "position": [0, -0.1, 0],
        "material": "m"})";

std::vector<double> timesOf(const Trajectory& run, EventKind kind) {
  std::vector<double> times;
  for (const Event& event : run.events)
    if (event.kind == kind) times.push_back(event.time);
  return times;
}

double energyDrift(const Trajectory& run) {
  double drift = 0;
  for (const Frame& frame : run.frames)
    drift = std::max(drift, std::abs(energyConstantOf(frame) - energyConstantOf(run.frames[0])));
  return drift;
}

Trajectory bounce(double restitution, double accuracy, const std::string& floor) {
  const std::string ball =
      R"(, {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0, 1.1, 0], "material": "m"})";
  return simulate(sceneOf(sceneText(accuracy, 6, 10, materialText(restitution, 0), floor + ball)));
}

/// Height (m) over the floor of a ball dropped from 1 m.
double bounceHeight(double restitution, double time) {
  double speed = std::sqrt(2 * kGravity), start = std::sqrt(2 / kGravity);
  if (time < start) return 1 - kGravity * time * time / 2;
  while (true) {
    speed *= restitution;
    const double flight = 2 * speed / kGravity, since = time - start;
    if (flight < 1e-12) return 0;
    if (since < flight) return speed * since - kGravity * since * since / 2;
    start += flight;
  }
}

// DOP853 is exact on parabolas: what is left is rounding, which each bounce doubles at most.
TEST(EventContact, BallsBounceOnTheClosedFormAtAnyAccuracy) {
  for (const std::string& floor : {kFloor, kSlab})
    for (const double accuracy : {1e-2, 1e-4, 1e-10})
      for (const double restitution : {1.0, 0.8}) {
        const Trajectory run = bounce(restitution, accuracy, floor);
        for (const Frame& frame : run.frames)
          EXPECT_NEAR(frame.states[0].position.y() - 0.1, bounceHeight(restitution, frame.time), 1e-10)
              << restitution << " " << frame.time;
      }
}

// Bounces that end within a second, more than sixty of them in its last quarter: a ball is followed through all of
// them, at a coarse accuracy too, and rests when they are over: h / 1 mm high, after sqrt(2 h / g) (1 + e) / (1 - e).
// What bounces are left out takes, and the accuracy, are parts of that.
TEST(EventContact, BallThatChattersAtACoarseAccuracyIsFollowedToItsRest) {
  const std::string ball =
      R"(, {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0, 0.101, 0], "material": "m"})";
  for (const double accuracy : {1e-3, 1e-4}) {
    std::vector<std::string> warnings;
    std::vector<double> rests;
    const SimulationSink sink{[](const Frame&) {},
                              [&](const Event& event) {
                                if (event.kind == EventKind::rest) rests.push_back(event.time);
                              },
                              [&](const std::string& warning) { warnings.push_back(warning); }};
    simulate(sceneOf(sceneText(accuracy, 2, 10, materialText(0.97, 0), kFloor + ball)), sink);
    EXPECT_TRUE(warnings.empty()) << accuracy;
    ASSERT_EQ(rests.size(), 1u) << accuracy;
    EXPECT_NEAR(rests[0], std::sqrt(2e-3 / kGravity) * 1.97 / 0.03, accuracy) << accuracy;
  }
}

// When one ball lands, the other hovers by half of what counts as touching: it falls on, and lands by itself. No more
// than the dead band of 1e-12 of the radius is closed by hand, by the weight times that.
TEST(EventContact, GapThatIsKnownIsClosedByFallingAlone) {
  std::string balls;
  for (const char* place : {"[0, 1.01, 0]", "[5, 1.010000005, 0]"})
    balls += fmt::format(R"(, {{"name": "ball{0}", "shape": {{"sphere": {{"radius": 1}}}}, "mass": 1, "material": "m",
        "position": {1}, "linearVelocity": [1, 0, 0]}})",
                         place[1], place);
  const Trajectory run = simulate(sceneOf(sceneText(1e-4, 0.1, 10, materialText(0, 0.5), kFloor + balls)));
  EXPECT_LT(std::abs(run.frames.back().energy.numerical), 2e-12 * kGravity);
  for (const Frame& frame : run.frames) EXPECT_NEAR(ledgerConstantOf(frame), ledgerConstantOf(run.frames[0]), 1e-13);
}

// The bounces left out take no time to 1e-7 sqrt(size / g), and their sum is added to the event's time.
TEST(EventContact, BouncesAccumulateToRestAtTheZenoTime) {
  const Trajectory run = bounce(0.8, 1e-6, kFloor);
  const std::vector<double> rests = timesOf(run, EventKind::rest);
  ASSERT_EQ(rests.size(), 1u);
  EXPECT_NEAR(rests[0], std::sqrt(2 / kGravity) * 1.8 / 0.2, 1e-8);
  EXPECT_EQ(run.frames.back().states[0].linearVelocity, Vec3::Zero());
  EXPECT_NEAR(run.frames.back().energy.dissipated, kGravity, 1e-10);
}

TEST(EventContact, RestitutionZeroDoesNotBounce) {
  const Trajectory run = bounce(0, 1e-6, kFloor);
  EXPECT_EQ(timesOf(run, EventKind::impact).size(), 1u);
  EXPECT_EQ(timesOf(run, EventKind::rest).size(), 1u);
}

// Flat on its face, by events and by steps: nothing rises once it is down, and all that it fell is gone.
TEST(RestitutionZero, LetsNoShapeBounce) {
  for (const char* shape :
       {R"({"sphere": {"radius": 0.1}})", R"({"box": {"size": [0.3, 0.2, 0.4]}})",
        R"({"cylinder": {"radius": 0.3, "length": 0.2}})", R"({"capsule": {"radius": 0.05, "length": 0.1}})"})
    for (const double accuracy : {1e-3, 1e-6})
      for (const double friction : {0.0, 0.5}) {
        const std::string body = fmt::format(
            R"(, {{"name": "body", "shape": {}, "mass": 1, "position": [0, 1.1, 0], "material": "m"}})", shape);
        const Trajectory run = simulate(sceneOf(sceneText(accuracy, 1, 100, materialText(0, friction), kSlab + body)));
        for (const Frame& frame : run.frames) EXPECT_LT(frame.states[0].linearVelocity.y(), 1e-9) << shape << accuracy;
        EXPECT_EQ(endOf(run).linearVelocity, Vec3::Zero()) << shape << accuracy;
        EXPECT_NEAR(endOf(run).position.y(), 0.1, 1e-6) << shape << accuracy;
      }
}

Trajectory cradleRun(int balls, int lifted, double accuracy) {
  const double radius = 0.05, length = 0.5, lift = std::numbers::pi / 4;
  std::string bodies, rods;
  for (int i = 0; i < balls; ++i) {
    const double angle = i < lifted ? lift : 0;
    bodies += fmt::format(R"({}{{"name": "b{}", "shape": {{"sphere": {{"radius": 0.05}}}}, "mass": 0.2, "material": "m",
                               "position": [{}, {}, 0]}})",
                          i ? ", " : "", i, 2 * radius * i - length * std::sin(angle), -length * std::cos(angle));
    rods += fmt::format(R"({}{{"bodyA": "b{}", "anchorA": [0, 0, 0], "anchorB": [{}, 0, 0]}})", i ? ", " : "", i,
                        2 * radius * i);
  }
  return simulate(
      sceneOf(sceneText(accuracy, 2, 50, materialText(1, 0), bodies, fmt::format(R"(, "rods": [{}])", rods))));
}

// As many balls leave as arrive, with their speed at the bottom; the others hang still. A ball's energy gives its speed
// at the bottom; the error of the motion up to there is some times the accuracy.
TEST(NewtonsCradle, AsManyBallsLeaveAsArrive) {
  const double speed = std::sqrt(2 * kGravity * 0.5 * (1 - std::cos(std::numbers::pi / 4)));
  for (int balls = 2; balls <= 7; ++balls)
    for (int lifted = 1; lifted <= std::min(3, balls - 1); ++lifted) {
      const Trajectory run = cradleRun(balls, lifted, 1e-10);
      EXPECT_LT(energyDrift(run), 1e-8 * kGravity);
      const double impact = timesOf(run, EventKind::impact).at(0);
      const auto after =
          std::find_if(run.frames.begin(), run.frames.end(), [&](const Frame& frame) { return frame.time > impact; });
      for (int i = 0; i < balls; ++i) {
        const BodyState& ball = after->states[static_cast<std::size_t>(i)];
        const double height = ball.position.y() + 0.5,
                     square = ball.linearVelocity.squaredNorm() + 2 * kGravity * height;
        if (i >= balls - lifted)
          EXPECT_NEAR(std::sqrt(square), speed, 1e-9 * speed) << balls << " " << lifted << " " << i;
        else
          EXPECT_LT(ball.linearVelocity.norm(), 1e-9) << balls << " " << lifted << " " << i;
      }
    }
}

/// A box on a slope of 30 degrees, thrown upwards.
Trajectory slopeRun(double friction, double upwards) {
  const double s = 0.5, c = std::sqrt(0.75);
  const std::string bodies = fmt::format(
      R"({{"name": "slope", "shape": {{"plane": {{"normal": [{}, {}, 0]}}}}, "motion": "static", "material": "m"}},
         {{"name": "box", "shape": {{"box": {{"size": [0.5, 0.2, 0.5]}}}}, "mass": 1, "material": "m",
           "position": [{}, {}, 0], "orientation": {{"axis": [0, 0, 1], "angleDegrees": -30}},
           "linearVelocity": [{}, {}, 0]}})",
      s, c, 0.1 * s, 0.1 * c, -upwards * c, upwards * s);
  return simulate(sceneOf(sceneText(1e-10, 2, 20, materialText(0, friction), bodies)));
}

double upTheSlope(const Frame& frame) {
  const Vec3& position = frame.states[0].position;
  return -(position.x() * std::sqrt(0.75) - position.y() * 0.5);
}

TEST(BlockOnSlopeByEvents, SlidesUpStopsAndSlidesBack) {
  const Trajectory run = slopeRun(0.2, 3);
  const double up = kGravity * (0.5 + 0.2 * std::sqrt(0.75)), down = kGravity * (0.5 - 0.2 * std::sqrt(0.75));
  const double stop = 3 / up, farthest = 3 * stop / 2;
  for (const Frame& frame : run.frames) {
    const double t = frame.time, since = t - stop;
    EXPECT_NEAR(upTheSlope(frame), t < stop ? 3 * t - up * t * t / 2 : farthest - down * since * since / 2, 2e-9);
  }
  ASSERT_FALSE(timesOf(run, EventKind::slip).empty());
  EXPECT_NEAR(timesOf(run, EventKind::slip)[0], stop, 1e-9);
}

TEST(BlockOnSlopeByEvents, SticksWhereFrictionHolds) {
  const Trajectory thrown = slopeRun(0.7, 3), laid = slopeRun(0.6, 0);
  const double stop = 3 / (kGravity * (0.5 + 0.7 * std::sqrt(0.75)));
  EXPECT_NEAR(timesOf(thrown, EventKind::stick).at(0), stop, 1e-9);
  EXPECT_NEAR(timesOf(thrown, EventKind::rest).at(0), stop, 1e-9);
  EXPECT_NEAR(upTheSlope(thrown.frames.back()), 3 * stop / 2, 1e-9);
  EXPECT_EQ(laid.frames.back().states[0].position, laid.frames[0].states[0].position);
  EXPECT_LT(laid.cost.evaluations, 5);  // what rests costs nothing
}

// R8d, R8e: mu g decelerates, 5/2 mu g / r turns; they meet at t = 2 (v0 - r w0) / (7 mu g), v = (5 v0 + 2 r w0) / 7.
TEST(BallByEvents, RollsOnceItsSlidingEnds) {
  for (const double spin : {0.0, -30.0}) {
    const std::string ball = fmt::format(
        R"(, {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "material": "m",
              "position": [0, 0.1, 0], "linearVelocity": [5, 0, 0], "angularVelocity": [0, 0, {}]}})",
        -spin);
    const Trajectory run = simulate(sceneOf(sceneText(1e-8, 1, 1, materialText(0, 0.3), kFloor + ball)));
    ASSERT_EQ(timesOf(run, EventKind::roll).size(), 1u);
    EXPECT_NEAR(timesOf(run, EventKind::roll)[0], 2 * (5 - 0.1 * spin) / (7 * 0.3 * kGravity), 1e-9);
    EXPECT_NEAR(endOf(run).linearVelocity.x(), (25 + 0.2 * spin) / 7, 1e-9);
  }
}

// R8g: four corners at half the diagonal d carry a quarter each: w' = mu g (d / 2) / ((a^2 + b^2) / 12) = 6 mu g / d.
TEST(BoxByEvents, SpinsOnItsCornersToRest) {
  const std::string box =
      R"(, {"name": "box", "shape": {"box": {"size": [0.4, 0.1, 0.2]}}, "mass": 1, "material": "m",
           "position": [0, 0.05, 0], "angularVelocity": [0, 10, 0]})";
  const Trajectory run = simulate(sceneOf(sceneText(1e-9, 0.5, 2, materialText(0, 0.3), kFloor + box)));
  const double rate = 6 * 0.3 * kGravity / std::sqrt(0.2);
  EXPECT_NEAR(timesOf(run, EventKind::rest).at(0), 10 / rate, 1e-8);
  const Quat& orientation = endOf(run).orientation;
  EXPECT_NEAR(2 * std::atan2(orientation.y(), orientation.w()), 50 / rate, 1e-8);
}

// R12: ball on a platform that hangs from a spring, until it rides and until it leaves.
TEST(BallOnPlatform, BouncesRidesAndLeavesAsTheReferenceDoes) {
  const std::string bodies = R"({"name": "platform", "shape": {"box": {"size": [1, 0.1, 1]}}, "mass": 2,
      "position": [0, -0.05, 0], "material": "m"},
    {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 0.5, "position": [0, 1.1, 0], "material": "m"})";
  const std::string spring = fmt::format(R"(, "springs": [{{"bodyA": "platform", "anchorA": [0, 0.05, 0],
      "anchorB": [0, 3, 0], "stiffness": 200, "restLength": {}}}])",
                                         3 - 2 * kGravity / 200);
  const Trajectory run = simulate(sceneOf(sceneText(1e-10, 3, 1, materialText(0.5, 0), bodies, spring)));
  const std::vector<double> impacts = timesOf(run, EventKind::impact);
  const std::vector<double> expected = {0.45152364098573090445, 0.69939396875219240931, 0.87546247605108234509,
                                        1.0888006663158161805};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(impacts.at(i), expected[i], 1e-9) << i;
  EXPECT_NEAR(impacts.back(), 1.192795, 1e-6);  // where the bounces accumulate
  const Frame& riding = run.frames.back();
  EXPECT_NEAR(riding.states[1].position.y() - 0.1, riding.states[0].position.y() + 0.05, 1e-12);
}

// Both start 0.2 m below their common equilibrium: y = -0.2 cos(w t), w^2 = k / (M + m) = 80 / s^2. The contact would
// have to pull where y'' = -g, at y = g / w^2.
TEST(BallOnPlatform, LeavesWhereThePlatformFallsFasterThanItself) {
  const std::string bodies = R"({"name": "platform", "shape": {"box": {"size": [1, 0.1, 1]}}, "mass": 2,
      "position": [0, -0.25, 0], "material": "m"},
    {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 0.5, "position": [0, -0.1, 0], "material": "m"})";
  const std::string spring = fmt::format(R"(, "springs": [{{"bodyA": "platform", "anchorA": [0, 0.05, 0],
      "anchorB": [0, 3, 0], "stiffness": 200, "restLength": {}}}])",
                                         3 - 2.5 * kGravity / 200);
  const Trajectory run = simulate(sceneOf(sceneText(1e-10, 0.4, 10, materialText(0.5, 0), bodies, spring)));
  ASSERT_EQ(timesOf(run, EventKind::release).size(), 1u);
  EXPECT_NEAR(timesOf(run, EventKind::release)[0], std::acos(-kGravity / 80 / 0.2) / std::sqrt(80), 1e-9);
}

// At x = 0.5, after 0.1 s, the table ends: with v^2 / r = 40 m/s^2 > g nothing bends the ball around its edge. The
// border is found to half of what touches, 1e-8 sizes: 5e-10 m, or 2.5e-10 s.
TEST(BallOnATable, FliesOnInAParabolaWhereTheTableEnds) {
  const double speed = 2, edge = 0.1;
  const Trajectory run = simulate(sceneOf(sceneText(1e-8, 0.6, 10, materialText(0, 0), kTable + R"(,
    {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0.3, 0.1, 0], "material": "m",
     "linearVelocity": [2, 0, 0]})")));
  for (const Frame& frame : run.frames) {
    const double flight = std::max(0.0, frame.time - edge);
    EXPECT_NEAR(frame.states[0].position.x(), 0.3 + speed * frame.time, 1e-8) << frame.time;
    EXPECT_NEAR(frame.states[0].position.y(), 0.1 - kGravity * flight * flight / 2, 1e-8) << frame.time;
  }
}

// Its centre of mass is carried until it is over the edge: at 0.2 s, were there no friction; then it tips and falls.
TEST(BoxOnATable, TipsOverItsEdge) {
  const Trajectory run = simulate(sceneOf(sceneText(1e-6, 0.6, 10, materialText(0, 0), kTable + R"(,
    {"name": "box", "shape": {"box": {"size": [0.2, 0.1, 0.2]}}, "mass": 1, "position": [0.3, 0.05, 0],
     "material": "m", "linearVelocity": [1, 0, 0]})")));
  EXPECT_NEAR(run.frames[1].states[0].position.y(), 0.05, 1e-8);
  EXPECT_LT(run.frames[3].states[0].angularVelocity.z(), -0.1);
  EXPECT_LT(run.frames[6].states[0].position.y(), -0.3);
}

// A cube stands on a corner; a ball slides from its top corner, without friction, along a plane of symmetry towards the
// edge between two faces. Around a corner it would leave at cos a = 2/3, where it would be (1 - cos 12.9) R = 2.5 mm
// deep in that edge, which begins at a = 35.3 degrees. An edge is met by steps: they leave some micrometres.
TEST(BallOnACorner, GoesOverAnEdgeWithoutSinkingIn) {
  const double radius = 0.1, corner = std::sqrt(0.75), degree = std::numbers::pi / 180;  // m, m, rad
  const Quat worldFromCube(Eigen::AngleAxisd(std::acos(1 / std::sqrt(3.)), Vec3(-1, 0, 1).normalized()));
  const Vec3 overEdge = worldFromCube * Vec3(1, 1, 0).normalized(), aside = Vec3(overEdge.x(), 0, overEdge.z());
  const Vec3 away = std::cos(10 * degree) * Vec3::UnitY() + std::sin(10 * degree) * aside.normalized();
  const std::string bodies = fmt::format(
      R"({{"name": "cube", "shape": {{"box": {{"size": [1, 1, 1]}}}}, "motion": "static", "material": "m",
          "orientation": {{"w": {}, "x": {}, "y": {}, "z": {}}}}},
         {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": {}, "material": "m"}})",
      worldFromCube.w(), worldFromCube.x(), worldFromCube.y(), worldFromCube.z(),
      vectorText(corner * Vec3::UnitY() + radius * away));
  const Trajectory run = simulate(sceneOf(sceneText(1e-6, 0.4, 100, materialText(0, 0), bodies)));
  for (const Frame& frame : run.frames) {
    const Vec3 inCube = worldFromCube.conjugate() * frame.states[0].position;
    const Vec3 fromEdge(inCube.x() - 0.5, inCube.y() - 0.5, std::max(0.0, inCube.z() - 0.5));
    EXPECT_GT(fromEdge.norm(), radius - 1e-4) << frame.time;
  }
  EXPECT_LT(endOf(run).position.y(), corner);
}

// Along the foot of an L of 3 m x 2 m to its other arm, 0.9 m away, and back: what carries the ball is a row by then.
TEST(BallInTheCornerOfAMesh, ReboundsFromTheArmThatItRollsAgainst) {
  const double arm = 10. * 0.1F;  // m: its width, as files have it
  const std::string bodies =
      fmt::format(R"({{"name": "corner", "shape": {{"mesh": "{}/assets/l_prism.3ds", "scale": 10}},
     "motion": "static", "material": "m"}},
    {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [2, {}, 0.5], "material": "m",
     "linearVelocity": [-1, 0, 0]}})",
                  CRADLE_SOURCE_DIR, arm + 0.1);
  const std::string text = sceneText(1e-8, 1.5, 10, materialText(1, 0), bodies);
  const Trajectory run = simulate(parseScene(text, "corner.json", modelFilesBeside("corner.json")).scene);
  for (const Frame& frame : run.frames) {
    EXPECT_NEAR(frame.states[0].position.x(), arm + 0.1 + std::abs(frame.time - 1.9 + arm), 1e-8) << frame.time;
    EXPECT_NEAR(frame.states[0].position.y(), arm + 0.1, 1e-8) << frame.time;
  }
}

// Past an edge of the same L, at a distance that is less than the radius by 1e-6 of it: for 2 sqrt(2e-6) R / v = 28 us.
TEST(BallPastAMesh, IsSeenToGrazeItsEdge) {
  const double edge = 10. * 0.3F, radius = 0.1;  // m: where the foot ends; its top is at 10 * 0.1F
  for (const double overlap : {1e-6, -1e-6}) {
    const Vec3 start(edge + radius * (1 - overlap) * std::sqrt(0.5) - 0.5,
                     10. * 0.1F + radius * (1 - overlap) * std::sqrt(0.5) + 0.5, 0.5);
    const std::string bodies =
        fmt::format(R"({{"name": "corner", "shape": {{"mesh": "{}/assets/l_prism.3ds", "scale": 10}},
       "motion": "static", "material": "m"}},
      {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": {}, "material": "m",
       "linearVelocity": [5, -5, 0]}})",
                    CRADLE_SOURCE_DIR, vectorText(start));
    const std::string text = sceneText(1e-4, 0.2, 10, materialText(1, 0), bodies, R"(, "gravity": [0, 0, 0])");
    const Trajectory run = simulate(parseScene(text, "corner.json", modelFilesBeside("corner.json")).scene);
    EXPECT_EQ(timesOf(run, EventKind::impact).size(), overlap > 0 ? 1u : 0u);
  }
}

// 2 cm at 1000 m/s against 1 mm: passed in 21 us, whatever the step would be. Glancing, spinning and long bodies too.
TEST(EventContact, NothingTunnels) {
  const std::string plate =
      R"({"name": "plate", "shape": {"box": {"size": [0.001, 4, 4]}}, "motion": "static", "material": "m"})";
  const std::vector<std::string> bullets = {
      R"({"name": "b", "shape": {"sphere": {"radius": 0.01}}, "mass": 1, "position": [-9, 0, 0], "material": "m",
          "linearVelocity": [1000, 0, 0]})",
      R"({"name": "b", "shape": {"sphere": {"radius": 0.01}}, "mass": 1, "position": [-0.5, 0, 0], "material": "m",
          "linearVelocity": [300, 900, 30]})",
      R"({"name": "b", "shape": {"box": {"size": [0.02, 0.02, 0.02]}}, "mass": 1, "position": [-9, 0, 0],
          "material": "m", "linearVelocity": [1000, 0, 0], "angularVelocity": [100, 200, 300]})",
      R"({"name": "b", "shape": {"box": {"size": [1, 0.01, 0.01]}}, "mass": 1, "position": [-0.4, 0, 0],
          "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}, "material": "m", "angularVelocity": [0, 0, 60]})"};
  for (const std::string& bullet : bullets)
    for (const double accuracy : {1e-4, 1e-8}) {
      const Trajectory run = simulate(sceneOf(
          sceneText(accuracy, 0.02, 1000, materialText(1, 0), plate + ", " + bullet, R"(, "gravity": [0, 0, 0])")));
      EXPECT_FALSE(timesOf(run, EventKind::impact).empty()) << bullet;
      for (const Frame& frame : run.frames) EXPECT_LT(frame.states[0].position.x(), 0) << bullet << frame.time;
    }
}

/// Shapes thrown onto a floor and onto each other; `mirror` is the sign of all z.
std::string heapText(unsigned seed, double mirror, bool reversed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random()) / 4294967295.0;
  };
  const int count = 2 + static_cast<int>(random() % 3);
  const double restitution = uniform(0, 0.9), friction = uniform(0, 0.8);
  std::vector<std::string> bodies;
  for (int i = 0; i < count; ++i) {
    const bool isSphere = random() % 2 == 1;
    const Vec3 size{uniform(0.15, 0.4), uniform(0.15, 0.4), uniform(0.15, 0.4)};
    const std::string shape = isSphere ? fmt::format(R"({{"sphere": {{"radius": {}}}}})", size.x() / 2)
                                       : fmt::format(R"({{"box": {{"size": {}}}}})", vectorText(size));
    const Vec3 position{uniform(-0.2, 0.2), 0.4 + 0.6 * i, mirror * uniform(-0.2, 0.2)};
    const Vec3 axis{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const Vec3 velocity{uniform(-1, 1), uniform(-1, 1), mirror * uniform(-1, 1)};
    const double mass = uniform(0.5, 2), angle = uniform(10, 80);
    bodies.push_back(fmt::format(
        R"({{"name": "b{}", "shape": {}, "mass": {}, "material": "m", "position": {}, "linearVelocity": {},
             "orientation": {{"axis": {}, "angleDegrees": {}}}}})",
        i, shape, mass, vectorText(position), vectorText(velocity),
        vectorText(Vec3(mirror * axis.x(), mirror * axis.y(), axis.z())), angle));
  }
  if (reversed) std::reverse(bodies.begin(), bodies.end());
  return sceneText(1e-7, 0.8, 20, materialText(restitution, friction),
                   fmt::format("{}, {}", kSlab, fmt::join(bodies, ", ")));
}

// Kinetic + potential + dissipated is constant to the accuracy's part, and what is dissipated never comes back.
TEST(Heaps, NeverGainEnergy) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Trajectory run = simulate(sceneOf(heapText(seed, 1, false)));
    EXPECT_LT(energyDrift(run), 1e-5) << seed;
    for (std::size_t i = 1; i < run.frames.size(); ++i)
      EXPECT_GE(run.frames[i].energy.dissipated, run.frames[i - 1].energy.dissipated - 1e-6) << seed;
  }
}

// Until the first impacts have magnified rounding, mirror images and other orders of the bodies move alike.
TEST(Heaps, MoveAlikeMirroredAndInAnotherOrder) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Trajectory run = simulate(sceneOf(heapText(seed, 1, false)));
    const Trajectory mirrored = simulate(sceneOf(heapText(seed, -1, false)));
    const Trajectory reversed = simulate(sceneOf(heapText(seed, 1, true)));
    const std::size_t frame = 8, count = run.frames[frame].states.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 position = run.frames[frame].states[i].position;
      const Vec3 other = mirrored.frames[frame].states[i].position;
      EXPECT_LT((position - Vec3(other.x(), other.y(), -other.z())).norm(), 1e-7) << seed;
      EXPECT_LT((position - reversed.frames[frame].states[count - 1 - i].position).norm(), 1e-7) << seed;
    }
  }
}

// A ball slides obliquely with a = mu g against its way, and its spin about the horizontal across that grows by 5 a /
// (2 r), until it rolls at t = 2 v / (7 a) = 0.053 s. Steps end there, where sliding tells no direction: frames inside
// them know it all the same.
TEST(SlidingBall, HasExactFramesUpToWhereItRolls) {
  const double radius = 0.08, friction = 0.2, deceleration = friction * kGravity;
  const Vec3 velocity(0.32, 0, 0.18), across = Vec3::UnitY().cross(velocity.normalized());
  for (const double accuracy : {1e-6, 1e-8, 1e-10}) {
    const Trajectory run = simulate(sceneWith(fmt::format(
        R"("duration": 0.06, "accuracy": {}, "output": {{"framesPerSecond": 1000}},
        "materials": {{"m": {{"restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
        {{"name": "floor", "shape": {{"box": {{"size": [4, 1, 4]}}}}, "position": [0, -0.5, 0], "motion": "static",
          "material": "m"}},
        {{"name": "ball", "shape": {{"sphere": {{"radius": {}}}}}, "material": "m", "position": [0, {}, 0],
          "linearVelocity": {}}}])",
        accuracy, friction, friction, radius, radius, vectorText(velocity))));
    for (const Frame& frame : run.frames) {
      if (frame.time > 0.053) break;
      const BodyState& ball = frame.states[0];
      const Vec3 spin = 2.5 * deceleration * frame.time / radius * across;
      EXPECT_LT((ball.angularVelocity - spin).norm(), 10 * accuracy) << accuracy << " " << frame.time;
      EXPECT_LT((ball.linearVelocity - velocity + deceleration * frame.time * velocity.normalized()).norm(), accuracy);
    }
  }
}

}  // namespace
}  // namespace cradle
