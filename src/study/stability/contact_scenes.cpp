#include "study/stability/contact_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "collision/broad_phase.h"
#include "scene/load_scene.h"

namespace cradle {
namespace {

constexpr double kBoxGap = 0.01;         // m
constexpr double kBallRadius = 0.1;      // m
constexpr double kPlateWidth = 100;      // m: no marble gets past its edge
constexpr double kMarbleSpacing = 4;     // radii
constexpr double kRowBallRadius = 0.05;  // m
constexpr double kTouching = 1e-9;       // m: rounding of places

Scene sceneOf(const std::string& name, double duration, const std::string& members) {
  const std::string text =
      fmt::format(R"({{"schema": "cradle-scene/1", "name": "{}", "duration": {}, {}}})", name, duration, members);
  return parseScene(text, name, [](const MeshReference&) { return LoadedModel{}; }).scene;
}

std::string smoothMaterial(double restitution) {
  return fmt::format(R"("materials": {{"smooth": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}})",
                     restitution);
}

const std::string kGround =
    R"({"name": "ground", "material": "smooth", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static"})";

struct Ball {
  double radius, mass;  // m, kg
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
};

std::string ballText(int number, const Ball& ball) {
  return fmt::format(
      R"({{"name": "ball{}", "material": "smooth", "shape": {{"sphere": {{"radius": {}}}}}, "mass": {},
        "position": [{}, {}, {}], "linearVelocity": [{}, {}, {}]}})",
      number, ball.radius, ball.mass, ball.position.x(), ball.position.y(), ball.position.z(), ball.velocity.x(),
      ball.velocity.y(), ball.velocity.z());
}

/// "bodies": those of `first`, then the balls.
std::string bodiesText(std::vector<std::string> first, const std::vector<Ball>& balls) {
  for (std::size_t i = 0; i < balls.size(); ++i) first.push_back(ballText(static_cast<int>(i), balls[i]));
  return fmt::format("\"bodies\": [{}]", fmt::join(first, ", "));
}

/// From the origin, by rods of 1 m.
Scene chainAlong(const Vec3& direction, int balls, double bobMass) {
  std::vector<Ball> chain;
  std::vector<std::string> rods;
  for (int i = 0; i < balls; ++i) {
    chain.push_back({kBallRadius, i == balls - 1 ? bobMass : 1, (i + 1) * direction});
    rods.push_back(i == 0 ? R"({"bodyA": "ball0", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]})"
                          : fmt::format(R"({{"bodyA": "ball{}", "anchorA": [0, 0, 0], "bodyB": "ball{}",
                              "anchorB": [0, 0, 0]}})",
                                        i, i - 1));
  }
  return sceneOf(
      "chain", 5,
      fmt::format("{}, {}, \"rods\": [{}]", smoothMaterial(0), bodiesText({}, chain), fmt::join(rods, ", ")));
}

}  // namespace

Scene bouncingBall(double restitution, double height, double duration) {
  const Ball ball{kBallRadius, 1, Vec3(0, kBallRadius + height, 0)};
  return sceneOf("bouncing ball", duration, smoothMaterial(restitution) + ", " + bodiesText({kGround}, {ball}));
}

Scene marblesAtPlate(double thickness, const std::vector<Throw>& throws) {
  std::vector<Ball> marbles;
  double duration = 0;
  for (const Throw& thrown : throws) {
    const double z = kMarbleSpacing * kMarbleRadius * static_cast<double>(marbles.size());
    const double start = -thickness / 2 - kMarbleRadius - thrown.gap;
    marbles.push_back({kMarbleRadius, 1, Vec3(start, 0, z), thrown.speed * Vec3::UnitX()});
    duration = std::max(duration, -4 * start / thrown.speed);
  }
  const std::string plate =
      fmt::format(R"({{"name": "plate", "material": "smooth", "shape": {{"box": {{"size": [{}, {}, {}]}}}},
        "motion": "static"}})",
                  thickness, kPlateWidth, kPlateWidth);
  return sceneOf("marbles at a plate", duration,
                 R"("gravity": [0, 0, 0], )" + smoothMaterial(0.5) + ", " + bodiesText({plate}, marbles));
}

Scene stackOfBalls(int balls, double topMass) {
  std::vector<Ball> stack;
  for (int i = 0; i < balls; ++i)
    stack.push_back({kBallRadius, i == balls - 1 ? topMass : 1, Vec3(0, (2 * i + 1) * kBallRadius, 0)});
  return sceneOf("stack of balls", 1, smoothMaterial(0) + ", " + bodiesText({kGround}, stack));
}

Scene droppedStack(int boxes, double topMass) {
  std::vector<std::string> bodies = {
      R"({"name": "ground", "motion": "static", "shape": {"box": {"size": [50, 1, 50]}}, "position": [0, -0.5, 0]})"};
  for (int i = 0; i < boxes; ++i)
    bodies.push_back(fmt::format(
        R"({{"name": "box{}", "shape": {{"box": {{"size": [1, 1, 1]}}}}, "mass": {}, "position": [0, {}, 0]}})", i,
        i == boxes - 1 ? topMass : 1, (i + 1) * (1 + kBoxGap) - 0.5));
  return sceneOf("dropped stack", 10, bodiesText(std::move(bodies), {}));
}

Scene hangingChain(int balls, double bobMass) {
  return chainAlong(-Vec3::UnitY(), balls, bobMass);
}

Scene swingingChain(int balls, double bobMass) {
  return chainAlong(Vec3(0.5, -std::sqrt(0.75), 0), balls, bobMass);
}

Scene rowOfFiveBalls(int moving) {
  std::vector<Ball> row;
  for (int i = 0; i < 5; ++i)
    row.push_back({kRowBallRadius, 0.2, Vec3(2 * i * kRowBallRadius, 0, 0), (i < moving ? 1 : 0) * Vec3::UnitX()});
  return sceneOf("row of five balls", 0.1,
                 R"("gravity": [0, 0, 0], )" + smoothMaterial(1) + ", " + bodiesText({}, row));
}

std::vector<Contact> contactsAtStart(Assembly& assembly) {
  BroadPhase broadPhase;
  std::vector<Contact> contacts;
  broadPhase.update(assembly.state, std::vector<double>(assembly.mechanism.bodies.size(), 0.0), kTouching,
                    assembly.geometry);
  findContacts(assembly.geometry, assembly.state, kTouching, contacts);
  return contacts;
}

}  // namespace cradle
