#pragma once

#include "mesh/load_mesh.h"

namespace cradle {

/// Closes a surface that is open at small holes alone, solid and drawn mesh alike, and notes how many and how large
/// they were. There is one way to do so if every hole is a ring of edges of its own that is less than a twentieth of
/// the mesh across, nearly flat, and does not cross itself; if one is not, the surface is left as it is. Faces of the
/// filling are flat, and of the material of the last triangle. O(n log n).
void fillHoles(LoadedModel& loaded);

}  // namespace cradle
