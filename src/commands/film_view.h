#pragma once

#include "commands/trajectory_source.h"
#include "render/framing.h"

namespace cradle {

/// The one view of a whole film, from all of its frames; sizes in pixels.
View viewOf(const TrajectorySource& source, int width, int height);

}  // namespace cradle
