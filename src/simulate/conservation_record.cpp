#include "simulate/conservation_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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
    : ConservationRecord(assembly, accuracy, {}) {
  measures_.startTime = assembly.startTime;
  measures_.start = invariantsOf(assembly.mechanism, assembly.state);
  measures_.startSpin = momentumSizesOf(assembly.mechanism.bodies, assembly.state, measures_.start.momentum).sum;
  const double gravity = assembly.mechanism.gravity.norm();
  measures_.largestEnergy = measures_.start.kinetic;  // an impact may take all of it at once
  for (const RigidBody& body : assembly.mechanism.bodies) {
    const double gyration = radiusOfGyration(body);
    measures_.largestEnergy += body.mass * (gravity * gyration + accuracy * accuracy);
    measures_.largestMomentum += body.mass * accuracy;
    measures_.largestSpin += body.mass * gyration * accuracy;
  }
}

ConservationRecord::ConservationRecord(const Assembly& assembly, double accuracy, Measures measures)
    : assembly_(assembly),
      ratio_(kMaxNumericalRatio * accuracy),
      isIsolated_(isIsolated(assembly)),
      measures_(std::move(measures)) {}

void ConservationRecord::measure(const VectorX& state) {
  measureEnergy(invariantsOf(assembly_.mechanism, state));
}

void ConservationRecord::measureEnergy(const Invariants& sums) {
  measures_.largestEnergy =
      std::max({measures_.largestEnergy, sums.kinetic, std::abs(sums.potential - measures_.start.potential)});
}

void ConservationRecord::add(double time, const VectorX& state) {
  const Invariants sums = invariantsOf(assembly_.mechanism, state);
  measureEnergy(sums);
  const double rounding = energyOfPlaceErrors(assembly_.mechanism, assembly_.radii, state, 0);
  measures_.energy.add(time, std::abs(numericalEnergy(state)) - rounding, ratio_ * measures_.largestEnergy);
  const auto addDissipation = [&](Measures::Dissipation& by, double taken) {
    by.given.add(time, by.taken - taken - rounding, ratio_ * measures_.largestEnergy);
    by.taken = std::max(by.taken, taken);
  };
  addDissipation(measures_.byImpact, impactEnergy(state));
  addDissipation(measures_.byFriction, frictionEnergy(state));
  addDissipation(measures_.byDamping, dampingEnergy(state));
  if (isIsolated_) addMomenta(time, state, sums);
}

void ConservationRecord::addMomenta(double time, const VectorX& state, const Invariants& sums) {
  const MomentumSizes sizes = momentumSizesOf(assembly_.mechanism.bodies, state, sums.momentum);
  const Vec3 byGravity = sizes.mass * (time - measures_.startTime) * assembly_.mechanism.gravity;
  measures_.largestMomentum = std::max(measures_.largestMomentum, sizes.momentum);
  measures_.largestSpin = std::max(measures_.largestSpin, sizes.spin);
  measures_.momentum.add(time, (sums.momentum - measures_.start.momentum - byGravity).norm(),
                         ratio_ * measures_.largestMomentum);
  measures_.spin.add(time, (sizes.sum - measures_.startSpin).norm() - sizes.spinRounding,
                     ratio_ * measures_.largestSpin);
}

std::optional<ConservationRecord::Loss> ConservationRecord::firstLoss() const {
  std::optional<Loss> first;
  const auto judge = [&](const Drift& drift, double largest, std::string_view sum) {
    const std::optional<double> time = drift.firstBeyond(ratio_ * largest);
    if (time && (!first || *time < first->time)) first = Loss{*time, sum};
  };
  judge(measures_.energy, measures_.largestEnergy, "numerical energy");
  judge(measures_.byImpact.given, measures_.largestEnergy, "energy that impacts gave");
  judge(measures_.byFriction.given, measures_.largestEnergy, "energy that friction gave");
  judge(measures_.byDamping.given, measures_.largestEnergy, "energy that damping gave");
  judge(measures_.momentum, measures_.largestMomentum, "momentum that nothing gave");
  judge(measures_.spin, measures_.largestSpin, "angular momentum that nothing gave");
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
