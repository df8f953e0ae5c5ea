#include "simulate/conservation_record.h"

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

std::optional<double> timeOf(const ConservationRecord& record) {
  const std::optional<ConservationRecord::Loss> loss = record.firstLoss();
  return loss ? std::optional(loss->time) : nullopt;
}

/// Of one sphere that may fall. A rope that never gets taut might take its momentum.
class EnergyOfASphere : public testing::Test {
 protected:
  void add(double time, double height, double speed, double numerical) {
    VectorX& state = at_.state();
    centerOfMass(state, 0) = Vec3(0, height, 0);
    linearVelocity(state, 0) = Vec3(speed, 0, 0);
    numericalEnergy(state) = numerical;
    record_.add(time, state);
  }

  OneIsland at_{fmt::format(R"("duration": 1, "gravity": [0, {}, 0], "bodies": [{{"name": "sphere", "mass": {},
    "shape": {{"sphere": {{"radius": {}}}}}}}],
    "ropes": [{{"bodyA": "sphere", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "maxLength": 1e9}}])",
                            -kGravity, kMass, kBallRadius)};
  ConservationRecord record_{at_.island.assembly, kAccuracy};
};

TEST_F(EnergyOfASphere, MeasuresByTheLargestKineticEnergyThatComesLaterToo) {
  const double largest = kMass * 5 * 5 / 2.0;
  add(0.1, 0, 1, kBelow * largest), add(0.2, 0, 5, 0);
  EXPECT_EQ(timeOf(record_), nullopt);
  add(0.3, 0, 1, kBeyond * largest);
  EXPECT_EQ(timeOf(record_), 0.3);
}

TEST_F(EnergyOfASphere, MeasuresByWhatGravityGave) {
  const double largest = kMass * kGravity * 3;
  add(0.1, -3, 0, kBelow * largest);
  EXPECT_EQ(timeOf(record_), nullopt);
  add(0.2, -3, 0, kBeyond * largest);
  EXPECT_EQ(timeOf(record_), 0.2);
}

// A body at rest has errors as well: of the accuracy in its velocity, of a part of its size in its place. The norm of a
// sphere's inertia tensor is sqrt(3) 2/5 m r^2.
TEST_F(EnergyOfASphere, MeasuresBodiesAtRestByAFallOfTheirSize) {
  const double gyration = kBallRadius * std::sqrt(0.4 * std::sqrt(3.0));
  const double largest = kMass * (kGravity * gyration + kAccuracy * kAccuracy);
  add(0.1, 0, 0, kBelow * largest);
  EXPECT_EQ(timeOf(record_), nullopt);
  add(0.2, 0, 0, kBeyond * largest);
  EXPECT_EQ(timeOf(record_), 0.2);
}

// At 1e12 m, places have steps of 1e-4 m: 64 of them are 0.01 m, and m g times that.
TEST_F(EnergyOfASphere, DoesNotCountRounding) {
  centerOfMass(at_.state(), 0) = Vec3(0, 1e12, 0);
  at_.island.assembly.state = at_.state();
  ConservationRecord far(at_.island.assembly, kAccuracy);
  const double gyration = kBallRadius * std::sqrt(0.4 * std::sqrt(3.0));
  const double largest = kMass * (kGravity * gyration + kAccuracy * kAccuracy);
  const double unseen = kMass * kGravity * 64 * std::numeric_limits<double>::epsilon() * 1e12;
  numericalEnergy(at_.state()) = unseen + kBelow * largest;
  far.add(0.1, at_.state());
  EXPECT_EQ(timeOf(far), nullopt);
  numericalEnergy(at_.state()) = unseen + kBeyond * largest;
  far.add(0.2, at_.state());
  EXPECT_EQ(timeOf(far), 0.2);
}

// What they have taken may be any part of the largest energy, but it stays taken: each by itself.
TEST_F(EnergyOfASphere, MayNotComeFromImpactsFrictionOrDampers) {
  const double largest = kMass * 5 * 5 / 2.0;
  using Taken = double& (*)(VectorX&);
  for (const Taken taken : {Taken(impactEnergy), Taken(frictionEnergy), Taken(dampingEnergy)}) {
    ConservationRecord record(at_.island.assembly, kAccuracy);
    VectorX state = at_.state();
    linearVelocity(state, 0) = Vec3(5, 0, 0);
    record.add(0, state);
    for (const double part : {0.5, 0.9, 0.9 - kBelow}) taken(state) = part * largest, record.add(part, state);
    EXPECT_EQ(timeOf(record), nullopt);
    taken(state) = (0.9 - kBeyond) * largest, record.add(2, state);
    taken(state) = largest, record.add(3, state);
    EXPECT_EQ(timeOf(record), 2);
  }
}

TEST_F(EnergyOfASphere, TellsTheFirstFrameBeyondWhetherLostOrGained) {
  const double largest = kMass * 5 * 5 / 2.0;
  add(0, 0, 5, 0), add(1, 0, 5, kBelow * largest), add(2, 0, 5, -kBelow * largest);
  EXPECT_EQ(timeOf(record_), nullopt);
  add(3, 0, 5, -kBeyond * largest), add(4, 0, 5, 0), add(5, 0, 5, 3 * kBeyond * largest);
  EXPECT_EQ(timeOf(record_), 3);
  add(6, 0, 5 * std::sqrt(2.0), 0);  // of twice the energy, that was too little
  EXPECT_EQ(timeOf(record_), 5);
}

/// Two spheres on a spring, 1 m apart across their velocities. `more`: members behind the springs.
std::string pairScene(const std::string& moreSprings = "", const std::string& more = "") {
  return fmt::format(R"("duration": 1, "gravity": [0, {}, 0], "bodies": [
      {{"name": "a", "mass": 1, "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [0.5, 0, 0],
        "linearVelocity": [0, 0, 3]}},
      {{"name": "b", "mass": 3, "shape": {{"sphere": {{"radius": 0.1}}}}, "position": [1.5, 0, 0],
        "linearVelocity": [0, 0, 1]}}],
      "springs": [{{"bodyA": "a", "bodyB": "b", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "stiffness": 1,
                    "restLength": 1}}{}]{})",
                     -kGravity, moreSprings, more);
}

/// The sum that a frame at 0.5 s shows not to be kept, with changes of the pair's velocities (m/s), after one with the
/// velocities of the start.
std::string lostBy(const std::string& scene, const Vec3& changeOfA, const Vec3& changeOfB) {
  OneIsland at(scene);
  ConservationRecord record(at.island.assembly, kAccuracy);
  record.add(0, at.state());
  const Vec3 byGravity(0, -0.5 * kGravity, 0);
  linearVelocity(at.state(), 0) += byGravity + changeOfA;
  linearVelocity(at.state(), 1) += byGravity + changeOfB;
  record.add(0.5, at.state());
  const auto loss = record.firstLoss();
  EXPECT_TRUE(!loss || loss->time == 0.5);
  return loss ? std::string(loss->sum) : "";
}

const char* const kMomentum = "momentum that nothing gave";
const char* const kSpin = "angular momentum that nothing gave";

// The largest sum of magnitudes is that of the frame at 0.5 s: sqrt(v^2 + (g/2)^2) of both. A common change of the
// velocities leaves the angular momentum about the middle as it is. Beside the fall, changes across it count.
TEST(MomentumOfAPair, IsMeasuredByTheLargestSumOfMagnitudes) {
  const double fall = 0.5 * kGravity, largest = std::hypot(3, fall) + 3 * std::hypot(1, fall);
  for (const auto& [change, lost] : {std::pair{0.0, ""}, {kBelow, ""}, {kBeyond, kMomentum}}) {
    const Vec3 common(change * largest / 4, 0, 0);
    EXPECT_EQ(lostBy(pairScene(), common, common), lost) << change;
  }
}

// What gravity gives in 0.5 s counts as its own: without it, it is momentum from nowhere.
TEST(MomentumOfAPair, IsChangedByGravity) {
  const Vec3 halfFall(0, 0.25 * kGravity, 0);
  EXPECT_EQ(lostBy(pairScene(), halfFall, halfFall), kMomentum);
}

// Opposite changes p of both momenta, along the velocities, change the angular momentum by p x 1 m. The middle is 0.75
// and 0.25 m from the spheres and moves at 1.5 m/s: the sum of magnitudes is 1 kg 0.75 m 1.5 m/s + 3 kg 0.25 m 0.5 m/s.
TEST(AngularMomentumOfAPair, IsMeasuredAboutTheMiddle) {
  const double largest = 0.75 * 1.5 + 0.75 * 0.5;
  for (const auto& [change, lost] : {std::pair{kBelow, ""}, {kBeyond, kSpin}}) {
    const Vec3 momentum(0, 0, change * largest);
    EXPECT_EQ(lostBy(pairScene(), -momentum, momentum / 3), lost) << change;
  }
}

// What is fixed takes any momentum: a spring to the world, ground, a push.
TEST(MomentumOfAPair, IsNotJudgedWhereSomethingActsFromOutside) {
  const std::string spring = R"(, {"bodyA": "a", "anchorA": [0, 0, 0], "anchorB": [-2, 0, 0], "stiffness": 1})";
  const std::string push =
      R"(, "pushes": [{"body": "a", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0.2, "duration": 0.1}])";
  const Vec3 change(1, 0, 0);
  EXPECT_EQ(lostBy(pairScene(), change, change), kMomentum);
  EXPECT_EQ(lostBy(pairScene(spring), change, change), "");
  EXPECT_EQ(lostBy(pairScene("", push), change, change), "");
}

}  // namespace
}  // namespace cradle
