// Light on surfaces before and after things move, computed as shadow.glsl does from depths of balls, against what
// MovedShadows marks.

#include "render/moved_shadows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/render_setup.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kSize = kShadowMapSize, kBlock = kShadowBlock, kBlocks = kSize / kBlock;
constexpr double kLightRadius = 0.03, kWidest = 16, kNarrowest = 1.3, kBias = 0.6, kSteepest = 12;  // as in shadow.glsl
constexpr double kAside = 1.5;                                                                      // surface.glsl
constexpr int kSamplePairs = 12;

using Ball = SphereItem;

/// The light's frame: texels across, and as many in depth.
struct LightFrame {
  explicit LightFrame(const RenderSetup& setup) : texel(setup.shadow.texel), deep(setup.shadow.deep / texel) {
    const Eigen::Matrix4d texture = setup.shadow.textureFromWorld.cast<double>();
    const Vec3 scale(kSize, kSize, deep);
    turn = scale.asDiagonal() * texture.topLeftCorner<3, 3>();
    shift = scale.cwiseProduct(texture.topRightCorner<3, 1>()) - turn * setup.origin;
  }
  Vec3 placeOf(const Vec3& point) const { return turn * point + shift; }

  Mat3 turn;
  Vec3 shift;
  double texel, deep;
};

/// Depths of balls, and the least of each block.
struct ShadowMap {
  ShadowMap(const std::vector<Ball>& balls, const LightFrame& light);
  double depthAt(int x, int y) const { return at(depths, kSize, x, y); }
  double blockAt(int x, int y) const { return at(blocks, kBlocks, x, y); }

 private:
  double at(const std::vector<double>& map, int size, int x, int y) const {
    const auto clamped = [&](int i) { return static_cast<std::size_t>(std::clamp(i, 0, size - 1)); };
    return map[clamped(y) * static_cast<std::size_t>(size) + clamped(x)];
  }
  std::vector<double> depths, blocks;
};

ShadowMap::ShadowMap(const std::vector<Ball>& balls, const LightFrame& light)
    : depths(kSize * kSize, light.deep), blocks(kBlocks * kBlocks, light.deep) {
  for (const Ball& ball : balls) {
    const Vec3 center = light.placeOf(ball.center);
    const double radius = ball.radius / light.texel;
    const auto from = [&](double place) { return std::max(1, static_cast<int>(place - radius)); };
    const auto to = [&](double place) { return std::min(kSize - 2, static_cast<int>(place + radius)); };
    for (int y = from(center.y()); y <= to(center.y()); ++y)
      for (int x = from(center.x()); x <= to(center.x()); ++x) {
        const double u = x + 0.5 - center.x(), v = y + 0.5 - center.y(), inside = radius * radius - u * u - v * v;
        if (inside <= 0) continue;
        const double depth = std::max(center.z() - std::sqrt(inside), 0.0);
        double& least = depths[static_cast<std::size_t>(y * kSize + x)];
        double& leastOfBlock = blocks[static_cast<std::size_t>(y / kBlock * kBlocks + x / kBlock)];
        least = std::min(least, depth);
        leastOfBlock = std::min(leastOfBlock, depth);
      }
  }
}

/// A point of a surface in the light's frame: where its light is looked up, and where it is seen.
struct LitPoint {
  Vec3 place;
  Eigen::Vector2d slope, seen;
};

LitPoint litPoint(const Vec3& point, const Vec3& normal, double aside, const LightFrame& light) {
  const Vec3 turned = light.turn * normal;
  const Eigen::Vector2d slope = turned.head<2>() / std::max(-turned.z(), 1e-6);
  return {light.placeOf(point + aside * normal), slope.cwiseMax(-kSteepest).cwiseMin(kSteepest),
          light.placeOf(point).head<2>()};
}

/// Mean distance of what stands in the cone to the light; 0 if nothing does.
double blockerDistance(const LitPoint& point, const ShadowMap& map, double deep) {
  const Eigen::Vector2i corner = (point.place.head<2>().array() / kBlock + 0.5).floor().cast<int>();
  double weights = 0, sum = 0;
  for (int row = corner.y() - 3; row < corner.y() + 3; ++row)
    for (int column = corner.x() - 3; column < corner.x() + 3; ++column) {
      const double x = kBlock * (column + 0.5) - point.place.x(), y = kBlock * (row + 0.5) - point.place.y();
      const double depth = map.blockAt(column, row);
      const double lowest = point.place.z() - 0.5 * kBlock * point.slope.cwiseAbs().sum() - kBias;
      const double away = std::min(lowest + point.slope.dot(Eigen::Vector2d(x, y)), point.place.z()) - depth;
      if (away < 1e-3 || depth >= deep) continue;
      const double beside =
          std::hypot(std::max(std::abs(x) - kBlock / 2, 0.0), std::max(std::abs(y) - kBlock / 2, 0.0));
      const double weight = std::max(1 - beside / (std::min(kLightRadius * away, kWidest) + kBlock / 2), 0.0);
      weights += weight, sum += weight * away;
    }
  return weights > 0 ? sum / weights : 0;
}

double litAround(const Eigen::Vector2d& texel, const LitPoint& point, const ShadowMap& map, double deep) {
  const Eigen::Vector2i corner = (texel.array() + 0.5).floor().cast<int>();
  double lit = 0;
  for (int y = corner.y() - 1; y <= corner.y(); ++y)
    for (int x = corner.x() - 1; x <= corner.x(); ++x) {
      const Eigen::Vector2d center(x + 0.5, y + 0.5);
      const double plane = point.place.z() + point.slope.dot(center - point.place.head<2>());
      if (map.depthAt(x, y) < std::min({plane, point.place.z(), deep + kBias}) - kBias) continue;
      lit += (1 - std::abs(texel.x() - center.x())) * (1 - std::abs(texel.y() - center.y()));
    }
  return lit;
}

/// What is looked up for a point: the disc's radius, 0 if nothing stands in the cone, and the share of light.
std::pair<double, double> softShadow(const LitPoint& point, const ShadowMap& map, double deep) {
  const double distance = blockerDistance(point, map, deep);
  if (distance == 0) return {0, 1};
  const double radius = std::clamp(kLightRadius * distance, kNarrowest, kWidest), turn = 2.39996323;
  double lit = 0;
  for (int i = 0; i < kSamplePairs; ++i) {
    const Eigen::Vector2d aside =
        radius * std::sqrt((i + 0.5) / kSamplePairs) * Eigen::Vector2d(std::cos(i * turn), std::sin(i * turn));
    for (const double side : {-1, 1}) lit += litAround(point.place.head<2>() + side * aside, point, map, deep);
  }
  return {radius, lit / (2 * kSamplePairs)};
}

/// Whether a point lies in the convex hull of points: no line through it has all of them on one side. By angles around
/// it: there must be no gap of half a turn.
bool isWithin(const Eigen::Vector2d& point, const std::vector<Eigen::Vector2d>& corners) {
  std::vector<double> angles;
  for (const Eigen::Vector2d& to : corners) angles.push_back(std::atan2(to.y() - point.y(), to.x() - point.x()));
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2 * M_PI - angles.back();
  for (std::size_t i = 0; i + 1 < angles.size(); ++i) gap = std::max(gap, angles[i + 1] - angles[i]);
  return gap <= M_PI + 1e-6;
}

/// Parts of a surface, as the light sees them.
std::vector<std::vector<Eigen::Vector2d>> marked(const MovedShadows& shadows, const LitSurface& surface,
                                                 const LightFrame& light) {
  std::vector<std::vector<Eigen::Vector2d>> parts;
  for (const auto& part : shadows.partsOf(surface)) {
    auto& corners = parts.emplace_back();
    for (const Vec3& point : part) corners.push_back(light.placeOf(point).head<2>());
  }
  return parts;
}

/// Balls are placed in the light's frame: what is behind what, and how near the edges of blocks, is random.
class MovedShadowsTest : public ::testing::Test {
 protected:
  MovedShadowsTest() : setup_(makeTestSetup()), light_(setup_) {}

  static RenderSetup makeTestSetup() {
    Scene scene = emptyScene();
    scene.lights[0].direction = Vec3(-0.35, -1, 0.2).normalized();
    const View view{cameraAt({0, 2, 6}, {0, 0.5, 0}, 0.6), Bounds(Vec3(-1, 0, -1), Vec3(1, 2, 1))};
    return makeRenderSetup(scene, view, std::nullopt, 320, 180);
  }

  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  /// Somewhere in a cube of twice that size.
  Vec3 within(double half) {
    const double x = number(-half, half), y = number(-half, half);
    return {x, y, number(-half, half)};
  }
  Ball sphereAt(const Vec3& place, double texels) const {
    return {light_.turn.inverse() * (place - light_.shift), texels * light_.texel};
  }

  /// A ball that moves, and two that do not, one of them near the light; texels.
  struct Balls {
    Vec3 place;
    double radius;
    std::vector<Ball> before, now, moved;
  };
  Balls balls() {
    Balls all;
    const double x = number(300, 700), y = number(300, 700),
                 depth = number(0, 1) < 0.5 ? number(3, 60) : number(300, 650);
    all.place = {x, y, depth};
    all.radius = std::exp(number(std::log(1.5), std::log(30)));
    all.moved = {sphereAt(all.place, all.radius), sphereAt(all.place + within(10), all.radius)};
    for (int i = 0; i < 2; ++i) {
      const Vec3 aside = within(all.radius + 15);
      const Ball still =
          sphereAt({x + aside.x(), y + aside.y(), number(0, i == 0 ? 0.3 * depth : depth + 150)}, number(2, 15));
      all.before.push_back(still), all.now.push_back(still);
    }
    all.before.push_back(all.moved[0]), all.now.push_back(all.moved[1]);
    return all;
  }
  MovedShadows shadowsOf(const Balls& all) const { return {{hullOf(all.moved[0]), hullOf(all.moved[1])}, setup_}; }

  /// Expects points on a surface on which light changes to be marked; returns how many there are.
  template <typename PointAt>
  int countChanged(const Balls& balls, const LitSurface& surface, const PointAt& pointAt) {
    constexpr int kPoints = 3000;
    const ShadowMap before(balls.before, light_), now(balls.now, light_);
    const MovedShadows shadows = shadowsOf(balls);
    const auto parts = marked(shadows, surface, light_);
    int changed = 0;
    for (int i = 0; i < kPoints; ++i) {
      const LitPoint lit = pointAt();
      if (softShadow(lit, before, light_.deep) == softShadow(lit, now, light_.deep)) continue;
      ++changed;
      EXPECT_TRUE(shadows.reach(surface));
      EXPECT_TRUE(std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return isWithin(lit.seen, part); }))
          << lit.place.transpose();
    }
    return changed;
  }

  const Vec3 towards() const { return setup_.lighting.lamps[0].towards; }

  std::mt19937 random_{1};
  const RenderSetup setup_;
  const LightFrame light_;
};

TEST_F(MovedShadowsTest, PartsOfAPlaneHoldAllPointsWhoseLightChanges) {
  int changed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Balls all = balls();
    // Through the ball, or behind it.
    const double depth = all.place.z() + (trial % 2 == 0 ? number(-0.95, 1) * all.radius : number(0, 300));
    const Vec3 foot = sphereAt({all.place.x(), all.place.y(), depth}, 0).center;
    const Vec3 normal = (towards() + within(1.2)).normalized();
    if (normal.dot(towards()) < 0.1) continue;
    changed += countChanged(all, MovedShadows({}, setup_).surfaceOf(normal, foot), [&] {
      const double around = all.radius + 35;
      const Vec3 start = sphereAt(all.place + within(around), 0).center;
      return litPoint(start - normal.dot(start - foot) / normal.dot(towards()) * towards(), normal, 0, light_);
    });
  }
  EXPECT_GT(changed, 3000);
}

TEST_F(MovedShadowsTest, PartsOfABallHoldAllPointsWhoseLightChanges) {
  int changed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Balls all = balls();
    // What moves is seen from the light before the receiver or next to it.
    const double radius = number(3, 40);
    Vec3 place = all.place + within(radius + all.radius + 10);
    place.z() = all.place.z() + radius + number(0, 100);
    const Ball receiver = sphereAt(place, radius);
    all.before.push_back(receiver), all.now.push_back(receiver);
    changed += countChanged(all, MovedShadows({}, setup_).surfaceOf(hullOf(receiver), 0), [&] {
      Vec3 normal = within(1).normalized();
      if (normal.dot(towards()) < 0) normal = -normal;
      const double facing = normal.dot(towards()), aside = kAside * light_.texel * std::sqrt(1 - facing * facing);
      return litPoint(receiver.center + receiver.radius * normal, normal, aside, light_);
    });
  }
  EXPECT_GT(changed, 3000);
}

TEST_F(MovedShadowsTest, MarkLittleElse) {
  // Blocks that a ball meets with 2 texels to spare reach 10 texels beyond it; the widest disc 16 and half a block
  // more; and surfaces stand off by 2.
  constexpr double kFarthest = 10 + 16 + 4 + 2;
  const Balls all = balls();
  const MovedShadows shadows = shadowsOf(all);
  const auto parts = marked(shadows, shadows.surfaceOf(Vec3::UnitY(), Vec3::Zero()), light_);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector2d place(number(0, kSize), number(0, kSize));
    double nearest = INFINITY;
    for (const Ball& one : all.moved)
      nearest = std::min(nearest, (place - light_.placeOf(one.center).head<2>()).lpNorm<Eigen::Infinity>());
    if (nearest > all.radius + kFarthest) {
      EXPECT_FALSE(std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return isWithin(place, part); }));
    }
  }
  EXPECT_FALSE(parts.empty());
}

TEST_F(MovedShadowsTest, ReachNothingBeforeOrBesideThem) {
  const Vec3 aside = towards().cross(Vec3::UnitX()).normalized();
  const Ball moved{{0, 1, 0}, 0.1};
  const MovedShadows shadows({hullOf(moved)}, setup_);
  const auto reached = [&](const Vec3& way) {
    return shadows.reach(shadows.surfaceOf(hullOf({moved.center + way, 0.1}), 0));
  };
  EXPECT_TRUE(reached(-0.5 * towards()));
  EXPECT_FALSE(reached(0.25 * towards()));
  EXPECT_TRUE(reached(-0.5 * towards() + 0.2 * aside));
  // Boxes along the map's axes stand for both: sqrt(2) as large in other directions. For what is added, see above.
  EXPECT_FALSE(reached(-0.5 * towards() + M_SQRT2 * (0.2 + 32 * light_.texel) * aside));
}

}  // namespace
}  // namespace cradle
