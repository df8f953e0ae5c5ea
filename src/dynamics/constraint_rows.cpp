#include "dynamics/constraint_rows.h"

namespace cradle {
namespace {

/// w x (w x r): acceleration of a point that only turns.
Vec3 centripetalAcceleration(const Attachment& attachment, const Vec3& arm, const VectorX& state) {
  if (attachment.body == kFixed) return Vec3::Zero();
  const Vec3 spin = angularVelocity(state, attachment.body);
  return spin.cross(spin.cross(arm));
}

}  // namespace

ConstraintRow rowOf(const RodConstraint& rod, const VectorX& state) {
  const AttachmentMotion a = motionOf(rod.anchorA, state), b = motionOf(rod.anchorB, state);
  const Vec3 d = a.position - b.position, rate = a.velocity - b.velocity;
  ConstraintRow row{rod.anchorA.body, rod.anchorB.body, d, a.arm.cross(d), -d, -b.arm.cross(d), 0, 0};
  row.value = 0.5 * (d.squaredNorm() - rod.length * rod.length);
  row.curvature = rate.squaredNorm() + d.dot(centripetalAcceleration(rod.anchorA, a.arm, state) -
                                             centripetalAcceleration(rod.anchorB, b.arm, state));
  return row;
}

double rateOf(const ConstraintRow& row, const VectorX& state) {
  double rate = 0;
  if (row.bodyA != kFixed)
    rate += row.linearA.dot(linearVelocity(state, row.bodyA)) + row.angularA.dot(angularVelocity(state, row.bodyA));
  if (row.bodyB != kFixed)
    rate += row.linearB.dot(linearVelocity(state, row.bodyB)) + row.angularB.dot(angularVelocity(state, row.bodyB));
  return rate;
}

}  // namespace cradle
