// Impacts at an event: contacts that close, and those that these make close, in the order of their gaps.

#include <algorithm>
#include <cmath>

#include "dynamics/invariants.h"
#include "simulate/events/event_contacts.h"

namespace cradle {
namespace {

constexpr double kStandstillRatio = 1e-12;   // of the fastest speed at an impact: what is left is rounding
constexpr double kSequenceRatio = 1e-9;      // of the time of a fall by the smallest size: as long it may take always
constexpr double kGapRoundingRatio = 4e-12;  // of the smallest size: beyond the dead band, a gap is one ...
constexpr double kSphereGapRatio = 2e-13;    // the same, of spheres: differences of two lengths
constexpr double kGapPlaceRounding = 4e-15;  // ... unless the places around it are rounded that coarsely

/// m/s: of the faster of the two bodies' centres.
double contactSpeed(const Contact& contact, const VectorX& state) {
  double speed = 0;
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed) speed = std::max(speed, linearVelocity(state, body).norm());
  return speed;
}

/// Impacts of one contact in a sequence are one event.
void addImpulse(std::size_t contact, double impulse, std::vector<ContactImpulse>& impulses) {
  if (!(impulse > 0)) return;
  const auto known = std::find_if(impulses.begin(), impulses.end(),
                                  [contact](const ContactImpulse& other) { return other.contact == contact; });
  if (known == impulses.end())
    impulses.push_back({contact, impulse});
  else
    known->impulse += impulse;
}

}  // namespace

/// Contacts that close are impacts, one after the other as their gaps say.
void EventContacts::collide(const std::optional<std::size_t>& closingPair) {
  double fastest = 0;
  for (const Contact& contact : touching_) fastest = std::max(fastest, contactSpeed(contact, island_.state));
  const double still = kStandstillRatio * fastest;
  const auto closes = [&](const Contact& contact) { return openingSpeed(contact, island_.state) < -still; };
  if (std::none_of(touching_.begin(), touching_.end(), closes)) return;
  const std::vector<Contact> near = contactsInReach();
  const SequenceLimits limits = limitsOf(near, still);
  ImpactSequence sequence(near, closingPair, island_.assembly.radii, limits, island_.state);
  std::vector<ContactImpulse> impulses;
  if (!sequence.beginsNow() && ropes_.pullStretched(island_.time, island_.state) && solver_.hasConstraints())
    solver_.factorize(island_.state);
  while (sequence.next(island_.state)) {
    strike(sequence, still, impulses);
    sequence.finishImpact(island_.state);
  }
  for (const ContactImpulse& struck : impulses)
    island_.log.recordContact(island_.time, EventKind::impact, near[struck.contact], struck.impulse);
  for (const Contact& contact : near) wakeStruck(contact);
  const double constant = energyConstant(island_.assembly.mechanism, island_.state);
  if (sequence.moveBodies(island_.state)) {
    bookNumerical(constant, island_.assembly.mechanism, island_.state);
    if (solver_.hasConstraints()) solver_.factorize(island_.state);
    findTouching(std::nullopt);
  }
  // A gap that closes later is an event of its own.
  std::erase_if(touching_,
                [&](const Contact& contact) { return contact.separation > limits.gapRounding && closes(contact); });
}

/// What touches, and what may come to touch while a sequence of impacts lasts.
std::vector<Contact> EventContacts::contactsInReach() {
  std::vector<Contact> near = touching_, farther;
  if (!(reach_ > touchTolerance_)) return near;
  findContacts(island_.assembly.geometry, island_.state, reach_, farther);
  eraseImmobile(ImpulseResponse(island_.assembly.mechanism.bodies, solver_), island_.state, farther);
  for (const Contact& contact : farther)
    if (contact.separation > touchTolerance_) near.push_back(contact);
  return near;
}

bool EventContacts::isOfSphere(const Contact& contact) const {
  const ContactGeometry& geometry = island_.assembly.geometry;
  const ColliderPair& pair = geometry.pairs[contact.pair];
  return geometry.colliders[pair.a].isSphere() || (!pair.againstPlane && geometry.colliders[pair.b].isSphere());
}

SequenceLimits EventContacts::limitsOf(const std::vector<Contact>& near, double stillSpeed) {
  double places = 0;  // m
  for (const Contact& contact : near)
    places = std::max(places, kGapPlaceRounding * contact.point.cwiseAbs().maxCoeff());
  SequenceLimits limits{{}, std::max(kGapRoundingRatio * size_, places), touchTolerance_, reach_, INFINITY, stillSpeed};
  for (const Contact& contact : near)
    limits.gapErrors.push_back(isOfSphere(contact) ? std::max(kSphereGapRatio * size_, places) : limits.gapRounding);
  const auto isClosed = [&](const Contact& contact) { return contact.separation <= limits.gapRounding; };
  if (std::all_of(near.begin(), near.end(), isClosed)) return limits;
  island_.equations.evaluate(island_.state, derivative_);
  double strongest = 0;  // m/s^2
  for (const Contact& contact : near)
    strongest = std::max(strongest, std::abs(openingAcceleration(contact, island_.state, derivative_)));
  limits.duration = std::max(kSequenceRatio, reach_ / size_) * std::sqrt(size_ / strongest);
  return limits;
}

/// Bodies that an impact at one of them may move.
DisjointSets EventContacts::connect(const std::vector<Contact>& contacts) const {
  DisjointSets islands(island_.assembly.mechanism.bodies.size());
  for (const Contact& contact : contacts) islands.join(contact.bodyA, contact.bodyB);
  forEachConstraint(island_.assembly.mechanism.constraints, [&](int bodyA, int bodyB) { islands.join(bodyA, bodyB); });
  return islands;
}

/// One impact of a sequence: all members, and all ropes that cannot lengthen, take part.
void EventContacts::strike(const ImpactSequence& sequence, double still, std::vector<ContactImpulse>& impulses) {
  std::vector<Contact> members;
  for (const std::size_t i : sequence.members()) members.push_back(sequence.contacts()[i]);
  std::vector<ImpactContact> ropes = ropes_.beginImpact(island_.state);
  if (!ropes.empty() && solver_.hasConstraints()) solver_.factorize(island_.state);
  DisjointSets together = connect(members);
  for (const ImpactContact& rope : ropes) together.join(rope.contact.bodyA, rope.contact.bodyB);
  std::vector<char> isStruck(island_.assembly.mechanism.bodies.size(), 0);
  for (const Contact& contact : members)
    if (openingSpeed(contact, island_.state) < -still)
      isStruck[static_cast<std::size_t>(together.islandOf(contact.movingBody()))] = 1;
  for (std::size_t group = 0; group < isStruck.size(); ++group)
    if (isStruck[group]) strike(together, static_cast<int>(group), sequence, ropes, impulses);
  ropes_.endImpact(island_.time, ropes, island_.state);
  if (!ropes.empty() && solver_.hasConstraints()) solver_.factorize(island_.state);
  for (const ImpactContact& rope : ropes) wakeStruck(rope.contact);
}

void EventContacts::strike(const DisjointSets& together, int group, const ImpactSequence& sequence,
                           std::vector<ImpactContact>& ropes, std::vector<ContactImpulse>& impulses) {
  const auto isIn = [&](const Contact& contact) { return together.islandOf(contact.movingBody()) == group; };
  std::vector<ImpactContact> impacts;
  std::vector<std::size_t> contacts;
  for (const std::size_t i : sequence.members()) {
    const Contact& contact = sequence.contacts()[i];
    if (!isIn(contact)) continue;
    ContactMaterial material = island_.assembly.geometry.pairs[contact.pair].material;
    if (sequence.isCollapse()) material.restitution = 0;
    impacts.push_back({contact, material, 0, Vec3::Zero()});
    contacts.push_back(i);
  }
  for (const ImpactContact& rope : ropes)
    if (isIn(rope.contact)) impacts.push_back(rope);
  resolveImpact(impacts);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    addImpulse(contacts[i], impacts[i].contact.normal.dot(impacts[i].impulse), impulses);
  std::size_t next = contacts.size();
  for (ImpactContact& rope : ropes)
    if (isIn(rope.contact)) rope.impulse = impacts[next++].impulse;
}

}  // namespace cradle
