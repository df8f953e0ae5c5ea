#include "constraints/weld.h"

#include <gtest/gtest.h>

#include "constraints/moving_ends.h"

namespace cradle {
namespace {

TEST(Weld, RatesAndVelocityProductsAreTheDerivativesOfItsError) {
  EXPECT_LT(largestDerivativeError(WeldConstraint{rotationAbout(Vec3(1, -2, 0.5), 0.7).toRotationMatrix()}),
            kDerivativeError);
}

// A ball joint's rows, and three that turn both bodies wherever the anchors are.
TEST(Weld, HoldsTheAnchorsAndTurnsBothBodies) {
  std::array<MovingEnd, 2> ends = someMovingEnds();
  for (MovingEnd& end : ends) end.point.setZero();
  Mat3 rotationA, rotationB;
  const ConstraintBlock block = blockOf(WeldConstraint(), {ends[0].in(0, rotationA), ends[1].in(0, rotationB)});
  EXPECT_TRUE(block.isPoint && block.turnsA && block.turnsB);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(rowOf(block, i).value, (ends[0].center - ends[1].center)[i]);
    EXPECT_EQ(rowOf(block, i).linearA, Vec3(Vec3::Unit(i)));
    EXPECT_EQ(rowOf(block, 3 + i).linearA, Vec3::Zero());
    EXPECT_GT(rowOf(block, 3 + i).angularA.norm(), 0.1);
  }
}

}  // namespace
}  // namespace cradle
