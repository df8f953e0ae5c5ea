#include "collision/mesh_nearest.h"

#include <cmath>

namespace cradle {
namespace {

constexpr double kFeatureAngle = 1e-6;         // rad: a direction as near to the normal of its feature is that normal
constexpr double kDifferenceRounding = 1e-15;  // of the size: ten unit roundoffs, for a difference of points

struct NearestVisit {
  const MeshSurface& surface;
  const Vec3& point;
  MeshPoint best;

  double reach() const { return best.distance2; }

  void keep(MeshPoint::Feature feature, std::uint32_t index, const Vec3& nearest) {
    const double distance2 = (point - nearest).squaredNorm();
    if (distance2 < best.distance2) best = {feature, index, nearest, Vec3::Zero(), distance2};
  }

  void operator()(std::uint32_t index) {
    const MeshSurface::Face& face = surface.faces[index];
    const FlatTriangle triangle = triangleOf(surface, index);
    const double height = triangle.heightOf(point);
    if (height * height >= best.distance2) return;
    if (triangle.isAbove(point)) return keep(MeshPoint::Feature::face, index, point - height * triangle.normal);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!face.ownsEdge[i]) continue;
      const Segment edge = segmentOf(surface, face.edges[i]);
      const double part = edge.nearestPart(point);
      const std::array<std::uint32_t, 2>& ends = surface.edges[face.edges[i]].vertices;
      if (part <= 0)
        keep(MeshPoint::Feature::vertex, ends[0], surface.vertices[ends[0]]);
      else if (part >= 1)
        keep(MeshPoint::Feature::vertex, ends[1], surface.vertices[ends[1]]);
      else
        keep(MeshPoint::Feature::edge, face.edges[i], edge.at(part));
    }
  }
};

}  // namespace

MeshPoint nearestPoint(const MeshSurface& surface, const Vec3& point, double reach) {
  NearestVisit visit{surface, point, {}};
  visit.best.distance2 = reach * reach;
  visitNear(surface.tree, point, visit);
  MeshPoint& best = visit.best;
  if (best.feature == MeshPoint::Feature::face) best.normal = surface.faces[best.index].normal;
  if (best.feature == MeshPoint::Feature::edge) best.normal = surface.edges[best.index].normal;
  if (best.feature == MeshPoint::Feature::vertex) best.normal = surface.vertexNormals[best.index];
  return best;
}

SignedHeight heightOver(const MeshSurface& surface, const Vec3& point) {
  const MeshPoint nearest = nearestPoint(surface, point);
  const Vec3 away = point - nearest.point;
  const bool isUnder = away.dot(nearest.normal) < 0;
  const double distance = std::sqrt(nearest.distance2), side = isUnder && !surface.isSheet ? -1 : 1;
  const Vec3 normal = isUnder && surface.isSheet ? Vec3(-nearest.normal) : nearest.normal;
  const Vec3 outward = distance > 0 ? Vec3(side / distance * away) : normal;
  const double noise = std::max(kFeatureAngle, kDifferenceRounding * surface.size / distance);
  const bool isFeatures = nearest.feature == MeshPoint::Feature::face || !((outward - normal).norm() > noise);
  return {side * distance, isFeatures ? normal : outward, nearest.point, nearest.feature};
}

}  // namespace cradle
