#include "simulate/energy_record.h"

#include <algorithm>
#include <cmath>

#include "dynamics/invariants.h"
#include "simulate/energy_guard.h"

namespace cradle {

EnergyRecord::EnergyRecord(const Assembly& assembly, double accuracy)
    : assembly_(assembly),
      largestEnergy_(0),
      startPotential_(invariantsOf(assembly.mechanism, assembly.state).potential) {
  const double gravity = assembly.mechanism.gravity.norm();
  for (const RigidBody& body : assembly.mechanism.bodies) {
    const double gyration = std::sqrt(body.inertiaTensor.norm() / body.mass);
    largestEnergy_ += body.mass * (gravity * gyration + accuracy * accuracy);
  }
}

void EnergyRecord::add(double time, const VectorX& state) {
  const Invariants sums = invariantsOf(assembly_.mechanism, state);
  largestEnergy_ = std::max({largestEnergy_, sums.kinetic, std::abs(sums.potential - startPotential_)});
  const double rounding = energyOfPlaceErrors(assembly_.mechanism, assembly_.radii, state, 0);
  const double numerical = std::abs(numericalEnergy(state)) - rounding;
  if (numerical_.empty() || numerical > numerical_.back().second) numerical_.emplace_back(time, numerical);
}

std::optional<double> EnergyRecord::firstBeyond(double ratio) const {
  const double most = ratio * largestEnergy_;
  const auto found =
      std::find_if(numerical_.begin(), numerical_.end(), [most](const auto& at) { return at.second > most; });
  return found == numerical_.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace cradle
