#include "impact/block_normals.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace cradle {
namespace {

using FourPoints = ContactBlock<4, false>;

/// A block of four points with a random plane, and laws, in both lanes. Impulses so far are zero.
struct RandomNormals {
  std::mt19937 random;
  FourPoints block{};
  NormalLaws<4> laws{};
  PlaneSpeeds before{};
  Mat3 inertia[kLanes];

  explicit RandomNormals(unsigned seed) : random(seed) {
    for (int lane = 0; lane < kLanes; ++lane) {
      Mat3 root;
      for (double& entry : root.reshaped()) entry = number();
      const Mat3 m = root * root.transpose() + Mat3::Identity();
      auto& plane = block.plane.inertia;
      plane.xx[lane] = m(0, 0), plane.xy[lane] = m(0, 1), plane.xz[lane] = m(0, 2);
      plane.yy[lane] = m(1, 1), plane.yz[lane] = m(1, 2), plane.zz[lane] = m(2, 2);
      inertia[lane] = m;
      for (int i = 0; i < 4; ++i) {
        block.points[i].u[lane] = (i & 1 ? 1 : -1) + 0.3 * number();
        block.points[i].v[lane] = (i & 2 ? 1 : -1) + 0.3 * number();
        laws.stiffness[i][lane] = 1 + 0.5 * number();
      }
    }
  }
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  static double speedAt(const PlaneSpeeds& speeds, const FourPoints::Point& point, int lane) {
    return speeds.middle[lane] + point.u[lane] * speeds.slopeU[lane] + point.v[lane] * speeds.slopeV[lane];
  }
  /// The laws of all points and the law of motion, to rounding of numbers of some ones.
  void expectLaws(const PlaneSpeeds& after, const Lanes (&impulses)[4], int lane) const {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 4; ++i) {
      const auto& point = block.points[i];
      const double asked = laws.offset[i][lane] - laws.stiffness[i][lane] * speedAt(after, point, lane);
      EXPECT_NEAR(impulses[i][lane], std::max(0.0, asked), 1e-12) << i << ' ' << lane;
      sum += (impulses[i][lane] - point.impulse[lane]) * Vec3(1, point.u[lane], point.v[lane]);
    }
    const Vec3 change(after.middle[lane] - before.middle[lane], after.slopeU[lane] - before.slopeU[lane],
                      after.slopeV[lane] - before.slopeV[lane]);
    EXPECT_LT((inertia[lane] * change - sum).norm(), 1e-12) << lane;
  }
};

// All points press, from impulses that they had: the laws are linear.
TEST(BlockNormals, ObeyTheLawsOfPointsThatPress) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    RandomNormals normals(seed);
    for (int lane = 0; lane < kLanes; ++lane)
      for (int i = 0; i < 4; ++i) {
        normals.block.points[i].impulse[lane] = 4 + normals.number();
        normals.laws.offset[i][lane] = 4 + normals.number();
      }
    normals.before = {same(0.1), Lanes{0.2, -0.1}, Lanes{0, 0.2}};
    Lanes impulses[4];
    const PlaneSpeeds after = solveNormals(normals.block, normals.before, normals.laws, impulses);
    for (int lane = 0; lane < kLanes; ++lane) normals.expectLaws(after, impulses, lane);
  }
}

// In one lane a point has an impulse that it gives up, as its law asks for none: the guess is mended in the second
// step. In the other nothing touches, and nothing changes.
TEST(BlockNormals, LetGoOfPointsThatOpen) {
  int opened = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    RandomNormals normals(seed);
    normals.before = {Lanes{-0.5, 0.5}, same(0), same(0)};
    for (int i = 0; i < 4; ++i) {
      normals.block.points[i].impulse[0] = 1;
      normals.laws.offset[i] = Lanes{i == 2 ? -1.0 : 6.0, -0.1};
    }
    Lanes impulses[4];
    const PlaneSpeeds after = solveNormals(normals.block, normals.before, normals.laws, impulses);
    opened += impulses[2][0] == 0;
    normals.expectLaws(after, impulses, 0);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(impulses[i][1], 0);
    EXPECT_EQ(after.middle[1], 0.5);
    EXPECT_EQ(after.slopeU[1], 0);
  }
  EXPECT_GE(opened, 5);
}

TEST(BlockNormals, LeaveWhatDoesNotTouch) {
  RandomNormals normals(1);
  normals.before = {same(0.7), same(0.1), same(-0.2)};
  Lanes impulses[4];
  const PlaneSpeeds after = solveNormals(normals.block, normals.before, normals.laws, impulses);
  EXPECT_EQ(after.middle[0], 0.7);
  EXPECT_EQ(after.slopeU[1], 0.1);
  EXPECT_EQ(after.slopeV[0], -0.2);
  for (const Lanes& impulse : impulses) EXPECT_EQ(impulse[0], 0);
}

// What a mirrored problem has mirrored impulses to the bit where the four corners are alike.
TEST(BlockNormals, DoNotPreferAPoint) {
  FourPoints block{};
  auto& m = block.plane.inertia;
  m.xx = same(3), m.yy = same(0.7), m.zz = same(0.7);
  NormalLaws<4> laws{};
  for (int i = 0; i < 4; ++i) {
    block.points[i].u = same(i & 1 ? 0.5 : -0.5), block.points[i].v = same(i & 2 ? 0.5 : -0.5);
    laws.stiffness[i] = same(7);
  }
  Lanes impulses[4];
  const PlaneSpeeds after = solveNormals(block, {same(-1), same(0), same(0)}, laws, impulses);
  // 3 (s + 1) = -4 x 7 s
  EXPECT_NEAR(after.middle[0], -3.0 / 31, 1e-15);
  for (const Lanes& impulse : impulses) EXPECT_EQ(impulse[0], impulses[0][0]);
  EXPECT_EQ(after.slopeU[0], 0);
}

}  // namespace
}  // namespace cradle
