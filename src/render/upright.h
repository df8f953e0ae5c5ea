#pragma once

#include "scene/scene.h"
#include "trajectory/trajectory.h"

// Pictures are drawn in a world whose y axis is up: the grid of the ground, the sky and the camera that is chosen.

namespace cradle {

/// Identity, unless gravity is along an axis of the world other than -y.
Quat uprightFromWorld(const Scene& scene);

/// What a scene, or a frame, an event or a contact of its trajectory, is in the upright world; driven bodies' motions
/// are left out.
Scene turned(const Quat& uprightFromWorld, Scene scene);
Frame turned(const Quat& uprightFromWorld, Frame frame);
Event turned(const Quat& uprightFromWorld, Event event);
ContactWrench turned(const Quat& uprightFromWorld, ContactWrench wrench);

}  // namespace cradle
