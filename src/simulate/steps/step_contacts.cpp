#include "simulate/steps/step_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "impact/contact_impulse.h"
#include "impact/frictional_impact.h"
#include "impact/generalized_reflections.h"
#include "impact/impact_energy.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr std::size_t kFewLoaded = 8;        // contacts that last: with more, time stepping alone is in use
constexpr double kReach = 2;                 // of the displacement of free motion: what others may make of it
constexpr double kRestingReachRatio = 1e-3;  // of its size: the same, for bodies at rest
constexpr double kNearOverlap = 10;  // of the deepest overlap: contacts so near may come to overlap by the correction
constexpr int kMaxRemovals = 4;      // of overlaps in a step: each leaves about the square of the relative overlap

double closingSpeed(const Contact& contact, const VectorX& state) {
  return -openingSpeed(contact, state);
}

/// Resolves an impact: without friction by generalized reflections, with friction by frictional contact problems.
ImpactFaults resolveImpact(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state) {
  const bool hasFriction = std::any_of(impacts.begin(), impacts.end(), [](const ImpactContact& impact) {
    return impact.material.staticFriction > 0 || impact.material.dynamicFriction > 0;
  });
  if (hasFriction) return resolveFrictionalImpact(impacts, response, state);
  resolveReflections(impacts, response, state);
  return {};
}

}  // namespace

StepContacts::StepContacts(IslandState& island, const ChosenMethod& method)
    : assembly_(island.assembly),
      log_(island.log),
      resting_(island.resting),
      bumps_(island.bumps),
      solver_(assembly_.mechanism.constraints, assembly_.mechanism.bodies),
      ties_(tiesOf(assembly_)),
      tieSolver_(ties_, assembly_.mechanism.bodies),
      timeStep_(method.timeStep),
      stepping_(assembly_) {
  resting_.setStillTime(tolerances().minAwakeTime(timeStep_));
  if (method.order == 1) stepping_.setFirstOrder();
}

void StepContacts::resolveImpacts(double time, const VectorX& before, LimitEvents& ropes, VectorX& state) {
  if (assembly_.geometry.colliders.empty()) return;
  findSimultaneous(state);
  if (touching_.empty()) return;
  wakeTouched(time, state);
  ropes.giveWay(touching_);
  eraseHeld(state, touching_);
  if (!stepsOnly_) {
    resolveImpactIslands(time, before, state);
    return letSleep(time, touching_, state);
  }
  const std::vector<Vec3> impulses = stepping_.resolveImpact(touching_, timeStep_, state);
  recordFaults(time);
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    if (touching_[i].normal.dot(impulses[i]) > 0) record(time, touching_[i], impulses[i], true);
  }
}

/// Contacts of this instant, and those that close so soon after it that they take part in its impact.
void StepContacts::findSimultaneous(const VectorX& state) {
  findTouching(state, tolerances().margin(), touching_);
  double fastest = 0;
  for (const Contact& contact : touching_) fastest = std::max(fastest, closingSpeed(contact, state));
  const double near = tolerances().simultaneousGap(fastest, timeStep_);
  std::erase_if(touching_, [&](const Contact& contact) { return contact.separation > near; });
}

/// Contacts whose gap is at most twice the displacements of their bodies in free motion: they may close within the
/// step, also where other contacts make the bodies faster.
void StepContacts::findWithinReach(const VectorX& before, const VectorX& state, double length) {
  std::vector<double> displacements;  // m, of each body within the step
  for (std::size_t i = 0; i < assembly_.radii.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    double speed = 0;
    for (const VectorX* moment : {&before, &state})
      speed = std::max(
          speed, linearVelocity(*moment, body).norm() + assembly_.radii[i] * angularVelocity(*moment, body).norm());
    displacements.push_back(kReach * speed * length + kRestingReachRatio * assembly_.radii[i]);
  }
  const auto displacementOf = [&](int body) {
    return body == kFixed ? 0 : displacements[static_cast<std::size_t>(body)];
  };
  findTouching(
      before, [&](int bodyA, int bodyB) { return displacementOf(bodyA) + displacementOf(bodyB); }, touching_);
}

/// The contacts of a step: of pairs that touch when it begins. Pairs that are apart are left to the search for impacts,
/// unless time stepping alone is in use.
void StepContacts::findStepContacts(const VectorX& before, const VectorX& state, double length) {
  findWithinReach(before, state, length);
  if (stepsOnly_) return loosenShortMomentArms(before, touching_);
  std::vector<char> touches(assembly_.geometry.pairs.size(), 0);
  for (const Contact& contact : touching_)
    if (contact.separation <= tolerances().touch) touches[contact.pair] = 1;
  std::erase_if(touching_, [&](const Contact& contact) { return !touches[contact.pair]; });
  loosenShortMomentArms(before, touching_);
}

/// Widens the gaps of contacts with a short moment arm about a joint, so that they may overlap a little: their impulses
/// rotate bodies farther than steps can follow, and bodies that do rotate give them a longer moment arm.
void StepContacts::loosenShortMomentArms(const VectorX& state, std::vector<Contact>& contacts) {
  if (contacts.empty() || !tieSolver_.hasConstraints()) return;
  const ImpulseResponse response(assembly_.mechanism.bodies, tieSolver_);
  for (Contact& contact : contacts)
    if (hasShortMomentArm(contact, response, state, StepTolerances::kLooseMomentArm))
      contact.separation += StepTolerances::kLoosened * smallestSize(contact, assembly_.radii);
}

void StepContacts::begin(double time, const VectorX& before, const VectorX& state, double length) {
  stepsOnly_ = willStepOnly_;
  stepPart_ = length / timeStep_;
  touching_.clear(), strikesInside_.clear();
  if (assembly_.geometry.colliders.empty()) return;
  findStepContacts(before, state, length);
  // A contact that closes within the step wakes its bodies, with all that rest with them.
  bool woken = false;
  for (const Contact& contact : touching_) {
    const double closing = -contact.normal.dot(relativeVelocity(contact, before, state));
    if (contact.separation - length * std::max(0.0, closing) > tolerances().touch) continue;
    for (const int body : {contact.bodyA, contact.bodyB})
      for (const int other : resting_.wake(time, body)) {
        log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
        woken = true;
      }
  }
  if (woken) findStepContacts(before, state, length);
}

std::vector<ColliderPair> StepContacts::pairsWithoutContact() const {
  const std::vector<ColliderPair>& pairs = assembly_.geometry.pairs;
  std::vector<char> hasContact(pairs.size(), 0);
  for (const Contact& contact : touching_) hasContact[contact.pair] = 1;
  std::vector<ColliderPair> others;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!hasContact[i]) others.push_back(pairs[i]);
  return others;
}

double StepContacts::nextImpact(const VectorX& before, const VectorX& state, double length) {
  NextImpact next = stepping_.nextImpact(touching_, before, length, state, tolerances().minNextImpactSpeed(timeStep_));
  strikesInside_ = std::move(next.strikesInside);
  return next.fraction;
}

void StepContacts::solveContacts(const VectorX& before, double length, const LimitEvents& ropes, VectorX& state) {
  stepPart_ = length / timeStep_;
  eraseHeld(before, touching_);
  // Of a step that is shortened after this, no impact inside is known.
  stepping_.resolve(touching_, ropes.withinReach(before, state, length), before, length, state,
                    std::exchange(strikesInside_, {}));
  correctPenetrations(ropes, state);
}

void StepContacts::recordAndLetSleep(double time, VectorX& state) {
  recordFaults(time);
  std::vector<Contact> acting;
  for (const SteppedContact& stepped : stepping_.contacts()) {
    const double impulse = stepped.contact.normal.dot(stepped.impulse);
    if (impulse <= kRestSpeedFloor * lightest(stepped.contact)) continue;
    if (stepped.isImpact) bumps_.noteWithout(time, stepped.contact, impulse / lightest(stepped.contact), log_);
    acting.push_back(stepped.contact);
    record(time, stepped.contact, stepped.impulse, stepped.isImpact);
  }
  if (stepsOnly_) letSleep(time, acting, state);
  willStepOnly_ = stepsOnly_ ? !acting.empty() : acting.size() > kFewLoaded;
}

/// Takes out overlaps at the end of a step: points on rims and edges that rotate may overlap there without having been
/// contacts at its start.
void StepContacts::correctPenetrations(const LimitEvents& ropes, VectorX& state) {
  for (int round = 0; round < kMaxRemovals; ++round) {
    findTouching(state, 0, overlapping_);
    loosenShortMomentArms(state, overlapping_);
    double deepest = 0;
    for (const Contact& contact : overlapping_) deepest = std::max(deepest, -contact.separation);
    if (deepest <= tolerances().letBe()) return;
    findTouching(state, kNearOverlap * deepest, overlapping_);
    eraseHeld(state, overlapping_);
    loosenShortMomentArms(state, overlapping_);
    stepping_.correctPenetration(overlapping_, ropes.withinReach(state, state, 0), state);
  }
}

bool StepContacts::hasImpact() const {
  const auto isImpact = [](const SteppedContact& stepped) { return stepped.isImpact; };
  return std::any_of(stepping_.contacts().begin(), stepping_.contacts().end(), isImpact);
}

/// Tells an impact as an event, unless its bodies pressed each other in the step before and it is less than the
/// lighter one's weight gives in kContactTime: that, and what is no impact, is a load of a contact that lasts.
void StepContacts::record(double time, const Contact& contact, const Vec3& impulse, bool isImpact) {
  const ColliderPair& pair = assembly_.geometry.pairs[contact.pair];
  const std::pair bodies = bodiesOf(assembly_, pair);
  const double normalImpulse = contact.normal.dot(impulse);
  const bool isSmall = normalImpulse <= kContactTime * lightest(contact) * assembly_.mechanism.gravity.norm();
  if (isImpact && !(isSmall && std::ranges::binary_search(pressedBefore_, bodies)))
    log_.recordContact(time, EventKind::impact, contact, normalImpulse);
  else
    loads_.push_back(loadOf(contact, pair, impulse, assembly_));
  pressed_.push_back(bodies);
}

std::vector<ContactLoad> StepContacts::takeLoads() {
  std::sort(pressed_.begin(), pressed_.end());
  pressedBefore_ = std::exchange(pressed_, {});
  return std::exchange(loads_, {});
}

/// Mass (kg) of the lighter of the bodies at a contact.
double StepContacts::lightest(const Contact& contact) const {
  double mass = INFINITY;
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed && !assembly_.mechanism.bodies[static_cast<std::size_t>(body)].isDriven())
      mass = std::min(mass, assembly_.mechanism.bodies[static_cast<std::size_t>(body)].mass);
  return mass;
}

void StepContacts::recordFaults(double time) {
  for (const SteppingFault& fault : stepping_.takeFaults())
    log_.recordCorrection(time, fault.kind, fault.bodies, fault.amount);
}

void StepContacts::letSleep(double time, const std::vector<Contact>& contacts, VectorX& state) {
  for (const int body : resting_.letSleep(time, contacts, state))
    log_.recordBody(time, EventKind::rest, body, centerOfMass(state, body));
}

/// Contacts of this instant between bodies of which one moves, which can open or close as far as ties let them,
/// with separations of at most marginOf(bodyA, bodyB) (m).
void StepContacts::findTouching(const VectorX& state, const std::function<double(int, int)>& marginOf,
                                std::vector<Contact>& touching) {
  const ContactGeometry& geometry = assembly_.geometry;
  const auto lies = [&](int body) { return body == kFixed || resting_.isResting(body); };
  touching.clear();
  for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair) {
    const int bodyA = geometry.colliders[geometry.pairs[pair].a].body, bodyB = bodyBOf(geometry, geometry.pairs[pair]);
    if (!lies(bodyA) || !lies(bodyB)) appendContacts(geometry, pair, state, marginOf(bodyA, bodyB), touching);
  }
  if (touching.empty() || !tieSolver_.hasConstraints()) return;
  tieSolver_.factorize(state);
  eraseImmobile(ImpulseResponse(assembly_.mechanism.bodies, tieSolver_), state, touching);
}

/// Erases the contacts that limits hold which have not given way to them, and factorises the constraints for the state.
void StepContacts::eraseHeld(const VectorX& state, std::vector<Contact>& contacts) {
  if (!solver_.hasConstraints()) return;
  solver_.factorize(state);
  eraseImmobile(ImpulseResponse(assembly_.mechanism.bodies, solver_), state, contacts);
}

void StepContacts::findTouching(const VectorX& state, double margin, std::vector<Contact>& touching) {
  findTouching(
      state, [&](int, int) { return margin; }, touching);
}

void StepContacts::wakeTouched(double time, const VectorX& state) {
  bool woken = false;
  for (const Contact& contact : touching_)
    for (const int body : {contact.bodyA, contact.bodyB})
      for (const int other : resting_.wake(time, body)) {
        log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
        woken = true;
      }
  if (woken) findSimultaneous(state);
}

/// Resolves the impacts of all islands in which a contact closes, each with all its contacts. A contact rebounds if it
/// closes faster than accelerations explain: than by the speed that it gained in the last step, scaled to kRestSteps
/// whole steps.
void StepContacts::resolveImpactIslands(double time, const VectorX& before, VectorX& state) {
  for (std::vector<ImpactContact>& impacts : findImpacts(before, state)) {
    if (impacts.empty()) continue;
    const VectorX approach = state;
    resolveWithBumps(time, impacts, state);
    const bool isHard = std::any_of(impacts.begin(), impacts.end(), [&](const ImpactContact& impact) {
      return closingSpeed(impact.contact, approach) > tolerances().minImpactSpeed(timeStep_);
    });
    bookImpact(impacts, assembly_.mechanism.bodies, solver_, approach, state);
    bookNumerical(energyConstant(assembly_.mechanism, approach), assembly_.mechanism, state);
    for (const ImpactContact& impact : impacts) {
      const double impulse = impact.contact.normal.dot(impact.impulse);
      if (impulse > 0) record(time, impact.contact, impact.impulse, isHard);
    }
  }
}

/// One impact, in which normals are tilted where the scene has bumps, and then one without bumps where that has left
/// contacts closing.
void StepContacts::resolveWithBumps(double time, std::vector<ImpactContact>& impacts, VectorX& state) {
  const ImpulseResponse response(assembly_.mechanism.bodies, solver_);
  std::vector<ImpactContact> left = impacts;  // to what still closes then
  const bool isTilted = bumps_.tilt(time, state, impacts);
  log_.recordFaults(time, impacts, resolveImpact(impacts, response, state));
  if (!isTilted) return;
  if (std::any_of(left.begin(), left.end(), [&](const ImpactContact& impact) {
        return closingSpeed(impact.contact, state) > tolerances().minClosingSpeed(timeStep_);
      }))
    log_.recordFaults(time, left, resolveImpact(left, response, state));
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    impacts[i].contact = left[i].contact;
    impacts[i].impulse += left[i].impulse;
  }
}

/// Impact islands: bodies that touch each other or are joined.
DisjointSets StepContacts::findImpactIslands() const {
  DisjointSets islands(assembly_.mechanism.bodies);
  for (const Contact& contact : touching_) islands.join(contact.bodyA, contact.bodyB);
  for (const Constraint& constraint : assembly_.mechanism.constraints)
    islands.join(constraint.anchorA.body, constraint.anchorB.body);
  return islands;
}

/// The impacts of this instant by impact island; most are empty.
std::vector<std::vector<ImpactContact>> StepContacts::findImpacts(const VectorX& before, const VectorX& state) const {
  const DisjointSets islands = findImpactIslands();
  std::vector<std::vector<ImpactContact>> impacts(assembly_.mechanism.bodies.size());
  std::vector<char> isStruck(impacts.size(), 0);
  for (const Contact& contact : touching_) {
    const double closing = closingSpeed(contact, state);
    const double gained = closing + contact.normal.dot(relativeVelocity(contact, state, before));
    const double restSpeed = std::max(StepTolerances::kRestSteps * std::max(0.0, gained / stepPart_),
                                      tolerances().minImpactSpeed(timeStep_));
    const auto island = static_cast<std::size_t>(islands.islandOf(contact.bodyA, contact.bodyB));
    impacts[island].push_back({contact, assembly_.geometry.pairs[contact.pair].material, restSpeed, Vec3::Zero()});
    if (closing > tolerances().minClosingSpeed(timeStep_)) isStruck[island] = 1;
  }
  for (std::size_t island = 0; island < impacts.size(); ++island)
    if (!isStruck[island]) impacts[island].clear();
  return impacts;
}

}  // namespace cradle
