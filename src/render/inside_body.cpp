// Models by their winding number: the solid angle that the triangles fill as seen from the point, which is 4 pi inside
// and 0 outside (A. van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2),
// 1983). Unlike counting what a ray hits, it has no trouble with edges.

#include "render/inside_body.h"

#include <cmath>
#include <numbers>

#include "mesh/solid.h"

namespace cradle {
namespace {

double solidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la);
}

bool isInside(const TriangleMesh& solid, const Vec3& point) {
  if (!checkSolid(solid).isClosed) return false;
  double angle = 0;
  for (const auto& triangle : solid.triangles)
    angle += solidAngle(solid.vertices[triangle[0]] - point, solid.vertices[triangle[1]] - point,
                        solid.vertices[triangle[2]] - point);
  return std::abs(angle) > 2 * std::numbers::pi;
}

struct IsInsideShape {
  const Scene& scene;
  const Vec3& point;

  bool operator()(const Sphere& sphere) const { return point.norm() < sphere.radius; }
  bool operator()(const Box& box) const { return (point.cwiseAbs().array() < box.size.array() / 2).all(); }
  bool operator()(const Cylinder& cylinder) const {
    return std::hypot(point.x(), point.z()) < cylinder.radius && std::abs(point.y()) < cylinder.length / 2;
  }
  bool operator()(const Capsule& capsule) const {
    const double beyond = std::max(std::abs(point.y()) - capsule.length / 2, 0.0);
    return Vec3(point.x(), beyond, point.z()).norm() < capsule.radius;
  }
  bool operator()(const Plane&) const { return false; }
  bool operator()(const ModelShape& shape) const {
    return isInside(scene.models.at(static_cast<std::size_t>(shape.model)).solid, point);
  }
};

}  // namespace

bool isInside(const Scene& scene, const Body& body, const Vec3& point) {
  return std::visit(IsInsideShape{scene, point}, body.shape);
}

}  // namespace cradle
