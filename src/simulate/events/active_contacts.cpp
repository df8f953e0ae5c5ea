// Which contacts are loaded, stick and slide is Coulomb's problem on accelerations; those that slide already keep their
// direction, and their friction follows their normal forces.

#include "simulate/events/active_contacts.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "impact/contact_impulse.h"
#include "math/anderson_mixing.h"
#include "simulate/plan/disjoint_sets.h"
#include "simulate/plan/event_rate_limit.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

/// m/s: of the surfaces along each other.
double slidingSpeed(const Contact& contact, const VectorX& state) {
  const Vec3 velocity = relativeVelocity(contact, state);
  return (velocity - contact.normal.dot(velocity) * contact.normal).norm();
}

using Index = Eigen::Index;

constexpr double kUnloadedRatio = 1e-9;  // of the accelerations: a contact that takes less carries nothing
constexpr double kReleasedRatio = 1e-6;  // the same when another is released: what is symmetric is released together
constexpr double kAccelerationRounding = 1e-14;  // of gravity
constexpr double kStillRatio = 1e-7;             // of the accelerations: less is held
constexpr int kMaxFrictionRounds = 200;          // of normal forces from friction, and friction from these
constexpr int kPlainFrictionRounds = 10;         // before they are mixed: most end sooner
constexpr int kMaxRoundsInVain = 10;             // without progress: in each of these ...
constexpr double kProgress = 0.9;                // ... the change is no smaller a part of the smallest
constexpr double kFrictionConverged = 1e-10;     // of the largest normal force
constexpr double kSameSide = 0.99;               // cosine between normals: a mesh may be touched on several
constexpr double kRankRatio = 1e-9;              // of the largest pivot: less is none
constexpr double kTurningTime = 2e-5;            // s: friction that turns sliding as fast costs 4 s of CPU a second
constexpr int kMaxTurningSteps = 1000;           // in a row: sliding that ends does so in some hundred
constexpr double kCreepRatio = 0.02;             // of mu g: see slidesTooSlowly
constexpr double kCreepOfAccuracy = 50;          // 1/(m s^2), of mu g T^2 A
constexpr const char* kTips = "a cylinder tips over its rim";
constexpr const char* kSlidesTooSlowly = "contacts slide so slowly that their friction has no sure direction";

}  // namespace

void ActiveContacts::classify(const std::vector<Contact>& touching, ConstraintSolver& constraints) {
  findBodyFrames(mechanism().bodies, island_.state, frames_);
  std::vector<ContactRecord> records = recordsOf(touching);
  if (!records.empty())
    for (const ContactGroup& group : groupsOf(records)) classify(group, records, constraints);
  noteTipping(records);
  noteMeshes(records);
  for (const ContactRecord& record : records)
    if (record.isLoaded) add(record);
  recordChanges();
}

void ActiveContacts::releaseResting() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    if (!isAwake(records_[i].contact)) continue;
    records_[kept] = records_[i];
    mechanism().contacts[kept++] = mechanism().contacts[i];
  }
  records_.resize(kept);
  mechanism().contacts.resize(kept);
}

bool ActiveContacts::isAwake(const Contact& contact) const {
  const auto isUp = [this](int body) { return body != kFixed && !island_.resting.isResting(body); };
  return isUp(contact.bodyA) || isUp(contact.bodyB);
}

/// The contacts that may last, and what their speeds say of them.
std::vector<ActiveContacts::ContactRecord> ActiveContacts::recordsOf(const std::vector<Contact>& touching) const {
  std::vector<ContactRecord> records;
  for (const Contact& contact : touching) {
    if (!isAwake(contact)) continue;
    if (openingSpeed(contact, island_.state) > stillSpeed(contact)) continue;
    ContactRecord record{contact, island_.assembly.geometry.pairs[contact.pair]};
    const ContactRows rows = rowsOf(contact, island_.state, frames_);
    const Vec3 sliding = tangentialVelocity(rows.place);
    record.slides = sliding.norm() > kSlowestSliding;
    if (record.slides) record.direction = sliding.normalized();
    const PreviousContact* previous = previousOf(record);
    if (previous && previous->isSlipping && !record.slides) record.slides = true, record.direction = previous->slipping;
    records.push_back(record);
  }
  return records;
}

std::vector<ActiveContacts::ContactGroup> ActiveContacts::groupsOf(const std::vector<ContactRecord>& records) const {
  DisjointSets islands(mechanism().bodies.size());
  for (const ContactRecord& record : records) islands.join(record.contact.bodyA, record.contact.bodyB);
  forEachConstraint(mechanism().constraints, [&](int bodyA, int bodyB) { islands.join(bodyA, bodyB); });
  std::vector<ContactGroup> groups(mechanism().bodies.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const int first = islands.islandOf(records[i].contact.movingBody());
    groups[static_cast<std::size_t>(first)].push_back(i);
  }
  std::erase_if(groups, [](const ContactGroup& group) { return group.empty(); });
  return groups;
}

void ActiveContacts::classify(const ContactGroup& group, std::vector<ContactRecord>& records,
                              ConstraintSolver& constraints) {
  std::vector<ContactRows> rows;
  std::vector<const ContactRecord*> members;
  for (const std::size_t i : group) {
    rows.push_back(rowsOf(records[i].contact, island_.state, frames_));
    members.push_back(&records[i]);
  }
  island_.equations.evaluate(island_.state, derivative_);
  if (nothingCloses(rows)) return;
  const ContactResponse response(rows, mechanism().bodies, frames_, constraints);
  const VectorX free = response.accelerations(derivative_);
  const ContactSolution solution = solve(members, rows, response);
  const double most = std::max(free.cwiseAbs().maxCoeff(), mechanism().gravity.norm());
  if (!(solution.residual <= kStillRatio * most)) noteUnsolved(members, solution.residual);
  const double still = stillAcceleration(island_.scene.accuracy, island_.scene.duration, most, solution.residual);
  const double unloaded = (isReleasing_ ? kReleasedRatio : kUnloadedRatio) * most;
  const MatrixX& delassus = response.delassus();
  std::vector<Index> activeRows;
  for (std::size_t k = 0; k < group.size(); ++k) {
    ContactRecord& record = records[group[k]];
    const Index at = 3 * static_cast<Index>(k);
    const Vec3 motion = solution.velocities.segment<3>(at);
    record.mass = 1 / delassus(at + 2, at + 2), record.force = most * record.mass;
    record.isLoaded = solution.impulses[at + 2] > unloaded / delassus(at + 2, at + 2);
    record.opens = !record.isLoaded && motion.z() > kStillRatio * most;
    if (!record.isLoaded) continue;
    if (!canLast(record.contact))  // on planes only rims are neither corners nor round
      noteFallback(record.pair.againstPlane ? kTips : "edges touch and press", {&record.contact});
    const bool hasFriction = record.pair.material.staticFriction > 0;
    record.sticks = hasFriction && !record.slides && motion.head<2>().norm() <= still;
    if (hasFriction && !record.slides && !record.sticks) {
      record.slides = true;
      record.direction = (motion.x() * rows[k].rows[0].linearA + motion.y() * rows[k].rows[1].linearA).normalized();
    }
    if (record.slides && slidesTooSlowly(record, motion.head<2>().norm(), most))
      noteFallback(kSlidesTooSlowly, {&record.contact});
    activeRows.push_back(at + 2);
    if (record.sticks) activeRows.push_back(at), activeRows.push_back(at + 1);
  }
  if (!activeRows.empty()) countRows(group, delassus(activeRows, activeRows), records);
}

/// Whether sliding stays so slow that the direction of its friction is not known, or costs too much to follow. Errors
/// of velocities turn friction aside: an error e = A / 10 (what steps allow) at a speed v takes mu g (e / v)^2 / 2 of
/// its deceleration, and half of that times T^2 of the way in a time T: more than the accuracy A below v = T sqrt(mu g
/// A) / 20; not of a sphere, which soon rolls. And friction turns the sliding at a derivative of mu g / v, which steps
/// of some 6 v / (mu g) follow at the most. Speeds that are reached in time count. What starts from rest with an
/// acceleration a passes through v = e sqrt(mu g / (2 a)), where these errors outweigh a. That takes v / a of its time,
/// T / 30 sqrt(mu g / (2 a)) of the accuracy at 1e-4 (measured: a block on a slope), and less at finer ones; below a =
/// mu g / 50 it may get no farther, as there is time for errors to grow to e.
bool ActiveContacts::slidesTooSlowly(const ContactRecord& record, double acceleration, double gravity) const {
  const double friction = record.pair.material.dynamicFriction * gravity;  // m/s^2
  const double time = island_.scene.duration, accuracy = island_.scene.accuracy;
  const std::vector<Collider>& colliders = island_.assembly.geometry.colliders;
  const bool rolls =
      colliders[record.pair.a].isSphere() || (!record.pair.againstPlane && colliders[record.pair.b].isSphere());
  const double slowest = std::max(rolls ? 0 : time * std::sqrt(friction * accuracy) / 20, kTurningTime * friction);
  const double speed = slidingSpeed(record.contact, island_.state);
  const double creeping = friction * std::min(kCreepRatio, kCreepOfAccuracy * time * time * accuracy);  // m/s^2
  const double passed = accuracy * std::sqrt(friction / (2 * std::max(acceleration, creeping)));  // m/s: ten times v
  return speed + acceleration * time < slowest || (!rolls && speed < passed && acceleration < creeping);
}

/// Forces that were not found decide all the same what lasts, and how.
void ActiveContacts::noteUnsolved(const std::vector<const ContactRecord*>& records, double residual) const {
  std::vector<int> bodies;
  for (const ContactRecord* record : records) bodies.push_back(record->contact.movingBody());
  island_.log.recordCorrection(island_.time, CorrectionKind::unsolvedContacts, bodies, residual);
}

/// m/s: what leaves more slowly does not leave.
double ActiveContacts::stillSpeed(const Contact& contact) const {
  const double size = smallestSize(contact, island_.assembly.radii);
  return kLastBounceRatio * std::sqrt(mechanism().gravity.norm() * size) + kRestSpeedFloor;
}

/// Whether a cylinder touches by points of its rims, or its side, that stay the same as long as it stands or lies.
bool ActiveContacts::isOfRim(const Contact& contact) const {
  if (!contact.rimAxisA.isZero(0)) return false;
  const ContactGeometry& geometry = island_.assembly.geometry;
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const auto isCylinder = [&](std::size_t collider) {
    return geometry.colliders[collider].kind() == ColliderKind::cylinder;
  };
  return (isCylinder(pair.a) && std::isfinite(contact.radiusA)) ||
         (!pair.againstPlane && isCylinder(pair.b) && std::isfinite(contact.radiusB));
}

/// m/s, at its rim: how fast a cylinder leaves the position in which it touches.
double ActiveContacts::tippingSpeed(const Contact& contact) const {
  const ContactGeometry& geometry = island_.assembly.geometry;
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const bool isA = geometry.colliders[pair.a].kind() == ColliderKind::cylinder && std::isfinite(contact.radiusA);
  const Collider& cylinder = geometry.colliders[isA ? pair.a : pair.b];
  const auto angularVelocityOf = [&](int body) -> Vec3 {
    return body == kFixed ? Vec3(Vec3::Zero()) : Vec3(angularVelocity(island_.state, body));
  };
  const Vec3 axis = Core(cylinder, poseOf(island_.state, cylinder.body)).axis();
  const Vec3 axisVelocity = (angularVelocityOf(contact.bodyA) - angularVelocityOf(contact.bodyB)).cross(axis);
  const bool isLying = std::abs(axis.dot(contact.normal)) < 0.5;
  return cylinder.boundingRadius * (isLying ? std::abs(axisVelocity.dot(contact.normal)) : axisVelocity.norm());
}

/// A corner stays one when the face beside it tips, but a cylinder rolls on over its rim: rows hold points of it only
/// as long as it stands or lies still, on two of them at least.
void ActiveContacts::noteTipping(const std::vector<ContactRecord>& records) {
  for (const ContactRecord& record : records) {
    if (!record.isLoaded || !isOfRim(record.contact)) continue;
    const auto isBeside = [&](const ContactRecord& other) {
      return other.contact.pair == record.contact.pair && isOfRim(other.contact) &&
             other.contact.normal.dot(record.contact.normal) > kSameSide;
    };
    const auto isLoaded = [&](const ContactRecord& other) { return isBeside(other) && other.isLoaded; };
    const auto opens = [&](const ContactRecord& other) { return isBeside(other) && other.opens; };
    if (std::count_if(records.begin(), records.end(), isLoaded) < 2 ||
        std::any_of(records.begin(), records.end(), opens) || tippingSpeed(record.contact) > stillSpeed(record.contact))
      noteFallback(kTips, {&record.contact});
  }
}

/// Notes whose forces are not unique, and whether rows are too many. `delassus`: J M^-1 J^T of the rows that hold.
void ActiveContacts::countRows(const ContactGroup& group, const MatrixX& delassus,
                               std::vector<ContactRecord>& records) {
  Eigen::ColPivHouseholderQR<MatrixX> factor(delassus);
  factor.setThreshold(kRankRatio);
  const Index rank = factor.rank();
  for (const std::size_t i : group) records[i].isRedundant = rank < delassus.rows();
  if (delassus.rows() - rank <= kMaxRedundant && rank <= kMaxIndependent) return;
  std::vector<const Contact*> contacts;
  for (const std::size_t i : group) contacts.push_back(&records[i].contact);
  noteFallback("too many contacts press at once", contacts);
}

/// What forces with hardly any lever do is not known to the accuracy.
void ActiveContacts::noteShortMomentArms(const std::vector<Contact>& touching, ConstraintSolver& constraints,
                                         double lever) {
  const ImpulseResponse response(mechanism().bodies, constraints);
  for (const Contact& contact : touching)
    if (hasShortLever(contact, response, island_.state, lever))
      noteFallback("something touches within a thousandth of its size of a joint", {&contact});
}

bool ActiveContacts::noteJam() {
  std::vector<const Contact*> sliding;
  for (const ContactRecord& record : records_)
    if (record.isLoaded && record.slides && record.pair.material.dynamicFriction > 0)
      sliding.push_back(&record.contact);
  if (sliding.empty()) return false;
  noteFallback("friction jams where contacts slide", sliding);
  return true;
}

/// Bodies of the scene are named: those of pairs that have gone may be told later.
void ActiveContacts::noteFallback(std::string_view reason, const std::vector<const Contact*>& contacts) {
  fallbackReason_ = reason;
  fallbackBodies_ = sceneBodiesOf(contacts);
}

std::vector<int> ActiveContacts::sceneBodies() const {
  std::vector<const Contact*> contacts;
  for (const ContactRecord& record : records_) contacts.push_back(&record.contact);
  return sceneBodiesOf(contacts);
}

/// In the order of the scene.
std::vector<int> ActiveContacts::sceneBodiesOf(const std::vector<const Contact*>& contacts) const {
  std::vector<int> bodies;
  for (const Contact* contact : contacts) {
    const auto [a, b] = bodiesOf(island_.assembly, island_.assembly.geometry.pairs[contact->pair]);
    bodies.push_back(a), bodies.push_back(b);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  return bodies;
}

/// Whether the accelerations in derivative_ press no contact together by more than rounding.
bool ActiveContacts::nothingCloses(const std::vector<ContactRows>& rows) const {
  const double most = kAccelerationRounding * mechanism().gravity.norm();
  return std::all_of(rows.begin(), rows.end(), [&](const ContactRows& contact) {
    return rateOf(contact.rows[2], derivative_) + contact.rows[2].velocityProduct >= -most;
  });
}

/// N: the normal forces of those that slide.
VectorX ActiveContacts::pressingOf(const std::vector<const ContactRecord*>& records, const VectorX& impulses) {
  VectorX pressing = VectorX::Zero(std::ssize(records));
  for (Index k = 0; k < pressing.size(); ++k)
    if (records[static_cast<std::size_t>(k)]->slides) pressing[k] = impulses[3 * k + 2];
  return pressing;
}

/// N: friction of those that slide, in the rows of all, for these normal forces.
VectorX ActiveContacts::frictionOf(const std::vector<const ContactRecord*>& records,
                                   const std::vector<ContactRows>& rows, const VectorX& pressing) {
  VectorX friction = VectorX::Zero(3 * pressing.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (!records[k]->slides) continue;
    const Index contact = static_cast<Index>(k);
    const double size = records[k]->pair.material.dynamicFriction * pressing[contact];
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}})
      friction[3 * contact + static_cast<Index>(i)] = -size * records[k]->direction.dot(rows[k].rows[i].linearA);
  }
  return friction;
}

/// Forces and accelerations of contacts whose free accelerations are those in derivative_. Those that slide have their
/// friction against their direction, from the normal forces of the round before. Where friction and normal forces drive
/// each other, rounds alone come to an end slowly, or not at all; where friction jams there is no end.
ContactSolution ActiveContacts::solve(const std::vector<const ContactRecord*>& records,
                                      const std::vector<ContactRows>& rows, const ContactResponse& response) const {
  const VectorX free = response.accelerations(derivative_);
  std::vector<double> frictions;
  bool slides = false;
  for (const ContactRecord* record : records) {
    frictions.push_back(record->slides ? 0 : record->pair.material.staticFriction);
    slides = slides || (record->slides && record->pair.material.dynamicFriction > 0);
  }
  VectorX normals = VectorX::Zero(std::ssize(records)), friction = VectorX::Zero(free.size());
  ContactSolution solution;
  AndersonMixing mixing;
  double least = INFINITY;
  int roundsInVain = 0;
  for (int round = 0; round < kMaxFrictionRounds; ++round) {
    solution = solveFrictionalContact(response.delassus(), free + response.delassus() * friction, frictions,
                                      solution.impulses);
    if (!slides) break;
    const VectorX pressing = pressingOf(records, solution.impulses), next = frictionOf(records, rows, pressing);
    const double change = (next - friction).cwiseAbs().maxCoeff();
    friction = next;
    if (change <= kFrictionConverged * pressing.maxCoeff()) break;
    roundsInVain = change < kProgress * least ? 0 : roundsInVain + 1;
    least = std::min(least, change);
    if (roundsInVain == kMaxRoundsInVain) break;
    normals = round < kPlainFrictionRounds ? pressing : VectorX(mixing.next(normals, pressing).cwiseMax(0));
    if (round >= kPlainFrictionRounds) friction = frictionOf(records, rows, normals);
  }
  solution.impulses += friction;
  return solution;
}

void ActiveContacts::add(const ContactRecord& record) {
  ContactConstraint constraint = rowsOf(record.contact, island_.state, frames_).constraint;
  if (record.sticks) constraint.motion = ContactMotion::sticking;
  if (record.slides && record.pair.material.dynamicFriction > 0) {
    constraint.motion = ContactMotion::sliding;
    constraint.friction = record.pair.material.dynamicFriction;
    setSlidingDirection(constraint, record.direction, island_.state);
  }
  mechanism().contacts.push_back(constraint);
  records_.push_back(record);
}

const std::vector<ActiveFeature>& ActiveContacts::features() {
  features_.clear();
  const ContactGeometry& geometry = island_.assembly.geometry;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const ColliderPair& own = records_[i].pair;
    const auto isSame = [&](const ColliderPair& pair) {
      return pair.a == own.a && pair.b == own.b && pair.againstPlane == own.againstPlane;
    };
    const auto pair = std::find_if(geometry.pairs.begin(), geometry.pairs.end(), isSame);
    if (pair == geometry.pairs.end()) continue;
    ActiveFeature feature{static_cast<std::size_t>(pair - geometry.pairs.begin()), 0, mechanism().contacts[i],
                          touchedFeature(records_[i].contact)};
    const Collider& a = geometry.colliders[own.a];
    if (own.againstPlane) {
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

void ActiveContacts::followSliding() {
  const ContactRecord* turning = nullptr;
  bool isPlaced = false;
  for (std::size_t i = 0; i < records_.size(); ++i) {
    ContactConstraint& contact = mechanism().contacts[i];
    if (contact.motion != ContactMotion::sliding) continue;
    if (!isPlaced) findBodyFrames(mechanism().bodies, island_.state, frames_);
    isPlaced = true;
    const Vec3 sliding = tangentialVelocity(kinematicsOf(contact, island_.state, frames_));
    const double speed = sliding.norm();
    if (speed > kSlowestSliding) setSlidingDirection(contact, sliding / speed, island_.state);
    const ContactRecord& record = records_[i];
    const double normal = before_[i][0] * record.force;  // N: at the end of the step that changed nothing
    if (speed < kTurningTime * record.pair.material.dynamicFriction * normal / record.mass) turning = &record;
  }
  turningSteps_ = turning ? turningSteps_ + 1 : 0;
  if (turningSteps_ > kMaxTurningSteps) noteFallback(kSlidesTooSlowly, {&turning->contact});
}

}  // namespace cradle
