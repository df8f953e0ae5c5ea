#include "collision/epa.h"

#include <gtest/gtest.h>

#include "collision/sample_cores.h"
#include "collision/widest_gap.h"
#include "rounding.h"

namespace cradle {
namespace {

// The error that the header states, of the depth.
constexpr double kKnownDepth = 1e-3;
// Of the size: a gap is a difference of two support values, each some 16 rounded products and sums.
constexpr double kEpaRounding = 64 * kEpsilon;

SeparatingAxis deepestOf(const CorePair& pair) {
  return deepestAxis(pair.a, pair.b);
}

// No direction of a search over the sphere sees a gap that is larger by more than the error; what the axis says is what
// its normal sees.
TEST(Epa, NoDirectionSeesLessOverlapAtAnySize) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    int overlapping = 0;
    forRandomCorePairs(size, 0.35, size == 1 ? 4 : 1, [&](const CorePair& pair) {
      if (!pair.isRound()) return;
      const auto gapSeen = [&](const Vec3& direction) { return pair.gapSeen(direction); };
      const SeparatingAxis found = deepestOf(pair);
      EXPECT_NEAR(found.normal.norm(), 1, 4 * kEpsilon);
      EXPECT_NEAR(pair.gapSeen(found.normal), found.separation, kEpaRounding * size) << pair.name();
      const double widest = gapSeen(widestGap(gapSeen, {400, 4, 1e-3}));
      if (widest >= 0) return;
      ++overlapping;
      EXPECT_GE(found.separation, widest * (1 + kKnownDepth) - kEpaRounding * size) << pair.name();
    });
    EXPECT_GT(overlapping, size == 1 ? 50 : 12);
  }
}

// A cylinder and a point inside it part through the nearer of side and end; two coaxial ones through their ends, unless
// they are longer than wide; side by side, across the axes; crossing at right angles, across both.
TEST(Epa, DepthsOfCylindersAreTheirClosedForms) {
  const SampleCore drum = cylinderCore("drum", 0.5, 2), rod = cylinderCore("rod", 0.2, 6), point = pointCore(0.1);
  const Quat straight = Quat::Identity(), crossing = rotationAbout(Vec3::UnitX(), M_PI / 2);
  const auto expectAxis = [](const CorePair& pair, double depth, const Vec3& normal) {
    const SeparatingAxis found = deepestOf(pair);
    EXPECT_NEAR(found.separation, -depth, 1e-12) << pair.name();  // 1e-12 of the size: ConvexTolerances::touching
    EXPECT_LT((found.normal - normal).norm(), 1e-6) << pair.name() << found.normal.transpose();
  };
  expectAxis({drum, point, {}, {straight, Vec3(0.3, 0.1, 0)}}, 0.2, Vec3::UnitX());
  expectAxis({drum, point, {}, {straight, Vec3(0.1, 0.9, 0)}}, 0.1, Vec3::UnitY());
  expectAxis({drum, rod, {}, {straight, Vec3(0, -3.7, 0)}}, 0.3, -Vec3::UnitY());
  expectAxis({drum, rod, {}, {straight, Vec3(0, 0.3, 0.6)}}, 0.1, Vec3::UnitZ());
  expectAxis({drum, rod, {}, {crossing, Vec3(-0.45, 0.2, 0.1)}}, 0.25, -Vec3::UnitX());
  expectAxis({rod, drum, {}, {crossing, Vec3(0.45, 0, 0.1)}}, 0.25, Vec3::UnitX());
}

// Concentric, one axis: every direction across it is as good, if it is shorter than the way along it.
TEST(Epa, ConcentricCoresPartByTheLesserOfBothWays) {
  const SampleCore drum = cylinderCore("drum", 0.5, 2), disc = cylinderCore("disc", 1, 0.3);
  EXPECT_NEAR(deepestOf({drum, drum, {}, {}}).separation, -1, 1e-12);
  EXPECT_NEAR(deepestOf({disc, disc, {}, {}}).separation, -0.3, 1e-12);
  EXPECT_NEAR(deepestOf({disc, drum, {}, {}}).separation, -1.15, 1e-12);
}

// Touching by faces, by a line, and at a point; and as far beside that they are just apart, or overlap: the separation
// is that shift.
TEST(Epa, GoesThroughTouchingWithoutAJump) {
  const SampleCore drum = cylinderCore("drum", 0.5, 0.8), box = boxCore("box", Vec3(1, 0.6, 1.4)),
                   point = pointCore(0.1), segment = segmentCore(1.5);
  const Quat straight = Quat::Identity(), across = rotationAbout(Vec3::UnitZ(), M_PI / 2);
  for (const double shift : {0.0, 1e-14, -1e-14, 1e-9, -1e-9, -1e-4}) {
    const Vec3 up(0, shift, 0), aside(shift, 0, 0);
    EXPECT_NEAR(deepestOf({box, drum, {}, {straight, Vec3(0.2, 0.7, 0.1) + up}}).separation, shift, 2e-12);
    EXPECT_NEAR(deepestOf({box, drum, {}, {across, Vec3(0.2, 0.8, 0.1) + up}}).separation, shift, 2e-12);
    EXPECT_NEAR(deepestOf({drum, drum, {}, {straight, Vec3(1, 0.1, 0) + aside}}).separation, shift, 2e-12);
    EXPECT_NEAR(deepestOf({drum, segment, {}, {straight, Vec3(0.5, 0.1, 0) + aside}}).separation, shift, 2e-12);
    EXPECT_NEAR(deepestOf({drum, point, {}, {straight, Vec3(0.3, 0.4, 0) + up}}).separation, shift, 2e-12);
  }
}

// A disc of a tenth of a millimetre in a body of a metre, and a disc through a flat segment's plane: the polytope of
// the difference is nearly flat.
TEST(Epa, ThinDiscsPartAcrossTheirFaces) {
  const SampleCore disc = cylinderCore("disc", 0.6, 1e-4), plate = boxCore("plate", Vec3(1.1, 1e-4, 0.7));
  for (const double tilt : {0.0, 1e-12, 1e-7}) {
    const Quat turn = rotationAbout(Vec3(1, 0, 2).normalized(), tilt);
    // The support values change by the tilt times the radius.
    EXPECT_NEAR(deepestOf({disc, disc, {}, {turn, Vec3(0.1, 3e-5, 0.2)}}).separation, -7e-5, 2e-12 + tilt);
    EXPECT_NEAR(deepestOf({disc, plate, {}, {turn, Vec3(0.1, -3e-5, 0.2)}}).separation, -7e-5, 2e-12 + tilt);
  }
  const SampleCore leaf = cylinderCore("leaf", 0.6, 1e-18), point = pointCore(0.1);
  const SeparatingAxis found = deepestOf({leaf, point, {}, {Quat::Identity(), Vec3(0.1, 0, 0.2)}});
  EXPECT_NEAR(found.separation, 0, 1e-17);
  EXPECT_NEAR(std::abs(found.normal.y()), 1, kEpsilon);
}

}  // namespace
}  // namespace cradle
