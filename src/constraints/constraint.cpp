#include "constraints/constraint.h"

namespace cradle {
namespace {

/// The end of a constraint at an anchor; `isOffCenter` tells whether its force turns the body.
ConstraintEnd endAt(const Attachment& anchor, const VectorX& state, const std::vector<BodyFrame>& frames,
                    bool& isOffCenter) {
  const int body = anchor.body;
  isOffCenter = body != kFixed && anchor.point != Vec3::Zero();
  if (body == kFixed) return {anchor.point, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), nullptr};
  const Mat3& rotation = frames[static_cast<std::size_t>(body)].rotation;
  const Vec3 arm = isOffCenter ? Vec3(rotation * anchor.point) : Vec3::Zero();
  return {centerOfMass(state, body) + arm, arm, linearVelocity(state, body), angularVelocity(state, body), &rotation};
}

}  // namespace

int rowCount(const Constraint& constraint) {
  return std::visit([](const auto& kind) { return kind.kRows; }, constraint.kind);
}

int rowCount(const Constraints& constraints) {
  int rows = 0;
  for (const Constraint& constraint : constraints) rows += rowCount(constraint);
  return rows;
}

void findRows(const Constraint& constraint, const VectorX& state, const std::vector<BodyFrame>& frames,
              ConstraintBlock& block) {
  const auto& [anchorA, anchorB, kind] = constraint;
  const ConstraintEnds ends{endAt(anchorA, state, frames, block.turnsA), endAt(anchorB, state, frames, block.turnsB)};
  block.bodyA = anchorA.body, block.bodyB = anchorB.body;
  block.isPoint = false;
  block.scale = 1, block.compliance = 0;
  std::visit(
      [&](const auto& each) {
        block.rows = each.kRows;
        putRows(each, ends, block);
      },
      kind);
}

}  // namespace cradle
