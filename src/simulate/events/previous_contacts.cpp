// What lasted before an event and what lasts after it: contacts are let go of and decided anew, found again by their
// places, and what has become of them is recorded.

#include <cmath>

#include "simulate/events/active_contacts.h"

namespace cradle {
namespace {

constexpr double kSamePoint = 1e-4;       // of a size
constexpr double kSameDirection = 0.999;  // cosine

}  // namespace

void ActiveContacts::release(const std::optional<ContactChange>& change) {
  previous_.clear();
  knownTime_ = NAN;
  if (change && change->kind == ContactChange::Kind::slip) island_.equations.evaluate(island_.state, derivative_);
  for (std::size_t i = 0; i < records_.size(); ++i) {
    PreviousContact previous{records_[i], mechanism().contacts[i]};
    if (change && change->kind == ContactChange::Kind::slip && change->contact == i) {
      previous.isSlipping = true;
      previous.slipping = -island_.equations.contactForces()[i].tangential.normalized();
    }
    previous_.push_back(previous);
  }
  isReleasing_ = change && change->kind == ContactChange::Kind::release;
  mechanism().contacts.clear();
  records_.clear();
  fallbackReason_ = {};
}

/// The contact that lasted until now at the same place, or null.
const ActiveContacts::PreviousContact* ActiveContacts::previousOf(const ContactRecord& record) const {
  for (const PreviousContact& previous : previous_) {
    const ColliderPair &a = previous.record.pair, &b = record.pair;
    if (a.a != b.a || a.b != b.b || a.againstPlane != b.againstPlane) continue;
    const ContactKinematics place = kinematicsOf(previous.constraint, island_.state, frames_);
    const double size = smallestSize(record.contact, island_.assembly.radii);
    if (std::abs(place.normal.dot(record.contact.normal)) > kSameDirection &&
        (place.point - record.contact.point).norm() < kSamePoint * size)
      return &previous;
  }
  return nullptr;
}

/// Whether what slid slides the other way now.
bool ActiveContacts::reverses(const PreviousContact& previous, const ContactRecord& now) const {
  const int body = previous.constraint.surfaceB.body;
  const Vec3& given = previous.constraint.slidingDirection;
  const Vec3 before = body == kFixed ? given : Vec3(orientation(island_.state, body).normalized() * given);
  return before.dot(now.direction) < 0;
}

/// What is new of the contacts that lasted before.
void ActiveContacts::recordChanges() {
  for (const PreviousContact& previous : previous_) {
    const ContactRecord* now = nullptr;
    for (const ContactRecord& record : records_)
      if (previousOf(record) == &previous) now = &record;
    const Contact& contact = previous.record.contact;
    const auto record = [&](EventKind kind) {
      const auto [a, b] = bodiesOf(island_.assembly, previous.record.pair);
      const ContactKinematics place = kinematicsOf(previous.constraint, island_.state, frames_);
      island_.log.record({island_.time, kind, a, b, place.point, contact.normal, 0});
    };
    const bool slid = previous.constraint.motion == ContactMotion::sliding;
    const bool stuck = previous.constraint.motion == ContactMotion::sticking;
    if (!isAwake(contact)) {
      if (slid) record(EventKind::stick);
    } else if (!now) {
      record(EventKind::release);
    } else if (slid && now->sticks) {
      Vec3 relative = Vec3::Zero();
      if (contact.bodyA != kFixed) relative -= angularVelocity(island_.state, contact.bodyA);
      if (contact.bodyB != kFixed) relative += angularVelocity(island_.state, contact.bodyB);
      const double size = smallestSize(contact, island_.assembly.radii);
      record(relative.norm() * size > kSlowestSliding ? EventKind::roll : EventKind::stick);
    } else if (now->slides && (stuck || (slid && reverses(previous, *now)))) {
      record(EventKind::slip);
    }
  }
  previous_.clear();
}

}  // namespace cradle
