// What lasted before an event and what lasts after it: contacts are let go of and decided anew, found again by their
// places, and what has become of them is recorded.

#include <cmath>

#include "simulate/events/lasting_contacts.h"

namespace cradle {
namespace {

constexpr double kSamePoint = 1e-4;       // of a size
constexpr double kSameDirection = 0.999;  // cosine

}  // namespace

void LastingContacts::letGo(const std::optional<ContactChange>& change) {
  former_.clear();
  knownTime_ = NAN;
  if (change && change->kind == ContactChange::Kind::slip) island_.equations.evaluate(island_.state, rate_);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Former former{entries_[i], mechanism().contacts[i]};
    if (change && change->kind == ContactChange::Kind::slip && change->contact == i) {
      former.isSlipping = true;
      former.slipping = -island_.equations.contactForces()[i].tangential.normalized();
    }
    former_.push_back(former);
  }
  isReleasing_ = change && change->kind == ContactChange::Kind::release;
  mechanism().contacts.clear();
  entries_.clear();
  fault_ = {};
}

/// The contact that lasted until now at the same place, or null.
const LastingContacts::Former* LastingContacts::formerOf(const Entry& entry) const {
  for (const Former& former : former_) {
    const ColliderPair &a = former.entry.pair, &b = entry.pair;
    if (a.a != b.a || a.b != b.b || a.againstPlane != b.againstPlane) continue;
    const ContactPlace place = placeOf(former.constraint, island_.state, frames_);
    const double size = smallestSize(entry.contact, island_.assembly.radii);
    if (std::abs(place.normal.dot(entry.contact.normal)) > kSameDirection &&
        (place.point - entry.contact.point).norm() < kSamePoint * size)
      return &former;
  }
  return nullptr;
}

/// Whether what slid slides the other way now.
bool LastingContacts::turnsBack(const Former& former, const Entry& now) const {
  const int body = former.constraint.surfaceB.body;
  const Vec3& given = former.constraint.slidingDirection;
  const Vec3 before = body == kFixed ? given : Vec3(orientation(island_.state, body).normalized() * given);
  return before.dot(now.direction) < 0;
}

/// What is new of the contacts that lasted before.
void LastingContacts::recordChanges() {
  for (const Former& former : former_) {
    const Entry* now = nullptr;
    for (const Entry& entry : entries_)
      if (formerOf(entry) == &former) now = &entry;
    const Contact& contact = former.entry.contact;
    const auto record = [&](EventKind kind) {
      const auto [a, b] = bodiesOf(island_.assembly, former.entry.pair);
      const ContactPlace place = placeOf(former.constraint, island_.state, frames_);
      island_.log.record({island_.time, kind, a, b, place.point, contact.normal, 0});
    };
    const bool slid = former.constraint.motion == ContactMotion::sliding;
    const bool stuck = former.constraint.motion == ContactMotion::sticking;
    if (!isAwake(contact)) {
      if (slid) record(EventKind::stick);
    } else if (!now) {
      record(EventKind::release);
    } else if (slid && now->sticks) {
      Vec3 spin = Vec3::Zero();
      if (contact.bodyA != kFixed) spin -= angularVelocity(island_.state, contact.bodyA);
      if (contact.bodyB != kFixed) spin += angularVelocity(island_.state, contact.bodyB);
      const double size = smallestSize(contact, island_.assembly.radii);
      record(spin.norm() * size > kSlowestSliding ? EventKind::roll : EventKind::stick);
    } else if (now->slides && (stuck || (slid && turnsBack(former, *now)))) {
      record(EventKind::slip);
    }
  }
  former_.clear();
}

}  // namespace cradle
