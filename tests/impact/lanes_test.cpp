#include "impact/lanes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

LaneVector laneVector(double first) {
  return {Lanes{first, first + 10}, Lanes{first + 1, first + 11}, Lanes{first + 2, first + 12}};
}

// Each lane is a contact of its own, with the operations of doubles.
TEST(Lanes, WorkLaneByLane) {
  const LaneVector a = laneVector(1), b = laneVector(-4);
  const Lanes factor{2, -3};
  const LaneVector sum = a + b, difference = a - b, product = factor * a;
  for (int i = 0; i < kLanes; ++i) {
    const double first = 1 + 10 * i, second = -4 + 10 * i;
    EXPECT_EQ(sum.x[i], first + second);
    EXPECT_EQ(sum.z[i], first + second + 4);
    EXPECT_EQ(difference.y[i], 5);
    EXPECT_EQ(product.x[i], factor[i] * first);
    EXPECT_EQ(product.y[i], factor[i] * (first + 1));
    EXPECT_EQ(product.z[i], factor[i] * (first + 2));
    EXPECT_EQ(dot(a, b)[i], first * second + (first + 1) * (second + 1) + (first + 2) * (second + 2));
  }
}

TEST(Lanes, CompareLaneByLane) {
  const Lanes a{1, 5}, b{2, 4};
  EXPECT_EQ(larger(a, b)[0], 2);
  EXPECT_EQ(larger(a, b)[1], 5);
  EXPECT_EQ(smaller(a, b)[0], 1);
  EXPECT_EQ(smaller(a, b)[1], 4);
  EXPECT_EQ(squareRoot(Lanes{9, 2})[0], 3);
  EXPECT_EQ(squareRoot(Lanes{9, 2})[1], std::sqrt(2.0));
  EXPECT_EQ(same(7)[0], 7);
  EXPECT_EQ(same(7)[1], 7);
}

// What two bodies are gathered from is what their lanes are scattered to.
TEST(Lanes, GatherAndScatterBodies) {
  const BodyMotion first{Lanes{1, 2}, Lanes{3, 4}, Lanes{5, 6}}, second{Lanes{7, 8}, Lanes{9, 10}, Lanes{11, 12}};
  const LaneMotion motion = gather(first, second);
  const Lanes parts[] = {motion.linear.x,  motion.linear.y,  motion.linear.z,
                         motion.angular.x, motion.angular.y, motion.angular.z};
  for (int part = 0; part < 6; ++part) {
    EXPECT_EQ(parts[part][0], 1 + part);
    EXPECT_EQ(parts[part][1], 7 + part);
  }
  BodyMotion one, other;
  scatter<0>(motion, one);
  scatter<1>(motion, other);
  const BodyMotion sum = one + other, rest = sum - second;
  EXPECT_EQ(rest.xy[0], 1);
  EXPECT_EQ(rest.xy[1], 2);
  EXPECT_EQ(rest.zu[0], 3);
  EXPECT_EQ(rest.zu[1], 4);
  EXPECT_EQ(rest.vw[0], 5);
  EXPECT_EQ(rest.vw[1], 6);
}

}  // namespace
}  // namespace cradle
