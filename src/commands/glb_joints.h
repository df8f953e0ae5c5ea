#pragma once

#include <vector>

#include "commands/glb_meshes.h"
#include "film/joint_parts.h"

namespace cradle {

/// Puts joints into a GlbFile; all are parts of the nodes of bodies.
class GlbJoints {
 public:
  /// `nodes` has the node of each body, at the body's centre of mass if it moves; kNoParent for planes. Of a rod that
  /// is drawn beside them, `radius` (m) is the radius. All must outlive this object.
  GlbJoints(const Scene& scene, const std::vector<int>& nodes, double radius, GlbFile& file, GlbMeshes& meshes);

  /// Adds everything but rails.
  void add();

  /// To be told each frame, and then to add rails.
  void follow(const Frame& frame) { include(frame, scene_, reach_); }
  void addRails();

 private:
  void add(const JointPart& part);

  const Scene& scene_;
  const std::vector<int>& nodes_;
  const double radius_;
  GlbFile& file_;
  int bar_ = -1, rail_ = -1, ball_ = -1;  // meshes
  SliderReach reach_;
};

}  // namespace cradle
