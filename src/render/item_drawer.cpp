#include "render/item_drawer.h"

#include <GL/glew.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/occlusion_culling.h"
#include "render/shadow_casters.h"

namespace cradle {
namespace {

constexpr double kBoxMargin = 2;  // pixels: samples lie beside centres, and rounding

/// The pixels in which a hull may be seen: all, if it is not wholly in front of the camera.
PixelRectangle seenIn(const DrawnHull& hull, const RenderSetup& setup) {
  const auto outline = outlineOf(hull, setup);
  if (!outline) return {0, 0, setup.width, setup.height};
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : *outline) box.extend(point);
  const auto pixel = [](double place, int size) {
    return static_cast<int>(std::floor(std::clamp(place, -kBoxMargin, size + kBoxMargin)));
  };
  return {pixel(box.min().x() - kBoxMargin, setup.width), pixel(box.min().y() - kBoxMargin, setup.height),
          pixel(box.max().x() + kBoxMargin, setup.width) + 1, pixel(box.max().y() + kBoxMargin, setup.height) + 1};
}

bool isSeenIn(const PixelRectangle& seen, const PixelRectangle& area) {
  return seen.left < area.right && seen.right > area.left && seen.bottom < area.top && seen.top > area.bottom;
}

bool isInside(const PixelRectangle& seen, const PixelRectangle& area) {
  return seen.left >= area.left && seen.right <= area.right && seen.bottom >= area.bottom && seen.top <= area.top;
}

/// Of the sphere around the middle of its bounds that fits into a closed mesh, if it fills them as a box does: else 0.
double radiusInside(const DrawnMesh& mesh) {
  constexpr double kFull = 1 - 1e-9;
  const Bounds bounds = boundsOf(mesh, true).whole;
  double volume = 0;  // signed tetrahedra from a corner
  for (const auto& [a, b, c] : mesh.triangles)
    volume += (mesh.vertices[a] - bounds.min())
                  .dot((mesh.vertices[b] - bounds.min()).cross(mesh.vertices[c] - bounds.min())) /
              6;
  return volume >= kFull * bounds.volume() ? bounds.sizes().minCoeff() / 2 : 0;
}

double nearestDepth(const DrawnHull& hull, const OcclusionCulling& occlusion) {
  constexpr double kOutermost = 1.06;  // of a radius: corners of polygons that stand for circles
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.count; ++i) nearest = std::min(nearest, occlusion.depthOf(hull.centers[i]));
  return nearest - kOutermost * hull.radius;
}

/// Calls draw(first, count) for each run of instances in [first, first + count) that are seen in `area`.
template <typename Draw>
void forSeen(const std::vector<PixelRectangle>& seen, std::size_t first, std::size_t count, const PixelRectangle& area,
             const Draw& draw) {
  const std::size_t end = first + count;
  for (std::size_t i = first; i < end; ++i) {
    if (!isSeenIn(seen[i], area)) continue;
    std::size_t last = i + 1;
    while (last < end && isSeenIn(seen[last], area)) ++last;
    draw(i, last - i);
    i = last;
  }
}

}  // namespace

ItemDrawer::ItemDrawer(const Appearance& appearance, const RenderSetup& setup)
    : appearance_(appearance),
      setup_(setup),
      white_({1, 1, {255, 255, 255}}),
      coilMesh_(makeTube(kMaxCoilTurns * kSegmentsPerTurn, kSegmentsAround)),
      ropeMesh_(makeTube(kRopeSegments, kSegmentsAround)),
      square_({-1, -1, 1, -1, 1, 1, -1, 1}, 2, {0, 1, 2, 0, 2, 3}) {
  for (std::size_t i = 0; i < appearance.meshes.size(); ++i) {
    meshes_.emplace_back(appearance.meshes[i]);
    radiusInside_.push_back(appearance.meshIsClosed[i] ? radiusInside(appearance.meshes[i]) : 0);
  }
  for (const DrawnTexture& texture : appearance.textures) textures_.emplace_back(texture.pixels);
  for (const int outline : kOutlines) {
    halfSpheres_.push_back(makeHalfSphere(outline));
    halfCylinders_.push_back(makeHalfCylinder(outline));
  }
}

void ItemDrawer::take(const DrawList& list, const std::vector<MeshBounds>& meshBounds) {
  packed_ = pack(list, setup_);
  meshInstances_.upload(packed_.meshInstances);
  wallInstances_.upload(packed_.wallInstances);
  sphereInstances_.upload(packed_.sphereInstances);
  cylinderInstances_.upload(packed_.cylinderInstances);
  tubeInstances_.upload(packed_.tubeInstances);
  contactShadowInstances_.upload(packed_.contactShadowInstances);
  findSeen(
      list, meshBounds, [&](const DrawnHull& hull) { return seenIn(hull, setup_); }, inPicture_);
  leaveOutHidden(list, meshBounds);
  const auto inLight = [&](DrawnHull hull) {
    hull.radius *= cornerOfEqualArea(kOutlines.front());  // rounds are drawn as polygons
    return shadowTexels(hull, setup_);
  };
  findSeen(list, meshBounds, inLight, inShadowMap_);
}

template <typename Place>
void ItemDrawer::findSeen(const DrawList& list, const std::vector<MeshBounds>& meshBounds, const Place& place,
                          SeenItems& seen) const {
  for (auto* items : {&seen.meshes, &seen.spheres, &seen.cylinders, &seen.tubes}) items->clear();
  seen.meshRuns.assign(list.meshes.size(), {});
  for (std::size_t i = 0; i < list.meshes.size(); ++i) {
    const MeshItem& item = list.meshes[i];
    const MeshBounds& bounds = meshBounds[static_cast<std::size_t>(item.mesh)];
    seen.meshes.push_back(place(hullOf(bounds.whole, item.worldFromMesh)));
    if (item.triangleCount <= kTrianglesPerRun) continue;
    const std::uint32_t last = item.firstTriangle + item.triangleCount - 1;
    for (std::uint32_t run = item.firstTriangle / kTrianglesPerRun; run <= last / kTrianglesPerRun; ++run)
      seen.meshRuns[i].push_back(place(hullOf(bounds.runs[run], item.worldFromMesh)));
  }
  for (const std::size_t i : packed_.sphereItems) seen.spheres.push_back(place(hullOf(list.spheres[i])));
  for (const std::size_t i : packed_.cylinderItems) seen.cylinders.push_back(place(hullOf(list.cylinders[i])));
  for (const TubeItem& item : list.tubes) seen.tubes.push_back(place(hullOf(item)));
}

/// Meshes and spheres that spheres stand before are seen nowhere in the picture.
void ItemDrawer::leaveOutHidden(const DrawList& list, const std::vector<MeshBounds>& meshBounds) {
  OcclusionCulling occlusion(setup_);
  for (const SphereItem& item : list.spheres) occlusion.add(item.center, item.radius);
  for (const MeshItem& item : list.meshes)
    if (const double radius = radiusInside_[static_cast<std::size_t>(item.mesh)]; radius > 0)
      occlusion.add(item.bounds.center(), radius);
  const auto leaveOut = [&](const DrawnHull& hull, PixelRectangle& pixels) {
    if (occlusion.hides(pixels, nearestDepth(hull, occlusion))) pixels = {};
  };
  for (std::size_t i = 0; i < list.meshes.size(); ++i) {
    const MeshItem& item = list.meshes[i];
    leaveOut(hullOf(meshBounds[static_cast<std::size_t>(item.mesh)].whole, item.worldFromMesh), inPicture_.meshes[i]);
  }
  for (std::size_t i = 0; i < packed_.sphereItems.size(); ++i)
    leaveOut(hullOf(list.spheres[packed_.sphereItems[i]]), inPicture_.spheres[i]);
}

/// Of one mesh, the runs of triangles that are seen.
void ItemDrawer::drawMesh(const Batch& batch, std::size_t instance, const SeenItems& seen,
                          const PixelRectangle& area) const {
  const std::uint32_t begin = batch.firstTriangle, end = begin + batch.triangleCount;
  const std::uint32_t firstRun = begin / kTrianglesPerRun * kTrianglesPerRun;
  const auto triangleOf = [&](std::size_t run) {
    return std::clamp(firstRun + static_cast<std::uint32_t>(run) * kTrianglesPerRun, begin, end);
  };
  const std::vector<PixelRectangle>& runs = seen.meshRuns[instance];
  forSeen(runs, 0, runs.size(), area, [&](std::size_t first, std::size_t count) {
    const std::uint32_t triangle = triangleOf(first);
    meshes_[static_cast<std::size_t>(batch.mesh)].draw(triangle, triangleOf(first + count) - triangle, meshInstances_,
                                                       instance, 1);
  });
}

void ItemDrawer::drawMeshes(const SeenItems& seen, const PixelRectangle& area) const {
  for (const Batch& batch : packed_.meshBatches) {
    const auto mesh = static_cast<std::size_t>(batch.mesh);
    textureOf(batch).bind(kColorUnit);
    if (appearance_.meshIsClosed[mesh]) glEnable(GL_CULL_FACE);
    forSeen(seen.meshes, batch.firstInstance, batch.instanceCount, area, [&](std::size_t first, std::size_t count) {
      if (count == 1 && !seen.meshRuns[first].empty() && !isInside(seen.meshes[first], area))
        drawMesh(batch, first, seen, area);
      else
        meshes_[mesh].draw(batch.firstTriangle, batch.triangleCount, meshInstances_, first, count);
    });
    glDisable(GL_CULL_FACE);
  }
  white_.bind(kColorUnit);
}

const GpuTexture& ItemDrawer::textureOf(const Batch& batch) const {
  return batch.texture < 0 ? white_ : textures_[static_cast<std::size_t>(batch.texture)];
}

void ItemDrawer::drawWalls() const {
  if (packed_.wallInstances.empty()) return;
  const GpuMesh& wall = meshes_[static_cast<std::size_t>(appearance_.wallMesh)];
  wall.draw(0, wall.triangleCount(), wallInstances_, 0, packed_.wallInstances.size());
}

void ItemDrawer::drawSpheres(const SeenItems& seen, const PixelRectangle& area) const {
  for (const Batch& batch : packed_.sphereBatches) {
    const GpuMesh& mesh = halfSpheres_[static_cast<std::size_t>(batch.mesh)];
    forSeen(seen.spheres, batch.firstInstance, batch.instanceCount, area, [&](std::size_t first, std::size_t count) {
      mesh.draw(0, mesh.triangleCount(), sphereInstances_, first, count);
    });
  }
}

void ItemDrawer::drawCylinders(const SeenItems& seen, const PixelRectangle& area) const {
  for (const Batch& batch : packed_.cylinderBatches) {
    const GpuMesh& mesh = halfCylinders_[static_cast<std::size_t>(batch.mesh)];
    forSeen(seen.cylinders, batch.firstInstance, batch.instanceCount, area, [&](std::size_t first, std::size_t count) {
      mesh.draw(0, mesh.triangleCount(), cylinderInstances_, first, count);
    });
  }
}

void ItemDrawer::drawTubes(const SeenItems& seen, const PixelRectangle& area) const {
  // Springs stand before ropes in the list.
  std::size_t coils = 0;
  while (coils < packed_.tubeInstances.size() && packed_.tubeInstances[coils][11] > 0) ++coils;
  const auto draw = [&](const GpuMesh& mesh, std::size_t begin, std::size_t size) {
    forSeen(seen.tubes, begin, size, area, [&](std::size_t first, std::size_t count) {
      mesh.draw(0, mesh.triangleCount(), tubeInstances_, first, count);
    });
  };
  draw(coilMesh_, 0, coils);
  draw(ropeMesh_, coils, packed_.tubeInstances.size() - coils);
}

void ItemDrawer::drawContactShadows() const {
  const std::size_t count = packed_.contactShadowInstances.size();
  if (count > 0) square_.draw(0, 2, contactShadowInstances_, 0, count);
}

}  // namespace cradle
