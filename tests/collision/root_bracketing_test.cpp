#include "collision/root_bracketing.h"

#include <gtest/gtest.h>

#include "collision/random_poses.h"

namespace cradle {
namespace {

/// The least value in [0, length] of the parabola through both ends with a second derivative, sampled.
double leastOfParabola(double from, double to, double acceleration, double length) {
  double least = std::min(from, to);
  for (int i = 1; i < 4000; ++i) {
    const double t = length * i / 4000, chord = from + (to - from) * i / 4000;
    least = std::min(least, chord - acceleration / 2 * t * (length - t));
  }
  return least;
}

// Of all gaps with that bound the parabola is the lowest; sampled at 1/4000 of the interval its least value is known to
// acceleration / 8 (length / 4000)^2.
TEST(StaysOpen, IsWhetherTheLowestParabolaDoes) {
  RandomPoses random(1);
  int open = 0, closed = 0;
  for (int i = 0; i < 1000; ++i) {
    const double length = random.number(0.01, 1), acceleration = std::exp(random.number(-3, 5));
    const double scale = acceleration * length * length / 8;
    const double from = random.number(0, 4) * scale, to = random.number(0, 4) * scale;
    const double least = leastOfParabola(from, to, acceleration, length);
    if (std::abs(least) < scale / (4000.0 * 4000) * 2) continue;
    const GapBounds bounds{INFINITY, acceleration};
    EXPECT_EQ(staysOpen(bounds, from, to, length), least > 0) << least;
    least > 0 ? ++open : ++closed;
    // A graze as deep as the parabola is passed over.
    EXPECT_TRUE(staysOpen({INFINITY, acceleration, std::max(0.0, -least) + scale * 1e-6}, from, to, length));
  }
  EXPECT_GT(open, 100);
  EXPECT_GT(closed, 100);
}

// The fastest approach from both ends meets at (a + b - speed T) / 2.
TEST(StaysOpen, IsWhetherTheFastestApproachDoes) {
  EXPECT_TRUE(staysOpen({1}, 0.3, 0.8, 1));
  EXPECT_FALSE(staysOpen({1}, 0.3, 0.6, 1));
  EXPECT_TRUE(staysOpen({1}, 0.3, 0.6, 0.8));
  EXPECT_TRUE(staysOpen({1, INFINITY, 0.1}, 0.3, 0.6, 1));
}

TEST(RootOfParabola, IsTheRootInTheBracket) {
  for (const double bend : {0.0, 1e-9, 2.0, -2.0, 0.7}) {
    const auto parabola = [&](double t) {
      return bend * t * t - (1 + bend * 0.3) * t + 0.3;
    };  // roots 0.3 and 1 / bend
    const Bracket bracket{0.1, parabola(0.1), 0.45, parabola(0.45)};
    EXPECT_NEAR(rootOfParabola(bracket, 0.9, parabola(0.9)), 0.3, 1e-15) << bend;
    EXPECT_NEAR(rootOfParabola(bracket, -0.4, parabola(-0.4)), 0.3, 1e-15) << bend;
  }
}

// Smooth and steep gaps: the bracket closes around the root, to the width that was asked for; a parabola is found at
// once. Flat and stepped gaps, at which parabolas fail, are halved in every third step.
TEST(CloseBracket, ClosesAroundTheRootOfAnyGap) {
  const double root = 0.37;
  int calls = 0;
  const auto close = [&](const auto& gap) {
    calls = 0;
    const auto counted = [&](double t) { return ++calls, gap(t); };
    Bracket bracket{0, gap(0), 1, gap(1)};
    closeBracket(counted, bracket);
    EXPECT_GT(bracket.gapBefore, 0);
    EXPECT_LE(bracket.gapAfter, 0);
    EXPECT_LE(bracket.after - bracket.before, kRootTolerance);
    EXPECT_LE(bracket.before, root);
    EXPECT_GE(bracket.after, root - 1e-15);
    EXPECT_EQ(bracket.gapBefore, gap(bracket.before));
    EXPECT_EQ(bracket.gapAfter, gap(bracket.after));
  };
  close([&](double t) { return 2 * (root * root - t * t); });
  EXPECT_LE(calls, 5);
  close([&](double t) { return 3 * (root - t); });
  EXPECT_LE(calls, 3);
  close([&](double t) { return std::exp(8 * (root - t)) - 1; });
  EXPECT_LE(calls, 20);
  close([&](double t) { return (root - t) * (root - t) * (root - t); });
  close([&](double t) { return t < root ? 1.0 : -1.0; });
  close([&](double t) { return t < root ? 1e-9 : -1e9; });
  EXPECT_LE(calls, kMaxBracketSteps);
}

// Two roots close together between open ends, behind which there is another: the first one, if they are farther apart
// than what may be passed over.
TEST(FirstRoot, IsTheFirstOfAllRoots) {
  for (const double first : {1e-3, 0.2, 0.77})
    for (const double apart : {0.1, 1e-3, 1e-5}) {
      const auto gap = [&](double t) { return 10 * (t - first) * (t - first - apart) * (1.5 - t); };
      // |gap''| = 10 |2 (1.5 - t) - 2 (2 t - ...)| <= 10 (3 + 4)
      const GapBounds bounds{INFINITY, 70};
      const auto found = firstRoot(gap, bounds, {0, gap(0), 1, gap(1)});
      ASSERT_TRUE(found) << first << ' ' << apart;
      EXPECT_NEAR(*found, first, kRootTolerance + 1e-15 / apart);
      const auto falling = [&](double t) { return t < 0.9 ? gap(t) : -1.0; };  // a root at once, and earlier ones
      const auto earlier = firstRoot(falling, bounds, {0, gap(0), 1, -1});
      ASSERT_TRUE(earlier);
      EXPECT_NEAR(*earlier, first, kRootTolerance + 1e-15 / apart);
    }
}

// Inside an interval whose ends leave it unsure a gap cannot be larger than the search says is enough, and that shrinks
// with the interval.
TEST(FirstRoot, AsksForGapsAsFarAsTheyCanBe) {
  double least = INFINITY;
  const auto gap = [&](double t, double enough = INFINITY) {
    const double found = std::abs(t - 0.7) - 1e-3 + 0.2 * std::sin(9 * t) * (0.7 - t);
    EXPECT_LE(found, enough) << t;
    least = std::min(least, enough);
    return found;
  };
  const GapBounds bounds{2.5};  // |g'| <= 1 + 0.2 + 0.2 * 9 * 0.7 = 2.46
  EXPECT_TRUE(firstRoot(gap, bounds, {0, gap(0), 1, gap(1)}));
  EXPECT_LE(least, 2.5 / 64);
}

TEST(FirstRoot, LooksNowhereThatStaysOpen) {
  int calls = 0;
  const auto gap = [&](double t) { return ++calls, 1 - t * (1 - t) * 3.9; };  // least 0.025, gap'' = 7.8
  EXPECT_FALSE(firstRoot(gap, {INFINITY, 7.9}, {0, 1, 1, 1}));
  EXPECT_EQ(calls, 0);
  EXPECT_FALSE(firstRoot(gap, {INFINITY, 8.3}, {0, 1, 1, 1}));  // 1 - 8.3 / 8 < 0: halved
  EXPECT_GT(calls, 0);
  calls = 0;
  int asked = 0;
  const auto isOpen = [&](const Bracket& ends) { return ++asked, ends.after <= 0.5; };
  EXPECT_FALSE(firstRoot(gap, {4.0}, isOpen, {0, 1, 1, 1}));
  EXPECT_GT(asked, 1);
  // A dip that is narrower than the finest interval is passed over, a wider one is not.
  const auto dip = [](double t) { return std::abs(t - 1 / 3.0) - 1e-8; };
  EXPECT_FALSE(firstRoot(dip, {1, INFINITY, 0, 1e-6}, {0, dip(0), 1, dip(1)}));
  EXPECT_TRUE(firstRoot(dip, {1, INFINITY, 0, 1e-9}, {0, dip(0), 1, dip(1)}));
}

}  // namespace
}  // namespace cradle
