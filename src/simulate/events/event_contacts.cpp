#include "simulate/events/event_contacts.h"

#include <algorithm>
#include <utility>

#include "constraints/invariants.h"
#include "simulate/events/cylinder_rims.h"

namespace cradle {

EventContacts::EventContacts(IslandState& island, LimitEvents& ropes, const EventTolerances& tolerances, bool isTrial)
    : island_(island),
      tolerances_(tolerances),
      solver_(island.assembly.mechanism.constraints, island.assembly.mechanism.bodies),
      active_(island, tolerances),
      rest_(island, ropes, solver_, tolerances),
      impacts_(island, ropes, solver_, rest_, tolerances),
      shortMomentArm_(isTrial ? EventTolerances::kUnboundedMomentArm : EventTolerances::kShortMomentArm) {}

TouchingFeatures EventContacts::touching() {
  return {tolerances_.touch, tolerances_.deadBand, &active_.features()};
}

void EventContacts::resolve(const std::optional<ContactChange>& change, const std::optional<std::size_t>& closingPair) {
  if (!island_.mayTouch()) return;
  std::vector<char> rested;
  for (std::size_t body = 0; body < island_.assembly.mechanism.bodies.size(); ++body)
    rested.push_back(island_.equations.isResting(body));
  if (solver_.hasConstraints()) solver_.factorize(island_.state);
  std::vector<Contact> touching = findTouching(island_, solver_, tolerances_, closingPair);
  const std::vector<Contact> met = touching;
  const VectorX before = island_.state;
  const double zenoTime = impacts_.resolve(closingPair, touching);
  active_.release(change);
  rest_.letSleep(touching);
  active_.classify(touching, solver_);
  active_.noteShortMomentArms(touching, solver_, shortMomentArm_);
  noteTippingImpacts(met, before);
  project();
  if (!active_.empty() && rest_.isAnySlow()) {  // contacts that stick are still after the projection
    rest_.letSleep(touching);
    active_.releaseResting();
  }
  recordRests(rested, zenoTime);
  recordLastingContacts();
}

/// Which pairs of bodies press each other from now on, and which do no more.
void EventContacts::recordLastingContacts() {
  std::vector<std::pair<int, int>> pressed;
  for (const BodiesInContact& active : active_.bodies()) pressed.emplace_back(active.bodyA, active.bodyB);
  for (const SupportForce& support : *island_.resting.supports())
    pressed.push_back(bodiesOf(island_.assembly, support.pair));
  std::sort(pressed.begin(), pressed.end());
  pressed.erase(std::unique(pressed.begin(), pressed.end()), pressed.end());
  const auto record = [this](EventKind kind, const std::vector<std::pair<int, int>>& of,
                             const std::vector<std::pair<int, int>>& others) {
    for (const auto& pair : of)
      if (!std::binary_search(others.begin(), others.end(), pair))
        island_.log.record({island_.time, kind, pair.first, pair.second, Vec3::Zero(), Vec3::Zero(), 0});
  };
  record(EventKind::contactEnd, pressed_, pressed);
  record(EventKind::contactBegin, pressed, pressed_);
  pressed_ = std::move(pressed);
}

void EventContacts::noteShortMomentArms() {
  noteShortMomentArms(shortMomentArm_);
}

bool EventContacts::noteUnboundedForces() {
  if (!active_.noteJam()) noteShortMomentArms(EventTolerances::kUnboundedMomentArm);
  return !active_.fallbackReason().empty();
}

void EventContacts::noteShortMomentArms(double momentArm) {
  if (active_.empty() || !solver_.hasConstraints()) return;
  solver_.factorize(island_.state);
  std::vector<Contact> touching = findTouching(island_, solver_, tolerances_, {});
  // A contact that still closes, as that of the edge of a lid beside its hinge before the lid lands, does not last.
  const double still = tolerances_.minOpeningSpeed(tolerances_.scales.size);
  std::erase_if(touching, [&](const Contact& contact) { return openingSpeed(contact, island_.state) < -still; });
  active_.noteShortMomentArms(touching, solver_, momentArm);
}

/// An end of a cylinder that strikes flat while it tips, or tips by that, strikes by one point of its rim after
/// another. Which ones they are depends on angles far smaller than rounding of gaps shows.
void EventContacts::noteTippingImpacts(const std::vector<Contact>& met, const VectorX& before) {
  const ContactGeometry& geometry = island_.assembly.geometry;
  for (const Contact& contact : met) {
    const double still = tolerances_.minOpeningSpeed(smallestSize(contact, island_.assembly.radii));
    if (openingSpeed(contact, before) < -still && standsOnEnd(geometry, contact) &&
        std::max(tippingSpeed(geometry, before, contact), tippingSpeed(geometry, island_.state, contact)) > still)
      active_.noteTipping(contact);
  }
}

/// Projects the state onto the active contacts: no gap and no opening speed, to rounding, and no sliding where they
/// stick. Contacts that cannot last, as two corners that meet, have no rows for that.
void EventContacts::project() {
  if (active_.empty() || !active_.fallbackReason().empty()) return;
  const VectorX before = island_.state;
  island_.equations.project(island_.state);
  bookProjection(before, island_.assembly.mechanism, island_.state);
}

void EventContacts::recordRests(const std::vector<char>& restedBefore, double zenoTime) {
  for (std::size_t body = 0; body < restedBefore.size(); ++body) {
    const bool rests = island_.equations.isResting(body);
    if (rests == static_cast<bool>(restedBefore[body])) continue;
    const double time = island_.time + (rests ? zenoTime : 0);
    island_.log.recordBody(time, rests ? EventKind::rest : EventKind::wake, static_cast<int>(body),
                           centerOfMass(island_.state, static_cast<Eigen::Index>(body)));
  }
}

}  // namespace cradle
