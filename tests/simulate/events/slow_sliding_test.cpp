#include "simulate/events/slow_sliding.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulate/events/on_plane.h"

namespace cradle {
namespace {

/// A box, or a ball, that slides on the floor along x, and how it slides.
struct SlowSliding : OnPlane {
  explicit SlowSliding(const char* body) : OnPlane(std::string(body) + "}") {
    tolerances = eventTolerancesOf({1e-4, 10, 0.1, kGravity});
    record.contact = contactsWithin(1e-3).at(0);
    record.pair = island.assembly.geometry.pairs[record.contact.pair];
  }
  bool isTooSlow(double speed, double acceleration, double change = 0) {
    linearVelocity(state(), 0) = Vec3(speed, -1, 0);  // along the surfaces alone
    return slidesTooSlowly(record, {acceleration, kGravity, change}, tolerances, island);
  }

  ContactRecord record;
};

// mu' g, m/s^2.
constexpr double kFrictionOfGravity = kDynamicFriction * kGravity;

// The slowest sliding of a run of T, with the accuracy A: T sqrt(mu' g A) / 20. What accelerates gets there in the run:
// a T is added. A ball is exempt, unless friction turns it within 2e-5 s.
TEST(SlowSliding, IsBelowTheSpeedThatErrorsLeave) {
  SlowSliding box(kBox), sphere(kBall);
  const double slowest = 10 * std::sqrt(kFrictionOfGravity * 1e-4) / 20, turned = 2e-5 * kFrictionOfGravity;
  const double quick = 0.03 * kFrictionOfGravity;  // does not creep
  for (const double part : {0.999, 1.001}) {
    EXPECT_EQ(box.isTooSlow(part * slowest, 0), part < 1);
    EXPECT_EQ(box.isTooSlow(part * slowest - 1e-3, 1e-4), part < 1);
    EXPECT_EQ(sphere.isTooSlow(part * turned, 0), part < 1);
  }
  EXPECT_FALSE(box.isTooSlow(0, quick));
}

// A contact that starts creeps below a fiftieth of mu' g, slower than A sqrt(mu' g / (2 a)) / 1 with the a of creeping
// at least: 1e-4 sqrt(25) m/s here. The run is so long that its slowest speed is reached.
TEST(SlowSliding, IsThatWhichCreeps) {
  SlowSliding box(kBox), sphere(kBall);
  const double passed = 1e-4 * std::sqrt(1 / (2 * 0.02)), creeping = 0.02 * kFrictionOfGravity;
  for (const double part : {0.999, 1.001}) {
    EXPECT_EQ(box.isTooSlow(part * passed, 0.9 * creeping), part < 1);
    EXPECT_EQ(box.isTooSlow(0.9 * passed, part * creeping), part < 1);
    EXPECT_FALSE(sphere.isTooSlow(0.9 * passed, part * creeping));
  }
}

// What begins without acceleration, and has that of creeping after a twentieth of the run of 10 s, does not creep,
// whether it gains it or loses it.
TEST(SlowSliding, IsNotThatWhoseAccelerationChanges) {
  SlowSliding box(kBox);
  const double change = 0.02 * kFrictionOfGravity / (0.05 * 10);
  for (const double part : {0.999, 1.001}) {
    EXPECT_EQ(box.isTooSlow(0, 0, part * change), part < 1);
    EXPECT_EQ(box.isTooSlow(0, 0, -part * change), part < 1);
  }
  // The slowest sliding is reached, j T^2 / 2, without acceleration and speed at the start.
  const double slowest = 10 * std::sqrt(kFrictionOfGravity * 1e-4) / 20, passed = 1e-4 * std::sqrt(1 / (2 * 0.02));
  SlowSliding sphere(kBall);
  const double turned = 2e-5 * kFrictionOfGravity;
  for (const double part : {0.999, 1.001}) {
    EXPECT_EQ(sphere.isTooSlow(0, 0, part * turned / 50), part < 1);
    EXPECT_EQ(box.isTooSlow(1.1 * passed, 0, part * (slowest - 1.1 * passed) / 50), part < 1);
  }
}

// The direction is kept for a hundredth of the accuracy 1e-4: a t^2 / 2, or j t^3 / 6.
TEST(SlowSliding, KeepsItsDirectionForAHundredthOfTheAccuracy) {
  const EventTolerances tolerances = eventTolerancesOf({1e-4, 10, 0.1, kGravity});
  const double accelerated = timeOfKeptDirection({0.5, kGravity, 1e-9}, tolerances);
  EXPECT_NEAR(0.5 * accelerated * accelerated / 2, 1e-6, 1e-20);
  for (const double change : {7.0, -7.0}) {
    const double changed = timeOfKeptDirection({0, kGravity, change}, tolerances);
    EXPECT_NEAR(7.0 * changed * changed * changed / 6, 1e-6, 1e-20);
  }
}

// Friction mu' N turns the sliding v of an effective mass m within v m / (mu' N).
TEST(SlowSliding, IsTurnedFastByFrictionWithinTwentyMicroseconds) {
  SlowSliding box(kBox);
  box.record.mass = 3;
  for (const double part : {0.999, 1.001}) {
    EXPECT_EQ(isDirectionTurnedFast(box.record, part * 2e-5 * kDynamicFriction * 60 / 3, 60), part < 1);
  }
}

// A box that keeps its speed on a slope of tan = mu': too slow below T sqrt(mu' g A) / 20 in a run of T, with T = 10 s
// and A = 1e-4; gravity g along the slope and across it together.
TEST(SlowSliding, OfABoxIsNotServed) {
  const double slowest = 10 * std::sqrt(kDynamicFriction * kGravity * 1e-4) / 20;
  for (const double part : {0.99, 1.01}) {
    OneIsland at(R"("duration": 10, "accuracy": 1e-4, "materials": {
        "rough": {"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.3}}, "bodies": [
        {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"}, )" +
                 std::string(kBox) + "}], " + slopeOf(kDynamicFriction));
    linearVelocity(at.state(), 0).x() = part * slowest;
    const EventTolerances tolerances = eventTolerancesOf(eventScalesOf(at.island));
    ActiveContacts active(at.island, tolerances);
    ConstraintSolver solver(at.mechanism().constraints, at.mechanism().bodies);
    active.classify(at.contactsWithin(tolerances.touch), solver);
    EXPECT_EQ(active.fallbackReason().empty(), part > 1) << active.fallbackReason();
  }
}

}  // namespace
}  // namespace cradle
