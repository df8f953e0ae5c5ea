#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "simulate/assembly.h"

namespace cradle {

/// What is turned to make a method more exact.
enum class SettingKind { timeStep, accuracy };

/// A scene in another engine, on its way from time 0.
class PeerWorld {
 public:
  virtual ~PeerWorld() = default;

  /// Goes on to `time` (s), or to the first step that reaches it. Throws Error(unstable) or Error(limit) if the engine
  /// says that it cannot.
  virtual void advance(double time) = 0;

  /// Poses and velocities now, in the layout of the assembly's state.
  virtual void read(VectorX& state) = 0;

  /// Of the right-hand side, so far; of an engine that has one a step, its steps.
  virtual long evaluations() const = 0;
};

/// A scene in an engine that goes by a fixed time step.
class SteppedWorld : public PeerWorld {
 public:
  explicit SteppedWorld(double timeStep, long evaluationsPerStep = 1);

  void advance(double time) final;
  long evaluations() const final { return steps_ * evaluationsPerStep_; }

 protected:
  double timeStep() const { return timeStep_; }

  /// Time (s) at the start of the step under way, and at its end.
  double time() const { return static_cast<double>(steps_) * timeStep_; }
  double endTime() const { return static_cast<double>(steps_ + 1) * timeStep_; }

 private:
  virtual void step() = 0;

  double timeStep_;  // s
  long evaluationsPerStep_, steps_ = 0;
};

/// One way to set up an engine that studies compare with.
struct Peer {
  std::string engine, version;  // "ode", "0.16.2"
  std::string name;             // of the method, in study.csv and --methods
  std::string title;            // in charts
  std::string configuration;    // what was set, in words
  SettingKind setting = SettingKind::timeStep;

  /// What the scene has that is not translated for the engine ("ropes"); empty if it can be simulated.
  std::function<std::string(const Scene&, const Assembly&)> missingIn;
  /// The scene must have nothing that is missing. `assembly` is the whole scene's; the world may keep a reference to
  /// both.
  std::function<std::unique_ptr<PeerWorld>(const Scene&, const Assembly&, double setting)> open;
};

/// All that the program was built with (CRADLE_PEERS), engine by engine; none without.
const std::vector<Peer>& peers();

}  // namespace cradle
