// The normal of a mirror halves the angle between the directions to the eye and to what is seen. Where these are known
// to within angles, so is the normal; and where the normal is known, so is the place on the sphere from which both
// directions are counted: a few rounds of this close in on the image.

#include "render/mirror_image.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cradle {
namespace {

constexpr int kRounds = 8;
constexpr double kRounding = 1e-3;  // of the mirror's radius
constexpr double kGrazing = 0.01;   // length by which the directions' sum is uncertain: rays through pixels at the edge

// Rays that hardly fall towards the ground or rise from it are given this slope (environment.glsl): from next to the
// ground they end near by.
constexpr double kMinApproach = 1e-3;

/// Unit direction from somewhere in `from` to somewhere in `to`, and how far from it in length the true one may be.
struct Direction {
  Vec3 middle;
  double error;
};

std::optional<Direction> directionBetween(const BoundingSphere& from, const BoundingSphere& to) {
  const Vec3 between = to.center - from.center;
  const double distance = between.norm(), sine = (from.radius + to.radius) / distance;
  if (!(sine < 1)) return std::nullopt;
  return Direction{between / distance, 2 * std::sin(std::asin(sine) / 2)};
}

/// What a flat side of a box shows of a sphere, as another sphere behind it; none if it cannot be shown to `mirror`.
std::optional<BoundingSphere> behindSide(const OccluderItem& box, int axis, double side, const BoundingSphere& seen,
                                         const BoundingSphere& mirror) {
  const Vec3 normal = side * box.rotation.toRotationMatrix().col(axis);
  const Vec3 point = box.center + box.half[axis] * normal;
  const double height = normal.dot(seen.center - point);
  if (height + seen.radius < 0 || normal.dot(mirror.center - point) + mirror.radius < 0) return std::nullopt;
  return BoundingSphere{seen.center - 2 * height * normal, seen.radius};
}

/// The lowest part of a sphere, where it nearly touches the ground; of no size if it does not.
BoundingSphere bottomOf(const SphereItem& sphere, const RenderSetup& setup) {
  const Ground& ground = *setup.ground;
  const double highest = 2 * kMinApproach * setup.size;
  const double height = highest - (ground.normal.dot(sphere.center - ground.point) - sphere.radius);
  return {sphere.center - sphere.radius * ground.normal, std::sqrt(2 * sphere.radius * std::max(height, 0.0))};
}

}  // namespace

BoundingSphere imageIn(const BoundingSphere& mirror, const BoundingSphere& eye, const BoundingSphere& seen) {
  BoundingSphere place = mirror;
  for (int round = 0; round < kRounds; ++round) {
    const auto toEye = directionBetween(place, eye), toSeen = directionBetween(place, seen);
    if (!toEye || !toSeen) break;
    const Vec3 sum = toEye->middle + toSeen->middle;
    // Sine of the angle by which the normal may differ.
    const double sine = (toEye->error + toSeen->error + kGrazing) / sum.norm();
    const double radius = mirror.radius * (sine + kRounding);
    if (!(sine < 1 && radius < place.radius)) break;
    place = {mirror.center + mirror.radius * std::sqrt(1 - sine * sine) * sum.normalized(), radius};
  }
  return place;
}

std::vector<BoundingSphere> imagesOnSphere(const SphereItem& sphere, const BoundingSphere& onGround,
                                           const DrawList& list, const RenderSetup& setup) {
  const BoundingSphere mirror{sphere.center, sphere.radius}, eye{setup.camera.position, 0};
  std::vector<BoundingSphere> images = {imageIn(mirror, eye, onGround)};
  if (const BoundingSphere bottom = bottomOf(sphere, setup); bottom.radius > 0) images.push_back(bottom);
  for (int i = 0; i < sphere.nearOccluders; ++i) {
    const int index = list.nearOccluders[static_cast<std::size_t>(sphere.firstNearOccluder + i)];
    const OccluderItem& occluder = list.occluders[static_cast<std::size_t>(index)];
    if (occluder.isSphere()) {
      images.push_back(imageIn(mirror, eye, imageIn({occluder.center, occluder.radius}, mirror, onGround)));
      continue;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1, 1})
        if (const auto behind = behindSide(occluder, axis, side, onGround, mirror))
          images.push_back(imageIn(mirror, eye, *behind));
  }
  return images;
}

}  // namespace cradle
