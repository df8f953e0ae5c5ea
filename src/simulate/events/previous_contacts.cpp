// Active contacts are released at an event and classified anew. A contact after the event is that of before if it is at
// the same place: contacts have no identity of their own.

#include "simulate/events/previous_contacts.h"

#include <cmath>

#include "simulate/events/event_tolerances.h"

namespace cradle {
namespace {

/// Whether a contact that slid slides the other way now.
bool isReversed(const PreviousContact& previous, const ContactRecord& now, const VectorX& state) {
  const int body = previous.constraint.surfaceB.body;
  const Vec3& given = previous.constraint.slidingDirection;
  const Vec3 before = body == kFixed ? given : Vec3(orientation(state, body).normalized() * given);
  return before.dot(now.direction) < 0;
}

/// Whether bodies rotate relative to each other at a contact that does not slide.
bool isRolling(const Contact& contact, const IslandState& island) {
  Vec3 relative = Vec3::Zero();  // rad/s
  if (contact.bodyA != kFixed) relative -= angularVelocity(island.state, contact.bodyA);
  if (contact.bodyB != kFixed) relative += angularVelocity(island.state, contact.bodyB);
  return relative.norm() * smallestSize(contact, island.assembly.radii) > kSlowestSliding;
}

}  // namespace

const PreviousContact* previousAt(const ContactRecord& record, const std::vector<PreviousContact>& previous,
                                  const std::vector<BodyFrame>& frames, const IslandState& island) {
  for (const PreviousContact& one : previous) {
    if (!isSamePair(one.record.pair, record.pair)) continue;
    const ContactKinematics place = kinematicsOf(one.constraint, island.state, frames);
    const double size = smallestSize(record.contact, island.assembly.radii);
    if (std::abs(place.normal.dot(record.contact.normal)) > EventTolerances::kSameContactNormal &&
        (place.point - record.contact.point).norm() < EventTolerances::kSameContactPoint * size)
      return &one;
  }
  return nullptr;
}

void recordContactEvents(const std::vector<PreviousContact>& previous, const std::vector<ContactRecord>& active,
                         const std::vector<BodyFrame>& frames, const IslandState& island, EventLog& log) {
  for (const PreviousContact& one : previous) {
    const ContactRecord* now = nullptr;
    for (const ContactRecord& record : active)
      if (previousAt(record, previous, frames, island) == &one) now = &record;
    const Contact& contact = one.record.contact;
    const auto record = [&](EventKind kind) {
      const auto [a, b] = bodiesOf(island.assembly, one.record.pair);
      const ContactKinematics place = kinematicsOf(one.constraint, island.state, frames);
      log.record({island.time, kind, a, b, place.point, contact.normal, 0});
    };
    const bool slid = one.constraint.motion == ContactMotion::sliding;
    const bool stuck = one.constraint.motion == ContactMotion::sticking;
    if (!isAwake(contact, island.resting)) {
      if (slid) record(EventKind::stick);
    } else if (!now) {
      record(EventKind::release);
    } else if (slid && now->sticks) {
      record(isRolling(contact, island) ? EventKind::roll : EventKind::stick);
    } else if (now->slides && (stuck || (slid && isReversed(one, *now, island.state)))) {
      record(EventKind::slip);
    }
  }
}

}  // namespace cradle
