#pragma once

#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Five metal balls on rods under a frame, the first drawn aside; and a few coloured balls on the ground.
Scene makeCradleScene();

/// A box that hangs by a corner from a spring, without ground.
Scene makeSpringScene();

/// The state that a scene starts in.
Frame startFrame(const Scene& scene);

}  // namespace cradle
