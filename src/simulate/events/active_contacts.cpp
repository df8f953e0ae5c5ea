#include "simulate/events/active_contacts.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "impact/contact_impulse.h"
#include "simulate/events/contact_classification.h"
#include "simulate/events/cylinder_rims.h"
#include "simulate/events/slow_sliding.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {
namespace {

// In a row: sliding that ends does so in some hundred. A face that begins to slide without acceleration takes more, and
// may take so many times that.
constexpr int kMaxTurningSteps = 1000;
constexpr double kTurningMargin = 3;
constexpr double kMaxTurningStepsOfFace =
    10 * kMaxTurningSteps;  // of a face that slips at 1e-11; of others they cost more

// Parts of the way to a stop at which the direction of sliding is taken, and the weights with which that of the stop is
// extrapolated from them, by a parabola.
constexpr std::array<double, 3> kAimParts = {0.7, 0.8, 0.9}, kAimWeights = {1, -3, 3};
constexpr double kFastToAim = 100;   // times slowSliding, at the first of them: slower has not its own direction
constexpr double kStopped = 1e-3;    // of the speed at the first of them: no more is left at a stop
constexpr double kStraight = 0.1;    // sine: sliding that turns by more on its last third is too curved for a parabola
constexpr double kDependent = 1e-6;  // of a row, left by what others of its pair make of it: it depends on them
constexpr double kMaxAimedSpeed = 1e-4;  // m/s: faster sliding has its own direction in any case

}  // namespace

void ActiveContacts::release(const std::optional<ContactChange>& change) {
  previous_.clear();
  changes_.forget();
  const bool slips = change && change->kind == ContactChange::Kind::slip;
  VectorX derivative;
  if (slips) island_.equations.evaluate(island_.time, island_.state, derivative);
  for (std::size_t i = 0; i < records_.size(); ++i) {
    PreviousContact previous{records_[i], mechanism().contacts[i]};
    if (slips && change->contact == i) {
      previous.isSlipping = true;
      previous.slipping = -island_.equations.contactForces()[i].tangential.normalized();
    } else if (slips && mechanism().contacts[i].motion == ContactMotion::sliding) {
      // Another contact that slips changes no velocity: one that has just begun to slide, as slowly, goes on.
      previous.isSlipping = true;
      previous.slipping = records_[i].direction;
    }
    previous_.push_back(previous);
  }
  isReleasing_ = change && change->kind == ContactChange::Kind::release;
  mechanism().contacts.clear();
  records_.clear(), bodies_.clear();
  fallback_.reason = {};
}

void ActiveContacts::classify(const std::vector<Contact>& touching, ConstraintSolver& constraints) {
  findBodyFrames(mechanism().bodies, island_.state, frames_);
  ClassifiedContacts found =
      classifyContacts({touching, previous_, frames_, isReleasing_, tolerances_}, constraints, island_);
  if (!found.fallback.reason.empty()) fallback_ = std::move(found.fallback);
  for (const ContactRecord& record : found.active) add(record, frames_);
  for (const ContactRecord& record : found.idle) addIdle(record);
  maxTurningSteps_ = kMaxTurningSteps;
  for (const ContactRecord& record : records_)
    if (record.sharesLoads && record.keepsDirectionUntil > island_.time)
      maxTurningSteps_ += kTurningMargin * stepsAfterKeptDirection(record, island_.time, tolerances_);
  maxTurningSteps_ = std::min(maxTurningSteps_, kMaxTurningStepsOfFace);
  recordContactEvents(previous_, records_, frames_, island_, island_.log);
  previous_.clear();
}

void ActiveContacts::add(const ContactRecord& record, const std::vector<BodyFrame>& frames) {
  ContactConstraint constraint = rowsOf(record.contact, island_.state, frames).constraint;
  if (record.sticks) constraint.motion = ContactMotion::sticking;
  if (record.slides && record.pair.material.dynamicFriction > 0) {
    constraint.motion = ContactMotion::sliding;
    constraint.friction = record.pair.material.dynamicFriction;
    setSlidingDirection(constraint, record.direction, island_.state);
    constraint.slowSliding = tolerances_.slowSliding;
    constraint.keepsDirection = record.keepsDirectionUntil > island_.time;
    constraint.directionTime = island_.time, constraint.directionRate = record.directionRate;
  }
  mechanism().contacts.push_back(constraint);
  records_.push_back(record);
  const auto [a, b] = bodiesOf(island_.assembly, record.pair);
  bodies_.push_back({a, b, constraint.centerA.body != record.contact.bodyA});
}

/// Finds the row of an idle contact as a sum of those of active contacts of its pair, if it depends on them.
void ActiveContacts::addIdle(const ContactRecord& idle) {
  const double size = smallestSize(idle.contact, island_.assembly.radii);
  const auto rowOf = [&](const ContactRecord& record) {
    const ConstraintBlock block = rowsOf(record.contact, island_.state, frames_).block;
    const bool isMirrored = block.bodyA != record.contact.bodyA;  // where A's surface is a face, rows have it for B
    const Vec3 linear = block.linear.row(2), angularA = block.angularA.row(2), angularB = block.angularB.row(2);
    Eigen::Matrix<double, 9, 1> row;
    row << (isMirrored ? -1 : 1) * linear, (isMirrored ? angularB : angularA) / size,
        (isMirrored ? angularA : angularB) / size;
    return row;
  };
  std::vector<std::size_t> beside;
  for (std::size_t i = 0; i < records_.size(); ++i)
    if (records_[i].contact.pair == idle.contact.pair) beside.push_back(i);
  if (beside.empty()) return;
  MatrixX rows(9, std::ssize(beside));
  for (std::size_t k = 0; k < beside.size(); ++k) rows.col(static_cast<Eigen::Index>(k)) = rowOf(records_[beside[k]]);
  const VectorX wanted = rowOf(idle);
  Eigen::CompleteOrthogonalDecomposition<MatrixX> decomposition;
  decomposition.setThreshold(EventTolerances::kRankRatio);
  const VectorX parts = decomposition.compute(rows).solve(wanted);
  if ((rows * parts - wanted).norm() > kDependent * wanted.norm()) return;
  IdleContact found;
  for (std::size_t k = 0; k < beside.size(); ++k)
    found.parts.emplace_back(beside[k], parts[static_cast<Eigen::Index>(k)]);
  records_[beside[0]].idle.push_back(found);
}

void ActiveContacts::releaseResting() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (!isAwake(records_[i].contact, island_.resting)) continue;
    records_[kept] = records_[i], bodies_[kept] = bodies_[i];
    mechanism().contacts[kept++] = mechanism().contacts[i];
  }
  records_.resize(kept), bodies_.resize(kept);
  mechanism().contacts.resize(kept);
}

/// Forces whose moment arm about a joint goes to nothing are not known to the accuracy.
void ActiveContacts::noteShortMomentArms(const std::vector<Contact>& touching, ConstraintSolver& constraints,
                                         double momentArm) {
  const ImpulseResponse response(mechanism().bodies, constraints);
  for (const Contact& contact : touching)
    if (hasShortMomentArm(contact, response, island_.state, momentArm))
      fallback_ =
          fallbackAt("something touches within a thousandth of its size of a joint", {&contact}, island_.assembly);
}

void ActiveContacts::noteTipping(const Contact& contact) {
  fallback_ = fallbackAt(kTips, {&contact}, island_.assembly);
}

bool ActiveContacts::noteJam() {
  std::vector<const ContactRecord*> loaded;
  for (const ContactRecord& record : records_)
    if (record.isLoaded) loaded.push_back(&record);
  ContactFallback jam = jamAt(loaded, island_.assembly);
  const bool isFound = !jam.reason.empty();
  if (isFound) fallback_ = std::move(jam);
  return isFound;
}

std::vector<int> ActiveContacts::sceneBodies() const {
  std::vector<const Contact*> contacts;
  for (const ContactRecord& record : records_) contacts.push_back(&record.contact);
  return sceneBodiesOf(contacts, island_.assembly);
}

const std::vector<ActiveFeature>& ActiveContacts::features() {
  features_.clear();
  const ContactGeometry& geometry = island_.assembly.geometry;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const auto isSame = [&](const ColliderPair& pair) { return isSamePair(pair, records_[i].pair); };
    const auto pair = std::find_if(geometry.pairs.begin(), geometry.pairs.end(), isSame);
    if (pair == geometry.pairs.end()) continue;
    ActiveFeature feature{static_cast<std::size_t>(pair - geometry.pairs.begin()), 0, mechanism().contacts[i],
                          touchedFeature(records_[i].contact)};
    const Collider& a = geometry.colliders[records_[i].pair.a];
    if (records_[i].pair.againstPlane) {
      const auto nearer = [&](const Vec3& left, const Vec3& right) {
        return (left - feature.contact.centerA.point).squaredNorm() <
               (right - feature.contact.centerA.point).squaredNorm();
      };
      feature.feature =
          static_cast<std::size_t>(std::min_element(a.points.begin(), a.points.end(), nearer) - a.points.begin());
    }
    features_.push_back(feature);
  }
  return features_;
}

double ActiveContacts::nextFreeDirection() const {
  double next = INFINITY;
  for (std::size_t i = 0; i < records_.size(); ++i)
    if (mechanism().contacts[i].keepsDirection) next = std::min(next, records_[i].keepsDirectionUntil);
  return next;
}

/// m/s, world: of each contact, at a fraction of the island's step.
std::vector<Vec3> ActiveContacts::slidingVelocitiesAt(double fraction) {
  interpolate(island_.step, fraction, sample_);
  place(mechanism().driven, island_.step.time + fraction * island_.step.timeStep, sample_);
  findBodyFrames(mechanism().bodies, sample_, frames_);
  std::vector<Vec3> velocities;
  for (const ContactConstraint& contact : mechanism().contacts)
    velocities.push_back(tangentialVelocity(kinematicsOf(contact, sample_, frames_)));
  return velocities;
}

// With v the velocity of sliding and 1 - p what is left of the way to the stop, v / (1 - p) has a limit there along the
// direction wanted.
bool ActiveContacts::aimAtStop(double fraction) {
  std::vector<Vec3> aims(records_.size(), Vec3::Zero());
  std::vector<Vec3> firsts;  // m/s, at the first part
  for (std::size_t k = 0; k < kAimParts.size(); ++k) {
    const std::vector<Vec3> velocities = slidingVelocitiesAt(kAimParts[k] * fraction);
    for (std::size_t i = 0; i < aims.size(); ++i) {
      aims[i] += kAimWeights[k] / (1 - kAimParts[k]) * velocities[i];
      if (k == 0) firsts.push_back(velocities[i]);
    }
  }
  const std::vector<Vec3> last = slidingVelocitiesAt(fraction);
  bool isAny = false;
  for (std::size_t i = 0; i < aims.size(); ++i) {
    ContactConstraint& contact = mechanism().contacts[i];
    if (contact.motion != ContactMotion::sliding || contact.keepsDirection) continue;
    const double speed = firsts[i].norm();
    if (!(speed > kFastToAim * tolerances_.slowSliding && last[i].norm() < kStopped * speed)) continue;
    if (!(aims[i].normalized().cross(firsts[i].normalized()).norm() < kStraight)) continue;
    isAny = true;
    setSlidingDirection(contact, aims[i], sample_);
    contact.slowSliding = std::max(tolerances_.slowSliding, std::min(kStopped * speed, kMaxAimedSpeed));
  }
  return isAny;
}

std::optional<double> ActiveContacts::followSliding() {
  const ContactRecord* fast = nullptr;
  bool isPlaced = false;
  std::optional<double> turningTime;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    ContactConstraint& contact = mechanism().contacts[i];
    if (contact.motion != ContactMotion::sliding) continue;
    if (!isPlaced) findBodyFrames(mechanism().bodies, island_.state, frames_);
    isPlaced = true;
    if (contact.keepsDirection && island_.time < records_[i].keepsDirectionUntil) continue;
    contact.slowSliding = tolerances_.slowSliding;
    const bool isFreed = contact.keepsDirection;
    if (isFreed) endKeptDirection(contact, island_.time);
    const Vec3 sliding = tangentialVelocity(kinematicsOf(contact, island_.state, frames_));
    const double speed = sliding.norm();
    if (speed > kSlowestSliding) setSlidingDirection(contact, sliding / speed, island_.state);
    const double normal = changes_.normalForceAtEnd(i, records_);
    if (isFreed) {
      const double turning = speed * records_[i].mass / (contact.friction * normal);
      turningTime = std::min(turning, turningTime.value_or(turning));
    }
    if (isDirectionTurnedFast(records_[i], speed, normal)) fast = &records_[i];
  }
  turningSteps_ = fast ? turningSteps_ + 1 : 0;
  if (turningSteps_ > maxTurningSteps_) fallback_ = fallbackAt(kSlidesTooSlowly, {&fast->contact}, island_.assembly);
  if (turningTime) changes_.forget();
  return turningTime;
}

}  // namespace cradle
