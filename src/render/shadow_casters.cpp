#include "render/shadow_casters.h"

#include <algorithm>
#include <limits>

#include "render/gpu_mesh.h"
#include "render/instances.h"

namespace cradle {
namespace {

constexpr int kRodPieces = 6;
constexpr double kMapMargin = 2;  // texels: rounding

}  // namespace

void appendPieces(const DrawnHull& hull, std::vector<DrawnHull>& pieces) {
  if (hull.count != 2) return pieces.push_back(hull);
  const Vec3 step = (hull.centers[1] - hull.centers[0]) / kRodPieces;
  for (int i = 0; i < kRodPieces; ++i) {
    DrawnHull& piece = pieces.emplace_back();
    piece.add(hull.centers[0] + i * step);
    piece.add(hull.centers[0] + (i + 1) * step);
    piece.radius = hull.radius;
  }
}

void appendCaster(const DrawnHull& hull, std::vector<DrawnHull>& casters) {
  DrawnHull drawn = hull;
  drawn.radius *= cornerOfEqualArea(kOutlines.front());  // rounds are drawn as polygons
  appendPieces(drawn, casters);
}

PixelRectangle shadowTexels(const DrawnHull& hull, const RenderSetup& setup) {
  Eigen::AlignedBox2d texels;
  const double around = hull.radius / setup.shadow.texel + kMapMargin;
  for (std::size_t i = 0; i < hull.count; ++i) {
    const Eigen::Vector4d place = (hull.centers[i] - setup.origin).homogeneous();
    const Eigen::Vector2d texel = kShadowMapSize * (setup.shadow.textureFromWorld.cast<double>() * place).head<2>();
    texels.extend(Eigen::Vector2d(texel.array() - around)), texels.extend(Eigen::Vector2d(texel.array() + around));
  }
  const auto whole = [](double place) { return static_cast<int>(std::clamp(place, 0.0, double{kShadowMapSize})); };
  return {whole(texels.min().x()), whole(texels.min().y()), whole(texels.max().x() + 1), whole(texels.max().y() + 1)};
}

std::optional<PixelRectangle> shadowTexels(const std::vector<DrawnHull>& casters, const RenderSetup& setup) {
  std::optional<PixelRectangle> all;
  for (const DrawnHull& hull : casters) {
    const PixelRectangle one = shadowTexels(hull, setup);
    all = all ? PixelRectangle{std::min(all->left, one.left), std::min(all->bottom, one.bottom),
                               std::max(all->right, one.right), std::max(all->top, one.top)}
              : one;
  }
  return all;
}

}  // namespace cradle
