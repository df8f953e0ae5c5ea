#include "truth/seen_surfaces.h"

#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "render/body_place.h"
#include "render/link_items.h"
#include "render/tube_curve.h"

namespace cradle {
namespace {

/// Triangles of a tube of so many segments along it: vertices are rings of kSegmentsAround.
std::vector<Triangle> tubeTriangles(int segmentsAlong) {
  std::vector<Triangle> triangles;
  for (int along = 0; along < segmentsAlong; ++along)
    for (int around = 0; around < kSegmentsAround; ++around) {
      const int next = (around + 1) % kSegmentsAround;
      const auto at = [](int ring, int place) { return static_cast<std::uint32_t>(ring * kSegmentsAround + place); };
      triangles.push_back({at(along, around), at(along, next), at(along + 1, around)});
      triangles.push_back({at(along + 1, around), at(along, next), at(along + 1, next)});
    }
  return triangles;
}

/// Rings around a tube's middle line; m, world.
std::vector<Vec3> tubeVertices(const TubeItem& tube, int segmentsAlong) {
  constexpr double kStep = 1e-4;  // of the way along the tube: differences of its tangent
  std::vector<Vec3> vertices;
  for (int along = 0; along <= segmentsAlong; ++along) {
    const double s = static_cast<double>(along) / segmentsAlong;
    const Vec3 tangent =
        (tubePoint(tube, std::min(s + kStep, 1.0)) - tubePoint(tube, std::max(s - kStep, 0.0))).normalized();
    const Vec3 outwards = tubeOutwards(tube, s);
    const Vec3 u = (outwards - outwards.dot(tangent) * tangent).normalized(), v = tangent.cross(u);
    for (int around = 0; around < kSegmentsAround; ++around) {
      const double angle = 2 * std::numbers::pi * around / kSegmentsAround;
      vertices.push_back(tubePoint(tube, s) + tube.wireRadius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  return vertices;
}

std::vector<Vec3> placed(const std::vector<Vec3>& vertices, const RigidTransform& worldFromMesh) {
  const Mat3 turn = worldFromMesh.rotation.toRotationMatrix();
  std::vector<Vec3> world;
  world.reserve(vertices.size());
  for (const Vec3& vertex : vertices) world.push_back(turn * vertex + worldFromMesh.translation);
  return world;
}

}  // namespace

SurfaceSource::SurfaceSource(const Scene& scene, const View& view)
    : scene_(scene),
      view_(view),
      appearance_(makeAppearance(scene, view, 1)),
      ropeTriangles_(tubeTriangles(kRopeSegments)) {
  for (int turns = 0; turns <= kMaxCoilTurns; ++turns)
    coilTriangles_.push_back(tubeTriangles(turns * kSegmentsPerTurn));
}

std::vector<SeenSurface> SurfaceSource::at(const Frame& frame, const Vec3& viewpoint) const {
  const std::vector<RigidTransform> places = placeBodies(scene_, frame);
  std::vector<SeenSurface> surfaces;
  for (std::size_t body = 0; body < places.size(); ++body) appendBody(body, places[body], viewpoint, surfaces);
  appendLinks(places, surfaces);
  return surfaces;
}

void SurfaceSource::appendBody(std::size_t body, const RigidTransform& worldFromBody, const Vec3& viewpoint,
                               std::vector<SeenSurface>& surfaces) const {
  const Shape& shape = scene_.bodies[body].shape;
  const BodyAppearance& look = appearance_.bodies[body];
  SeenSurface surface{static_cast<int>(body), {}, worldFromBody, {}};
  const auto takeTriangles = [&](int index, const RigidTransform& worldFromMesh) {
    const DrawnMesh& mesh = appearance_.meshes[static_cast<std::size_t>(index)];
    surface.shape = WorldTriangles{placed(mesh.vertices, worldFromMesh), &mesh.triangles};
  };
  if (look.isDrawnAsSphere) {
    surface.worldFromShape.translation = worldFromBody * look.sphere->center;
    surface.shape = Sphere{look.sphere->radius};
  } else if (look.cylinder) {
    surface.shape = *look.cylinder;
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    surface.shape = *capsule;
  } else if (const auto* plane = std::get_if<Plane>(&shape)) {
    const std::optional<MeshItem> wall = wallOf(scene_, appearance_, view_, body, viewpoint);
    const bool isSeen = (worldFromBody.rotation * plane->normal).dot(viewpoint - worldFromBody.translation) > 0;
    if (!isSeen) return;
    if (wall)
      takeTriangles(wall->mesh, wall->worldFromMesh);
    else
      surface.shape = *plane;
  } else if (!look.parts.empty()) {
    takeTriangles(look.parts[0].mesh, worldFromBody);
  }
  surfaces.push_back(std::move(surface));
}

void SurfaceSource::appendLinks(const std::vector<RigidTransform>& places, std::vector<SeenSurface>& surfaces) const {
  DrawList list;
  cradle::appendLinks(scene_, appearance_, view_, places, list);
  for (const SphereItem& item : list.spheres)
    surfaces.push_back({kWorld, item.link, {Quat::Identity(), item.center}, Sphere{item.radius}});
  for (const CylinderItem& item : list.cylinders)
    surfaces.push_back({kWorld,
                        item.link,
                        {rotationBetween(Vec3::UnitY(), item.axis), item.center},
                        Cylinder{item.radius, item.length}});
  for (const TubeItem& item : list.tubes) surfaces.push_back(tubeOf(item));
}

SeenSurface SurfaceSource::tubeOf(const TubeItem& tube) const {
  const bool isCoil = tube.turns > 0;
  const int segments = isCoil ? tube.turns * kSegmentsPerTurn : kRopeSegments;
  const auto* triangles = isCoil ? &coilTriangles_[static_cast<std::size_t>(tube.turns)] : &ropeTriangles_;
  return {kWorld, tube.link, {}, WorldTriangles{tubeVertices(tube, segments), triangles}};
}

}  // namespace cradle
