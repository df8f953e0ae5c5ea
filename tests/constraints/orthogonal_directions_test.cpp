#include "constraints/orthogonal_directions.h"

#include <gtest/gtest.h>

#include "constraints/moving_ends.h"

namespace cradle {
namespace {

/// The rows of putSameOrientation alone.
struct SameOrientation {
  static constexpr int kRows = 3;
  Mat3 aFromB;
};

void putRows(const SameOrientation& kept, const ConstraintEnds& ends, ConstraintBlock& block) {
  block.turnsA = ends.a.rotation, block.turnsB = ends.b.rotation;
  putSameOrientation(kept.aFromB, ends, 0, block);
}

const Mat3 kSkewed = rotationAbout(Vec3(1, -2, 0.5), 0.7).toRotationMatrix();

TEST(SameOrientation, RatesAndVelocityProductsAreTheDerivativesOfItsError) {
  EXPECT_LT(largestDerivativeError(SameOrientation{kSkewed}), kDerivativeError);
}

// At the orientation that is kept, dC/dt is the angular velocity of A against B in B's axes: those that the rows keep
// across each other, a1 and b2, turn towards each other about the third.
TEST(SameOrientation, RowsAreTheRelativeAngularVelocityWhereTheyHold) {
  const auto [endA, endB] = someMovingEnds();
  Mat3 rotationA, rotationB;
  const ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  const ConstraintBlock block = blockOf(SameOrientation{rotationA.transpose() * rotationB}, ends);
  for (int row = 0; row < 3; ++row) {
    const ConstraintRow kept = rowOf(block, row);
    EXPECT_NEAR(kept.value, 0, 1e-15);
    EXPECT_LT((kept.angularA - rotationB.col((row + 2) % 3)).norm(), 1e-14);
    EXPECT_EQ(kept.angularB, Vec3(-kept.angularA));
    EXPECT_EQ(kept.linearA, Vec3::Zero());
    EXPECT_EQ(kept.rounding, kRowRounding);
  }
}

// B turned by t about its third axis against A: a1 . b2 = -sin t, the others 0; and so on.
TEST(SameOrientation, ErrorIsTheSineOfATurn) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double turn : {1e-9, 0.4, -1.2}) {
      const MovingEnd a{Vec3::Zero(), Vec3::Zero(), Vec3::UnitX(), rotationAbout(Vec3(3, 1, 2), 1.1), Vec3::Zero()};
      Mat3 rotationA;
      ConstraintEnd endA = a.in(0, rotationA), endB = endA;
      const Mat3 rotationB = rotationA * kSkewed * rotationAbout(Vec3(Vec3::Unit(axis)), turn).toRotationMatrix();
      endB.rotation = &rotationB;
      const ConstraintBlock block = blockOf(SameOrientation{kSkewed}, {endA, endB});
      for (int row = 0; row < 3; ++row)
        EXPECT_NEAR(rowOf(block, row).value, (row + 2) % 3 == axis ? -std::sin(turn) : 0, 1e-15) << axis << row;
    }
}

}  // namespace
}  // namespace cradle
