#pragma once

#include <string>
#include <vector>

#include "commands/glb_meshes.h"

namespace cradle {

/// Puts joints into a GlbFile as pictures show them: the pin of a hinge, the rail and the sleeve of a slider, balls of
/// ball joints and welds, and arms to joints that are outside of their bodies. All are parts of the nodes of bodies.
class GlbJoints {
 public:
  /// `nodes` has the node of each body, at the body's centre of mass if it moves; kNoParent for planes. Of a rod that
  /// is drawn beside them, `radius` (m) is the radius. All must outlive this object.
  GlbJoints(const Scene& scene, const std::vector<int>& nodes, double radius, GlbFile& file, GlbMeshes& meshes);

  /// Adds everything but rails.
  void add();

  /// To be told each frame, and then to add rails, which reach as far as their sleeves have gone.
  void follow(const Frame& frame);
  void addRails();

 private:
  void addBar(const std::string& name, int body, const Vec3& from, const Vec3& to, double radius, bool isDark = true);
  void addBall(const Anchor& anchor, const std::string& name, double radius);
  void addArms(const Anchor& a, const Anchor& b, const std::string& name, double radius);
  int addPart(const std::string& name, int body, const RigidTransform& bodyFromPart, const Vec3& scale);

  const Scene& scene_;
  const std::vector<int>& nodes_;
  const double radius_;
  GlbFile& file_;
  GlbMeshes& meshes_;
  int darkCylinder_ = -1, cylinder_ = -1, ball_ = -1;
  std::vector<double> least_, most_;  // m, coordinates of sliders so far
};

}  // namespace cradle
