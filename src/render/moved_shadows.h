#pragma once

#include <optional>
#include <vector>

#include "render/drawn_hull.h"
#include "render/tile_mask.h"

namespace cradle {

/// A surface, or a box around one, as the light sees it: texels of the shadow map across, and as many from its nearest
/// depth onwards.
struct LitSurface {
  Bounds bounds;
  std::optional<Vec3> plane;  // if it is flat, its depth at (x, y): plane.x x + plane.y y + plane.z
};

/// Where shadows change: of casters that moved, at their old and new places, on whatever they fall on.
class MovedShadows {
 public:
  MovedShadows(const std::vector<DrawnHull>& casters, const RenderSetup& setup);

  /// Of a box, and of a triangle, in world coordinates (m); `wider` (m) is added to the bounds.
  LitSurface surfaceOf(const DrawnHull& box, double wider) const;
  LitSurface surfaceOf(const std::array<Vec3, 3>& triangle, double wider) const;
  /// Of an endless plane through a point.
  LitSurface surfaceOf(const Vec3& normal, const Vec3& point) const;

  /// Whether light may change anywhere on a surface.
  bool reach(const LitSurface& surface) const;

  /// Points (m, world) around each part of a surface on which light may change; together they hold all that changes.
  std::vector<std::vector<Vec3>> partsOf(const LitSurface& surface) const;

 private:
  /// Blocks of the shadow map beside each other in a row, and the least depth of what moved in them; texels.
  struct Run {
    Eigen::AlignedBox2d texels;
    double nearest;
  };

  Vec3 inLight(const Vec3& point) const { return lightFromWorld_ * point + lightOrigin_; }
  Vec3 inWorld(const Vec3& place) const { return worldFromLight_ * (place - lightOrigin_); }
  void putBlocks(const DrawnHull& caster, double texel, const TileMask& blocks, std::vector<double>& nearest) const;
  void appendRuns(int row, const double* nearest);
  double reachOf(const Run& run, const LitSurface& surface) const;
  void appendPart(const Run& run, const LitSurface& surface, std::vector<std::vector<Vec3>>& parts) const;

  Mat3 lightFromWorld_, worldFromLight_;
  Vec3 lightOrigin_;
  std::vector<Run> runs_;
};

}  // namespace cradle
