#pragma once

#include <map>
#include <optional>
#include <string>

#include "scene/scene.h"
#include "simulate/world.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// A body that meets two others within one step, of which one may be fixed: the step makes one impact of both.
struct CloseImpacts {
  double time = 0;                      // s, of the second
  int body = 0, first = 0, second = 0;  // of the scene
};

/// What a run by steps of one length, with all contact resolved once a step, makes of the scene.
struct OtherMethod {
  double timeStep = 0;     // s
  double difference = 0;   // from the finer run, in the measure of errors, as long as that means something
  double time = 0;         // s, of that
  double ownError = 0;     // what twice the step changes
  bool disagrees = false;  // the difference is more than its own error and close impacts explain
  std::optional<CloseImpacts> closeImpacts;  // that explain it: from there on the steps say nothing
  std::string failure;                       // why it ended before its time, if it did
};

/// Two runs by steps of one length, one twice as long as the other, beside a run by events. Where the two agree and
/// events do not, it is no sensitivity of the scene: the method of one of them is wrong there.
class SteppedRuns {
 public:
  explicit SteppedRuns(const Scene& scene);
  SteppedRuns(const SteppedRuns&) = delete;
  SteppedRuns& operator=(const SteppedRuns&) = delete;

  /// An event of the run by events, before the frames that come after it.
  void add(const Event& event);

  /// Compares frames with one of the run by events. `growth`: of small differences until shortly before. Throws
  /// Error(interrupted).
  void take(const Frame& frame, double growth);

  const OtherMethod& result() const { return result_; }

 private:
  template <class Action>
  void attempt(const Action& action);

  Scene fineScene_, coarseScene_;
  std::optional<World> fine_, coarse_;
  OtherMethod result_;
  std::map<int, Event> lastImpacts_;  // of each body
  std::optional<CloseImpacts> closeImpacts_;
};

}  // namespace cradle
