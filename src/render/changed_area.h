#pragma once

#include "render/drawn_hull.h"
#include "render/tile_mask.h"

namespace cradle {

/// What has to be drawn again when one draw list follows another; the rest of the picture has the same bytes.
struct ChangedArea {
  TileMask picture;
  std::optional<PixelRectangle> shadows;  // texels of the shadow map; none if nothing that throws a shadow moved
  bool contactShadowsChanged = false;     // something that darkens the ground did
};

/// `meshBounds` are those of Appearance::meshes. Contains all that differs in looks, and what
/// its shadows, its mirror images and its darkening of what is near may touch, before and now. O(changed items x
/// items).
ChangedArea changedArea(const DrawList& before, const DrawList& now, const RenderSetup& setup,
                        const std::vector<MeshBounds>& meshBounds);

/// All of a picture, and its maps.
ChangedArea wholePicture(const RenderSetup& setup);

}  // namespace cradle
