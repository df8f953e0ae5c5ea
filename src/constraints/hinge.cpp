#include "constraints/hinge.h"

#include "constraints/ball_joint.h"
#include "constraints/orthogonal_directions.h"

namespace cradle {

void putRows(const HingeConstraint& hinge, const ConstraintEnds& ends, ConstraintBlock& block) {
  putRows(BallJointConstraint(), ends, block);
  block.turnsA = ends.a.rotation, block.turnsB = ends.b.rotation;  // wherever the anchors are
  for (std::size_t i = 0; i < 2; ++i) putOrthogonal(hinge.axisA, hinge.acrossB[i], ends, 3 + i, block);
}

}  // namespace cradle
