#pragma once

#include <vector>

#include "render/draw_list.h"

namespace cradle {

/// The middle line of a tube as tube.vert draws it, at a share `s` of the way from start to end; m, world.
Vec3 tubePoint(const TubeItem& tube, double s);

/// A unit vector that turns along the tube with the turns of its coil, and is never along its middle line.
Vec3 tubeOutwards(const TubeItem& tube, double s);

/// Points whose convex hull contains a rope's middle line; m, world.
std::vector<Vec3> ropeCorners(const TubeItem& rope);

/// Lets a rope of a length (m) hang between its ends along the unit vector `down`: a catenary, or nearly one where the
/// ends are one below the other. For a length below the distance of the ends, straight.
void hangRope(double length, const Vec3& down, TubeItem& rope);

/// Winds a spring's wire of a length (m) into its turns, no narrower than `narrowest` (m). Returns the length that is
/// drawn: longer for a spring that is pulled beyond that.
double windCoil(double wireLength, double narrowest, TubeItem& coil);

}  // namespace cradle
