#pragma once

#include <string>
#include <vector>

#include "collision/separation.h"
#include "impact/pairwise.h"
#include "simulate/assembly.h"
#include "simulate/corrections.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Collects the events of a run, in terms of the scene's bodies.
class EventLog {
 public:
  /// Keeps a reference to `assembly`.
  explicit EventLog(const Assembly& assembly) : assembly_(assembly) {}

  void recordContact(double time, EventKind kind, const Contact& contact, double impulse);
  /// Something that happens to one moving body, at `point` (m, world).
  void recordBody(double time, EventKind kind, int movingBody, const Vec3& point);

  void record(const Event& event);
  void warn(const std::string& warning) { warnings_.push_back(warning); }

  /// A correction of the motion of moving bodies beside the laws of mechanics.
  void recordCorrection(double time, CorrectionKind kind, const std::vector<int>& movingBodies, double amount);
  /// The corrections of a simultaneous impact.
  void recordFaults(double time, const std::vector<ImpactContact>& impacts, const ImpactFaults& faults);
  Corrections& corrections() { return corrections_; }

  /// The scene's bodies of the last event between two, or between one and the world; none before the first.
  const std::vector<int>& latestBodies() const { return latestBodies_; }

  /// Events since the last call, in the order in which they were recorded.
  std::vector<Event> take();
  /// Warnings since the last call.
  std::vector<std::string> takeWarnings();

 private:
  const Assembly& assembly_;
  std::vector<Event> events_;
  std::vector<int> latestBodies_;
  std::vector<std::string> warnings_;
  Corrections corrections_;
};

}  // namespace cradle
