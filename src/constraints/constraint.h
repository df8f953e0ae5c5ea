#pragma once

#include <type_traits>
#include <variant>
#include <vector>

#include "constraints/ball_joint.h"
#include "constraints/hinge.h"
#include "constraints/joint_coordinate.h"
#include "constraints/rod.h"
#include "constraints/slider.h"
#include "constraints/weld.h"
#include "core/error.h"

namespace cradle {

/// A bilateral constraint of two bodies, or of a body and the world, between a point of each. What it keeps, and in how
/// many rows, is told by its kind alone.
struct Constraint {
  Attachment anchorA, anchorB;
  std::variant<RodConstraint, BallJointConstraint, HingeConstraint, SliderConstraint, WeldConstraint, JointCoordinate>
      kind;
};

using Constraints = std::vector<Constraint>;

/// Number of rows of a constraint, or of all.
int rowCount(const Constraint& constraint);
int rowCount(const Constraints& constraints);

/// Calls visit(std::integral_constant of `rows`): loops over the rows of a constraint have a length that the compiler
/// knows.
template <class Visit>
void withRows(int rows, const Visit& visit) {
  if (rows == 1) return visit(std::integral_constant<int, 1>());
  if (rows == 3) return visit(std::integral_constant<int, 3>());
  if (rows == 5) return visit(std::integral_constant<int, 5>());
  CRADLE_CHECK(rows == 6);
  visit(std::integral_constant<int, 6>());
}

/// Fills in the rows of a constraint in `state`, in which the bodies have `frames`.
void findRows(const Constraint& constraint, const VectorX& state, const std::vector<BodyFrame>& frames,
              ConstraintBlock& block);

/// The rows of all constraints, one by one, in their order.
void findRows(const Constraints& constraints, const VectorX& state, const std::vector<BodyFrame>& frames,
              std::vector<ConstraintRow>& rows);

/// Calls visit(anchorA, anchorB, kind) for each constraint of one kind.
template <class Kind, class Visit>
void forEachOf(const Constraints& constraints, const Visit& visit) {
  for (const Constraint& constraint : constraints)
    if (const Kind* kind = std::get_if<Kind>(&constraint.kind)) visit(constraint.anchorA, constraint.anchorB, *kind);
}

}  // namespace cradle
