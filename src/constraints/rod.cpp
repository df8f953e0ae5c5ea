#include "constraints/rod.h"

namespace cradle {

void putRows(const RodConstraint& rod, const ConstraintEnds& ends, ConstraintBlock& block) {
  const Vec3 d = ends.a.position - ends.b.position;
  block.linear.row(0) = d;
  block.value[0] = 0.5 * (d.squaredNorm() - rod.length * rod.length);
  block.velocityProduct[0] = (ends.a.pointVelocity() - ends.b.pointVelocity()).squaredNorm();
  block.rounding[0] = kRowRounding * rod.length;
  block.scale = rod.length;
  if (!block.turnsA && !block.turnsB) return;
  block.angularA.row(0) = ends.a.arm.cross(d), block.angularB.row(0) = -ends.b.arm.cross(d);
  block.velocityProduct[0] += d.dot(ends.centripetalAcceleration());
}

}  // namespace cradle
