#pragma once

#include <vector>

#include "render/draw_list.h"
#include "render/drawn_hull.h"
#include "render/render_setup.h"

namespace cradle {

/// Near plane and maps for what is seen of one frame from `camera`, by that frame alone: all things that are seen, or
/// whose shadows may be, count, but for those that are larger than the shadow map, which throw their shadows where it
/// is. Places are coarse, so that few frames change them. `meshBounds` as in changedArea. O(items).
FrameLayout layoutOf(const DrawList& list, const std::vector<MeshBounds>& meshBounds, const Camera& camera,
                     const RenderSetup& setup);

/// The place nearest to home where a map holds `needed` and has `border` (of its size) beside it, as large as it has to
/// be, up to a limit; beyond that, at home.
MapPlace placeAround(const Box2& needed, const Box2& home, double border);

}  // namespace cradle
