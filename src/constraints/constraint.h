#pragma once

#include <variant>
#include <vector>

#include "constraints/ball_joint.h"
#include "constraints/hinge.h"
#include "constraints/joint_coordinate.h"
#include "constraints/rod.h"
#include "constraints/slider.h"
#include "constraints/weld.h"

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

/// Fills in the rows of a constraint in `state`, in which the bodies have `frames`.
void findRows(const Constraint& constraint, const VectorX& state, const std::vector<BodyFrame>& frames,
              ConstraintBlock& block);

/// Calls visit(anchorA, anchorB, kind) for each constraint of one kind.
template <class Kind, class Visit>
void forEachOf(const Constraints& constraints, const Visit& visit) {
  for (const Constraint& constraint : constraints)
    if (const Kind* kind = std::get_if<Kind>(&constraint.kind)) visit(constraint.anchorA, constraint.anchorB, *kind);
}

}  // namespace cradle
