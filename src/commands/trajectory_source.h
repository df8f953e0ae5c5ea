#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "commands/kept_simulation.h"
#include "commands/simulate_scene.h"
#include "film/film_source.h"
#include "simulate/frame_stream.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// The hash of the states of a whole trajectory file; empty if there is none that can be read, or only a part.
std::string stateHashOf(const std::string& path);

/// The motion that a command draws: a trajectory file; or a scene to be simulated, into a file without a name that goes
/// with the object, or beside the drawing.
class TrajectorySource : public FilmSource {
 public:
  /// Opens the trajectory, or loads the scene with `options`, its warnings on stderr.
  TrajectorySource(const std::string& sceneOrTrajectory, bool quiet, const SceneOptions& options = {});

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

  Frame frameAt(long number) override;
  void forgetBefore(long number) override;
  std::vector<Event> pushEvents() override;  // simulates until all pushes began or missed their bodies

  /// Takes the frames that nobody has asked for: throws what is wrong with them.
  void finish();

 private:
  void simulateKept();
  template <class Simulate>
  void simulateBy(const Simulate& simulateInto);

  bool quiet_;
  std::function<void(const std::string&)> warn_;
  std::function<void(double time)> reached_;
  std::optional<KeptSimulation> kept_;
  std::deque<Frame> waiting_;          // of the stream: those that may be asked for again, at least the latest
  std::optional<FrameStream> stream_;  // of the scene
};

}  // namespace cradle
