// The Voronoi regions of a surface's features: B. Mirtich, "V-Clip: fast and robust polyhedral collision detection",
// ACM Trans. Graphics 17(3), 1998. Flat regions take the place of triangles: an edge inside of one is no feature.

#include "collision/mesh_feature.h"

#include <algorithm>

namespace cradle {
namespace {

using Feature = MeshPoint::Feature;

// Of kBeyondEnd, by which contacts may be found beyond the border of a region: wide enough for both sides of the
// border. A tenth or ten times as much changes no test.
constexpr double kBorderRatio = 4;

struct FootVisit {
  const MeshSurface& surface;
  std::uint32_t region;
  Vec3 foot;
  bool isFound = false;

  double reach() const { return isFound ? -1 : 0; }
  void operator()(std::uint32_t face) {
    if (surface.regions[face] == region && triangleOf(surface, face).isAbove(foot, kBeyondEnd)) isFound = true;
  }
};

/// Distance (m) from the foot of the perpendicular on a flat region to the region's outline; < 0 outside of it.
double insideOutline(const MeshSurface& surface, std::uint32_t face, const Vec3& point) {
  const FlatTriangle plane = triangleOf(surface, face);
  const std::uint32_t region = surface.regions[face];
  const Vec3 foot = point - plane.heightOf(point) * plane.normal;
  double distance2 = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = surface.firstBorder[region]; i < surface.firstBorder[region + 1]; ++i) {
    const Segment edge = segmentOf(surface, surface.borders[i]);
    distance2 = std::min(distance2, (foot - edge.at(edge.nearestPart(foot))).squaredNorm());
  }
  if (plane.isAbove(foot)) return std::sqrt(distance2);
  const double slack = MeshTolerances(surface.size).inPlane;
  FootVisit visit{surface, region, foot};
  visitNear(surface.tree, Bounds(Vec3(foot.array() - slack), Vec3(foot.array() + slack)), visit);
  return visit.isFound ? std::sqrt(distance2) : -std::sqrt(distance2);
}

double insideWedge(const MeshSurface& surface, const MeshSurface::Edge& edge, const Vec3& point) {
  const Vec3 &from = surface.vertices[edge.vertices[0]], &to = surface.vertices[edge.vertices[1]];
  const Vec3 along = (to - from).normalized(), away = point - from;
  double inside = std::min(away.dot(along), (to - point).dot(along));
  for (const std::uint32_t across : edge.across) {
    const Vec3 side = surface.vertices[across] - from;
    const Vec3 inward = (side - along * along.dot(side)).normalized();
    inside = std::min(inside, -away.dot(inward));
  }
  return inside;
}

double insideCone(const MeshSurface& surface, std::uint32_t vertex, const Vec3& point) {
  const Vec3 away = point - surface.vertices[vertex];
  double inside = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = surface.firstNeighbour[vertex]; i < surface.firstNeighbour[vertex + 1]; ++i) {
    const Vec3 side = surface.vertices[surface.neighbours[i]] - surface.vertices[vertex];
    inside = std::min(inside, -away.dot(side.normalized()));
  }
  return inside;
}

HalfSpace behind(const Vec3& normal, const Vec3& point) {
  return {normal, normal.dot(point)};
}

bool isBehind(const FlatTriangle& triangle, const std::vector<HalfSpace>& space, double slack) {
  return std::all_of(space.begin(), space.end(), [&](const HalfSpace& half) {
    const double most =
        std::max({half.normal.dot(triangle.a), half.normal.dot(triangle.b), half.normal.dot(triangle.c)});
    return most <= half.offset + slack;
  });
}

struct BesideVisit {
  const MeshSurface& surface;
  const std::vector<std::vector<HalfSpace>>& touched;
  const Vec3& point;
  double slack, distance2;  // m, m^2

  double reach() const { return distance2; }

  void operator()(std::uint32_t face) {
    const FlatTriangle triangle = triangleOf(surface, face);
    const double height = triangle.heightOf(point);
    if (height * height >= distance2) return;
    for (const std::vector<HalfSpace>& space : touched)
      if (isBehind(triangle, space, slack)) return;
    if (triangle.isAbove(point)) {
      distance2 = height * height;
      return;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Segment side{cornerOf(triangle, i), cornerOf(triangle, (i + 1) % 3) - cornerOf(triangle, i)};
      distance2 = std::min(distance2, (point - side.at(side.nearestPart(point))).squaredNorm());
    }
  }
};

}  // namespace

double insideRegion(const MeshSurface& surface, const TouchedFeature& touched, const Vec3& point) {
  if (touched.feature == Feature::edge) return insideWedge(surface, surface.edges[touched.index], point);
  if (touched.feature == Feature::vertex) return insideCone(surface, touched.index, point);
  return insideOutline(surface, touched.index, point);
}

double borderWidth(const MeshSurface& surface) {
  return kBorderRatio * kBeyondEnd * surface.size;
}

std::vector<HalfSpace> spaceBehind(const MeshSurface& surface, const TouchedFeature& touched) {
  std::vector<HalfSpace> space;
  if (touched.feature == Feature::face) {
    const MeshSurface::Face& face = surface.faces[touched.index];
    space.push_back(behind(face.normal, surface.vertices[face.vertices[0]]));
    return space;
  }
  // The triangles at an edge or vertex, and the edges there: at the border of a sheet these bound it.
  const auto addEdge = [&](const MeshSurface::Edge& edge) {
    const Vec3& point = surface.vertices[edge.vertices[0]];
    for (const std::uint32_t face : edge.faces) space.push_back(behind(surface.faces[face].normal, point));
    space.push_back(behind(edge.normal, point));
  };
  if (touched.feature == Feature::edge) {
    addEdge(surface.edges[touched.index]);
    return space;
  }
  for (const MeshSurface::Edge& edge : surface.edges)
    if (edge.vertices[0] == touched.index || edge.vertices[1] == touched.index) addEdge(edge);
  return space;
}

double distanceBeside(const MeshSurface& surface, const std::vector<std::vector<HalfSpace>>& touched, const Vec3& point,
                      double reach) {
  BesideVisit visit{surface, touched, point, MeshTolerances(surface.size).inPlane, reach * reach};
  visitNear(surface.tree, point, visit);
  return visit.distance2 < reach * reach ? std::sqrt(visit.distance2) : std::numeric_limits<double>::infinity();
}

}  // namespace cradle
