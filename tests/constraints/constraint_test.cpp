#include "constraints/constraint.h"

#include <gtest/gtest.h>

#include "constraints/moving_ends.h"
#include "constraints/tumbling_bodies.h"

namespace cradle {
namespace {

const Constraints& oneOfEachKind() {
  static const Attachment a{0, Vec3(0.3, -0.2, 0.1)}, b{1, Vec3(0.1, 0.4, -0.2)}, centerB{1, Vec3::Zero()},
      fixed{kFixed, Vec3(0.2, 1, -0.4)};
  static const Constraints all = {{a, b, RodConstraint{0.8}},
                                  {b, fixed, BallJointConstraint()},
                                  {a, centerB, HingeConstraint{Vec3(2, 1, 2) / 3, {Vec3::UnitX(), Vec3::UnitZ()}}},
                                  {a, b, SliderConstraint{{Vec3::UnitY(), Vec3::UnitZ()}, Mat3::Identity()}},
                                  {fixed, a, WeldConstraint{Mat3::Identity()}},
                                  {a, b, JointCoordinate{true, Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitX(), 0.2, 0.05}},
                                  {centerB, fixed, RodConstraint{2}}};
  return all;
}

TEST(Constraint, HasTheRowsOfItsKind) {
  const int rows[] = {1, 3, 5, 5, 6, 1, 1};
  for (std::size_t i = 0; i < oneOfEachKind().size(); ++i) EXPECT_EQ(rowCount(oneOfEachKind()[i]), rows[i]) << i;
  EXPECT_EQ(rowCount(oneOfEachKind()), 22);
  EXPECT_EQ(rowCount(Constraints()), 0);
}

/// The end of a constraint at a point of a body, from the state alone.
ConstraintEnd endOf(const Attachment& anchor, const VectorX& state, Mat3& rotation) {
  if (anchor.body == kFixed) return fixedEnd(anchor.point);
  rotation = orientation(state, anchor.body).toRotationMatrix();
  const Vec3 arm = rotation * anchor.point;
  return {Vec3(centerOfMass(state, anchor.body)) + arm, arm, linearVelocity(state, anchor.body),
          angularVelocity(state, anchor.body), &rotation};
}

// The same block serves one constraint after the other, in either order: nothing of the one before is left.
TEST(Constraint, HasRowsBetweenItsAnchors) {
  const TumblingBodies at(2);
  std::vector<BodyFrame> frames;
  findBodyFrames(at.bodies, at.state, frames);
  ConstraintBlock block;
  const std::size_t count = oneOfEachKind().size();
  for (std::size_t k = 0; k < 2 * count; ++k) {
    const Constraint& constraint = oneOfEachKind()[k < count ? k : 2 * count - 1 - k];
    findRows(constraint, at.state, frames, block);
    Mat3 rotationA, rotationB;
    const ConstraintEnds ends{endOf(constraint.anchorA, at.state, rotationA),
                              endOf(constraint.anchorB, at.state, rotationB)};
    const ConstraintBlock expected = std::visit([&](const auto& kind) { return blockOf(kind, ends); }, constraint.kind);
    EXPECT_EQ(block.bodyA, constraint.anchorA.body);
    EXPECT_EQ(block.bodyB, constraint.anchorB.body);
    EXPECT_EQ(block.rows, expected.rows);
    EXPECT_EQ(block.isPoint, expected.isPoint) << k;
    EXPECT_EQ(block.scale, expected.scale);
    EXPECT_EQ(block.compliance, expected.compliance);
    EXPECT_EQ(block.turnsA, expected.turnsA) << k;
    EXPECT_EQ(block.turnsB, expected.turnsB) << k;
    constexpr double kRounding = 1e-14;  // of a few terms of some m, m/s and m/s^2
    for (int i = 0; i < block.rows; ++i) {
      const ConstraintRow found = rowOf(block, i), row = rowOf(expected, i);
      EXPECT_NEAR(found.value, row.value, kRounding) << k << " " << i;
      EXPECT_NEAR(found.velocityProduct, row.velocityProduct, 10 * kRounding) << k << " " << i;
      EXPECT_LT((found.linearA - row.linearA).norm(), kRounding) << k << " " << i;
      EXPECT_LT((found.angularA - row.angularA).norm(), kRounding) << k << " " << i;
      EXPECT_LT((found.angularB - row.angularB).norm(), kRounding) << k << " " << i;
    }
  }
}

TEST(Constraint, IsVisitedByItsKind) {
  std::vector<double> lengths;
  forEachOf<RodConstraint>(oneOfEachKind(), [&](const Attachment& a, const Attachment& b, const RodConstraint& rod) {
    EXPECT_NE(a.body, b.body);
    lengths.push_back(rod.length);
  });
  EXPECT_EQ(lengths, std::vector<double>({0.8, 2}));
}

}  // namespace
}  // namespace cradle
