#include "simulate/events/event_impacts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "constraints/invariants.h"
#include "impact/contact_impulse.h"
#include "impact/frictional_impact.h"
#include "impact/frictional_tolerances.h"
#include "impact/generalized_reflections.h"
#include "impact/impact_energy.h"

namespace cradle {
namespace {

// Of the fastest contact before an impact: a solved one leaves no contact that closes as fast. Rounding leaves 1e-12.
constexpr double kMinClosingRatio = 0.01;

// Of contacts that others close: a box that is pushed, or falls on what stands, needs one or two. All are solved at
// once where more would be needed, as in a stack.
constexpr int kMaxClosingRounds = 3;

/// m/s: of the faster of the two bodies' centres.
double contactSpeed(const Contact& contact, const VectorX& state) {
  double speed = 0;
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed) speed = std::max(speed, linearVelocity(state, body).norm());
  return speed;
}

}  // namespace

/// Impacts of one contact in a sequence are one event.
void EventImpacts::addImpulse(std::size_t contact, double impulse, std::vector<ContactImpulse>& impulses) {
  if (!(impulse > 0)) return;
  const auto known = std::find_if(impulses.begin(), impulses.end(),
                                  [contact](const ContactImpulse& other) { return other.contact == contact; });
  if (known == impulses.end())
    impulses.push_back({contact, impulse});
  else
    known->impulse += impulse;
}

double EventImpacts::resolve(const std::optional<std::size_t>& closingPair, std::vector<Contact>& touching) {
  double fastest = 0, zenoTime = 0;
  for (const Contact& contact : touching) fastest = std::max(fastest, contactSpeed(contact, island_.state));
  const double still = EventTolerances::kStandstillRatio * fastest;
  const auto closes = [&](const Contact& contact) { return openingSpeed(contact, island_.state) < -still; };
  if (std::none_of(touching.begin(), touching.end(), closes)) return zenoTime;
  const std::vector<Contact> near = contactsInReach(touching);
  const SequenceLimits limits = limitsOf(near, still);
  ImpactSequence sequence(near, closingPair, island_.assembly.radii, limits, island_.state);
  std::vector<ContactImpulse> impulses;
  if (!sequence.beginsNow() && ropes_.pullStretched(island_.time, island_.state) && constraints_.hasConstraints())
    constraints_.factorize(island_.state);
  while (sequence.next(island_.state)) {
    zenoTime = std::max(zenoTime, resolveNext(sequence, still, impulses));
    sequence.finishImpact(island_.state);
  }
  for (const ContactImpulse& struck : impulses)
    island_.log.recordContact(island_.time, EventKind::impact, near[struck.contact], struck.impulse);
  for (const Contact& contact : near) rest_.wakeStruck(contact);
  const double constant = energyConstant(island_.assembly.mechanism, island_.state);
  if (sequence.moveBodies(island_.state)) {
    bookNumerical(constant, island_.assembly.mechanism, island_.state);
    if (constraints_.hasConstraints()) constraints_.factorize(island_.state);
    touching = findTouching(island_, constraints_, tolerances_, std::nullopt);
  }
  knownGaps_.keep(sequence, limits.leastRounding);
  // A gap that closes later is an event of its own.
  std::erase_if(touching, [&](const Contact& contact) { return closes(contact) && isApart(contact, limits); });
  return zenoTime;
}

/// The touching contacts, and those that may come to touch while a sequence of impacts lasts.
std::vector<Contact> EventImpacts::contactsInReach(const std::vector<Contact>& touching) {
  std::vector<Contact> near = touching, farther;
  if (!(tolerances_.reach > tolerances_.touch)) return near;
  findContacts(island_.assembly.geometry, island_.state, tolerances_.reach, farther);
  eraseImmobile(ImpulseResponse(island_.assembly.mechanism.bodies, constraints_), island_.state, farther);
  for (const Contact& contact : farther) {
    // The pair of an event has one contact among the touching ones, however large its gap.
    const auto isIt = [&](const Contact& other) {
      return other.pair == contact.pair && (other.point - contact.point).norm() <= tolerances_.touch;
    };
    if (contact.separation > tolerances_.touch && std::none_of(touching.begin(), touching.end(), isIt))
      near.push_back(contact);
  }
  return near;
}

bool EventImpacts::isOfSphere(const Contact& contact) const {
  const ContactGeometry& geometry = island_.assembly.geometry;
  const ColliderPair& pair = geometry.pairs[contact.pair];
  return geometry.colliders[pair.a].isSphere() || (!pair.againstPlane && geometry.colliders[pair.b].isSphere());
}

SequenceLimits EventImpacts::limitsOf(const std::vector<Contact>& near, double stillSpeed) {
  double farthest = 0;  // m: largest coordinate of a contact
  for (const Contact& contact : near) farthest = std::max(farthest, contact.point.cwiseAbs().maxCoeff());
  SequenceLimits limits;
  limits.gapRounding = tolerances_.gapRounding(farthest), limits.stillSpeed = stillSpeed;
  limits.openingSpeed = tolerances_.minOpeningSpeed(tolerances_.scales.size);
  limits.touchTolerance = tolerances_.touch, limits.reach = tolerances_.reach, limits.duration = INFINITY;
  limits.shortestTime = EventTolerances::kInstantRatio * island_.time;
  limits.leastRounding = tolerances_.sphereGapRounding(farthest);
  for (const Contact& contact : near)
    limits.gapErrors.push_back(isOfSphere(contact) ? limits.leastRounding : limits.gapRounding);
  limits.acceleration = island_.assembly.mechanism.gravity.norm();
  useKnownGaps(near, limits);
  if (std::none_of(near.begin(), near.end(), [&](const Contact& contact) { return isApart(contact, limits); }))
    return limits;
  VectorX derivative;
  island_.equations.evaluate(island_.time, island_.state, derivative);
  double strongest = 0;  // m/s^2
  for (const Contact& contact : near)
    strongest = std::max(strongest, std::abs(openingAcceleration(contact, island_.state, derivative)));
  limits.duration = tolerances_.maxSequenceTime(strongest);
  limits.acceleration = std::max(limits.acceleration, strongest);
  return limits;
}

/// Whether a contact has a gap that its separation shows.
bool EventImpacts::isApart(const Contact& contact, const SequenceLimits& limits) const {
  const auto known = knownGaps_.find(contact, limits.leastRounding);
  if (known && known->gap > EventTolerances::kKnownGapRatio * known->error) return true;
  const bool isShown = known && std::abs(contact.separation - known->gap) <= limits.leastRounding;
  return contact.separation > (isShown ? limits.leastRounding : limits.gapRounding);
}

/// Contacts that have just had an impact have gaps that are known from it, better than they are measured.
void EventImpacts::useKnownGaps(const std::vector<Contact>& near, SequenceLimits& limits) const {
  limits.gapOffsets.assign(near.size(), 0.0);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const auto known = knownGaps_.find(near[i], limits.leastRounding);
    if (!known) continue;
    limits.gapOffsets[i] = near[i].separation - known->gap;
    limits.gapErrors[i] = known->error;
  }
}

/// Impact islands: bodies that an impact at one of them may move.
DisjointSets EventImpacts::findImpactIslands(const std::vector<Contact>& contacts) const {
  DisjointSets islands(island_.assembly.mechanism.bodies);
  for (const Contact& contact : contacts) islands.join(contact.bodyA, contact.bodyB);
  for (const Constraint& constraint : island_.assembly.mechanism.constraints)
    islands.join(constraint.anchorA.body, constraint.anchorB.body);
  return islands;
}

/// One impact of a sequence: all its members, and all ropes that cannot lengthen, take part. Returns the Zeno time (s).
double EventImpacts::resolveNext(const ImpactSequence& sequence, double still, std::vector<ContactImpulse>& impulses) {
  std::vector<Contact> members;
  for (const std::size_t i : sequence.members()) members.push_back(sequence.contacts()[i]);
  std::vector<ImpactContact> ropes = ropes_.beginImpact(island_.state);
  if (!ropes.empty() && constraints_.hasConstraints()) constraints_.factorize(island_.state);
  DisjointSets islands = findImpactIslands(members);
  for (const ImpactContact& rope : ropes) islands.join(rope.contact.bodyA, rope.contact.bodyB);
  std::vector<char> isStruck(island_.assembly.mechanism.bodies.size(), 0);
  for (const Contact& contact : members)
    if (openingSpeed(contact, island_.state) < -still)
      isStruck[static_cast<std::size_t>(islands.islandOf(contact.bodyA, contact.bodyB))] = 1;
  double zenoTime = 0;
  for (std::size_t island = 0; island < isStruck.size(); ++island)
    if (isStruck[island])
      zenoTime = std::max(zenoTime, resolveIsland(islands, static_cast<int>(island), sequence, still, ropes, impulses));
  ropes_.endImpact(island_.time, ropes, island_.state);
  if (!ropes.empty() && constraints_.hasConstraints()) constraints_.factorize(island_.state);
  for (const ImpactContact& rope : ropes) rest_.wakeStruck(rope.contact);
  return zenoTime;
}

/// The impact of one impact island. Sets the impulses of its ropes. Returns the Zeno time (s).
double EventImpacts::resolveIsland(const DisjointSets& islands, int island, const ImpactSequence& sequence,
                                   double still, std::vector<ImpactContact>& ropes,
                                   std::vector<ContactImpulse>& impulses) {
  const auto isIn = [&](const Contact& contact) { return islands.islandOf(contact.bodyA, contact.bodyB) == island; };
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
  const VectorX approach = island_.state;
  const double zenoTime = resolveWithBumps(contacts.size(), impacts, still);
  requireRoom(approach, impacts, contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i)
    addImpulse(contacts[i], impacts[i].contact.normal.dot(impacts[i].impulse), impulses);
  std::size_t next = contacts.size();
  for (ImpactContact& rope : ropes)
    if (isIn(rope.contact)) rope.impulse = impacts[next++].impulse;
  return zenoTime;
}

/// One impact, in which normals of the first `contacts` are tilted where the scene has bumps, and then one without
/// bumps where that has left contacts closing. Returns the Zeno time (s).
double EventImpacts::resolveWithBumps(std::size_t contacts, std::vector<ImpactContact>& impacts, double still) {
  std::vector<ImpactContact> left = impacts;  // to what still closes then
  const bool isTilted =
      island_.bumps.tilt(island_.time, island_.state, std::span<ImpactContact>(impacts).first(contacts));
  const double zenoTime = resolveImpact(impacts, still);
  if (!isTilted) return zenoTime;
  if (std::any_of(left.begin(), left.end(),
                  [&](const ImpactContact& impact) { return openingSpeed(impact.contact, island_.state) < -still; }))
    resolveImpact(left, still);
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    impacts[i].contact = left[i].contact;
    impacts[i].impulse += left[i].impulse;
  }
  return zenoTime;
}

/// One impact, without the rebounds that end a Zeno sequence. Returns the Zeno time (s).
double EventImpacts::resolveImpact(std::vector<ImpactContact>& impacts, double still) {
  VectorX& state = island_.state;
  const VectorX approach = state;
  const ImpulseResponse response(island_.assembly.mechanism.bodies, constraints_);
  const bool hasFriction = std::any_of(impacts.begin(), impacts.end(), [](const ImpactContact& impact) {
    return impact.material.staticFriction > 0 || impact.material.dynamicFriction > 0;
  });
  ImpactFaults faults;
  const auto solve = [&] {
    if (!hasFriction)
      resolveReflections(impacts, response, state);
    else if (!resolveByThoseThatClose(impacts, response, still, faults))
      faults = resolveFrictionalImpact(impacts, response, state);
  };
  solve();
  const double zenoTime = endZenoSequence(approach, impacts);
  if (zenoTime > 0) {
    state = approach;
    for (ImpactContact& impact : impacts) impact.impulse.setZero();
    solve();
  }
  island_.log.recordFaults(island_.time, impacts, faults);
  bookImpact(impacts, island_.assembly.mechanism.bodies, constraints_, approach, state);
  bookNumerical(energyConstant(island_.assembly.mechanism, approach), island_.assembly.mechanism, state);
  return zenoTime;
}

/// With friction, impulses of contacts that do not close by themselves, as those under a box that is pushed, may have
/// many solutions. They take no part if the impact of those that close, and of those that these close in turn, leaves
/// them open or as they are. True if that solves the impact; else the island's state stays as it is.
bool EventImpacts::resolveByThoseThatClose(std::vector<ImpactContact>& impacts, const ImpulseResponse& response,
                                           double still, ImpactFaults& faults) {
  const VectorX approach = island_.state;
  double closing = still, fastest = 0;  // m/s
  for (const ImpactContact& impact : impacts) fastest = std::max(fastest, -openingSpeed(impact.contact, approach));
  std::vector<std::size_t> members, others(impacts.size());
  std::iota(others.begin(), others.end(), std::size_t(0));
  for (int round = 0; round < kMaxClosingRounds; ++round) {
    const std::size_t before = members.size();
    std::erase_if(others, [&](std::size_t i) {
      const bool closes = openingSpeed(impacts[i].contact, island_.state) < -closing;
      if (closes) members.push_back(i);
      return closes;
    });
    if (members.size() == before) return true;
    for (ImpactContact& impact : impacts) impact.impulse.setZero();
    island_.state = approach;
    if (others.empty()) return false;
    closing = std::max(still, FrictionalImpactTolerances(fastest).closed);
    std::vector<ImpactContact> struck;
    for (const std::size_t i : members) struck.push_back(impacts[i]);
    faults = resolveFrictionalImpact(struck, response, island_.state);
    for (std::size_t k = 0; k < members.size(); ++k) impacts[members[k]].impulse = struck[k].impulse;
  }
  for (ImpactContact& impact : impacts) impact.impulse.setZero();
  island_.state = approach;
  return false;
}

/// Driven bodies that come together over what they touch, or that press it against others by stops and ropes, leave it
/// no velocity with which all contacts open and all limits are kept. Throws Error(unstable) then. Behind the contacts
/// of `impacts`, one at least, stand those of limits.
void EventImpacts::requireRoom(const VectorX& approach, const std::vector<ImpactContact>& impacts,
                               std::size_t contacts) const {
  if (island_.assembly.mechanism.driven.empty()) return;
  double fastest = 0, led = 0;  // m/s
  for (const ImpactContact& impact : impacts) {
    fastest = std::max(fastest, contactSpeed(impact.contact, approach));
    for (const int body : {impact.contact.bodyA, impact.contact.bodyB})
      if (body != kFixed && island_.assembly.mechanism.bodies[static_cast<std::size_t>(body)].isDriven())
        led = std::max(led, pointVelocity(body, impact.contact.point, approach).norm());
  }
  if (led < kMinClosingRatio * fastest) return;  // faults of others' impacts are none of theirs
  const double closing = std::max(kMinClosingRatio * fastest, tolerances_.minOpeningSpeed(tolerances_.scales.size));
  for (std::size_t i = 0; i < impacts.size(); ++i)
    if (openingSpeed(impacts[i].contact, island_.state) < -closing && impacts[i].contact.separation < tolerances_.touch)
      island_.failAtNoRoom(impacts[i < contacts ? i : 0].contact);
}

/// Gives contacts whose rebound is too low to be seen no rebound: their bounces accumulate at the Zeno time 2 v / (a (1
/// - e)) (s) from now, v the speed of the rebound, a the acceleration of closing, e the restitution. Returns the latest
/// of these times, 0 if there is no such contact. `approach` is the state before the impact.
double EventImpacts::endZenoSequence(const VectorX& approach, std::vector<ImpactContact>& impacts) {
  const VectorX& state = island_.state;
  VectorX derivative;
  double zenoTime = 0;
  for (ImpactContact& impact : impacts) {
    const double speed = openingSpeed(impact.contact, state), restitution = impact.material.restitution;
    const bool rebounds = openingSpeed(impact.contact, approach) < 0 && speed > 0 && restitution < 1;
    if (!rebounds || restitution == 0) continue;
    if (derivative.size() == 0) island_.equations.evaluate(island_.time, state, derivative);
    const double closing = -openingAcceleration(impact.contact, state, derivative);
    const double size = smallestSize(impact.contact, island_.assembly.radii);
    if (!(closing > 0) || speed > tolerances_.minReboundSpeed(closing, size)) continue;
    impact.restSpeed = INFINITY;
    zenoTime = std::max(zenoTime, 2 * speed / (closing * (1 - restitution)));
  }
  return zenoTime;
}

}  // namespace cradle
