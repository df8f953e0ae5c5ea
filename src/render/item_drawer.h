#pragma once

#include <vector>

#include "render/drawn_hull.h"
#include "render/gpu_mesh.h"
#include "render/instances.h"
#include "render/tile_mask.h"

namespace cradle {

/// The items of one draw list on the side of OpenGL: their triangles, and where each is seen. Needs a current context.
class ItemDrawer {
 public:
  /// `appearance` and `stage` must outlive this object.
  ItemDrawer(const Appearance& appearance, const Stage& stage);

  /// Takes a picture's items; `meshBounds` as in changedArea.
  void take(const DrawList& list, const std::vector<MeshBounds>& meshBounds);

  /// Draws with the program in use what is seen in `area` of the picture, or all; walls apart.
  void drawMeshes(const PixelRectangle* area = nullptr) const;
  void drawWalls() const;
  void drawSpheres(const PixelRectangle* area = nullptr) const;
  void drawCylinders(const PixelRectangle* area = nullptr) const;
  void drawTubes(const PixelRectangle* area = nullptr) const;

  /// Squares of the contact map.
  void drawContacts() const;

  const PackedDrawList& packed() const { return packed_; }

 private:
  using Seen = std::vector<PixelRectangle>;  // by instance; empty where something stands before it
  void findSeen(const DrawList& list, const std::vector<MeshBounds>& meshBounds);

  const Appearance& appearance_;
  const Stage& stage_;
  InstanceBuffer meshInstances_, wallInstances_, sphereInstances_, cylinderInstances_, tubeInstances_,
      contactInstances_;
  std::vector<GpuMesh> meshes_, halfBalls_, halfCylinders_;
  GpuMesh coilMesh_, ropeMesh_, square_;
  PackedDrawList packed_;
  Seen seenMeshes_, seenSpheres_, seenCylinders_, seenTubes_;
  std::vector<double> radiusInside_;  // m, by mesh: of a ball around the middle of its bounds that it contains, or 0
};

}  // namespace cradle
