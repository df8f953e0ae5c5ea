#include "constraints/constraint_block.h"

namespace cradle {

double rateOf(const ConstraintBlock& block, int row, const VectorX& state) {
  double rate = 0;
  const auto add = [&](int body, double sign, bool turns, const ConstraintBlock::Jacobian& angular) {
    if (body == kFixed) return;
    const double moving = sign * block.linear.row(row).dot(linearVelocity(state, body));
    rate += turns ? moving + angular.row(row).dot(angularVelocity(state, body)) : moving;
  };
  add(block.bodyA, 1, block.turnsA, block.angularA);
  add(block.bodyB, -1, block.turnsB, block.angularB);
  return rate;
}

}  // namespace cradle
