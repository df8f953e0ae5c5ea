#include "dynamics/constraint_rows.h"

namespace cradle {
namespace {

constexpr double kRounding = 1e-15;  // of the lengths that enter a row: a few units in their last place

/// Both ends of a constraint at one instant.
struct Ends {
  AttachmentMotion a, b;
  Vec3 spinA, spinB;  // rad/s, world; zero if fixed
};

Vec3 spinOf(int body, const VectorX& state) {
  return body == kFixed ? Vec3::Zero() : Vec3(angularVelocity(state, body));
}

Ends endsOf(const Attachment& anchorA, const Attachment& anchorB, const VectorX& state,
            const std::vector<BodyFrame>& frames) {
  return {motionOf(anchorA, state, frames), motionOf(anchorB, state, frames), spinOf(anchorA.body, state),
          spinOf(anchorB.body, state)};
}

/// w x (w x r) of a point that only turns.
Vec3 centripetalAcceleration(const Vec3& spin, const Vec3& arm) {
  if (arm == Vec3::Zero()) return Vec3::Zero();
  return spin.cross(spin.cross(arm));
}

/// That of A minus that of B.
Vec3 centripetalAcceleration(const Ends& ends) {
  return centripetalAcceleration(ends.spinA, ends.a.arm) - centripetalAcceleration(ends.spinB, ends.b.arm);
}

bool isAtCenter(const Attachment& anchor) {
  return anchor.body == kFixed || anchor.point == Vec3::Zero();
}

/// Filled in where it stands: rods are most of the bodies' constraints of many scenes.
void addRow(const RodConstraint& rod, const VectorX& state, const std::vector<BodyFrame>& frames,
            std::vector<ConstraintRow>& rows) {
  const AttachmentMotion a = motionOf(rod.anchorA, state, frames), b = motionOf(rod.anchorB, state, frames);
  const Vec3 d = a.position - b.position;
  ConstraintRow& row = rows.emplace_back();
  row.bodyA = rod.anchorA.body, row.bodyB = rod.anchorB.body;
  row.linearA = d, row.linearB = -d;
  row.value = 0.5 * (d.squaredNorm() - rod.length * rod.length);
  row.velocityProduct = (a.velocity - b.velocity).squaredNorm();
  row.scale = rod.length;
  row.rounding = kRounding * rod.length;
  if (isAtCenter(rod.anchorA) && isAtCenter(rod.anchorB)) {
    row.angularA.setZero(), row.angularB.setZero();
    return;
  }
  row.angularA = a.arm.cross(d), row.angularB = -b.arm.cross(d);
  row.velocityProduct += d.dot(centripetalAcceleration({a, b, spinOf(row.bodyA, state), spinOf(row.bodyB, state)}));
}

void addPointRows(const Attachment& anchorA, const Attachment& anchorB, const Ends& ends,
                  std::vector<ConstraintRow>& rows) {
  const Vec3 error = ends.a.position - ends.b.position, velocityProduct = centripetalAcceleration(ends);
  const double size = ends.a.position.norm() + ends.a.arm.norm() + ends.b.arm.norm();
  for (int i = 0; i < 3; ++i) {
    const Vec3 direction = Vec3::Unit(i);
    rows.push_back({anchorA.body, anchorB.body, direction, ends.a.arm.cross(direction), -direction,
                    -ends.b.arm.cross(direction), error[i], velocityProduct[i], 1, kRounding * size});
  }
}

Vec3 turned(int body, const Vec3& direction, const std::vector<BodyFrame>& frames) {
  return body == kFixed ? direction : Vec3(frames[static_cast<std::size_t>(body)].rotation * direction);
}

void addAxisRows(const HingeConstraint& hinge, const Ends& ends, const std::vector<BodyFrame>& frames,
                 std::vector<ConstraintRow>& rows) {
  const Vec3 axis = turned(hinge.anchorA.body, hinge.axisA, frames);
  for (const Vec3& acrossB : hinge.acrossB) {
    const Vec3 across = turned(hinge.anchorB.body, acrossB, frames), lever = axis.cross(across);
    const Vec3 leverRate = ends.spinA.cross(axis).cross(across) + axis.cross(ends.spinB.cross(across));
    rows.push_back({hinge.anchorA.body, hinge.anchorB.body, Vec3::Zero(), lever, Vec3::Zero(), -lever, axis.dot(across),
                    leverRate.dot(ends.spinA - ends.spinB), 1, kRounding});
  }
}

}  // namespace

void findRows(const Constraints& constraints, const VectorX& state, const std::vector<BodyFrame>& frames,
              std::vector<ConstraintRow>& rows, const std::vector<char>& excluded) {
  const auto isOut = [&](const auto& constraint) {
    const int a = constraint.anchorA.body, b = constraint.anchorB.body;
    return !excluded.empty() && ((a != kFixed && excluded[static_cast<std::size_t>(a)]) ||
                                 (b != kFixed && excluded[static_cast<std::size_t>(b)]));
  };
  rows.clear();
  for (const RodConstraint& rod : constraints.rods)
    if (!isOut(rod)) addRow(rod, state, frames, rows);
  for (const BallJointConstraint& joint : constraints.ballJoints)
    if (!isOut(joint))
      addPointRows(joint.anchorA, joint.anchorB, endsOf(joint.anchorA, joint.anchorB, state, frames), rows);
  for (const HingeConstraint& hinge : constraints.hinges) {
    if (isOut(hinge)) continue;
    const Ends ends = endsOf(hinge.anchorA, hinge.anchorB, state, frames);
    addPointRows(hinge.anchorA, hinge.anchorB, ends, rows);
    addAxisRows(hinge, ends, frames, rows);
  }
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
