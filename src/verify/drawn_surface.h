#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace cradle {

/// The triangles of a mesh in the cells of a grid, so that those at a point are found without looking at all.
class DrawnSurface {
 public:
  /// `mesh` must outlive this object. O(triangles).
  explicit DrawnSurface(const DrawnMesh& mesh);

  /// What the surface is at a point that is on it but for `reach` (m).
  struct Match {
    double distance = 0;         // m, to the nearest triangle; 1000 reaches if none is within them
    double normalDeviation = 0;  // of the best triangle within reach, on either side of it; infinite if there is none
    double normalTolerance = 0;  // of its normal, whose corners are known to `rounding` (m)
  };
  Match match(const Vec3& point, const Vec3& normal, double reach, double rounding) const;

 private:
  template <class Visit>
  void visitNear(const Bounds& box, const Visit& visit) const;
  Eigen::Array3i cellAt(const Vec3& point) const;

  const DrawnMesh& mesh_;
  Bounds bounds_;
  Vec3 cell_;                                       // m, size of a cell
  int cellsAlong_;                                  // of each axis
  std::vector<std::vector<std::uint32_t>> inCell_;  // indices of triangles
};

}  // namespace cradle
