#include "simulate/strict_watch.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace cradle {

StrictWatch::StrictWatch(const Scene& scene, const Plan& plan) : scene_(scene), overlaps_(scene, plan) {}

void StrictWatch::note(const PromiseEnd& end) {
  faults_.push_back({end.time, fmt::format("at {:.6g} s the accuracy asked was given up: {} ({})", end.time, end.reason,
                                           namesOfBodies(end.bodies, scene_))});
}

void StrictWatch::note(const Correction& correction) {
  faults_.push_back({correction.time, describe(correction, scene_)});
}

void StrictWatch::check(const Frame& frame) {
  const std::optional<Overlap> worst = overlaps_.worstOf(frame);
  if (worst && worst->depth > worst->allowed) faults_.push_back({frame.time, describe(*worst, scene_)});
  tellOfFirst(frame.time);  // steps go beyond the frame: what comes later is told with the frame that shows it
}

void StrictWatch::tellOfFirst(double until) const {
  const auto first =
      std::min_element(faults_.begin(), faults_.end(), [](const Fault& a, const Fault& b) { return a.time < b.time; });
  if (first != faults_.end() && first->time <= until) throw Error(ErrorKind::unstable, "", "strict: " + first->text);
}

}  // namespace cradle
