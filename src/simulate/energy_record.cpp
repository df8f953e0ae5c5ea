#include "simulate/energy_record.h"

#include <algorithm>
#include <cmath>

#include "constraints/invariants.h"
#include "simulate/energy_guard.h"

namespace cradle {

EnergyRecord::EnergyRecord(const Assembly& assembly, double accuracy)
    : assembly_(assembly),
      ratio_(kMaxNumericalRatio * accuracy),
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
  const bool isMost = numerical_.empty() || numerical > numerical_.back().second;
  if (isMost && numerical > ratio_ * largestEnergy_) numerical_.emplace_back(time, numerical);
}

std::optional<double> EnergyRecord::firstBeyond() const {
  const double most = ratio_ * largestEnergy_;
  const auto found =
      std::find_if(numerical_.begin(), numerical_.end(), [most](const auto& at) { return at.second > most; });
  return found == numerical_.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace cradle
