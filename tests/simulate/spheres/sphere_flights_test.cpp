#include "simulate/spheres/sphere_flights.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "math/rotation.h"

namespace cradle {
namespace {

using testing::SizeIs;

const Vec3 kPull(0, -9.81, 0);  // m/s^2
constexpr std::array<int, 3> kNoSupports = {-1, -1, -1};

SphereWorld spheresAt(const std::vector<UniformMotion>& starts, double radius = 0.1) {
  SphereWorld world;
  world.gravity = kPull;
  world.starts = starts;
  world.radii.assign(starts.size(), radius);
  world.inverseMasses.assign(starts.size(), 1.0);
  return world;
}

/// 200 spheres of two sizes at random in a room of 1.7 m, that fly in all directions.
SphereWorld crowd() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 1.7), speed(-3, 3);
  std::vector<UniformMotion> starts;
  while (starts.size() < 200) {
    const Vec3 position{place(random), place(random), place(random)},
        velocity{speed(random), speed(random), speed(random)};
    bool isFree = true;
    for (const UniformMotion& other : starts) isFree = isFree && (other.position - position).norm() > 0.13;
    if (isFree) starts.push_back({position, velocity, kPull});
  }
  SphereWorld world = spheresAt(starts, 0.06);
  for (std::size_t i = 0; i < 200; i += 2) world.radii[i] = 0.04;
  return world;
}

/// When two spheres meet: both fall alike, so that they move along straight lines as seen from each other.
double meetingOf(const SphereWorld& world, std::size_t i, std::size_t j) {
  const Vec3 apart = world.starts[j].position - world.starts[i].position,
             velocity = world.starts[j].velocity - world.starts[i].velocity;
  const double reach = world.radii[i] + world.radii[j], slope = apart.dot(velocity);
  const double root = slope * slope - velocity.squaredNorm() * (apart.squaredNorm() - reach * reach);
  return slope < 0 && root > 0 ? (-slope - std::sqrt(root)) / velocity.squaredNorm() : kNever;
}

// What a sphere meets before it or the other leaves its cell is in the cells around; a later one need not be found, but
// what is found comes about.
TEST(SphereFlights, FindTheFirstOfAllMeetingsBeforeASphereLeavesItsCell) {
  const SphereWorld world = crowd();
  const SphereFlights flights(world, 10);
  int due = 0;
  for (int sphere = 0; sphere < 200; ++sphere) {
    const auto i = static_cast<std::size_t>(sphere);
    const double crossing = flights.nextCrossing(sphere, 0).time;
    const PredictedCollision found = flights.nextCollision(sphere, 0, crossing);
    if (found.other != kNoPartner) {
      EXPECT_NEAR(found.time, meetingOf(world, i, static_cast<std::size_t>(found.other)), 1e-12) << sphere;
    }
    for (int other = 0; other < 200; ++other) {
      const double time = other == sphere ? kNever : meetingOf(world, i, static_cast<std::size_t>(other));
      if (time > std::min(crossing, flights.nextCrossing(other, 0).time)) continue;
      EXPECT_LE(found.time, time + 1e-12) << sphere << " " << other;
      ++due;
    }
  }
  EXPECT_GE(due, 20);
}

// Sides of cells are a grid: places where spheres cross one are whole numbers of cells apart, whatever sphere crosses.
TEST(SphereFlights, LeaveACellWhereTheirParabolaComesToItsSide) {
  const SphereWorld world = crowd();
  SphereFlights flights(world, 10);
  std::array<std::vector<double>, 3> places;  // m, by axis
  for (int sphere = 0; sphere < 200; ++sphere) {
    double now = 0;
    for (int i = 0; i < 6; ++i) {
      const CellCrossing crossing = flights.nextCrossing(sphere, now);
      ASSERT_GE(crossing.time, now);
      ASSERT_LT(crossing.time, 10);
      const UniformMotion motion = world.starts[static_cast<std::size_t>(sphere)].after(crossing.time);
      EXPECT_GE(crossing.step * motion.velocity[crossing.axis], -1e-12);
      places[static_cast<std::size_t>(crossing.axis)].push_back(motion.position[crossing.axis]);
      flights.cross(sphere, crossing);
      now = crossing.time;
    }
  }
  for (std::vector<double>& along : places) {
    ASSERT_GT(along.size(), 100u);
    std::sort(along.begin(), along.end());
    double size = kNever;
    for (std::size_t i = 1; i < along.size(); ++i)
      if (along[i] - along[i - 1] > 1e-9) size = std::min(size, along[i] - along[i - 1]);
    EXPECT_GE(size, 2 * 0.06);  // or a sphere could touch others than those of the cells around
    for (const double place : along)
      EXPECT_NEAR(std::remainder(place - along[0], size), 0, 1e-11) << size;  // of places below 100 m
  }
}

// A sphere whose partner has been struck meets nothing there; the clock of a struck one starts anew.
TEST(SphereFlights, ForgetMeetingsWhosePartnerWasStruck) {
  const SphereWorld world = spheresAt({{Vec3::Zero(), Vec3(1, 0, 0), kPull}, {Vec3(1, 0, 0), Vec3::Zero(), kPull}});
  SphereFlights flights(world, 10);
  const PredictedCollision meeting = flights.nextCollision(0, 0, kNever);
  EXPECT_NEAR(meeting.time, 0.8, 1e-15);
  EXPECT_EQ(meeting.other, 1);
  EXPECT_TRUE(flights.holds(meeting));
  flights.strike(1, 0.5, {Vec3(1, 5, 0), Vec3(0, 2, 0), Vec3(0, -1, 0)}, kNoSupports);
  EXPECT_FALSE(flights.holds(meeting));
  EXPECT_EQ(flights.hits(1), 1);
  const UniformMotion later = flights.motionAt(1, 1.5);
  EXPECT_LT((later.position - Vec3(1, 6.5, 0)).norm(), 1e-15);
  EXPECT_LT((later.velocity - Vec3(0, 1, 0)).norm(), 1e-15);
  flights.shiftTime(0.25);
  EXPECT_LT((flights.motionAt(1, 1.25).position - Vec3(1, 6.5, 0)).norm(), 1e-15);
}

// h = g t^2 / 2 to a plane, and the way of a sphere that a plane carries is not to it.
TEST(SphereFlights, MeetPlanesThatDoNotCarryThem) {
  SphereWorld world = spheresAt({{Vec3(0, 1.1, 0), Vec3::Zero(), kPull}});
  const Vec3 slant(0.6, 0.8, 0);
  world.planes = {{Vec3(0, -3, 0), Vec3::UnitY(), 0}, {Vec3::Zero(), slant, 0}};
  SphereFlights flights(world, 10);
  const PredictedCollision meeting = flights.nextCollision(0, 0, kNever);
  EXPECT_EQ(meeting.other, ~1);
  EXPECT_NEAR(meeting.time, std::sqrt(2 * (0.88 - 0.1) / (0.8 * 9.81)), 1e-15);
  flights.strike(0, 0, world.starts[0], {1, -1, -1});
  const PredictedCollision floor = flights.nextCollision(0, 0, kNever);
  EXPECT_EQ(floor.other, ~0);
  EXPECT_NEAR(floor.time, std::sqrt(2 * 4 / 9.81), 1e-15);
}

// A sphere of 0.1 m beside the edge of a turned box with rounding: it falls by 1 m - sqrt(0.15^2 - 0.09^2) until it is
// 0.15 m from the edge.
TEST(SphereFlights, MeetEdgesOfBoxes) {
  SphereWorld world = spheresAt({{Vec3(0.59, 1.5, 0.1), Vec3::Zero(), kPull}});
  const RigidTransform worldFromBox{rotationAbout(Vec3::UnitZ(), 1.5707963267948966), Vec3::Zero()};
  world.boxes = {{worldFromBox.inverse(), Vec3(0.5, 0.5, 1), 0.05}};
  const PredictedCollision meeting = SphereFlights(world, 10).nextCollision(0, 0, kNever);
  EXPECT_EQ(meeting.other, ~0);
  EXPECT_NEAR(meeting.time, std::sqrt(2 * (1 - 0.12) / 9.81), 1e-14);
}

// Spheres that touch and pass each other with 2 m/s: what they close by beside that is rounding below 1e-14 of it.
TEST(SphereFlights, DoNotMeetWhatTheyTouchByRounding) {
  for (const double part : {0.9, 1.1}) {
    const SphereWorld world = spheresAt(
        {{Vec3::Zero(), Vec3(part * 2e-14, 2, 0), Vec3::Zero()}, {Vec3(0.2, 0, 0), Vec3::Zero(), Vec3::Zero()}});
    const PredictedCollision meeting = SphereFlights(world, 10).nextCollision(0, 0, kNever);
    EXPECT_EQ(meeting.other, part < 1 ? kNoPartner : 1);
  }
}

TEST(SphereFlights, TouchWithinAPartOfTheSmallerRadius) {
  for (const double part : {0.9, 1.1}) {
    const double gap = part * 1e-11 * 0.05;
    SphereWorld world = spheresAt(
        {{Vec3(0, 0.1 + gap, 0), Vec3::Zero(), kPull}, {Vec3(0.15 + gap, 0.1 + gap, 0), Vec3::Zero(), kPull}});
    world.radii = {0.1, 0.05};
    world.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
    const SphereFlights flights(world, 10);
    std::vector<SphereContact> contacts;
    flights.appendTouching(1, 0, contacts);  // the plane is 0.05 m below
    EXPECT_THAT(contacts, SizeIs(part < 1 ? 1 : 0));
    contacts.clear();
    flights.appendTouching(0, 0, contacts);  // to the plane its own radius counts, twice as large
    EXPECT_THAT(contacts, SizeIs(part < 1 ? 2 : 1));
  }
}

TEST(SphereFlights, HaveContactsInTheMiddleBetweenTheSurfaces) {
  SphereWorld world = spheresAt({{Vec3(0, 0.5, 0), Vec3::Zero(), kPull}, {Vec3(0.3, 0.9, 0), Vec3::Zero(), kPull}});
  world.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
  const SphereFlights flights(world, 10);
  const SphereContact pair = flights.contactOf(0, 1, 0), plane = flights.contactOf(0, ~0, 0);
  EXPECT_LT((pair.normal - Vec3(0.6, 0.8, 0)).norm(), 1e-15);
  EXPECT_NEAR(pair.gap, 0.3, 1e-15);
  EXPECT_LT((pair.point - Vec3(0.15, 0.7, 0)).norm(), 1e-15);
  EXPECT_EQ(plane.normal, -Vec3::UnitY());
  EXPECT_NEAR(plane.gap, 0.4, 1e-15);
  EXPECT_LT((plane.point - Vec3(0, 0.2, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace cradle
