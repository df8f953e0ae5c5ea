#include "constraints/constraint_row.h"

namespace cradle {

double rateOf(const ConstraintRow& row, const VectorX& state) {
  double rate = 0;
  if (row.bodyA != kFixed)
    rate += row.linearA.dot(linearVelocity(state, row.bodyA)) + row.angularA.dot(angularVelocity(state, row.bodyA));
  if (row.bodyB != kFixed)
    rate += row.linearB.dot(linearVelocity(state, row.bodyB)) + row.angularB.dot(angularVelocity(state, row.bodyB));
  return rate;
}

}  // namespace cradle
