#pragma once

#include <functional>
#include <optional>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

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

/// The camera of each frame of a film: the one that the scene names, as it moves, else one that stands still.
class FilmCamera {
 public:
  /// `frameAt` reads the frames before one that is asked for out of turn. The scene must outlive this object.
  FilmCamera(const Scene& scene, const Camera& still, std::function<Frame(long)> frameAt);

  /// Throws as CameraPath::next does. O(bodies) for the frame after the one before.
  const Camera& at(const Frame& frame);

 private:
  const Scene& scene_;
  const std::function<Frame(long)> frameAt_;
  std::optional<CameraPath> path_;
  Camera camera_;  // of frame next_ - 1
  long next_ = 0;
};

/// Throws Error(scene) if the scene names a camera that cannot be used at its start.
void requireUsableCamera(const Scene& scene);

}  // namespace cradle
