#include "impact/soft_sleep.h"

#include <gmock/gmock.h>

#include <optional>

#include "impact/posed_bodies.h"
#include "impact/soft_parameters.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr double kSlow = 0.04, kFast = 1;  // m/s
constexpr double kStep = 1.0 / 64;         // s: 32 of them are half a second

/// Balls of 0.1 m in a row on a floor, each touching the next, and one apart from them.
struct SleepyRow : PosedBodies {
  explicit SleepyRow(const std::vector<double>& masses) : sleep(masses, SoftParameters::kStillTime) {
    const std::size_t count = masses.size();
    geometry.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
    for (std::size_t i = 0; i < count; ++i)
      add(colliderOf(Sphere{0.1}, {}), Vec3(0.2 * static_cast<double>(i) + (i + 1 == count ? 1 : 0), 0.1, 0));
    for (std::size_t i = 0; i < count; ++i) geometry.pairs.push_back({i, 0, true, {}});
    for (std::size_t i = 0; i + 1 < count; ++i) geometry.pairs.push_back({i, i + 1, false, {}});
    place();
    contacts.emplace(geometry);
    contacts->takePairs();
    contacts->update(stepStart(), threads);
  }
  /// Steps at whose end the bodies have these speeds (m/s). Returns who has fallen asleep.
  std::vector<int> pass(int steps, const std::vector<double>& speeds) {
    std::vector<int> fallen;
    for (int i = 0; i < steps; ++i) sleep.letSleep(*contacts, speeds, kSlow, kStep, fallen);
    for (const int body : fallen) poses[static_cast<std::size_t>(body)].isAsleep = true;
    return fallen;
  }

  WorkerThreads threads{1};
  std::optional<SoftContacts> contacts;
  SoftSleep sleep;
};

std::vector<double> speedsOf(std::size_t count, double speed) {
  return std::vector<double>(count, speed);
}

TEST(SoftSleep, ComesAfterHalfASecondOfSlowness) {
  SleepyRow row({1, 1, 1, 1});
  EXPECT_THAT(row.pass(31, speedsOf(4, 0.99 * kSlow)), IsEmpty());
  EXPECT_EQ(row.sleep.awake(), 4u);
  EXPECT_THAT(row.pass(1, speedsOf(4, 0.99 * kSlow)), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(row.sleep.awake(), 0u);
  EXPECT_TRUE(row.sleep.isAsleep(2));

  SleepyRow fast({1, 1, 1, 1});
  EXPECT_THAT(fast.pass(100, speedsOf(4, 1.01 * kSlow)), IsEmpty());
}

TEST(SoftSleep, BeginsAnewWithEachMotion) {
  SleepyRow row({1, 1, 1, 1});
  row.pass(31, speedsOf(4, 0));
  row.pass(1, speedsOf(4, kFast));
  EXPECT_THAT(row.pass(31, speedsOf(4, 0)), IsEmpty());
  EXPECT_THAT(row.pass(1, speedsOf(4, 0)), ElementsAre(0, 1, 2, 3));
}

// Body 1 moves: those beside it stay awake, and the one apart does not.
TEST(SoftSleep, DoesNotComeBesideWhatMoves) {
  SleepyRow row({1, 1, 1, 1});
  EXPECT_THAT(row.pass(100, {0, kFast, 0, 0}), ElementsAre(3));
  EXPECT_THAT(row.pass(32, {0, 0, 0, 0}), ElementsAre(0, 1, 2));
}

/// All of a row sleep; then a ball that has flown comes down on the first of them with that momentum (N s).
struct Struck {
  std::vector<int> woken;
  bool isAwake = false;  // the ball

  explicit Struck(double momentum) {
    const std::vector<double> masses = {1, 2, 3, 4, 9, 0.5};
    PosedBodies bodies;
    for (int i = 0; i < 5; ++i) bodies.add(colliderOf(Sphere{0.1}, {}), Vec3(0.2 * i + (i == 4 ? 1 : 0), 0, 0));
    bodies.add(colliderOf(Sphere{0.1}, {}), Vec3(0, 3, 0));
    for (std::size_t i = 0; i < 4; ++i) bodies.geometry.pairs.push_back({i, i + 1, false, {}});
    bodies.geometry.pairs.insert(bodies.geometry.pairs.begin() + 1, {0, 5, false, {}});
    bodies.place();
    WorkerThreads threads(1);
    SoftContacts contacts(bodies.geometry);
    SoftSleep sleep(masses, SoftParameters::kStillTime);
    contacts.takePairs();
    contacts.update(bodies.stepStart(), threads);
    std::vector<int> fallen;
    for (int i = 0; i < 40; ++i) sleep.letSleep(contacts, {0, 0, 0, 0, 0, kFast}, kSlow, kStep, fallen);
    EXPECT_THAT(fallen, ElementsAre(0, 1, 2, 3, 4));
    for (const int body : fallen) bodies.poses[static_cast<std::size_t>(body)].isAsleep = true;
    bodies.poses[5].linearVelocity = Vec3(0, -momentum / 0.5, 0);
    bodies.move(5, Vec3(0, -2.8, 0));
    contacts.beginStep();
    contacts.update(bodies.stepStart(), threads);
    sleep.wakeTouched(contacts, bodies.poses, kSlow, woken);
    for (const int body : woken) EXPECT_FALSE(sleep.isAsleep(static_cast<std::size_t>(body)));
    EXPECT_EQ(sleep.awake(), 1 + woken.size());
  }
};

// A blow of momentum p wakes the body struck and others along contacts until they have p / slow together: so much it
// can make as fast as what counts as moving. Masses in the row are 1, 2, 3, 4 kg; the one apart sleeps on.
TEST(SoftSleep, EndsForAsManyAsABlowCanMove) {
  EXPECT_THAT(Struck(0.99 * 1 * kSlow).woken, UnorderedElementsAre(0));
  EXPECT_THAT(Struck(1.01 * 1 * kSlow).woken, UnorderedElementsAre(0, 1));
  EXPECT_THAT(Struck(2.99 * kSlow).woken, UnorderedElementsAre(0, 1));
  EXPECT_THAT(Struck(3.01 * kSlow).woken, UnorderedElementsAre(0, 1, 2));
  EXPECT_THAT(Struck(6.01 * kSlow).woken, UnorderedElementsAre(0, 1, 2, 3));
  EXPECT_THAT(Struck(100).woken, UnorderedElementsAre(0, 1, 2, 3));
}

}  // namespace
}  // namespace cradle
