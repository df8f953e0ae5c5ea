#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/drawn_hull.h"
#include "render/tile_mask.h"

namespace cradle {

/// Something drawn as before, or a part of it, on which light may change.
struct LightReceiver {
  DrawnHull hull;
  double wider = 0;                             // m, by which shading may take place beyond it
  std::optional<std::array<Vec3, 3>> triangle;  // m, world; if it is one
  std::optional<TileSpans> spans;               // of the hull in the picture, once they are asked for
};

/// Append what of an item may be seen.
void appendReceivers(const MeshItem& item, const MeshBounds& bounds, const RenderSetup& setup,
                     std::vector<LightReceiver>& receivers);
void appendReceivers(const SphereItem& item, const RenderSetup& setup, std::vector<LightReceiver>& receivers);
void appendReceivers(const CylinderItem& item, const RenderSetup& setup, std::vector<LightReceiver>& receivers);
void appendReceivers(const TubeItem& item, const RenderSetup& setup, std::vector<LightReceiver>& receivers);

}  // namespace cradle
