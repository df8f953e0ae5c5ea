#include "study/drift_meter.h"

#include <algorithm>
#include <cmath>

#include "constraints/constraint.h"

namespace cradle {

void DriftMeter::add(const Frame& frame) {
  const EnergyBalance& energy = frame.energy;
  const double constant = energy.kinetic + energy.potential + energy.dissipated - energy.work;
  if (isFirst_) startConstant_ = constant;
  isFirst_ = false;
  energyChange_ = std::max(energyChange_, std::abs(constant - startConstant_));
  largestKinetic_ = std::max(largestKinetic_, energy.kinetic);

  const VectorX state = stateOf(assembly_, frame);
  std::vector<BodyFrame> bodies;
  findBodyFrames(assembly_.mechanism.bodies, state, bodies);
  ConstraintBlock block;
  for (const Constraint& constraint : assembly_.mechanism.constraints) {
    findRows(constraint, state, bodies, block);
    for (std::size_t row = 0; row < static_cast<std::size_t>(block.rows); ++row)
      constraintDrift_ = std::max(constraintDrift_, std::abs(block.value[row] / block.scale));
  }

  for (const Contact& overlap : overlaps_.overlapsOf(state)) penetration_ = std::max(penetration_, -overlap.separation);
}

double DriftMeter::energyDrift() const {
  return largestKinetic_ > 0 ? energyChange_ / largestKinetic_ : 0;
}

}  // namespace cradle
