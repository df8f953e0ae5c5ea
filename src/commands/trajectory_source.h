#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "commands/kept_simulation.h"
#include "commands/simulate_scene.h"
#include "scene/scene.h"
#include "simulate/frame_stream.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// The scene as a trajectory holds it: its text, with the meshes of the file. Throws Error(usage) if it cannot be read,
/// or has other bodies than the file.
Scene sceneOf(const TrajectoryReader& trajectory);

/// The hash of the states of a whole trajectory file; empty if there is none that can be read, or only a part.
std::string stateHashOf(const std::string& path);

/// The trajectory that a command draws: a file; or a scene to be simulated, into a file without a name that goes with
/// the object, or beside the drawing.
class TrajectorySource {
 public:
  /// Opens the trajectory, or loads the scene with `options`, its warnings on stderr.
  TrajectorySource(const std::string& sceneOrTrajectory, bool quiet, const SceneOptions& options = {});
  /// Of a file that is open.
  TrajectorySource(TrajectoryReader trajectory, bool quiet);
  TrajectorySource(const TrajectorySource&) = delete;
  TrajectorySource& operator=(const TrajectorySource&) = delete;

  /// The scene as the trajectory holds it: its text, with the meshes of the file.
  const Scene& scene() const { return scene_; }

  /// Scene, frames and events as pictures show them: turned so that y is up.
  const Scene& drawnScene() const { return upright_ ? upright_->scene : scene_; }
  Quat worldFromDrawn() const { return upright_ ? upright_->fromWorld.conjugate() : Quat::Identity(); }
  Frame drawnFrameAt(long number);
  std::vector<Event> drawnPushEvents();
  std::vector<Event> drawnEvents() const;                         // of a whole trajectory
  std::vector<ContactWrench> drawnContactsAt(long number) const;  // the same

  /// Known before the simulation, too.
  long frameCount() const { return frameCount_; }

  /// What is simulated of a scene is kept in PATH.part while this object lives: see KeptSimulation, which throws. To be
  /// called before simulate() or simulateBeside().
  void keepAt(const std::string& path);

  /// Simulates the scene; with a trajectory there is nothing to do. To be called once, before frames are read.
  void simulate();

  /// The same, but a run that becomes unstable after its first frame is told, and taken as far as it went.
  void simulateUntilItFails();

  /// The same, but the simulation goes on while its frames are asked for, until forgetBefore(): it is as far as the
  /// latest of them. Warnings are told with the frame that they belong to, and the simulated time (s) inside a frame
  /// that takes long.
  void simulateBeside(std::function<void(const std::string&)> warn, std::function<void(double time)> reached);

  /// Throws what reading throws, or simulating.
  Frame frameAt(long number);

  /// The frames before are not asked for again.
  void forgetBefore(long number);

  /// The events of pushes that began or missed their bodies, perhaps among others. Simulates until all pushes did.
  std::vector<Event> pushEvents();

  /// Takes the frames that nobody has asked for: throws what is wrong with them.
  void finish();

  /// Needs a whole trajectory.
  const TrajectoryReader& reader() const { return *reader_; }
  bool isWhole() const { return reader_.has_value(); }

  /// Number of pictures: frames 0..N-1, at least one.
  long pictureCount() const;

 private:
  struct Upright {
    Quat fromWorld;
    Scene scene;
  };
  void open(TrajectoryReader trajectory);
  void setScene(Scene scene);
  std::vector<Event> drawn(std::vector<Event> events) const;
  void simulateKept();
  template <class Simulate>
  void simulateBy(const Simulate& simulateInto);

  bool quiet_;
  std::optional<TrajectoryReader> reader_;
  Scene scene_;
  std::optional<Upright> upright_;  // if gravity is along another axis
  long frameCount_ = 0;
  std::function<void(const std::string&)> warn_;
  std::function<void(double time)> reached_;
  std::optional<KeptSimulation> kept_;
  std::deque<Frame> waiting_;          // of the stream: those that may be asked for again, at least the latest
  std::optional<FrameStream> stream_;  // of scene_
};

}  // namespace cradle
