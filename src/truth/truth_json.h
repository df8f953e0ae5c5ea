#pragma once

#include <map>
#include <string>
#include <vector>

#include "trajectory/trajectory.h"
#include "truth/passes.h"

// The files beside passes. Lengths in m, angles in rad, SI units; numbers have as many digits as give the same bits.

namespace cradle {

/// A segmentation pass with its size in pixels.
struct Segmentation {
  const std::vector<std::uint16_t>& ids;
  int width, height;
};

/// COCO's run lengths of the pixels with an id: column by column, beginning with those that have another. By id.
std::map<std::uint16_t, std::vector<long>> runLengths(const Segmentation& segmentation);

/// A frame's camera, in the world of the scene.
struct FrameCamera {
  long frame = 0;
  double time = 0;  // s
  Pinhole pinhole;
};

/// `camera.json`: of each frame K, and worldFromCamera for OpenGL's axes (x right, y up, z back) and OpenCV's.
std::string cameraJson(const std::vector<FrameCamera>& cameras);

/// `truth.json`: the trajectory that a film was drawn from, a path from the film's folder on or absolute, and the hash
/// of its states.
std::string originJson(const std::string& trajectory, const std::string& stateHash);

/// `events.json`: the events of the trajectory; bodies by their names, null for the world.
std::string eventsJson(const std::vector<Event>& events, const Scene& scene);

/// `instances_NUMBER.json`, in the form of COCO ("Common objects in context", T.-Y. Lin et al., ECCV 2014): the bodies
/// in the picture of a frame, with what they are and how they move. `scene` and `frame` are in the world of the scene;
/// `wholes` are those of each body.
std::string instancesJson(const Scene& scene, const Frame& frame, const std::vector<WholeExtent>& wholes,
                          const Segmentation& segmentation);

}  // namespace cradle
