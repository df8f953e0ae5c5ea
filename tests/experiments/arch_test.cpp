#include <gtest/gtest.h>

#include <numbers>

#include "experiments/experiment.h"

// A semicircular arch of stones that nothing but friction holds. J. Heyman, "The stone skeleton", Int. J. Solids and
// Structures 2, 1966: it stands if a line of thrust fits into it; M. Milankovitch, "Theorie der Druckkurven", Z. Math.
// Phys. 55, 1907: of mean radius 1 and weights that act where they are, one that is thinner than 0.1075 falls.

namespace cradle {
namespace {

constexpr int kStones = 10;
constexpr double kHalfAngle = std::numbers::pi / kStones / 2;  // rad

/// A stone at the crown, its faces in planes through the z axis: thickness is that of an arch of mean radius 1.
LoadedModel stoneOf(double thickness) {
  DrawnMesh drawn;
  for (const double z : {-0.25, 0.25})
    for (const double height : {1 - thickness / 2, 1 + thickness / 2})
      for (const double side : {-1.0, 1.0})
        drawn.vertices.emplace_back(side * height * std::sin(kHalfAngle), height * std::cos(kHalfAngle), z);
  for (const std::array<std::uint32_t, 4>& q :
       {std::array<std::uint32_t, 4>{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3}, {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}})
    drawn.triangles.insert(drawn.triangles.end(), {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}});
  drawn.normals.assign(drawn.vertices.size(), Vec3f::UnitY());
  return {{"stone", weld(drawn.vertices, drawn.triangles), drawn}, {}};
}

Trajectory runArch(double thickness, double duration) {
  std::string stones;
  for (int i = 0; i < kStones; ++i)
    stones += fmt::format(R"(, {{"name": "s{}", "material": "m", "shape": {{"mesh": "stone.obj"}},
        "orientation": {{"axis": [0, 0, 1], "angleDegrees": {:.17g}}}}})",
                          i, (i + 0.5) * 180.0 / kStones - 90);
  const std::string text = fmt::format(R"({{"schema": "cradle-scene/1", "name": "Arch", "duration": {},
    "accuracy": 1e-6, "materials": {{"m": {{"density": 2000, "staticFriction": 0.9, "dynamicFriction": 0.9}}}},
    "bodies": [{{"name": "ground", "motion": "static", "material": "m", "shape": {{"plane": {{}}}}}}{}]}})",
                                       duration, stones);
  return simulate(parseScene(text, "arch.json", [&](const MeshReference&) { return stoneOf(thickness); }).scene);
}

/// How far the line of thrust stays inside of all joints at best, as a part of the thickness; negative: none fits.
/// Stones stand on each other from the crown down; by symmetry the thrust there is level.
double roomForThrust(double thickness) {
  const double inner = 1 - thickness / 2, outer = 1 + thickness / 2, middle = std::cos(kHalfAngle);
  const double centroid = middle * (inner + thickness / 3 * (inner + 2 * outer) / (inner + outer));
  double best = -INFINITY;
  for (int push = 0; push <= 200; ++push)
    for (int place = 0; place <= 40; ++place) {
      const double thrust = kStones / 2.0 * (0.2 + 0.4 * push / 200), top = inner + thickness * place / 40;
      double room = 0.5 - std::abs(top - 1) / thickness, moment = 0;  // weights are 1
      for (int i = 1; i <= kStones / 2; ++i) {
        const double angle = 2 * i * kHalfAngle;
        moment += centroid * std::sin(angle - kHalfAngle);
        const double radius = (thrust * top + moment) / (thrust * std::cos(angle) + i * std::sin(angle));
        room = std::min(room, 0.5 - std::abs(radius - 1) / thickness);
      }
      best = std::max(best, room);
    }
  return best;
}

// Ten straight stones need 0.1085 (by the search above), an arch of very many 0.1075.

TEST(Arch, StandsIfALineOfThrustFitsIntoIt) {
  for (const double thickness : {0.111, 0.15}) {
    EXPECT_GT(roomForThrust(thickness), 0);
    const Trajectory run = runArch(thickness, 1);
    EXPECT_EQ(run.frames.back().energy.kinetic, 0) << thickness;
    for (int i = 0; i < kStones; ++i) {
      const BodyState &start = run.frames[0].states[static_cast<std::size_t>(i)],
                      &end = run.frames.back().states[static_cast<std::size_t>(i)];
      EXPECT_LT((end.position - start.position).norm(), 1e-9) << thickness << " " << i;
    }
  }
}

// Each stone by the forces at its two faces, which are the thrust; that is level at the crown, by symmetry. At rest
// accelerations of 1e-6 g may be left; arms are 1 m at most.
TEST(Arch, ForcesOfItsContactsHoldEachStone) {
  const Trajectory run = runArch(0.15, 1);
  const Frame& end = run.frames.back();
  ASSERT_EQ(end.contacts.size(), kStones + 1u);
  for (int stone = 0; stone < kStones; ++stone) {
    const MassProperties& properties = run.header.bodies[static_cast<std::size_t>(stone + 1)].massProperties;
    Vec3 force = properties.mass * Vec3(0, -kGravity, 0), torque = Vec3::Zero();
    for (const ContactWrench& wrench : end.contacts) {
      const double sign = wrench.bodyB == stone + 1 ? 1 : wrench.bodyA == stone + 1 ? -1 : 0;
      const Vec3 arm = wrench.point - end.states[static_cast<std::size_t>(stone)].position;
      force += sign * wrench.force, torque += sign * (wrench.torque + arm.cross(wrench.force));
    }
    const double most = 1e-6 * properties.mass * kGravity;
    EXPECT_LT(force.norm(), most) << stone;
    EXPECT_LT(torque.norm(), most) << stone;
  }
  const auto isAtCrown = [](const ContactWrench& wrench) {
    return wrench.bodyA == kStones / 2 && wrench.bodyB == kStones / 2 + 1;
  };
  const auto crown = std::find_if(end.contacts.begin(), end.contacts.end(), isAtCrown);
  ASSERT_NE(crown, end.contacts.end());
  EXPECT_LT(std::abs(crown->force.y()), 1e-6 * std::abs(crown->force.x()));
}

// Hinges open where the line of thrust leaves it: at the crown and the springings outside, at the haunches inside.
TEST(Arch, FallsIfNoLineOfThrustFitsIntoIt) {
  for (const double thickness : {0.08, 0.104}) {
    EXPECT_LT(roomForThrust(thickness), 0);
    const Trajectory run = runArch(thickness, 0.06);
    const auto height = [&](const Frame& frame, std::size_t stone) { return frame.states[stone].position.y(); };
    const Frame &start = run.frames.front(), &end = run.frames.back();
    EXPECT_LT(height(end, 4), height(start, 4) - 1e-5) << thickness;  // at the crown
    EXPECT_GT(std::abs(end.states[1].position.x()), std::abs(start.states[1].position.x()) + 1e-6) << thickness;
    EXPECT_GT(end.energy.kinetic, 0);
  }
}

}  // namespace
}  // namespace cradle
