#include "verify/placed_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "verify/single_precision.h"

namespace cradle {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// A place is known to some rounding of its distance from the camera and from the world's origin: both programs turn
// and shift it in a dozen operations of 1.1e-16 each. A thousand times that is still far below single precision.
constexpr double kPlaceRounding = 1e-12;
constexpr double kSlopeRounding = 1e-14;  // of the cosine between a ray and a plane's normal
constexpr double kGrazing = 1e-6;         // cosine to the view below which a normal's side is not told
constexpr double kSteepestGround = 0.3;   // cosine between up and the normal of a plane that is the ground

/// Where a ray is inside of a solid, in its depths; empty unless enter <= exit.
struct RaySpan {
  double enter = kInfinite, exit = -kInfinite;
  bool isEmpty() const { return !(enter <= exit); }
};

/// About the point of the line that is nearest to the middle: the quadratic has no linear part.
RaySpan spanInRound(const Vec3& origin, const Vec3& direction, double radius) {
  const double slope = direction.squaredNorm();
  if (slope == 0) return origin.norm() <= radius ? RaySpan{-kInfinite, kInfinite} : RaySpan{};
  const double nearest = -origin.dot(direction) / slope;
  const double left = radius * radius - (origin + nearest * direction).squaredNorm();
  if (radius < 0 || left < 0) return {};
  const double half = std::sqrt(left / slope);
  return {nearest - half, nearest + half};
}

RaySpan spanInSlab(double origin, double direction, double half) {
  if (direction == 0) return std::abs(origin) <= half ? RaySpan{-kInfinite, kInfinite} : RaySpan{};
  const double a = (-half - origin) / direction, b = (half - origin) / direction;
  return half < 0 ? RaySpan{} : RaySpan{std::min(a, b), std::max(a, b)};
}

RaySpan both(const RaySpan& a, const RaySpan& b) {
  return {std::max(a.enter, b.enter), std::min(a.exit, b.exit)};
}

/// Of solids whose union is convex.
RaySpan either(const RaySpan& a, const RaySpan& b) {
  if (a.isEmpty() || b.isEmpty()) return a.isEmpty() ? b : a;
  return {std::min(a.enter, b.enter), std::max(a.exit, b.exit)};
}

const Vec3 kAcross(1, 0, 1);  // the axis of what is long

// Spans of a ray, in the body's frame, in solids whose surfaces are moved outwards by `growth` (m).

RaySpan spanIn(const Sphere& sphere, const PictureRay& ray, double growth) {
  return spanInRound(ray.origin, ray.direction, sphere.radius + growth);
}

RaySpan spanIn(const Box& box, const PictureRay& ray, double growth) {
  RaySpan span{-kInfinite, kInfinite};
  for (Eigen::Index i = 0; i < 3; ++i)
    span = both(span, spanInSlab(ray.origin[i], ray.direction[i], box.size[i] / 2 + growth));
  return span;
}

RaySpan spanIn(const Cylinder& cylinder, const PictureRay& ray, double growth) {
  return both(
      spanInRound(ray.origin.cwiseProduct(kAcross), ray.direction.cwiseProduct(kAcross), cylinder.radius + growth),
      spanInSlab(ray.origin.y(), ray.direction.y(), cylinder.length / 2 + growth));
}

RaySpan spanIn(const Capsule& capsule, const PictureRay& ray, double growth) {
  const Vec3 cap(0, capsule.length / 2, 0);
  const double radius = capsule.radius + growth;
  const RaySpan side = both(spanInRound(ray.origin.cwiseProduct(kAcross), ray.direction.cwiseProduct(kAcross), radius),
                            spanInSlab(ray.origin.y(), ray.direction.y(), capsule.length / 2));
  return either(side, either(spanInRound(ray.origin - cap, ray.direction, radius),
                             spanInRound(ray.origin + cap, ray.direction, radius)));
}

/// Of the solid half of the world, met from above.
RaySpan spanIn(const Plane& plane, const PictureRay& ray, double growth) {
  const double approach = plane.normal.dot(ray.direction);
  if (approach >= 0) return {};
  const double slope = kSlopeRounding * ray.direction.norm() / -approach;
  const double depth = (growth - plane.normal.dot(ray.origin)) / approach;
  return {growth > 0 ? depth * (1 - slope) : depth * (1 + slope), kInfinite};
}

double reachOf(const Sphere& sphere) {
  return sphere.radius;
}
double reachOf(const Box& box) {
  return box.size.norm() / 2;
}
double reachOf(const Cylinder& cylinder) {
  return std::hypot(cylinder.radius, cylinder.length / 2);
}
double reachOf(const Capsule& capsule) {
  return capsule.radius + capsule.length / 2;
}
double reachOf(const Plane&) {
  return kInfinite;
}

/// A direction in which a surface may point, and how much it turns over a metre.
struct SurfaceNormal {
  Vec3 direction;
  double bend = 0;      // 1/m
  double distance = 0;  // m, of the place from this part of the surface
};

std::vector<SurfaceNormal> normalsAt(const Sphere& sphere, const Vec3& place) {
  return {{place.normalized(), 1 / sphere.radius}};
}

std::vector<SurfaceNormal> normalsAt(const Box& box, const Vec3& place) {
  std::vector<SurfaceNormal> normals;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vec3 normal = Vec3::Unit(i) * (place[i] < 0 ? -1 : 1);
    normals.push_back({normal, 0, std::abs(std::abs(place[i]) - box.size[i] / 2)});
  }
  return normals;
}

std::vector<SurfaceNormal> normalsAt(const Cylinder& cylinder, const Vec3& place) {
  const Vec3 across = place.cwiseProduct(kAcross), cap(0, place.y() < 0 ? -1 : 1, 0);
  return {{across.normalized(), 1 / cylinder.radius, std::abs(across.norm() - cylinder.radius)},
          {cap, 0, std::abs(std::abs(place.y()) - cylinder.length / 2)}};
}

std::vector<SurfaceNormal> normalsAt(const Capsule& capsule, const Vec3& place) {
  const double half = capsule.length / 2;
  return {{(place - Vec3(0, std::clamp(place.y(), -half, half), 0)).normalized(), 1 / capsule.radius}};
}

std::vector<SurfaceNormal> normalsAt(const Plane& plane, const Vec3&) {
  return {{plane.normal}};
}

/// The plane that is nearest to level, if one is a floor rather than a wall; else kWorld.
int groundOf(const Scene& scene) {
  int ground = kWorld;
  double best = kSteepestGround;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Plane* plane = std::get_if<Plane>(&scene.bodies[i].shape);
    const double level =
        plane == nullptr ? 0 : (scene.bodies[i].worldFromBody.rotation * plane->normal).dot(upOf(scene));
    if (level <= best) continue;
    best = level;
    ground = static_cast<int>(i);
  }
  return ground;
}

std::optional<PlacedSolid::Form> formOf(const Shape& shape) {
  return std::visit(
      [](const auto& form) -> std::optional<PlacedSolid::Form> {
        if constexpr (std::is_same_v<std::decay_t<decltype(form)>, ModelShape>)
          return std::nullopt;
        else
          return form;
      },
      shape);
}

bool isSolid(const Scene& scene, std::size_t body, int ground) {
  const Shape& shape = scene.bodies[body].shape;
  if (std::holds_alternative<ModelShape>(shape)) return false;
  return !std::holds_alternative<Plane>(shape) || static_cast<int>(body) == ground;
}

}  // namespace

std::vector<RigidTransform> posesOf(const Scene& scene, const Frame& frame) {
  std::vector<RigidTransform> poses;
  auto state = frame.states.begin();
  for (const Body& body : scene.bodies) {
    RigidTransform pose = body.worldFromBody;
    if (body.motion != Motion::fixed) {
      pose.rotation = state->orientation;
      pose.translation = state->position - pose.rotation.toRotationMatrix() * body.massProperties.centerOfMass;
      ++state;
    }
    poses.push_back(pose);
  }
  return poses;
}

PlacedSolid::PlacedSolid(int body, const Form& form, const RigidTransform& worldFromBody, const Vec3& viewpoint)
    : body_(body),
      form_(form),
      worldFromBody_(worldFromBody),
      bodyFromWorld_(worldFromBody.rotation.toRotationMatrix().transpose()),
      reach_(std::visit([](const auto& shape) { return reachOf(shape); }, form)),
      rounding_(kPlaceRounding * ((worldFromBody.translation - viewpoint).norm() + viewpoint.norm() +
                                  worldFromBody.translation.norm())) {}

PictureRay PlacedSolid::inBody(const PictureRay& ray) const {
  return {bodyFromWorld_ * (ray.origin - worldFromBody_.translation), bodyFromWorld_ * ray.direction};
}

std::optional<DepthRange> PlacedSolid::meet(const PictureRay& ray) const {
  const Vec3 towards = worldFromBody_.translation - ray.origin;
  const double reach = reach_ + rounding_;
  if (towards.cross(ray.direction).squaredNorm() > reach * reach * ray.direction.squaredNorm() * (1 + kPlaceRounding))
    return std::nullopt;
  const PictureRay local = inBody(ray);
  const auto span = [&](double growth) {
    return std::visit([&](const auto& form) { return spanIn(form, local, growth); }, form_);
  };
  const RaySpan outer = span(rounding_), inner = span(-rounding_);
  if (outer.isEmpty() || outer.exit <= 0) return std::nullopt;
  if (outer.enter > 0)
    return DepthRange{outer.enter, inner.isEmpty() ? std::min(outer.exit, 2 * outer.enter) : inner.enter,
                      !inner.isEmpty()};
  if (outer.exit == kInfinite) return std::nullopt;
  const bool isSure = !inner.isEmpty() && inner.enter < 0 && inner.exit > 0;
  return DepthRange{isSure ? inner.exit : 0, outer.exit, isSure};
}

PlacedSolid::NormalDeviation PlacedSolid::compareNormal(const PictureRay& ray, const DepthRange& depths,
                                                        const Vec3& normal) const {
  const PictureRay local = inBody(ray);
  const Vec3 place = local.origin + depths.middle() * local.direction;
  const double length = local.direction.norm();
  const double slack = (depths.most - depths.least) * length + 4 * rounding_;
  NormalDeviation best{kInfinite, 0, Vec3::Zero()};
  const auto candidates = std::visit([&](const auto& form) { return normalsAt(form, place); }, form_);
  for (const SurfaceNormal& candidate : candidates) {
    if (candidates.size() > 1 && candidate.distance > slack) continue;
    const double cosine = candidate.direction.dot(local.direction) / length;
    const Vec3 expected = worldFromBody_.rotation * (cosine > 0 ? Vec3(-candidate.direction) : candidate.direction);
    double deviation = (normal - expected).norm();
    if (std::abs(cosine) < kGrazing) deviation = std::min(deviation, (normal + expected).norm());
    if (!(deviation < best.deviation) && best.expected != Vec3::Zero()) continue;
    best = {deviation, kSingleNormal + slack * candidate.bend, expected};
  }
  return best;
}

std::vector<PlacedSolid> solidsOf(const Scene& scene, const std::vector<RigidTransform>& worldFromBody,
                                  const Vec3& viewpoint) {
  const int ground = groundOf(scene);
  std::vector<PlacedSolid> solids;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (isSolid(scene, i, ground))
      solids.emplace_back(static_cast<int>(i), *formOf(scene.bodies[i].shape), worldFromBody[i], viewpoint);
  return solids;
}

bool hasSolidsAlone(const Scene& scene) {
  const int ground = groundOf(scene);
  std::size_t links = 0;
  forEachKindOfLink(scene, [&](const auto& all) { links += all.size(); });
  if (links > 0) return false;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (!isSolid(scene, i, ground)) return false;
  return true;
}

}  // namespace cradle
