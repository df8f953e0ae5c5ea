#pragma once

#include <vector>

#include "scene/scene.h"
#include "simulate/events/event_log.h"

namespace cradle {

/// When the pushes of a scene begin and end, and where their rays hit.
class PushSchedule {
 public:
  /// Keeps references to all three. `sceneBodies`: scene body of each moving body, ascending.
  PushSchedule(const Scene& scene, const std::vector<int>& sceneBodies, EventLog& log);

  /// The next time (s) at which a push begins or ends, later than the last call of apply; infinite if none. No step may
  /// go beyond it.
  double nextChange() const;

  /// Puts the pushes that act from `time` on into `acting`. Returns the moving bodies on which one begins or ends.
  std::vector<int> apply(double time, const VectorX& state, std::vector<PushForce>& acting);

 private:
  struct Planned {
    const Push* push;
    int body;  // moving
    bool isActing = false, isOver = false;
    PushForce force;
  };
  bool begin(Planned& planned, double time, const VectorX& state);

  const Scene& scene_;
  EventLog& log_;
  std::vector<Planned> planned_;
};

}  // namespace cradle
