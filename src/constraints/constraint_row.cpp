#include "constraints/constraint_row.h"

namespace cradle {
namespace {

/// w x (w x r) of a point that only turns.
Vec3 centripetalOf(const Vec3& angularVelocity, const Vec3& arm) {
  if (arm == Vec3::Zero()) return Vec3::Zero();
  return angularVelocity.cross(angularVelocity.cross(arm));
}

}  // namespace

double rateOf(const ConstraintRow& row, const VectorX& state) {
  double rate = 0;
  if (row.bodyA != kFixed)
    rate += row.linearA.dot(linearVelocity(state, row.bodyA)) + row.angularA.dot(angularVelocity(state, row.bodyA));
  if (row.bodyB != kFixed)
    rate += row.linearB.dot(linearVelocity(state, row.bodyB)) + row.angularB.dot(angularVelocity(state, row.bodyB));
  return rate;
}

ConstraintEnds endsOf(const Attachment& anchorA, const Attachment& anchorB, const VectorX& state,
                      const std::vector<BodyFrame>& frames) {
  const auto angularVelocityOf = [&](int body) {
    return body == kFixed ? Vec3::Zero() : Vec3(angularVelocity(state, body));
  };
  const auto rotationOf = [&](int body) {
    return body == kFixed ? nullptr : &frames[static_cast<std::size_t>(body)].rotation;
  };
  return {anchorA.body,
          anchorB.body,
          motionOf(anchorA, state, frames),
          motionOf(anchorB, state, frames),
          angularVelocityOf(anchorA.body),
          angularVelocityOf(anchorB.body),
          rotationOf(anchorA.body),
          rotationOf(anchorB.body)};
}

Vec3 centripetalAcceleration(const ConstraintEnds& ends) {
  return centripetalOf(ends.angularVelocityA, ends.a.arm) - centripetalOf(ends.angularVelocityB, ends.b.arm);
}

}  // namespace cradle
