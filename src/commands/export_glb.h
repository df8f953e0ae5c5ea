#pragma once

#include <string>

#include "trajectory/trajectory_file.h"

namespace cradle {

/// Writes a trajectory as glTF 2.0 in its binary form, for viewers and Blender. Every body is a node of its name, a
/// dynamic one at its centre of mass, with one animation over the frames in simulated time. Planes are squares much
/// wider than the scene; springs, rods and ropes are straight cylinders between their ends; the camera is that of
/// pictures, and moves as it does; pushes are left out. FILE is replaced when all is written; states are held in memory
/// meanwhile, 28 bytes each. Throws Error(output), Error(limit), Error(usage) if there is no frame or frames are too
/// close for 32-bit times, and what reading throws.
void exportGlb(TrajectoryReader reader, const std::string& path, bool quiet);

}  // namespace cradle
