// A point's light changes only if something that moved stands, before or now, in the cone from the point to the light,
// or in the disc of the shadow map that is looked up for it (shadow.glsl). Both are found by whole blocks of the map.

#include "render/moved_shadows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/tile_mask.h"

namespace cradle {
namespace {

// As in shadow.glsl; texels. Half a block is what the cone is widened by there.
constexpr double kLightRadius = 0.03, kWidestRadius = 16, kHalfBlock = 4;
constexpr double kAroundDisc = 1.5;  // each look-up takes four texels
constexpr double kAside = 2;         // surfaces stand off from their depths by 1.5 texels; and rounding
constexpr double kBehind = 2;        // what lies so far in front of a caster is surely not in its shadow
constexpr double kSteepest = 50;     // slope in the light's frame: beyond, a surface is bounded by a box

constexpr double kMaxReach = kWidestRadius + kHalfBlock + kAside;

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr int kBlocks = kShadowMapSize / kShadowBlock;

/// Corners of an octagon around a disc.
void appendDisc(const Eigen::Vector2d& middle, double radius, std::vector<Eigen::Vector2d>& corners) {
  const double far = radius, near = radius * (std::sqrt(2.0) - 1);
  for (const double x : {-1, 1})
    for (const double y : {-1, 1}) {
      corners.emplace_back(middle.x() + x * far, middle.y() + y * near);
      corners.emplace_back(middle.x() + x * near, middle.y() + y * far);
    }
}

double coneAt(double away) {
  return std::min(kLightRadius * std::max(away, 0.0), kWidestRadius);
}

/// A box with its corners cut off as far as a disc of that radius does not reach; counter-clockwise.
std::vector<Eigen::Vector2d> rounded(const Eigen::AlignedBox2d& box, double radius) {
  const double cut = radius * (2 - std::sqrt(2.0));
  const Eigen::Vector2d &a = box.min(), &b = box.max();
  return {{a.x() + cut, a.y()}, {b.x() - cut, a.y()}, {b.x(), a.y() + cut}, {b.x(), b.y() - cut},
          {b.x() - cut, b.y()}, {a.x() + cut, b.y()}, {a.x(), b.y() - cut}, {a.x(), a.y() + cut}};
}

/// The part of a convex polygon where `inside` is not negative; linear.
template <typename Inside>
std::vector<Eigen::Vector2d> cut(const std::vector<Eigen::Vector2d>& polygon, const Inside& inside) {
  std::vector<Eigen::Vector2d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double atA = inside(a), atB = inside(b);
    if (atA >= 0) kept.push_back(a);
    if ((atA < 0) != (atB < 0)) kept.emplace_back(a + atA / (atA - atB) * (b - a));
  }
  return kept;
}

std::vector<Eigen::Vector2d> cut(std::vector<Eigen::Vector2d> polygon, const Bounds& bounds) {
  for (int axis = 0; axis < 2; ++axis) {
    polygon = cut(polygon, [&](const Eigen::Vector2d& p) { return p[axis] - bounds.min()[axis]; });
    polygon = cut(polygon, [&](const Eigen::Vector2d& p) { return bounds.max()[axis] - p[axis]; });
  }
  return polygon;
}

/// Whether what moved in `texels` is near enough to change light within `bounds`.
bool mayReach(const Eigen::AlignedBox2d& texels, const Bounds& bounds, double around = kMaxReach) {
  const auto overlaps = [&](int axis) {
    return texels.min()[axis] - around <= bounds.max()[axis] && texels.max()[axis] + around >= bounds.min()[axis];
  };
  return overlaps(0) && overlaps(1);
}

double depthAt(const Eigen::Vector2d& place, const Vec3& plane) {
  return plane.head<2>().dot(place) + plane.z();
}

}  // namespace

MovedShadows::MovedShadows(const std::vector<DrawnHull>& casters, const RenderSetup& setup) {
  const Eigen::Matrix4d texture = setup.shadow.textureFromWorld.cast<double>();
  const Vec3 scale(kShadowMapSize, kShadowMapSize, setup.shadow.deep / setup.shadow.texel);
  lightFromWorld_ = scale.asDiagonal() * texture.topLeftCorner<3, 3>();
  worldFromLight_ = lightFromWorld_.inverse();
  lightOrigin_ = scale.cwiseProduct(texture.topRightCorner<3, 1>()) - lightFromWorld_ * setup.origin;

  std::vector<double> nearest(kBlocks * kBlocks, kNone);
  const TileMask blocks(kShadowMapSize, kShadowMapSize);
  for (const DrawnHull& caster : casters) putBlocks(caster, setup.shadow.texel, blocks, nearest);
  for (int row = 0; row < kBlocks; ++row) appendRuns(row, &nearest[static_cast<std::size_t>(row) * kBlocks]);
}

/// Gives the blocks in which a caster stands its least depth.
void MovedShadows::putBlocks(const DrawnHull& caster, double texel, const TileMask& blocks,
                             std::vector<double>& nearest) const {
  const double radius = caster.radius / texel;
  std::vector<Eigen::Vector2d> outline;
  double depth = kNone;
  for (std::size_t i = 0; i < caster.count; ++i) {
    const Vec3 center = inLight(caster.centers[i]);
    appendDisc(center.head<2>(), radius, outline);
    depth = std::min(depth, center.z() - radius);
  }
  const TileSpans spans = blocks.spansOf(std::move(outline));
  for (std::size_t i = 0; i < spans.rows.size(); ++i)
    for (int column = spans.rows[i].first; column <= spans.rows[i].second; ++column) {
      double& least =
          nearest[(static_cast<std::size_t>(spans.firstRow) + i) * kBlocks + static_cast<std::size_t>(column)];
      least = std::min(least, depth);
    }
}

void MovedShadows::appendRuns(int row, const double* nearest) {
  for (int column = 0; column < kBlocks; ++column) {
    if (nearest[column] == kNone) continue;
    Run run{{}, kNone};
    run.texels.extend(Eigen::Vector2d(kShadowBlock * column, kShadowBlock * row));
    for (; column < kBlocks && nearest[column] != kNone; ++column) run.nearest = std::min(run.nearest, nearest[column]);
    run.texels.extend(Eigen::Vector2d(kShadowBlock * column, kShadowBlock * (row + 1)));
    runs_.push_back(run);
  }
}

LitSurface MovedShadows::surfaceOf(const DrawnHull& box, double wider) const {
  LitSurface surface;
  const double texels = (box.radius + wider) * lightFromWorld_.row(0).norm();
  for (std::size_t i = 0; i < box.count; ++i) surface.bounds.extend(inLight(box.centers[i]));
  surface.bounds.min().array() -= texels;
  surface.bounds.max().array() += texels;
  return surface;
}

LitSurface MovedShadows::surfaceOf(const std::array<Vec3, 3>& triangle, double wider) const {
  DrawnHull corners;
  for (const Vec3& corner : triangle) corners.add(corner);
  LitSurface surface = surfaceOf(corners, wider);
  const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  surface.plane = surfaceOf(normal, triangle[0]).plane;
  return surface;
}

LitSurface MovedShadows::surfaceOf(const Vec3& normal, const Vec3& point) const {
  constexpr double kFar = 1e9;
  LitSurface surface{{Vec3::Constant(-kFar), Vec3::Constant(kFar)}, std::nullopt};
  const Vec3 turned = lightFromWorld_ * normal, place = inLight(point);
  if (turned.head<2>().norm() < kSteepest * std::abs(turned.z())) {
    const Eigen::Vector2d slope = -turned.head<2>() / turned.z();
    surface.plane = Vec3(slope.x(), slope.y(), place.z() - slope.dot(place.head<2>()));
  }
  return surface;
}

/// Texels around a run within which light changes on a surface; negative if nowhere.
double MovedShadows::reachOf(const Run& run, const LitSurface& surface) const {
  double farthest = surface.bounds.max().z();
  if (farthest + kBehind < run.nearest || !mayReach(run.texels, surface.bounds)) return -1;
  if (surface.plane) {
    double atCorners = -std::numeric_limits<double>::infinity();
    for (const double x : {run.texels.min().x(), run.texels.max().x()})
      for (const double y : {run.texels.min().y(), run.texels.max().y()})
        atCorners = std::max(atCorners, depthAt({x, y}, *surface.plane));
    farthest = std::min(farthest, atCorners + kMaxReach * surface.plane->head<2>().cwiseAbs().sum());
    if (farthest + kBehind < run.nearest) return -1;
  }
  return std::max(coneAt(farthest - run.nearest) + kHalfBlock, coneAt(farthest) + kAroundDisc) + kAside;
}

bool MovedShadows::reach(const LitSurface& surface) const {
  return std::any_of(runs_.begin(), runs_.end(), [&](const Run& run) {
    const double around = reachOf(run, surface);
    return around >= 0 && mayReach(run.texels, surface.bounds, around);
  });
}

void MovedShadows::appendPart(const Run& run, const LitSurface& surface, std::vector<std::vector<Vec3>>& parts) const {
  const double around = reachOf(run, surface);
  if (around < 0) return;
  const Eigen::AlignedBox2d reached(Eigen::Vector2d(run.texels.min().array() - around),
                                    Eigen::Vector2d(run.texels.max().array() + around));
  const auto area = cut(rounded(reached, around), surface.bounds);
  if (area.empty()) return;
  std::vector<Vec3>& part = parts.emplace_back();
  for (const Eigen::Vector2d& corner : area) {
    if (surface.plane) {
      part.push_back(inWorld({corner.x(), corner.y(), depthAt(corner, *surface.plane)}));
      continue;
    }
    for (const double depth : {surface.bounds.min().z(), surface.bounds.max().z()})
      part.push_back(inWorld({corner.x(), corner.y(), depth}));
  }
}

std::vector<std::vector<Vec3>> MovedShadows::partsOf(const LitSurface& surface) const {
  std::vector<std::vector<Vec3>> parts;
  for (const Run& run : runs_) appendPart(run, surface, parts);
  return parts;
}

}  // namespace cradle
