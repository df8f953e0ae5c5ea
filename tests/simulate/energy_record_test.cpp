#include "simulate/energy_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using std::nullopt;

constexpr double kGravity = 9.81, kMass = 2, kRadius = 0.1, kAccuracy = 1e-3;

/// Of one sphere that may fall.
class EnergyRecordOfASphere : public testing::Test {
 protected:
  void add(double time, double height, double speed, double numerical) {
    VectorX& state = at_.state();
    centerOfMass(state, 0) = Vec3(0, height, 0);
    linearVelocity(state, 0) = Vec3(speed, 0, 0);
    numericalEnergy(state) = numerical;
    record_.add(time, state);
  }

  OneIsland at_{fmt::format(R"("duration": 1, "gravity": [0, {}, 0], "bodies": [{{"name": "sphere", "mass": {},
    "shape": {{"sphere": {{"radius": {}}}}}}}])",
                            -kGravity, kMass, kRadius)};
  EnergyRecord record_{at_.island.assembly, kAccuracy};
};

TEST_F(EnergyRecordOfASphere, MeasuresByTheLargestKineticEnergyThatComesLaterToo) {
  const double largest = kMass * 5 * 5 / 2.0;
  add(0.1, 0, 1, 0.011 * largest), add(0.2, 0, 5, 0.005 * largest);
  EXPECT_EQ(record_.firstBeyond(0.0111), nullopt);
  EXPECT_EQ(record_.firstBeyond(0.0109), 0.1);
}

TEST_F(EnergyRecordOfASphere, MeasuresByWhatGravityGave) {
  const double largest = kMass * kGravity * 3;
  add(0.1, -3, 0, 0.01 * largest);
  EXPECT_EQ(record_.firstBeyond(0.0101), nullopt);
  EXPECT_EQ(record_.firstBeyond(0.0099), 0.1);
}

// A body at rest has errors as well: of the accuracy in its velocity, of a part of its size in its place. The norm of a
// sphere's inertia tensor is sqrt(3) 2/5 m r^2.
TEST_F(EnergyRecordOfASphere, MeasuresBodiesAtRestByAFallOfTheirSize) {
  const double gyration = kRadius * std::sqrt(0.4 * std::sqrt(3.0));
  const double largest = kMass * (kGravity * gyration + kAccuracy * kAccuracy);
  add(0.1, 0, 0, 0.01 * largest);
  EXPECT_EQ(record_.firstBeyond(0.0101), nullopt);
  EXPECT_EQ(record_.firstBeyond(0.0099), 0.1);
}

// At 1e9 m, places have steps of 1e-7 m: 64 of them are 1e-5 m, and m g times that.
TEST_F(EnergyRecordOfASphere, DoesNotCountRounding) {
  centerOfMass(at_.state(), 0) = Vec3(0, 1e9, 0);
  EnergyRecord far(at_.island.assembly, kAccuracy);
  const double unseen = kMass * kGravity * 64 * std::numeric_limits<double>::epsilon() * 1e9;
  numericalEnergy(at_.state()) = 0.99 * unseen;
  far.add(0.1, at_.state());
  EXPECT_EQ(far.firstBeyond(0), nullopt);
  numericalEnergy(at_.state()) = 1.01 * unseen;
  far.add(0.2, at_.state());
  EXPECT_EQ(far.firstBeyond(0), 0.2);
}

TEST_F(EnergyRecordOfASphere, TellsTheFirstFrameBeyondWhetherLostOrGained) {
  const double largest = kMass * 5 * 5 / 2.0;
  add(0, 0, 5, 0);
  const double parts[] = {0.001, -0.003, 0.002, -0.004, 0.1, 0};
  for (int i = 0; i < 6; ++i) add(i + 1, 0, 5, parts[i] * largest);
  EXPECT_EQ(record_.firstBeyond(0.0009), 1);
  EXPECT_EQ(record_.firstBeyond(0.0029), 2);
  EXPECT_EQ(record_.firstBeyond(0.0031), 4);
  EXPECT_EQ(record_.firstBeyond(0.0041), 5);
  EXPECT_EQ(record_.firstBeyond(0.11), nullopt);
}

}  // namespace
}  // namespace cradle
