#include "constraints/weld.h"

#include "constraints/ball_joint.h"
#include "constraints/orthogonal_directions.h"

namespace cradle {

void putRows(const WeldConstraint& weld, const ConstraintEnds& ends, ConstraintBlock& block) {
  putRows(BallJointConstraint(), ends, block);
  block.turnsA = ends.a.rotation, block.turnsB = ends.b.rotation;  // wherever the anchors are
  putSameOrientation(weld.aFromB, ends, 3, block);
}

}  // namespace cradle
