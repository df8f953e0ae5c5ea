#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// The trajectory that a command draws: a file, or a scene simulated now into a temporary file that goes with the
/// object.
class TrajectorySource {
 public:
  TrajectorySource(const std::string& sceneOrTrajectory, bool quiet);
  ~TrajectorySource();
  TrajectorySource(const TrajectorySource&) = delete;
  TrajectorySource& operator=(const TrajectorySource&) = delete;

  const TrajectoryReader& reader() const { return *reader_; }

  /// The scene as the trajectory holds it: its text, with the meshes of the file.
  const Scene& scene() const { return scene_; }

  /// Number of pictures: frames 0..N-1, at least one.
  long pictureCount() const;

 private:
  void simulateToTemporary(const Scene& scene, bool quiet) const;
  void removeTemporary() const;

  std::string temporary_;  // path, or empty
  std::optional<TrajectoryReader> reader_;
  Scene scene_;
};

}  // namespace cradle
