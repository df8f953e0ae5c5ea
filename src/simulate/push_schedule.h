#pragma once

#include <vector>

#include "scene/scene.h"
#include "simulate/assembly.h"
#include "simulate/events/event_log.h"

namespace cradle {

/// When the pushes of an island begin and end, and where their rays hit.
class PushSchedule {
 public:
  /// Keeps references to `scene` and `log`. O(n log n) of n pushes of the island.
  PushSchedule(const Scene& scene, const Assembly& assembly, EventLog& log);

  /// The next time (s) at which a push begins or ends, later than the last call of apply; infinite if none. No step may
  /// go beyond it. O(1): every step asks.
  double nextChange() const { return nextChange_; }

  /// Those that act at a time (s) that is not later than the last call of apply.
  std::vector<StartedPush> startedBy(double time) const;

  /// The forces of those that act now.
  std::vector<PushForce> forces() const;

  /// Puts the pushes that act from `time` on into `acting`. Returns the moving bodies on which one begins or ends.
  /// O(pushes that act).
  std::vector<int> apply(double time, const VectorX& state, std::vector<PushForce>& acting);

 private:
  struct Planned {
    double end() const { return push->start + push->duration; }  // s

    const Push* push;
    int body;  // moving
    PushForce force;
    bool hasBegun = false;
  };
  void plan(std::size_t index, const Assembly& assembly);
  static PushForce forceOf(const Push& push, int body, const Vec3& point);
  bool begin(Planned& planned, double time, const VectorX& state);
  std::vector<std::size_t> takeDue(double time);
  void findNextChange();

  const Scene& scene_;
  EventLog& log_;
  std::vector<Planned> planned_;      // in the order of the scene
  std::vector<std::size_t> waiting_;  // of planned_, from the last to begin to the first
  std::vector<std::size_t> acting_;   // of planned_, ascending
  double nextChange_ = 0;             // s
};

}  // namespace cradle
