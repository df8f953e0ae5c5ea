// Bounds on where bodies can get to, against where they do get to.

#include "simulate/plan/reach.h"

#include <gtest/gtest.h>

#include <random>

#include "experiments/experiment.h"
#include "simulate/plan/plan.h"

namespace cradle {
namespace {

std::vector<Reach> reachesOf(const Scene& scene) {
  return reachOf(scene, std::vector<char>(scene.bodies.size(), 0));
}

/// How far out of its reach, in parts of it, any body comes: below 1 all stay inside. The scene's bodies all move.
double farthestPart(const Scene& scene) {
  const std::vector<Reach> reaches = reachesOf(scene);
  double farthest = 0;
  for (const Frame& frame : simulate(scene).frames)
    for (std::size_t body = 0; body < reaches.size(); ++body)
      farthest = std::max(farthest, (frame.states[body].position - reaches[body].center).norm() / reaches[body].radius);
  return farthest;
}

std::string body(const std::string& name, const Vec3& position, const Vec3& velocity, const Vec3& spin) {
  return fmt::format(R"({{"name": "{}", "shape": {{"box": {{"size": [0.2, 0.3, 0.4]}}}}, "collision": "none", "mass": 2,
    "centerOfMass": [0.02, 0.05, -0.03], "inertiaTensor": [[0.08, 0.01, -0.02], [0.01, 0.05, 0.005], [-0.02, 0.005, 0.07]],
    "position": {}, "linearVelocity": {}, "angularVelocity": {}}})",
                     name, vectorText(position), vectorText(velocity), vectorText(spin));
}

class Throws {
 public:
  double number(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

 private:
  std::mt19937 random_{20};
};

// Springs of all kinds: stiff and soft, stretched and compressed, one and two, at corners.
TEST(Reach, OfBodiesOnSpringsToFixedPointsHolds) {
  Throws throws;
  double tightest = 0;
  for (int i = 0; i < 60; ++i) {
    std::string springs;
    for (int count = 1 + i % 2; count > 0; --count) {
      const Vec3 anchorA = throws.vector(0.3), anchorB = throws.vector(1.5);
      const double stiffness = std::exp(throws.number(1, 6)), restLength = throws.number(0, 2);
      springs += fmt::format(R"({{"bodyA": "a", "anchorA": {}, "anchorB": {}, "stiffness": {}, "restLength": {}}}{})",
                             vectorText(anchorA), vectorText(anchorB), stiffness, restLength, count > 1 ? ", " : "");
    }
    const Vec3 position = throws.vector(1), velocity = throws.vector(4), spin = throws.vector(4);
    const Scene scene = sceneWith(
        fmt::format(R"("duration": 5, "bodies": [{}], "springs": [{}])", body("a", position, velocity, spin), springs));
    ASSERT_LT(reachesOf(scene)[0].radius, 1e3);
    const double part = farthestPart(scene);
    EXPECT_LT(part, 1) << springs;
    tightest = std::max(tightest, part);
  }
  EXPECT_GT(tightest, 0.5) << "far too careful";
}

// A weld keeps its body as near as a hinge would; a slider lets it go as far as its time allows, and a spring that ends
// on what a slider moves tells nothing of energies.
TEST(Reach, OfWeldedBodiesIsBoundedAndOfSlidingOnesIsNot) {
  const std::string pair = body("a", Vec3(0, 0, 0), Vec3::Zero(), Vec3::Zero()) + ", " +
                           body("b", Vec3(1, 0, 0), Vec3(0, 0, 0), Vec3::Zero());
  const std::string hinge = R"("hinges": [{"bodyA": "a", "anchorA": [0, 1, 0], "anchorB": [0, 1, 0]}], )";
  const std::string joint = R"([{"bodyA": "b", "anchorA": [-0.5, 0, 0], "bodyB": "a", "anchorB": [0.5, 0, 0]}])";
  const auto sceneOfPair = [&](const std::string& joints) {
    return sceneWith(R"("duration": 2, "bodies": [)" + pair + "], " + joints);
  };
  const Scene welded = sceneOfPair(hinge + R"("welds": )" + joint);
  EXPECT_LT(reachesOf(welded)[1].radius, 4);
  EXPECT_LT(farthestPart(welded), 1);
  EXPECT_TRUE(std::isinf(reachesOf(sceneOfPair(hinge + R"("sliders": )" + joint))[1].radius));
  const std::string spring = R"("springs": [{"bodyA": "a", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0]}], )";
  EXPECT_TRUE(std::isinf(reachesOf(sceneOfPair(spring + R"("sliders": )" + joint))[0].radius));
}

TEST(Reach, OfBodiesInAChainOfTiesHolds) {
  Throws throws;
  for (int i = 0; i < 30; ++i) {
    const Vec3 pin = throws.vector(1), middle = throws.vector(0.3);
    const Vec3 velocityA = throws.vector(3), spinA = throws.vector(3);
    const Vec3 beside = throws.vector(0.5), velocityC = throws.vector(6), spinC = throws.vector(3);
    const Scene scene = sceneWith(fmt::format(
        R"("duration": 5, "bodies": [{}, {}, {}],
        "ballJoints": [{{"bodyA": "b", "anchorA": {}, "bodyB": "a", "anchorB": {}}}],
        "rods": [{{"bodyA": "a", "anchorA": [0.1, 0.1, 0.1], "anchorB": {}}}],
        "ropes": [{{"bodyA": "c", "anchorA": [0, 0.2, 0], "bodyB": "b", "anchorB": [0.1, 0, 0], "maxLength": 4}}])",
        body("a", Vec3::Zero(), velocityA, spinA), body("b", middle, Vec3::Zero(), Vec3::Zero()),
        body("c", middle + beside, velocityC, spinC), vectorText(-0.5 * middle), vectorText(0.5 * middle),
        vectorText(pin)));
    EXPECT_LT(farthestPart(scene), 1);
  }
}

// A parabola touches its ball at the start and at the end.
TEST(Reach, OfFlyingBodiesHoldsAndIsTight) {
  Throws throws;
  for (int i = 0; i < 60; ++i) {
    const double duration = throws.number(0.1, 3);
    const Vec3 position = throws.vector(1), velocity = throws.vector(10), spin = throws.vector(3);
    const Scene scene =
        sceneWith(fmt::format(R"("duration": {}, "bodies": [{}])", duration, body("a", position, velocity, spin)));
    const double part = farthestPart(scene);
    EXPECT_LT(part, 1);
    EXPECT_GT(part, 0.3);
  }
  // Straight up and back: the whole sag of the chord.
  const Scene thrown =
      sceneWith(R"("duration": 2, "bodies": [)" + body("a", Vec3::Zero(), Vec3(0, 9.81, 0), Vec3::Zero()) + "]");
  EXPECT_NEAR(farthestPart(thrown), 1, 1e-5);
}

TEST(Reach, IsUnboundedWhereSomethingElseActs) {
  const std::string bodies = R"("duration": 1, "bodies": [)" + body("a", Vec3::Zero(), Vec3::Zero(), Vec3::Zero()) +
                             ", " + body("b", Vec3(2, 0, 0), Vec3::Zero(), Vec3::Zero()) + "]";
  const std::string spring =
      R"(, "springs": [{"bodyA": "a", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0], "stiffness": 9}])";
  EXPECT_TRUE(std::isfinite(reachesOf(sceneWith(bodies + spring))[0].radius));
  const std::string push =
      R"(, "pushes": [{"body": "a", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0, "duration": 0.1}])";
  EXPECT_FALSE(std::isfinite(reachesOf(sceneWith(bodies + spring + push))[0].radius));
  const std::string between =
      R"(, "springs": [{"bodyA": "a", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0], "stiffness": 9},
      {"bodyA": "b", "anchorA": [0, 0, 0], "bodyB": "a", "anchorB": [0, 0, 0], "stiffness": 9}])";
  EXPECT_FALSE(std::isfinite(reachesOf(sceneWith(bodies + between))[0].radius));
  EXPECT_FALSE(std::isfinite(reachesOf(sceneWith(bodies + between))[1].radius));
}

// Hung 1 m below its anchor on a spring at rest, thrown along it with speed v: it swings through +-v sqrt(m/k) about
// its place. A floor below that is never met, one within it is.
TEST(BodyOnASpring, IsWatchedForThePlaneThatItMayReachAlone) {
  const double mass = 1, stiffness = 100, speed = 2, swing = speed * std::sqrt(mass / stiffness), radius = 0.1;
  const auto planFor = [&](double floor) {
    return planOf(sceneWith(fmt::format(
        R"("duration": 2, "gravity": [0, 0, 0], "bodies": [{{"name": "ball", "shape": {{"sphere": {{"radius": {}}}}}, "mass": {},
        "linearVelocity": [0, -{}, 0]}}, {{"name": "floor", "shape": {{"plane": {{"normal": [0, 1, 0]}}}}, "motion": "static",
        "position": [0, {}, 0]}}],
        "springs": [{{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0], "stiffness": {}}}])",
        radius, mass, speed, floor, stiffness)));
  };
  const Plan above = planFor(-0.99 * (swing + radius)), below = planFor(-1.01 * (swing + radius));
  EXPECT_EQ(above.islands.at(0).touching.size(), 2u);
  EXPECT_EQ(below.islands.at(0).touching.size(), 0u);
}

}  // namespace
}  // namespace cradle
