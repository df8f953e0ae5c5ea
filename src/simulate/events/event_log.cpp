#include "simulate/events/event_log.h"

#include <algorithm>
#include <utility>

namespace cradle {

void EventLog::record(const Event& event) {
  events_.push_back(event);
  if (isOfLastingContact(event.kind)) return;
  const bool isMet = event.kind == EventKind::impact || event.kind == EventKind::taut;  // the world, by a joint or rope
  if (event.bodyB != kWorld)
    latestBodies_ = {event.bodyA, event.bodyB};
  else if (isMet)
    latestBodies_ = {event.bodyA};
}

void EventLog::recordContact(double time, EventKind kind, const Contact& contact, double impulse) {
  const auto [a, b] = bodiesOf(assembly_, assembly_.geometry.pairs[contact.pair]);
  record({time, kind, a, b, contact.point, contact.normal, impulse});
}

void EventLog::recordBody(double time, EventKind kind, int movingBody, const Vec3& point) {
  record({time, kind, assembly_.sceneBodies[static_cast<std::size_t>(movingBody)], kWorld, point, Vec3::Zero(), 0});
}

void EventLog::recordCorrection(double time, CorrectionKind kind, const std::vector<int>& movingBodies, double amount) {
  Correction correction{kind, time, {}, amount};
  for (const int body : movingBodies)
    correction.bodies.push_back(assembly_.sceneBodies[static_cast<std::size_t>(body)]);
  corrections_.record(std::move(correction));
}

void EventLog::recordFaults(double time, const std::vector<ImpactContact>& impacts, const ImpactFaults& faults) {
  std::vector<int> bodies;
  for (const ImpactContact& impact : impacts)
    for (const int body : {impact.contact.bodyA, impact.contact.bodyB})
      if (body != kFixed) bodies.push_back(body);
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  if (faults.residual > 0) recordCorrection(time, CorrectionKind::unsolvedContacts, bodies, faults.residual);
  if (faults.scaledEnergy > 0) recordCorrection(time, CorrectionKind::scaledImpulses, bodies, faults.scaledEnergy);
  if (faults.rounds > 0) recordCorrection(time, CorrectionKind::endlessImpacts, bodies, faults.rounds);
}

std::vector<Event> EventLog::take() {
  return std::exchange(events_, {});
}

std::vector<std::string> EventLog::takeWarnings() {
  return std::exchange(warnings_, {});
}

}  // namespace cradle
