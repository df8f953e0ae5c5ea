#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulate/assembly.h"
#include "study/study_method.h"
#include "trajectory/trajectory.h"

namespace cradle {

enum class RunStatus { ok, unstable, failed };

/// What one run of a scene showed. Without a meaning unless `status` is ok: all but status, setting and message.
struct StudyRun {
  RunStatus status = RunStatus::ok;
  double setting = 0;          // time step in s, or accuracy
  std::string message;         // why it is not ok
  std::vector<BodyState> end;  // states of the dynamic bodies at the end
  RunCost cost;
  double energyDrift = 0, constraintDrift = 0, penetration = 0;  // as DriftMeter has them; NaN if energy is not known
};

/// A scene that is run again and again.
class StudyScene {
 public:
  /// Throws Error(scene) if no method can simulate the scene.
  explicit StudyScene(Scene scene);
  StudyScene(const StudyScene&) = delete;
  StudyScene& operator=(const StudyScene&) = delete;

  /// What the scene has that the method's engine cannot simulate at all ("ropes"); empty for our own.
  std::string missingIn(const StudyMethod& method) const;

  double duration() const { return scene_.duration; }
  const std::string& name() const { return scene_.name; }

  /// Natural frequency (rad/s) of the fastest spring at the start, 0 without springs.
  double fastestFrequency() const;

  /// Goes to the end once, for drifts at 16 frames and the end; then, if that is short, some times more without frames
  /// on the way, for the least CPU time. Fails if it takes more than `cpuLimit` (s). Throws Error(interrupted) alone.
  StudyRun run(const StudyMethod& method, double setting, double cpuLimit);

  /// The least CPU time (s) of some more of the short runs, for one that took `cpuSeconds`. Nothing if it was long, and
  /// exact enough.
  std::optional<double> costInAnotherTurn(const StudyMethod& method, double setting, double cpuSeconds);

 private:
  std::optional<RunCost> leastCost(const StudyMethod& method, double setting, double cpuLimit);
  StudyRun runOnce(const StudyMethod& method, double setting, long frames, double cpuLimit);

  Scene scene_;
  Assembly assembly_;
};

}  // namespace cradle
