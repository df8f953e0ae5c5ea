#pragma once

#include <memory>
#include <string>

#include "commands/running_simulation.h"
#include "scene/scene.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// The trajectory that a command draws: a file, or a scene that is simulated beside the drawing into a temporary file,
/// which goes with the object.
class TrajectorySource {
 public:
  /// Opens the trajectory, or loads the scene, with its warnings on stderr.
  TrajectorySource(const std::string& sceneOrTrajectory, bool quiet);
  ~TrajectorySource();
  TrajectorySource(const TrajectorySource&) = delete;
  TrajectorySource& operator=(const TrajectorySource&) = delete;

  /// Starts the simulation if there is one to run; to be called before anything but the scene and counts is asked for.
  void start();

  /// The scene as the trajectory holds it: its text, with the meshes of the file.
  const Scene& scene() const { return scene_; }

  /// Of the whole trajectory, whether or not they are simulated.
  long frameCount() const { return frameCount_; }

  /// Number of pictures: frames 0..N-1, at least one.
  long pictureCount() const;

  /// Frame `number` of 0..frameCount()-1, in any order: waits until it is simulated. Throws what ended the simulation
  /// before its time, as soon as it has.
  Frame frame(long number) const;

  /// Waits for the end of the simulation, with its progress and warnings on stderr. Throws as frame() does.
  void waitForEnd() const;

  /// Whether all is simulated.
  bool isComplete() const { return !simulation_ || simulation_->isFinished(); }

  /// Warnings of the simulation since the last call.
  std::vector<std::string> takeWarnings() const;

  /// All frames and events are there after waitForEnd().
  const TrajectoryReader& reader() const { return simulation_ ? simulation_->reader() : *ownReader_; }

 private:
  bool quiet_;
  Scene scene_;
  long frameCount_ = 0;
  std::string temporary_;                          // path, or empty
  std::unique_ptr<RunningSimulation> simulation_;  // null for a trajectory
  std::unique_ptr<TrajectoryReader> ownReader_;    // null for a scene
};

}  // namespace cradle
