#pragma once

#include <vector>

#include "render/drawn_hull.h"
#include "render/gpu_mesh.h"
#include "render/gpu_texture.h"
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
  /// `appearance` and `setup` must outlive this object.
  ItemDrawer(const Appearance& appearance, const RenderSetup& setup);

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

  /// Squares of the map of contact shadows.
  void drawContactShadows() const;

  const PackedDrawList& packed() const { return packed_; }

 private:
  template <typename Place>
  void findSeen(const DrawList& list, const std::vector<MeshBounds>& meshBounds, const Place& place,
                SeenItems& seen) const;
  const GpuTexture& textureOf(const Batch& batch) const;
  void drawMesh(const Batch& batch, std::size_t instance, const SeenItems& seen, const PixelRectangle& area) const;
  void leaveOutHidden(const DrawList& list, const std::vector<MeshBounds>& meshBounds);

  const Appearance& appearance_;
  const RenderSetup& setup_;
  InstanceBuffer meshInstances_, wallInstances_, sphereInstances_, cylinderInstances_, tubeInstances_,
      contactShadowInstances_;
  std::vector<GpuMesh> meshes_, halfSpheres_, halfCylinders_;
  std::vector<GpuTexture> textures_;
  GpuTexture white_;  // of what has none
  GpuMesh coilMesh_, ropeMesh_, square_;
  PackedDrawList packed_;
  SeenItems inPicture_, inShadowMap_;
  std::vector<double> radiusInside_;  // m, by mesh: of a sphere around the middle of its bounds that it contains, or 0
};

}  // namespace cradle
