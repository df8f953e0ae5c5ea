#include "simulate/conservation_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulate/energy_guard.h"

namespace cradle {
namespace {

constexpr double kSpinRounding = 64 * std::numeric_limits<double>::epsilon();  // of places and velocities

bool actsFromOutside(const Attachment& a, const Attachment& b) {
  return a.body == kFixed || b.body == kFixed;
}

/// Whether nothing but gravity acts on the bodies of an island from outside of it.
bool isIsolated(const Assembly& assembly) {
  const auto isTied = [](const auto& link) { return actsFromOutside(link.anchorA, link.anchorB); };
  const auto areFree = [&](const auto& links) { return std::none_of(links.begin(), links.end(), isTied); };
  const std::vector<Collider>& colliders = assembly.geometry.colliders;
  return assembly.pushes.empty() && assembly.mechanism.driven.empty() && assembly.geometry.planes.empty() &&
         areFree(assembly.mechanism.springs) && areFree(assembly.mechanism.constraints) &&
         std::none_of(assembly.limits.begin(), assembly.limits.end(),
                      [](const Limit& limit) {
                        const auto [a, b] = bodiesOf(limit);
                        return a == kFixed || b == kFixed;
                      }) &&
         std::none_of(colliders.begin(), colliders.end(), [](const Collider& c) { return c.body == kFixed; });
}

double radiusOfGyration(const RigidBody& body) {
  return body.isDriven() ? 0 : std::sqrt(body.inertiaTensor.norm() / body.mass);
}

/// Magnitudes of the bodies' momenta about the centre of mass of all, and what rounding may change of their sum.
struct MomentumSizes {
  double mass = 0;                // kg
  double momentum = 0, spin = 0;  // kg m/s, kg m^2/s
  double spinRounding = 0;        // kg m^2/s
  Vec3 sum = Vec3::Zero();        // kg m^2/s: angular momentum about the centre
};

MomentumSizes momentumSizesOf(const std::vector<RigidBody>& bodies, const VectorX& state, const Vec3& momentum) {
  MomentumSizes sizes;
  Vec3 center = Vec3::Zero();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    sizes.mass += bodies[i].mass;
    center += bodies[i].mass * centerOfMass(state, static_cast<Eigen::Index>(i));
  }
  center /= sizes.mass;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const Vec3 place = centerOfMass(state, body), velocity = linearVelocity(state, body);
    const Vec3 arm = place - center, relative = velocity - momentum / sizes.mass;
    const Vec3 own = spinMomentum(bodies[i], body, state);
    const double mass = bodies[i].mass;
    sizes.momentum += mass * velocity.norm();
    sizes.spin += mass * arm.norm() * relative.norm() + own.norm();
    sizes.spinRounding += kSpinRounding * mass * (place.norm() * relative.norm() + arm.norm() * velocity.norm());
    sizes.sum += mass * arm.cross(relative) + own;
  }
  return sizes;
}

}  // namespace

std::optional<double> Drift::firstBeyond(double most) const {
  const auto found =
      std::find_if(largest_.begin(), largest_.end(), [most](const auto& at) { return at.second > most; });
  return found == largest_.end() ? std::nullopt : std::optional(found->first);
}

ConservationRecord::ConservationRecord(const Assembly& assembly, double accuracy)
    : assembly_(assembly),
      ratio_(kMaxNumericalRatio * accuracy),
      isIsolated_(isIsolated(assembly)),
      start_(invariantsOf(assembly.mechanism, assembly.state)),
      startSpin_(momentumSizesOf(assembly.mechanism.bodies, assembly.state, start_.momentum).sum) {
  const double gravity = assembly.mechanism.gravity.norm();
  largestEnergy_ = start_.kinetic;  // an impact may take all of it at once
  for (const RigidBody& body : assembly.mechanism.bodies) {
    const double gyration = radiusOfGyration(body);
    largestEnergy_ += body.mass * (gravity * gyration + accuracy * accuracy);
    largestMomentum_ += body.mass * accuracy;
    largestSpin_ += body.mass * gyration * accuracy;
  }
}

void ConservationRecord::measure(const VectorX& state) {
  measureEnergy(invariantsOf(assembly_.mechanism, state));
}

void ConservationRecord::measureEnergy(const Invariants& sums) {
  largestEnergy_ = std::max({largestEnergy_, sums.kinetic, std::abs(sums.potential - start_.potential)});
}

void ConservationRecord::add(double time, const VectorX& state) {
  const Invariants sums = invariantsOf(assembly_.mechanism, state);
  measureEnergy(sums);
  const double rounding = energyOfPlaceErrors(assembly_.mechanism, assembly_.radii, state, 0);
  energy_.add(time, std::abs(numericalEnergy(state)) - rounding, ratio_ * largestEnergy_);
  const auto addDissipation = [&](Dissipation& by, double taken) {
    by.given.add(time, by.taken - taken - rounding, ratio_ * largestEnergy_);
    by.taken = std::max(by.taken, taken);
  };
  addDissipation(byImpact_, impactEnergy(state));
  addDissipation(byFriction_, frictionEnergy(state));
  addDissipation(byDamping_, dampingEnergy(state));
  if (isIsolated_) addMomenta(time, state, sums);
}

void ConservationRecord::addMomenta(double time, const VectorX& state, const Invariants& sums) {
  const MomentumSizes sizes = momentumSizesOf(assembly_.mechanism.bodies, state, sums.momentum);
  const Vec3 byGravity = sizes.mass * (time - assembly_.startTime) * assembly_.mechanism.gravity;
  largestMomentum_ = std::max(largestMomentum_, sizes.momentum);
  largestSpin_ = std::max(largestSpin_, sizes.spin);
  momentum_.add(time, (sums.momentum - start_.momentum - byGravity).norm(), ratio_ * largestMomentum_);
  spin_.add(time, (sizes.sum - startSpin_).norm() - sizes.spinRounding, ratio_ * largestSpin_);
}

std::optional<ConservationRecord::Loss> ConservationRecord::firstLoss() const {
  std::optional<Loss> first;
  const auto judge = [&](const Drift& drift, double largest, std::string_view sum) {
    const std::optional<double> time = drift.firstBeyond(ratio_ * largest);
    if (time && (!first || *time < first->time)) first = Loss{*time, sum};
  };
  judge(energy_, largestEnergy_, "numerical energy");
  judge(byImpact_.given, largestEnergy_, "energy that impacts gave");
  judge(byFriction_.given, largestEnergy_, "energy that friction gave");
  judge(byDamping_.given, largestEnergy_, "energy that damping gave");
  judge(momentum_, largestMomentum_, "momentum that nothing gave");
  judge(spin_, largestSpin_, "angular momentum that nothing gave");
  return first;
}

PromiseEnd endOf(const ConservationRecord::Loss& loss, const std::vector<int>& bodies, const Scene& scene) {
  PromiseEnd end{
      loss.time, fmt::format("{} is beyond {:g} times the accuracy", loss.sum, kMaxNumericalRatio), bodies, {}};
  end.warning = fmt::format("{}: the accuracy asked was not kept from {:.6g} s on: {} ({})", scene.path, end.time,
                            end.reason, namesOfBodies(bodies, scene));
  return end;
}

}  // namespace cradle
