#pragma once

#include "mesh/load_mesh.h"

namespace cradle {

/// Turns the parts of a closed surface that are inside-out, solid and drawn mesh alike, and notes which. A part that
/// lies inside another and faces inwards is a cavity, and stays as it is; so does all of a surface that is not closed.
/// The triangles of the drawn mesh, if there is one, are those of the solid, in the same order.
void turnPartsOutwards(LoadedModel& loaded);

}  // namespace cradle
