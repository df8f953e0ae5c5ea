#pragma once

#include "scene/scene.h"

namespace cradle {

/// The camera that a scene names, as it moves with the frames of its trajectory. Each camera follows from the frames up
/// to its own, by closed forms between them: nothing depends on which of them are drawn.
class CameraPath {
 public:
  /// The scene must name a camera, and outlive this object.
  explicit CameraPath(const Scene& scene);

  /// The camera of the next frame, beginning with the first: `worldFromBody` as placeBodies() says. Throws Error(scene)
  /// if it is inside a body, at its target, or looks along its up vector. O(bodies), and O(triangles) of models that it
  /// is close to.
  Camera next(double time, const std::vector<RigidTransform>& worldFromBody);

 private:
  void follow(double time, const Vec3& leader);
  void requireUsable(const Camera& camera, double time, const std::vector<RigidTransform>& worldFromBody) const;

  const Scene& scene_;
  const CameraMotion& motion_;
  std::vector<Bounds> localBounds_;  // of every body
  bool hasStarted_ = false;
  double time_ = 0;               // s, of the frame before
  Vec3 leaderStart_, leader_;     // m, world: of the body that is followed
  Vec3 behind_;                   // m, from the end of the spring to the body
  Vec3 velocity_ = Vec3::Zero();  // m/s, of the end of the spring
};

/// Throws Error(scene) if the scene names a camera that cannot be used at its start.
void requireUsableCamera(const Scene& scene);

}  // namespace cradle
