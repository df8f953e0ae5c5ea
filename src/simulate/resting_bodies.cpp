#include "simulate/resting_bodies.h"

#include <algorithm>
#include <cmath>

#include "constraints/disjoint_sets.h"
#include "constraints/invariants.h"
#include "impact/contact_delassus.h"
#include "impact/frictional_contact.h"
#include "impact/sparse_delassus.h"

namespace cradle {
namespace {

constexpr std::size_t kFewSupports = 12;  // whose forces are found densely
constexpr double kMinLoadRatio =
    1e-9;  // of the largest force that keeps bodies still: less touches, and carries nothing

bool holdsAny(const SupportForce& support, const std::vector<int>& bodies) {
  const auto isOfContact = [&](int body) { return body == support.contact.bodyA || body == support.contact.bodyB; };
  return std::any_of(bodies.begin(), bodies.end(), isOfContact);
}

}  // namespace

RestingBodies::RestingBodies(const Mechanism& mechanism, const ContactGeometry& geometry, EquationsOfMotion& equations)
    : mechanism_(mechanism),
      geometry_(geometry),
      equations_(equations),
      tolerances_(stepTolerancesOf({smallestSize(geometry), mechanism.gravity.norm()})),
      sizes_(mechanism.bodies.size(), 0.0),
      wakeTimes_(mechanism.bodies.size(), -INFINITY),
      restingIsland_(mechanism.bodies.size(), -1) {
  for (std::size_t i = 0; i < sizes_.size(); ++i) sizes_[i] = gyrationRadius(mechanism.bodies[i]);
  for (const Collider& collider : geometry.colliders)
    if (collider.body != kFixed) sizes_[static_cast<std::size_t>(collider.body)] = collider.boundingRadius;
}

std::vector<int> RestingBodies::islandsOf(const std::vector<Contact>& contacts) const {
  DisjointSets joined(mechanism_.bodies.size());
  for (const Contact& contact : contacts) joined.join(contact.bodyA, contact.bodyB);
  for (const SpringForce& spring : mechanism_.springs) joined.join(spring.anchorA.body, spring.anchorB.body);
  for (const Constraint& constraint : mechanism_.constraints)
    joined.join(constraint.anchorA.body, constraint.anchorB.body);
  std::vector<int> islands;
  for (std::size_t body = 0; body < sizes_.size(); ++body) islands.push_back(joined.islandOf(static_cast<int>(body)));
  return islands;
}

/// What is shaken again and again does not rest in between.
bool RestingBodies::isStill(double time, std::size_t body, const VectorX& state) const {
  if (mechanism_.bodies[body].isDriven()) return isDrivenStill(mechanism_.driven, static_cast<int>(body), time);
  return time - wakeTimes_[body] >= stillTime_ && isSlow(body, state);
}

bool RestingBodies::isSlow(std::size_t index, const VectorX& state) const {
  const Eigen::Index body = static_cast<Eigen::Index>(index);
  const double speed2 = linearVelocity(state, body).squaredNorm() +
                        sizes_[index] * sizes_[index] * angularVelocity(state, body).squaredNorm();
  return speed2 < tolerances_.maxSlowSquare(sizes_[index]);
}

/// The contact forces that keep an island still, if there are any within the friction cones.
std::optional<std::vector<SupportForce>> RestingBodies::findEquilibrium(double time, const std::vector<int>& islands,
                                                                        int island, const VectorX& state) {
  // Accelerations stand in for velocities: the impulses that stop them are then the forces of the equilibrium.
  VectorX derivative, accelerations = state;
  equations_.evaluate(time, state, derivative);
  const Eigen::Index velocities = static_cast<Eigen::Index>(islands.size()) * kVelocitySize;
  accelerations.segment(poseComponents(state), velocities) = derivative.segment(poseComponents(state), velocities);

  std::vector<Contact> near, supports;
  std::vector<double> frictions;
  findContacts(geometry_, state, tolerances_.support, near);
  const auto leaves = [&](int body) {  // what is driven carries nothing that it does not go with
    return body != kFixed && mechanism_.bodies[static_cast<std::size_t>(body)].isDriven() &&
           islands[static_cast<std::size_t>(body)] != island;
  };
  for (const Contact& contact : near) {
    if (islands[static_cast<std::size_t>(contact.movingBody())] != island || leaves(contact.bodyB)) continue;
    supports.push_back(contact);
    frictions.push_back(geometry_.pairs[contact.pair].material.staticFriction);
    const Vec3 velocity = relativeVelocity(contact, state),
               slip = velocity - contact.normal.dot(velocity) * contact.normal;
    const double most = tolerances_.maxSmoothSlip(smallestSize(contact, sizes_));
    if (frictions.back() == 0 && slip.norm() > most) return std::nullopt;
  }
  std::vector<SupportForce> forces = applySupportForces(supports, frictions, state, accelerations);

  for (std::size_t i = 0; i < islands.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const double left =
        std::max(linearVelocity(accelerations, body).norm(), sizes_[i] * angularVelocity(accelerations, body).norm());
    if (islands[i] == island && left > tolerances_.residualAcceleration) return std::nullopt;
  }
  return forces;
}

/// Adds to the accelerations what forces at the supports give that leave as little closing and sliding as can be;
/// returns the forces.
std::vector<SupportForce> RestingBodies::applySupportForces(const std::vector<Contact>& supports,
                                                            const std::vector<double>& frictions, const VectorX& state,
                                                            VectorX& accelerations) {
  std::vector<SupportForce> forces;
  const auto take = [&](const auto& forceAt) {
    for (std::size_t i = 0; i < supports.size(); ++i)
      forces.push_back({supports[i], geometry_.pairs[supports[i].pair], forceAt(i)});
  };
  ConstraintSolver solver(mechanism_.constraints, mechanism_.bodies);
  if (solver.hasConstraints()) solver.factorize(state);
  if (supports.size() <= kFewSupports) {
    const ContactDelassus cones(supports, ImpulseResponse(mechanism_.bodies, solver), state);
    const VectorX free = cones.velocitiesIn(accelerations);
    const VectorX impulses = solveFrictionalContact(cones.matrix(), free, frictions).impulses;
    cones.apply(impulses, accelerations);
    take([&](std::size_t i) { return cones.worldImpulse(i, impulses); });
    return forces;
  }
  SparseDelassus cones;
  cones.set(supports, mechanism_.bodies, solver, state);
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(supports.size());
  WarmStart start{VectorX::Zero(size), VectorX::Zero(size), 0};
  const VectorX free = cones.velocitiesIn(accelerations);
  const VectorX impulses =
      solveFrictionalContact(cones.scaledOperator(), free, frictions, tolerances_.forceError, start).impulses;
  cones.apply(impulses, accelerations);
  take([&](std::size_t i) { return Vec3(cones.axes(i) * impulses.segment<3>(3 * static_cast<Eigen::Index>(i))); });
  return forces;
}

std::vector<int> RestingBodies::letSleep(double time, const std::vector<Contact>& contacts, VectorX& state) {
  std::vector<int> asleep;
  if (contacts.empty()) return asleep;
  const std::vector<int> islands = islandsOf(contacts);
  std::vector<char> candidate(islands.size(), 0);
  for (const Contact& contact : contacts)
    for (const int body : {contact.bodyA, contact.bodyB})
      if (body != kFixed && !isResting(body))
        candidate[static_cast<std::size_t>(islands[static_cast<std::size_t>(body)])] = 1;
  for (std::size_t body = 0; body < islands.size(); ++body)
    if (!isStill(time, body, state)) candidate[static_cast<std::size_t>(islands[body])] = 0;

  for (std::size_t island = 0; island < islands.size(); ++island) {
    if (!candidate[island]) continue;
    const auto supports = findEquilibrium(time, islands, static_cast<int>(island), state);
    if (!supports) continue;
    std::vector<int> members;
    for (std::size_t body = 0; body < islands.size(); ++body) {
      if (islands[body] != static_cast<int>(island)) continue;
      if (!equations_.isResting(body)) asleep.push_back(static_cast<int>(body));
      members.push_back(static_cast<int>(body));
    }
    bringToRest(members, state, *supports);
  }
  return asleep;
}

void RestingBodies::bringToRest(const std::vector<int>& bodies, VectorX& state,
                                const std::vector<SupportForce>& supports) {
  setSupports(bodies, supports);
  for (const int body : bodies) {
    numericalEnergy(state) += kineticEnergy(mechanism_.bodies[static_cast<std::size_t>(body)], body, state);
    state.segment<kVelocitySize>(velocityOffset(state, body)).setZero();
    equations_.setResting(static_cast<std::size_t>(body), true);
    restingIsland_[static_cast<std::size_t>(body)] = bodies[0];
  }
}

RestingBodies::Record RestingBodies::record() const {
  Record record{restingIsland_, wakeTimes_, *supports_};
  for (std::size_t body = 0; body < record.islands.size(); ++body)
    if (!equations_.isResting(body)) record.islands[body] = -1;
  return record;
}

void RestingBodies::goOnFrom(const Record& record) {
  restingIsland_ = record.islands, wakeTimes_ = record.wakeTimes;
  supports_ = std::make_shared<std::vector<SupportForce>>(record.supports);
  for (std::size_t body = 0; body < restingIsland_.size(); ++body)
    if (restingIsland_[body] >= 0) equations_.setResting(body, true);
}

bool RestingBodies::allRest() const {
  for (std::size_t body = 0; body < sizes_.size(); ++body)
    if (!equations_.isResting(body)) return false;
  return true;
}

bool RestingBodies::anyRests() const {
  const std::vector<char>& resting = equations_.resting();
  return std::any_of(resting.begin(), resting.end(), [](char rests) { return rests != 0; });
}

std::vector<int> RestingBodies::wake(double time, int body) {
  std::vector<int> woken;
  if (!isResting(body)) return woken;
  const int island = restingIsland_[static_cast<std::size_t>(body)];
  for (std::size_t other = 0; other < restingIsland_.size(); ++other) {
    if (!equations_.isResting(other) || restingIsland_[other] != island) continue;
    equations_.setResting(other, false);
    wakeTimes_[other] = time;
    woken.push_back(static_cast<int>(other));
  }
  setSupports(woken, {});
  return woken;
}

/// Replaces the forces that keep bodies still. Most contacts that touch and carry nothing have some from rounding.
void RestingBodies::setSupports(const std::vector<int>& bodies, const std::vector<SupportForce>& supports) {
  auto all = std::make_shared<std::vector<SupportForce>>(*supports_);
  std::erase_if(*all, [&](const SupportForce& support) { return holdsAny(support, bodies); });
  double most = 0;  // N
  for (const SupportForce& support : supports) most = std::max(most, support.force.norm());
  for (const SupportForce& support : supports)
    if (support.force.norm() > kMinLoadRatio * most) all->push_back(support);
  supports_ = std::move(all);
}

}  // namespace cradle
