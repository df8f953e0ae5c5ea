#include "constraints/block_response.h"

#include <gtest/gtest.h>

#include "constraints/constraint_row.h"
#include "constraints/tumbling_bodies.h"

namespace cradle {
namespace {

/// Three tumbling bodies, one of which nothing turns, and blocks of one to six rows between them in all
/// orders, with anchors at a centre of mass among them.
struct BlockProblem : TumblingBodies {
  std::vector<BodyFrame> frames;
  std::vector<ConstraintBlock> blocks;
  std::vector<BlockResponse> responses;

  BlockProblem() : TumblingBodies(3) {
    bodies[2].hasConstantSpin = true, bodies[2].inverseInertia.setZero();
    findBodyFrames(bodies, state, frames);
    const Vec3 point(0.3, -0.2, 0.4), none = Vec3::Zero();
    const HingeConstraint hinge{Vec3(2, 1, 2) / 3, {Vec3::UnitX(), Vec3::UnitZ()}};
    const SliderConstraint slider{{Vec3::UnitY(), Vec3::UnitZ()}, Mat3::Identity()};
    add({{0, point}, {1, -point}, hinge});
    add({{1, point}, {0, none}, BallJointConstraint()});
    add({{0, none}, {1, point}, BallJointConstraint()});
    add({{2, point}, {1, point}, slider});
    add({{kFixed, point}, {0, point}, WeldConstraint{Mat3::Identity()}});
    add({{1, point}, {kFixed, none}, RodConstraint{0.8}});
    add({{0, -point}, {2, point}, RodConstraint{0.6}});
  }
  void add(const Constraint& constraint) {
    findRows(constraint, state, frames, blocks.emplace_back());
    findResponse(blocks.back(), bodies, frames, responses.emplace_back());
  }
};

constexpr double kEntryError = 1e-14;  // entries of up to 10, sums of some ten terms

// Every pair, and each with itself: bodies in common as A and A, A and B, both or none.
TEST(BlockResponse, EntriesAreThoseOfItsRowsOneByOne) {
  const BlockProblem problem;
  double largest = 0;
  for (const ConstraintBlock& row : problem.blocks)
    for (std::size_t at = 0; at < problem.blocks.size(); ++at) {
      const ConstraintBlock& column = problem.blocks[at];
      const SharedBodies shared = sharedBodies(row, column);
      MatrixX entries = MatrixX::Constant(row.rows + 1, column.rows, 7);
      if (!shared.any()) entries.topRows(row.rows).setZero();
      if (shared.any())
        withRows(row.rows, [&](auto rows) {
          withRows(column.rows, [&](auto columns) {
            putDelassus<rows, columns>(row, column, shared, problem.responses[at], entries.data(), rows + 1);
          });
        });
      for (int k = 0; k < column.rows; ++k) {
        const VectorX response = responseTo(rowOf(column, k), problem.bodies, problem.frames);
        for (int i = 0; i < row.rows; ++i) {
          EXPECT_NEAR(entries(i, k), rateOf(rowOf(row, i), response), kEntryError) << at << " " << i << " " << k;
          largest = std::max(largest, std::abs(entries(i, k)));
        }
        EXPECT_EQ(entries(row.rows, k), 7);  // what is not the block's
      }
      if (&row != &column) continue;
      MatrixX own(row.rows, row.rows);
      withRows(row.rows, [&](auto rows) { putDelassus<rows>(row, problem.responses[at], own.data()); });
      EXPECT_LT((own - entries.topRows(row.rows)).norm(), kEntryError);
    }
  EXPECT_GT(largest, 1);
}

TEST(BlockResponse, RatesAndResponsesAreThoseOfItsRowsOneByOne) {
  const BlockProblem problem;
  for (std::size_t at = 0; at < problem.blocks.size(); ++at) {
    const ConstraintBlock& block = problem.blocks[at];
    std::array<double, 6> rates{}, multipliers{};
    withRows(block.rows, [&](auto rows) { findRates<rows>(block, problem.state, rates.data()); });
    VectorX expected = VectorX::Zero(problem.state.size()), found = expected;
    for (int i = 0; i < block.rows; ++i) {
      const ConstraintRow row = rowOf(block, i);
      EXPECT_NEAR(rates[static_cast<std::size_t>(i)], rateOf(row, problem.state), kEntryError);
      EXPECT_NEAR(rateOf(block, i, problem.state), rateOf(row, problem.state), kEntryError);
      multipliers[static_cast<std::size_t>(i)] = 0.4 + i;
      expected += (0.4 + i) * responseTo(row, problem.bodies, problem.frames);
    }
    addResponse(block, problem.responses[at], multipliers.data(), found);
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 10 * kEntryError) << at;
  }
}

// 1/m_A + 1/m_B and what the arms add; the row of a rod is the way from end to end, no unit vector.
TEST(BlockResponse, MobilityIsTheInverseMassAlongARod) {
  const BlockProblem problem;
  const ConstraintBlock& rod = problem.blocks.back();
  const Vec3 along = rod.linear.row(0);
  const Attachment a{0, -Vec3(0.3, -0.2, 0.4)}, b{2, Vec3(0.3, -0.2, 0.4)};
  const double expected = inverseMassAlong(along.normalized(), a, problem.bodies, problem.state) +
                          inverseMassAlong(along.normalized(), b, problem.bodies, problem.state);
  EXPECT_NEAR(mobilityOf(rod, problem.bodies, problem.frames), along.squaredNorm() * expected, 1e-13);
}

}  // namespace
}  // namespace cradle
