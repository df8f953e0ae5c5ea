#include "constraints/constraint.h"

namespace cradle {

int rowCount(const Constraint& constraint) {
  return std::visit([](const auto& kind) { return kind.kRows; }, constraint.kind);
}

int rowCount(const Constraints& constraints) {
  int rows = 0;
  for (const Constraint& constraint : constraints) rows += rowCount(constraint);
  return rows;
}

void findRows(const Constraints& constraints, const VectorX& state, const std::vector<BodyFrame>& frames,
              std::vector<ConstraintRow>& rows, const std::vector<char>& excluded) {
  const auto isOut = [&](int body) {
    return body != kFixed && !excluded.empty() && excluded[static_cast<std::size_t>(body)];
  };
  rows.clear();
  for (const Constraint& constraint : constraints) {
    if (isOut(constraint.anchorA.body) || isOut(constraint.anchorB.body)) continue;
    const ConstraintEnds ends = endsOf(constraint.anchorA, constraint.anchorB, state, frames);
    std::visit([&](const auto& kind) { appendRows(kind, ends, rows); }, constraint.kind);
  }
}

}  // namespace cradle
