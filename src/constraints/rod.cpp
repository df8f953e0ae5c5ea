#include "constraints/rod.h"

namespace cradle {

void appendRows(const RodConstraint& rod, const ConstraintEnds& ends, std::vector<ConstraintRow>& rows) {
  const Vec3 d = ends.a.position - ends.b.position;
  ConstraintRow& row = rows.emplace_back();  // filled in where it stands: many scenes have rods alone
  row.bodyA = ends.bodyA, row.bodyB = ends.bodyB;
  row.linearA = d, row.linearB = -d;
  row.value = 0.5 * (d.squaredNorm() - rod.length * rod.length);
  row.velocityProduct = (ends.a.velocity - ends.b.velocity).squaredNorm();
  row.scale = rod.length;
  row.rounding = kRowRounding * rod.length;
  if (ends.a.arm == Vec3::Zero() && ends.b.arm == Vec3::Zero()) {
    row.angularA.setZero(), row.angularB.setZero();
    return;
  }
  row.angularA = ends.a.arm.cross(d), row.angularB = -ends.b.arm.cross(d);
  row.velocityProduct += d.dot(centripetalAcceleration(ends));
}

}  // namespace cradle
