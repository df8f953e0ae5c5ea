#pragma once

#include <vector>

#include "render/drawn_hull.h"
#include "render/gpu_mesh.h"
#include "render/instances.h"
#include "render/tile_mask.h"

namespace cradle {

/// Where instances stand in the picture or in the shadow map; pixels or texels.
struct SeenItems {
  std::vector<PixelRectangle> meshes, spheres, cylinders, tubes;
  std::vector<std::vector<PixelRectangle>> meshRuns;  // of each mesh of more than one run of triangles
};

/// The items of one draw list on the side of OpenGL: their triangles, and where each is seen. Needs a current context.
class ItemDrawer {
 public:
  /// `appearance` and `stage` must outlive this object.
  ItemDrawer(const Appearance& appearance, const Stage& stage);

  /// Takes a picture's items; `meshBounds` as in changedArea.
  void take(const DrawList& list, const std::vector<MeshBounds>& meshBounds);

  const SeenItems& inPicture() const { return inPicture_; }
  const SeenItems& inShadowMap() const { return inShadowMap_; }

  /// Draws with the program in use what is seen in `area`; walls apart.
  void drawMeshes(const SeenItems& seen, const PixelRectangle& area) const;
  void drawWalls() const;
  void drawSpheres(const SeenItems& seen, const PixelRectangle& area) const;
  void drawCylinders(const SeenItems& seen, const PixelRectangle& area) const;
  void drawTubes(const SeenItems& seen, const PixelRectangle& area) const;

  /// Squares of the contact map.
  void drawContacts() const;

  const PackedDrawList& packed() const { return packed_; }

 private:
  template <typename Place>
  void findSeen(const DrawList& list, const std::vector<MeshBounds>& meshBounds, const Place& place,
                SeenItems& seen) const;
  void drawMesh(const Batch& batch, std::size_t instance, const SeenItems& seen, const PixelRectangle& area) const;
  void leaveOutHidden(const DrawList& list, const std::vector<MeshBounds>& meshBounds);

  const Appearance& appearance_;
  const Stage& stage_;
  InstanceBuffer meshInstances_, wallInstances_, sphereInstances_, cylinderInstances_, tubeInstances_,
      contactInstances_;
  std::vector<GpuMesh> meshes_, halfBalls_, halfCylinders_;
  GpuMesh coilMesh_, ropeMesh_, square_;
  PackedDrawList packed_;
  SeenItems inPicture_, inShadowMap_;
  std::vector<double> radiusInside_;  // m, by mesh: of a ball around the middle of its bounds that it contains, or 0
};

}  // namespace cradle
