// Spheres show the shadows on the ground only as far as these are not blurred: where a mirrored ray is wider than
// kBlurredTexels (environment.glsl). It widens with the surface's roughness, and with how the normal rotates from pixel
// to pixel.

#include "render/mirrored_shadows.h"

#include <algorithm>
#include <cmath>

#include "render/instances.h"

namespace cradle {
namespace {

constexpr double kBlurredTexels = 12;  // as in environment.glsl
// Pixels a radius by which a mirrored ray widens a metre at least, as environment.glsl counts: twice the turn of the
// normal from pixel to pixel and, but for pixels on the edge of a sphere drawn exactly round, as much as the rays of
// neighbouring pixels part, which is more than 1.
constexpr double kWideningOfSphere = 1.8, kWideningOfSmoothMesh = 2.8, kWideningOfFacets = 1;
constexpr double kSmooth = 0.05;    // greatest error of a smooth sphere's normals
constexpr double kQuickShadow = 4;  // texels around a shadow that is mirrored

}  // namespace

void MirroredShadows::addCaster(const DrawnHull& caster) {
  const Vec3 light = setup_.lighting.lamps[0].towards;
  const Ground& ground = *setup_.ground;
  const double steepness = ground.normal.dot(light);
  if (steepness <= 0) return;
  DrawnHull feet;
  for (std::size_t i = 0; i < caster.count; ++i)
    feet.add(caster.centers[i] - ground.normal.dot(caster.centers[i] - ground.point) / steepness * light);
  feet.radius = (caster.radius + kQuickShadow * setup_.shadow.texel) / steepness;
  patches_.push_back({feet.middle(), feet.reach()});
}

void MirroredShadows::addDarkened(const DrawnHull& onGround) {
  patches_.push_back({onGround.middle(), onGround.reach()});
}

/// How far from a sphere's surface shadows are not blurred; m.
double MirroredShadows::reachOf(const SphereItem& sphere, double widening) const {
  const double distance = (sphere.center - setup_.camera.position).norm() - sphere.radius;
  const double pixel = pixelAngle(setup_) * std::max(distance, 0.0);
  const double spread = sphere.surface.roughness * sphere.surface.roughness + widening * pixel / sphere.radius;
  return kBlurredTexels * setup_.shadow.texel / spread;
}

std::vector<DrawnHull> MirroredShadows::imagesOn(const SphereItem& sphere, const DrawList& list) const {
  std::vector<DrawnHull> images;
  if (!mirrorsShadows(sphere.surface)) return images;
  const double reach = sphere.radius + reachOf(sphere, kWideningOfSphere);
  for (const BoundingSphere& patch : patches_) {
    if ((patch.center - sphere.center).norm() > patch.radius + reach) continue;
    for (const BoundingSphere& image : imagesOnSphere(sphere, patch, list, setup_)) {
      DrawnHull& hull = images.emplace_back();
      hull.add(image.center);
      hull.radius = image.radius;
    }
  }
  return images;
}

bool MirroredShadows::areSeenOn(const MeshItem& item, const MeshBounds& bounds) const {
  if (!item.isSphere || !mirrorsShadows(item.surface)) return false;
  const SphereItem sphere{item.worldFromMesh * Vec3(bounds.whole.center()), bounds.whole.sizes().maxCoeff() / 2,
                          item.surface};
  const double widening = bounds.normalError < kSmooth ? kWideningOfSmoothMesh : kWideningOfFacets;
  const double reach = sphere.radius + reachOf(sphere, widening);
  return std::any_of(patches_.begin(), patches_.end(), [&](const BoundingSphere& patch) {
    return (patch.center - sphere.center).norm() <= patch.radius + reach;
  });
}

}  // namespace cradle
