#include "collision/collider.h"

#include <algorithm>
#include <cmath>

#include "collision/contact_point.h"
#include "collision/core.h"
#include "collision/mesh_surface.h"

namespace cradle {
namespace {

constexpr double kMinDepthRatio = 1.01;  // than the centre of the bounds: by more than rounding

/// Half the extents (m) of a disc across a unit axis.
Vec3 discExtents(double radius, const Vec3& axis) {
  return radius * (Vec3::Ones() - axis.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
}

/// Fills in what the points and radii mean for the size.
Collider enclosed(Collider collider) {
  Vec3 around = Vec3::Constant(collider.radius), axis = Vec3::Zero();
  if (collider.kind() == ColliderKind::cylinder) {
    axis = (collider.points[0] - collider.points[1]).normalized();
    around = discExtents(collider.rimRadius, axis);
  }
  for (const Vec3& point : collider.points) {
    const double along = axis.dot(point), across = (point - along * axis).norm() + collider.rimRadius;
    collider.boundingRadius =
        std::max(collider.boundingRadius, std::sqrt(along * along + across * across) + collider.radius);
    collider.bounds.extend(Vec3(point - around));
    collider.bounds.extend(Vec3(point + around));
  }
  return collider;
}

/// How deep (m) a point is inside; < 0 outside.
double depthOf(const Vec3& point, const Collider& collider) {
  return -nearestSurfacePoint(collider, point).distance;
}

Vec3 meanOf(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

std::vector<Vec3> endsOf(double length, const RigidTransform& bodyFromShape) {
  const Vec3 end = length / 2 * Vec3::UnitY();
  return {bodyFromShape * end, bodyFromShape * -end};
}

Collider colliderOf(Polytope polytope) {
  Collider collider;
  collider.points = polytope.vertices;
  collider.polytope = std::make_shared<const Polytope>(std::move(polytope));
  return enclosed(std::move(collider));
}

SurfacePoint nearestOnCapsule(const Collider& capsule, const Vec3& point) {
  const Vec3 along = capsule.points[1] - capsule.points[0], from = point - capsule.points[0];
  const double part = std::clamp(along.dot(from) / along.squaredNorm(), 0.0, 1.0);
  const Vec3 away = from - part * along;
  const double distance = away.norm();
  const Vec3 normal = distance > 0 ? Vec3(away / distance) : along.unitOrthogonal();
  const bool isAtEnd = part <= 0 || part >= 1;
  const Vec3 nearest = capsule.points[0] + part * along + capsule.radius * normal;
  return {distance - capsule.radius, nearest, normal, isAtEnd ? capsule.radius : kNotRound};
}

SurfacePoint nearestOnCylinder(const Collider& cylinder, const Vec3& point) {
  const Vec3 center = (cylinder.points[0] + cylinder.points[1]) / 2;
  const double length = (cylinder.points[0] - cylinder.points[1]).norm();
  const Vec3 axis = (cylinder.points[0] - cylinder.points[1]) / length;
  const double height = axis.dot(point - center);
  const Vec3 away = point - center - height * axis;
  const double fromAxis = away.norm();
  const Vec3 end = height < 0 ? Vec3(-axis) : axis;
  const Vec3 radial = unitAcross(axis, away);
  const double overEnd = std::abs(height) - length / 2, overSide = fromAxis - cylinder.rimRadius;
  if (overEnd > 0 && overSide > 0) {
    const double distance = std::sqrt(overEnd * overEnd + overSide * overSide);
    const Vec3 normal = (overEnd * end + overSide * radial) / distance;
    return {distance, point - distance * normal, normal, kNotRound};
  }
  if (overEnd >= overSide) return {overEnd, point - overEnd * end, end, kFlat};
  return {overSide, point - overSide * radial, radial, kNotRound};
}

}  // namespace

SurfacePoint nearestSurfacePoint(const Collider& collider, const Vec3& point) {
  switch (collider.kind()) {
    case ColliderKind::sphere: {
      const Vec3 away = point - collider.points[0];
      const double distance = away.norm();
      const Vec3 normal = distance > 0 ? Vec3(away / distance) : Vec3(Vec3::UnitY());
      return {distance - collider.radius, collider.points[0] + collider.radius * normal, normal, collider.radius};
    }
    case ColliderKind::capsule:
      return nearestOnCapsule(collider, point);
    case ColliderKind::cylinder:
      return nearestOnCylinder(collider, point);
    case ColliderKind::polytope:
    case ColliderKind::mesh:
      break;
  }
  return nearestSurfacePoint(*collider.polytope, point);
}

Collider colliderOf(const Sphere& sphere, const RigidTransform& bodyFromShape) {
  Collider collider;
  collider.points = {bodyFromShape.translation};
  collider.radius = sphere.radius;
  return enclosed(std::move(collider));
}

Collider colliderOf(const Box& box, const RigidTransform& bodyFromShape) {
  return colliderOf(polytopeOf(box, bodyFromShape));
}

Collider colliderOf(const Cylinder& cylinder, const RigidTransform& bodyFromShape) {
  Collider collider;
  collider.points = endsOf(cylinder.length, bodyFromShape);
  collider.rimRadius = cylinder.radius;
  collider.polytope = std::make_shared<const Polytope>(inscribedPrism(cylinder, bodyFromShape));
  return enclosed(std::move(collider));
}

Collider colliderOf(const Capsule& capsule, const RigidTransform& bodyFromShape) {
  Collider collider;
  collider.points = endsOf(capsule.length, bodyFromShape);
  collider.radius = capsule.radius;
  collider.polytope = std::make_shared<const Polytope>(segmentBetween(collider.points[0], collider.points[1]));
  return enclosed(std::move(collider));
}

Collider colliderOf(const ConvexHull& hull, const RigidTransform& bodyFromShape) {
  ConvexHull placed = hull;
  for (Vec3& vertex : placed.vertices) vertex = bodyFromShape * vertex;
  return colliderOf(polytopeOf(placed));
}

bool isPinned(const Collider& collider, int other, const Vec3& point, double tolerance) {
  return std::any_of(collider.pins.begin(), collider.pins.end(), [&](const PinnedPlace& pin) {
    const Vec3 arm = point - pin.point;
    return pin.other == other && (arm - pin.axis.dot(arm) * pin.axis).norm() <= tolerance;
  });
}

double innerRadius(const Collider& collider) {
  if (collider.kind() != ColliderKind::mesh) {
    const double atCenter = depthOf(collider.bounds.center(), collider),
                 atMean = depthOf(meanOf(collider.points), collider);
    return atMean > kMinDepthRatio * atCenter ? atMean : atCenter;
  }
  if (!collider.mesh) return collider.boundingRadius;
  if (collider.mesh->isSheet) return std::numeric_limits<double>::infinity();
  double volume = 0, area = 0;
  for (const MeshSurface::Face& face : collider.mesh->faces) {
    const Vec3 &a = collider.mesh->vertices[face.vertices[0]], &b = collider.mesh->vertices[face.vertices[1]],
               &c = collider.mesh->vertices[face.vertices[2]];
    volume += a.dot(b.cross(c)) / 6;
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area > 0 ? std::abs(volume) / area : collider.boundingRadius;
}

double smallestSize(const ContactGeometry& geometry) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Collider& collider : geometry.colliders)
    if (collider.body != kFixed) smallest = std::min(smallest, collider.boundingRadius);
  return std::isfinite(smallest) ? smallest : 1;
}

}  // namespace cradle
