// Mesa's software renderer computes the colour of every pixel of every triangle, hidden or not, where pixels have
// several samples: it tests their depths first, but goes on with none left. So what is wholly hidden is found here, and
// left out. The other way round from hierarchical depth buffers (N. Greene, M. Kass, G. Miller, "Hierarchical Z-buffer
// visibility", SIGGRAPH 1993): not from what is drawn, but from discs that are surely inside of it.

#include "render/occlusion_culling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/camera.h"

namespace cradle {
namespace {

constexpr int kCell = 2;  // pixels a side
// Of a sphere's radius: the outlines of polygons that are drawn for it come as near to the centre as 0.974.
constexpr double kSurelyFilled = 0.96;
constexpr double kSurelyBehind = 1.002;  // ratio of depths that the depth buffer tells apart, wherever the scene is

}  // namespace

OcclusionCulling::OcclusionCulling(const RenderSetup& setup)
    : setup_(setup),
      axes_(cameraAxes(setup.camera)),
      focal_(setup.height / (2 * std::tan(setup.camera.verticalFieldOfView / 2))),
      columns_((setup.width + kCell - 1) / kCell),
      rows_((setup.height + kCell - 1) / kCell),
      filledAt_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                std::numeric_limits<float>::infinity()) {}

double OcclusionCulling::depthOf(const Vec3& point) const {
  return -axes_.col(2).dot(point - setup_.camera.position);
}

/// The disc through the centre, parallel to the picture, is inside the sphere and a circle in the picture; what is seen
/// of the sphere there is nearer than the disc.
void OcclusionCulling::add(const Vec3& center, double radius) {
  const Vec3 seen = axes_.transpose() * (center - setup_.camera.position);
  const double depth = -seen.z(), inside = kSurelyFilled * radius;
  if (depth <= 2 * radius) return;  // perhaps cut by the near plane
  const double x = (setup_.width / 2.0 + focal_ * seen.x() / depth) / kCell;
  const double y = (setup_.height / 2.0 + focal_ * seen.y() / depth) / kCell;
  const double reach = focal_ * inside / depth / kCell;  // cells
  const int firstRow = std::max(0, static_cast<int>(std::ceil(std::max(y - reach, -1.0))));
  const int endRow = static_cast<int>(std::floor(std::min<double>(y + reach, rows_)));
  for (int row = firstRow; row < endRow; ++row) {
    const double away = std::max(std::abs(row - y), std::abs(row + 1 - y));
    if (away >= reach) continue;
    const double half = std::sqrt(reach * reach - away * away);
    const int first = std::max(0, static_cast<int>(std::ceil(std::max(x - half, -1.0))));
    const int end = static_cast<int>(std::floor(std::min<double>(x + half, columns_)));
    float* cells = filledAt_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    for (int column = first; column < end; ++column) cells[column] = std::min(cells[column], static_cast<float>(depth));
  }
}

bool OcclusionCulling::hides(const PixelRectangle& pixels, double nearest) const {
  const float behind = static_cast<float>(nearest / kSurelyBehind);
  const int left = std::max(pixels.left, 0) / kCell, right = (std::min(pixels.right, setup_.width) - 1) / kCell;
  const int bottom = std::max(pixels.bottom, 0) / kCell, top = (std::min(pixels.top, setup_.height) - 1) / kCell;
  for (int row = bottom; row <= top; ++row) {
    const float* cells = filledAt_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    for (int column = left; column <= right; ++column)
      if (!(cells[column] < behind)) return false;
  }
  return true;
}

}  // namespace cradle
