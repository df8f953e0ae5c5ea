#include "simulate/events/contact_classification.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "constraints/disjoint_sets.h"
#include "simulate/events/contacts_on_meshes.h"
#include "simulate/events/cylinder_rims.h"
#include "simulate/events/sliding_friction.h"
#include "simulate/events/slow_sliding.h"
#include "simulate/plan/event_rate_limit.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

using Index = Eigen::Index;
using RecordGroup = std::vector<std::size_t>;  // records whose forces depend on each other

constexpr double kSameMeshSide = 0.99;  // cosine between normals: a mesh may be touched on several sides

/// Whether a contact of a body opens at that speed (m/s).
bool opensAt(double speed, const Contact& contact, const ClassificationInput& input, const IslandState& island) {
  return speed > input.tolerances.minOpeningSpeed(smallestSize(contact, island.assembly.radii));
}

/// The contacts that may be active, with their directions of sliding.
std::vector<ContactRecord> recordsOf(const ClassificationInput& input, const IslandState& island) {
  std::vector<ContactRecord> records;
  for (const Contact& contact : input.touching) {
    if (!isAwake(contact, island.resting)) continue;
    if (opensAt(openingSpeed(contact, island.state), contact, input, island)) continue;
    ContactRecord record{contact, island.assembly.geometry.pairs[contact.pair]};
    const ContactRows rows = rowsOf(contact, island.state, input.frames);
    const Vec3 sliding = tangentialVelocity(rows.place);
    record.slides = sliding.norm() > input.tolerances.slowSliding;
    if (record.slides) record.direction = sliding.normalized();
    const PreviousContact* previous = previousAt(record, input.previous, input.frames, island);
    if (previous && previous->isSlipping && !record.slides) record.slides = true, record.direction = previous->slipping;
    records.push_back(record);
  }
  return records;
}

std::vector<RecordGroup> groupsOf(const std::vector<ContactRecord>& records, const Mechanism& mechanism) {
  DisjointSets sets(mechanism.bodies);
  for (const ContactRecord& record : records) sets.join(record.contact.bodyA, record.contact.bodyB);
  for (const Constraint& constraint : mechanism.constraints)
    sets.join(constraint.anchorA.body, constraint.anchorB.body);
  std::vector<RecordGroup> groups(mechanism.bodies.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const int first = sets.islandOf(records[i].contact.bodyA, records[i].contact.bodyB);
    groups[static_cast<std::size_t>(first)].push_back(i);
  }
  std::erase_if(groups, [](const RecordGroup& group) { return group.empty(); });
  return groups;
}

/// Whether the accelerations of a state derivative press no contact together by more than rounding.
bool nothingCloses(const std::vector<ContactRows>& rows, const VectorX& derivative, double gravity) {
  return std::all_of(rows.begin(), rows.end(), [&](const ContactRows& contact) {
    return rateOf(contact.block, 2, derivative) + contact.block.velocityProduct[2] >=
           -EventTolerances::kClosingRounding * gravity;
  });
}

/// The contacts on their way to a classification.
struct Candidates {
  std::vector<ContactRecord> records;
  ContactFallback fallback;
};

/// Marks statically indeterminate contacts: those of a group whose active rows have less than full rank. `delassus` is
/// J M^-1 J^T of these rows. A fallback if there are too many of them to be solved at each evaluation.
void countRows(const RecordGroup& group, const MatrixX& delassus, const Assembly& assembly, Candidates& found) {
  Eigen::ColPivHouseholderQR<MatrixX> factor(delassus);
  factor.setThreshold(EventTolerances::kRankRatio);
  const Index rank = factor.rank();
  for (const std::size_t i : group) found.records[i].isRedundant = rank < delassus.rows();
  if (delassus.rows() - rank <= kMaxRedundant && rank <= kMaxIndependent) return;
  std::vector<const Contact*> contacts;
  for (const std::size_t i : group) contacts.push_back(&found.records[i].contact);
  found.fallback = fallbackAt("too many contacts press at once", contacts, assembly);
}

/// Logs that forces were not found to the tolerance. They classify the contacts all the same.
void logUnsolved(const std::vector<const ContactRecord*>& records, double residual, IslandState& island) {
  std::vector<int> bodies;
  for (const ContactRecord* record : records) bodies.push_back(record->contact.movingBody());
  island.log.recordCorrection(island.time, CorrectionKind::unsolvedContacts, bodies, residual);
}

/// Limits of accelerations in a group; m/s^2.
struct AccelerationLimits {
  double largest;   // of all free accelerations, and gravity
  double still;     // slower sliding sticks
  double unloaded;  // a normal force that gives no more carries nothing
};

/// Force and acceleration of a contact, of A relative to B.
struct ContactState {
  double force, inverseMass;  // N, 1/kg: along the normal
  Vec3 acceleration;          // m/s^2, (t1, t2, n)
};

/// Sets whether a contact is loaded, opens, sticks or slides.
void classifyOne(const ContactRows& rows, const ContactState& state, const AccelerationLimits& limits,
                 ContactRecord& record) {
  record.mass = 1 / state.inverseMass, record.force = limits.largest * record.mass;
  record.isLoaded = state.force > limits.unloaded / state.inverseMass;
  record.opens = !record.isLoaded && state.acceleration.z() > EventTolerances::kStillRatio * limits.largest;
  if (!record.isLoaded || !(record.pair.material.staticFriction > 0) || record.slides) return;
  record.sticks = state.acceleration.head<2>().norm() <= limits.still;
  if (record.sticks) return;
  record.slides = true;
  record.direction = (rows.block.linear.topRows<2>().transpose() * state.acceleration.head<2>()).normalized();
}

/// Marks the contacts that slip in a solution: those that stuck before, and are accelerated by more than `still`
/// (m/s^2). True if there are any whose friction drops by that.
bool findSlipping(const RecordGroup& group, const SlidingSolution& solution, double still, Candidates& found) {
  bool isAny = false;
  for (std::size_t k = 0; k < group.size(); ++k) {
    ContactRecord& record = found.records[group[k]];
    const ContactMaterial& material = record.pair.material;
    const Index at = 3 * static_cast<Index>(k);
    if (record.slides || record.slips || !(material.dynamicFriction < material.staticFriction)) continue;
    if (!(solution.impulses[at + 2] > 0 && solution.velocities.segment<2>(at).norm() > still)) continue;
    record.slips = isAny = true;
  }
  return isAny;
}

/// Contacts of a group that are classified: how they go on.
struct GoingContacts {
  const std::vector<const ContactRecord*>& records;
  const std::vector<ContactRows>& rows;  // at the island's state
  const VectorX& derivative;             // of it, with the forces of contacts

  /// m/s^2, (t1, t2, n) each, at a state near the island's, and its time, of contacts that slide as `sliding` says. Of
  /// `island` the equations are evaluated. `moved` gets the rows there.
  VectorX accelerationsAt(const std::vector<const ContactRecord*>& sliding, double time, const VectorX& state,
                          IslandState& island, std::vector<ContactRows>& moved) const {
    const Mechanism& mechanism = island.assembly.mechanism;
    std::vector<BodyFrame> frames;
    findBodyFrames(mechanism.bodies, state, frames);
    ConstraintSolver constraints(mechanism.constraints, mechanism.bodies);
    if (constraints.hasConstraints()) constraints.factorize(state, frames);
    moved.clear();
    for (const ContactRows& contact : rows) moved.push_back(rowsOf(contact.constraint, state, frames));
    VectorX free;
    island.equations.evaluateWithoutContacts(time, state, free);
    const DenseDelassus delassus(blocksOf(moved), mechanism.bodies, frames, &constraints);
    return solveContactForces(sliding, moved, delassus, free, records[0]->sharesLoads).velocities;
  }

  /// The state to which these accelerations lead within a short time (s).
  VectorX stateAfter(double time, const IslandState& island) const {
    VectorX state = island.state + time * derivative;
    place(island.assembly.mechanism.driven, island.time + time, state);
    return state;
  }

  /// m/s^2, of the sliding of each at a state near the island's, and its time; others have that of what sticks.
  VectorX slidingAt(double time, const VectorX& state, IslandState& island) const {
    std::vector<ContactRows> moved;
    const VectorX accelerations = accelerationsAt(records, time, state, island, moved);
    VectorX sliding(std::ssize(records));
    for (Index k = 0; k < sliding.size(); ++k) sliding[k] = accelerations.segment<2>(3 * k).norm();
    return sliding;
  }

  /// m/s^3: the rates of the accelerations of sliding.
  VectorX changesOfSliding(const EventTolerances& tolerances, IslandState& island) const {
    const double step = tolerances.rateTime;
    return (slidingAt(island.time + step, stateAfter(step, island), island) -
            slidingAt(island.time, island.state, island)) /
           step;
  }

  /// 1/s, in the frames of their B: how fast the directions turn in which contacts begin to slide, over a time (s).
  /// Friction across them has to take what loads change there, to the first order in the time.
  std::vector<Vec3> turningOfSliding(const std::vector<char>& slid, double step, IslandState& island) const {
    std::vector<ContactRecord> beginning;
    for (std::size_t k = 0; k < records.size(); ++k) beginning.push_back(*records[k]);
    for (std::size_t k = 0; k < records.size(); ++k)
      if (!slid[k]) beginning[k].slips = std::exchange(beginning[k].slides, false);
    std::vector<const ContactRecord*> members;
    for (const ContactRecord& record : beginning) members.push_back(&record);
    std::vector<ContactRows> moved;
    const VectorX state = stateAfter(step, island);
    const VectorX accelerations = accelerationsAt(members, island.time + step, state, island, moved);
    std::vector<Vec3> rates(records.size(), Vec3::Zero());
    for (std::size_t k = 0; k < records.size(); ++k) {
      const Eigen::Vector2d sliding = accelerations.segment<2>(3 * static_cast<Index>(k));
      if (slid[k] || !records[k]->slides || sliding.isZero(0)) continue;
      const Vec3 then = moved[k].block.linear.topRows<2>().transpose() * sliding.normalized();
      const ContactConstraint& constraint = rows[k].constraint;
      rates[k] =
          (inFrameOfB(constraint, then, state) - inFrameOfB(constraint, records[k]->direction, island.state)) / step;
    }
    return rates;
  }
};

/// Tells which contacts of a group begin to slide so slowly that they keep their directions (those of a face turn them
/// steadily), and a fallback where that does not help. `accelerations` are those of the contacts, (t1, t2, n) each,
/// `largest` m/s^2; `slid` tells which slid before.
void findSlowSliding(const RecordGroup& group, const GoingContacts& contacts, const VectorX& accelerations,
                     double largest, const std::vector<char>& slid, const EventTolerances& tolerances,
                     IslandState& island, Candidates& found) {
  VectorX changes;             // found only where they matter
  double shortest = INFINITY;  // s: for which a direction is kept
  for (std::size_t k = 0; k < group.size(); ++k) {
    ContactRecord& record = found.records[group[k]];
    if (!record.isLoaded || !record.slides) continue;
    const Index at = static_cast<Index>(k);
    SlidingAccelerations sliding{accelerations.segment<2>(3 * at).norm(), largest};
    if (!slidesTooSlowly(record, sliding, tolerances, island)) continue;
    if (changes.size() == 0) changes = contacts.changesOfSliding(tolerances, island);
    sliding.change = changes[at];
    const double kept = timeOfKeptDirection(sliding, tolerances);
    record.keepsDirectionUntil = island.time + kept;
    shortest = std::min(shortest, kept);
    if (slidesTooSlowly(record, sliding, tolerances, island))
      found.fallback = fallbackAt(kSlidesTooSlowly, {&record.contact}, island.assembly);
  }
  if (!std::isfinite(shortest) || !found.records[group[0]].sharesLoads) return;
  const std::vector<Vec3> rates = contacts.turningOfSliding(slid, shortest, island);
  for (std::size_t k = 0; k < group.size(); ++k) found.records[group[k]].directionRate = rates[k];
}

/// Classifies the contacts of one group by their forces and accelerations.
void classifyGroup(const RecordGroup& group, const ClassificationInput& input, ConstraintSolver& constraints,
                   IslandState& island, Candidates& found) {
  const Mechanism& mechanism = island.assembly.mechanism;
  std::vector<ContactRows> rows;
  std::vector<const ContactRecord*> members;
  for (const std::size_t i : group) {
    rows.push_back(rowsOf(found.records[i].contact, island.state, input.frames));
    members.push_back(&found.records[i]);
  }
  const bool sharesLoads = shareLoads(members, island);
  VectorX derivative;
  island.equations.evaluateWithoutContacts(island.time, island.state, derivative);
  if (nothingCloses(rows, derivative, mechanism.gravity.norm())) return;
  const DenseDelassus delassus(blocksOf(rows), mechanism.bodies, input.frames, &constraints);
  SlidingSolution solution = solveContactForces(members, rows, delassus, derivative, sharesLoads);
  const double largest = std::max(delassus.accelerations(derivative).cwiseAbs().maxCoeff(), mechanism.gravity.norm());
  // Accelerations that give less than a speed of rounding over the whole run do not count.
  const double most = std::max(EventTolerances::kStillRatio * largest, kRestSpeedFloor / island.scene.duration);
  // Where contacts slip, friction is dynamic, and others may follow: at most all of them do, one after the other.
  while (findSlipping(group, solution, input.tolerances.stillAcceleration(largest, solution.residual), found))
    solution = solveContactForces(members, rows, delassus, derivative, sharesLoads);
  if (!(solution.residual <= most)) logUnsolved(members, solution.residual, island);
  const AccelerationLimits limits{
      largest, input.tolerances.stillAcceleration(largest, solution.residual),
      (input.isReleasing ? EventTolerances::kReleasedRatio : EventTolerances::kUnloadedRatio) * largest};
  const MatrixX& matrix = delassus.matrix();
  std::vector<char> slid;
  for (std::size_t k = 0; k < group.size(); ++k) {
    ContactRecord& record = found.records[group[k]];
    const Index at = 3 * static_cast<Index>(k);
    slid.push_back(record.slides);
    record.slips = false, record.sharesLoads = sharesLoads;
    classifyOne(rows[k], {solution.impulses[at + 2], matrix(at + 2, at + 2), solution.velocities.segment<3>(at)},
                limits, record);
  }
  std::vector<Index> activeRows;
  for (std::size_t k = 0; k < group.size(); ++k) {
    ContactRecord& record = found.records[group[k]];
    const Index at = 3 * static_cast<Index>(k);
    if (!record.isLoaded) continue;
    if (!canLast(record.contact))  // with planes only rims are neither corners nor round
      found.fallback =
          fallbackAt(record.pair.againstPlane ? kTips : "edges touch and press", {&record.contact}, island.assembly);
    activeRows.push_back(at + 2);
    if (record.sticks) activeRows.push_back(at), activeRows.push_back(at + 1);
  }
  delassus.apply(solution.impulses, derivative);
  findSlowSliding(group, {members, rows, derivative}, solution.velocities, largest, slid, input.tolerances, island,
                  found);
  if (!activeRows.empty()) countRows(group, matrix(activeRows, activeRows), island.assembly, found);
  if (!(solution.frictionError <= most)) found.fallback = jamAt(members, island.assembly);
}

/// A corner stays a corner when the face beside it tips, but a cylinder rolls on over its rim. Rows keep points of a
/// rim as they are only as long as the cylinder stands or lies still, on two of them at least.
bool tips(const ContactRecord& record, const std::vector<ContactRecord>& records, const ClassificationInput& input,
          const IslandState& island) {
  const ContactGeometry& geometry = island.assembly.geometry;
  if (!record.isLoaded || !standsOnRim(geometry, record.contact)) return false;
  const auto isBeside = [&](const ContactRecord& other) {
    const bool isSide = !other.contact.lineA.isZero(0) && !other.contact.lineB.isZero(0);
    return other.contact.pair == record.contact.pair && (isSide || standsOnRim(geometry, other.contact)) &&
           other.contact.normal.dot(record.contact.normal) > kSameMeshSide;
  };
  const auto carries = [&](const ContactRecord& other) { return isBeside(other) && other.isLoaded; };
  const auto opens = [&](const ContactRecord& other) { return isBeside(other) && other.opens; };
  return std::count_if(records.begin(), records.end(), carries) < 2 ||
         std::any_of(records.begin(), records.end(), opens) ||
         opensAt(tippingSpeed(geometry, island.state, record.contact), record.contact, input, island);
}

/// Cylinders that lie and may tip roll on a rim from now on; those that stand have no rows.
void letCylindersTip(const ClassificationInput& input, const IslandState& island, Candidates& found) {
  std::vector<ContactRecord*> tipping;
  for (ContactRecord& record : found.records)
    if (tips(record, found.records, input, island)) tipping.push_back(&record);
  for (ContactRecord* record : tipping)
    if (!rollOnRim(island.assembly.geometry, island.state, record->contact))
      found.fallback = fallbackAt(kTips, {&record->contact}, island.assembly);
}

}  // namespace

ClassifiedContacts classifyContacts(const ClassificationInput& input, ConstraintSolver& constraints,
                                    IslandState& island) {
  Candidates found{recordsOf(input, island), {}};
  const std::vector<ContactRecord>& records = found.records;
  for (const RecordGroup& group : groupsOf(records, island.assembly.mechanism))
    classifyGroup(group, input, constraints, island, found);
  letCylindersTip(input, island, found);
  for (const ContactRecord& record : records)
    if (record.isLoaded && canLast(record.contact) &&
        !isServedOnMesh(record, input.tolerances.touch, input.frames, island))
      found.fallback = fallbackAt("a body moves over the edges of a mesh", {&record.contact}, island.assembly);
  ClassifiedContacts result{{}, {}, std::move(found.fallback)};
  for (const ContactRecord& record : records) {
    if (record.isLoaded) result.active.push_back(record);
    if (record.sharesLoads && !record.isLoaded && !record.opens) result.idle.push_back(record);
  }
  return result;
}

}  // namespace cradle
