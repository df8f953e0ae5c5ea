#include "simulate/energy_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using std::nullopt;

constexpr double kMass = 2, kBallRadius = 0.1, kAccuracy = 1e-3;
constexpr double kMost = 10 * kAccuracy;  // of the largest energy
constexpr double kBelow = 0.99 * kMost, kBeyond = 1.01 * kMost;

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
                            -kGravity, kMass, kBallRadius)};
  EnergyRecord record_{at_.island.assembly, kAccuracy};
};

TEST_F(EnergyRecordOfASphere, MeasuresByTheLargestKineticEnergyThatComesLaterToo) {
  const double largest = kMass * 5 * 5 / 2.0;
  add(0.1, 0, 1, kBelow * largest), add(0.2, 0, 5, 0);
  EXPECT_EQ(record_.firstBeyond(), nullopt);
  add(0.3, 0, 1, kBeyond * largest);
  EXPECT_EQ(record_.firstBeyond(), 0.3);
}

TEST_F(EnergyRecordOfASphere, MeasuresByWhatGravityGave) {
  const double largest = kMass * kGravity * 3;
  add(0.1, -3, 0, kBelow * largest);
  EXPECT_EQ(record_.firstBeyond(), nullopt);
  add(0.2, -3, 0, kBeyond * largest);
  EXPECT_EQ(record_.firstBeyond(), 0.2);
}

// A body at rest has errors as well: of the accuracy in its velocity, of a part of its size in its place. The norm of a
// sphere's inertia tensor is sqrt(3) 2/5 m r^2.
TEST_F(EnergyRecordOfASphere, MeasuresBodiesAtRestByAFallOfTheirSize) {
  const double gyration = kBallRadius * std::sqrt(0.4 * std::sqrt(3.0));
  const double largest = kMass * (kGravity * gyration + kAccuracy * kAccuracy);
  add(0.1, 0, 0, kBelow * largest);
  EXPECT_EQ(record_.firstBeyond(), nullopt);
  add(0.2, 0, 0, kBeyond * largest);
  EXPECT_EQ(record_.firstBeyond(), 0.2);
}

// At 1e12 m, places have steps of 1e-4 m: 64 of them are 0.01 m, and m g times that.
TEST_F(EnergyRecordOfASphere, DoesNotCountRounding) {
  centerOfMass(at_.state(), 0) = Vec3(0, 1e12, 0);
  at_.island.assembly.state = at_.state();
  EnergyRecord far(at_.island.assembly, kAccuracy);
  const double gyration = kBallRadius * std::sqrt(0.4 * std::sqrt(3.0));
  const double largest = kMass * (kGravity * gyration + kAccuracy * kAccuracy);
  const double unseen = kMass * kGravity * 64 * std::numeric_limits<double>::epsilon() * 1e12;
  numericalEnergy(at_.state()) = unseen + kBelow * largest;
  far.add(0.1, at_.state());
  EXPECT_EQ(far.firstBeyond(), nullopt);
  numericalEnergy(at_.state()) = unseen + kBeyond * largest;
  far.add(0.2, at_.state());
  EXPECT_EQ(far.firstBeyond(), 0.2);
}

TEST_F(EnergyRecordOfASphere, TellsTheFirstFrameBeyondWhetherLostOrGained) {
  const double largest = kMass * 5 * 5 / 2.0;
  add(0, 0, 5, 0), add(1, 0, 5, kBelow * largest), add(2, 0, 5, -kBelow * largest);
  EXPECT_EQ(record_.firstBeyond(), nullopt);
  add(3, 0, 5, -kBeyond * largest), add(4, 0, 5, 0), add(5, 0, 5, 3 * kBeyond * largest);
  EXPECT_EQ(record_.firstBeyond(), 3);
  add(6, 0, 5 * std::sqrt(2.0), 0);  // of twice the energy, that was too little
  EXPECT_EQ(record_.firstBeyond(), 5);
}

}  // namespace
}  // namespace cradle
