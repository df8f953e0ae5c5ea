#include "simulate/spheres/sphere_impact.h"

#include <gmock/gmock.h>

#include <cmath>

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

struct Spheres {
  SphereWorld world;
  std::optional<SphereFlights> flights;
  std::optional<SphereImpact> impact;

  void add(const Vec3& position, const Vec3& velocity, double mass, double radius = 0.1) {
    world.starts.push_back({position, velocity, world.gravity});
    world.radii.push_back(radius), world.inverseMasses.push_back(1 / mass);
  }
  void begin() {
    flights.emplace(world, 10);
    impact.emplace(world, *flights);
    impact->begin();
  }
  Vec3 velocity(int sphere) { return flights->motionAt(sphere, 0).velocity; }
  Vec3 acceleration(int sphere) { return flights->motionAt(sphere, 0).acceleration; }
};

// Along the normal n = (0.6, 0.8, 0): p = 2 v / (1/m + 1/m'), and across it nothing changes.
TEST(SphereImpact, ReflectsAPairAsElasticBodiesOfTheirMasses) {
  Spheres spheres;
  const Vec3 normal(0.6, 0.8, 0), a(3, 1, 0.5), b(-1, 0, 2);
  spheres.add(Vec3::Zero(), a, 2);
  spheres.add(0.25 * normal, b, 5, 0.15);
  spheres.begin();
  spheres.impact->resolve(1, 0, 0);
  const double impulse = 2 * normal.dot(a - b) / (1 / 2.0 + 1 / 5.0);
  EXPECT_LT((spheres.velocity(0) - a + impulse / 2 * normal).norm(), 1e-14);
  EXPECT_LT((spheres.velocity(1) - b - impulse / 5 * normal).norm(), 1e-14);
  ASSERT_THAT(spheres.impact->impulses(), SizeIs(1));
  EXPECT_NEAR(spheres.impact->impulses()[0], impulse, 1e-14);
  EXPECT_THAT(spheres.impact->spheres(), ElementsAre(0, 1));
  EXPECT_NEAR(spheres.impact->energyTaken(), 0, 1e-13);
  EXPECT_NEAR(spheres.impact->energyLost(), 0, 1e-13);
}

// A sphere between two that touch it: all three are one impact, which loses no energy and no momentum and leaves
// nothing that closes. What is near without touching stays out of it.
TEST(SphereImpact, TakesAllThatTouchDirectlyOrByOthers) {
  Spheres spheres;
  spheres.add(Vec3(-0.2, 0, 0), Vec3(2, 0, 0), 1);
  spheres.add(Vec3(0, 0, 0), Vec3::Zero(), 3);
  spheres.add(Vec3(0.12, 0.16, 0), Vec3::Zero(), 2);
  spheres.add(Vec3(0, -0.201, 0), Vec3(1, 1, 1), 7);
  spheres.begin();
  spheres.impact->resolve(0, 1, 0);
  EXPECT_THAT(spheres.impact->spheres(), ElementsAre(0, 1, 2));
  EXPECT_EQ(spheres.velocity(3), Vec3(1, 1, 1));
  const Vec3 momentum = spheres.velocity(0) + 3 * spheres.velocity(1) + 2 * spheres.velocity(2);
  EXPECT_LT((momentum - Vec3(2, 0, 0)).norm(), 1e-14);
  EXPECT_NEAR(
      spheres.velocity(0).squaredNorm() + 3 * spheres.velocity(1).squaredNorm() + 2 * spheres.velocity(2).squaredNorm(),
      4, 1e-13);
  EXPECT_GT((spheres.velocity(1) - spheres.velocity(0)).x(), 0.1);
  EXPECT_GT((spheres.velocity(2) - spheres.velocity(1)).dot(Vec3(0.6, 0.8, 0)), 0.1);
  // Impulses act along the lines of centres alone: those of the outer two show them.
  EXPECT_LT((spheres.velocity(0) - Vec3(2 - spheres.impact->impulses()[0], 0, 0)).norm(), 1e-14);
  EXPECT_LT((spheres.velocity(2) - spheres.impact->impulses()[1] / 2 * Vec3(0.6, 0.8, 0)).norm(), 1e-14);
}

// In the valley between two slopes a sphere is carried by both, and slides along their line d = n x n': a = d (d.g).
TEST(SphereImpact, LetsPlanesCarryWhatLiesOnThem) {
  Spheres spheres;
  spheres.world.gravity = Vec3(0.5, -9.81, -2);
  const Vec3 left = Vec3(1, 1, 0).normalized(), right = Vec3(-1, 2, 1).normalized();
  spheres.world.planes = {{Vec3::Zero(), left, 0}, {Vec3::Zero(), right, 0}, {Vec3(0, 9, 0), -Vec3::UnitY(), 0}};
  const Vec3 along = left.cross(right).normalized();
  Mat3 planes;
  planes << left.transpose(), right.transpose(), along.transpose();
  const Vec3 valley = planes.inverse() * Vec3(0.1, 0.1, 0);
  spheres.add(valley, 0.7 * along, 2);
  spheres.begin();
  EXPECT_LT((spheres.acceleration(0) - along * along.dot(spheres.world.gravity)).norm(), 1e-14);
  EXPECT_LT((spheres.velocity(0) - 0.7 * along).norm(), 1e-15);
}

// A slope that the sphere touches from the side of gravity, or leaves, does not carry it.
TEST(SphereImpact, LetsOnlyPlanesThatArePressedCarry) {
  for (const double up : {0.0, 1e-3}) {
    Spheres spheres;
    spheres.world.gravity = Vec3(0, -9.81, 0);
    spheres.world.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}, {Vec3(-0.1, 0, 0), Vec3::UnitX(), 0}};
    spheres.add(Vec3(0, 0.1, 0), Vec3(0, up, 0), 2);
    spheres.begin();
    EXPECT_LT((spheres.acceleration(0) - (up > 0 ? spheres.world.gravity : Vec3(0, 0, 0))).norm(), 1e-14);
    EXPECT_EQ(spheres.velocity(0).y(), up);
  }
}

// Slower than 1e-7 sqrt(g r) is rounding: a plane stops it, and the ledger has what that took.
TEST(SphereImpact, StopsOnPlanesWhatIsSlowerThanRounding) {
  for (const double part : {0.9, 1.1}) {
    Spheres spheres;
    spheres.world.gravity = Vec3(0, -9.81, 0);
    spheres.world.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
    const double speed = part * 1e-7 * std::sqrt(9.81 * 0.1);
    spheres.add(Vec3(0, 0.1, 0), Vec3(0, -speed, 0), 2);
    spheres.flights.emplace(spheres.world, 10);
    spheres.impact.emplace(spheres.world, *spheres.flights);
    spheres.impact->resolve(0, ~0, 0);
    EXPECT_EQ(spheres.velocity(0).y(), part < 1 ? 0 : speed);
    EXPECT_NEAR(spheres.impact->energyLost(), part < 1 ? speed * speed : 0, 1e-29);
  }
}

// On top of another sphere nothing holds it but contact, unless it passes so fast that it lifts off: v^2 / (r + r') >
// g.
TEST(SphereImpact, TellsOfContactsThatWouldLast) {
  for (const double part : {0.99, 1.01}) {
    Spheres spheres;
    spheres.world.gravity = Vec3(0, -9.81, 0);
    spheres.world.planes = {{Vec3::Zero(), Vec3::UnitY(), 0}};
    spheres.add(Vec3(0, 0.1, 0), Vec3::Zero(), 2);
    spheres.add(Vec3(0, 0.35, 0), Vec3(std::sqrt(part * 9.81 * 0.25), 0, 0), 1, 0.15);
    spheres.begin();
    const auto lasting = spheres.impact->lastingContact();
    ASSERT_EQ(lasting.has_value(), part < 1);
    if (lasting) {
      EXPECT_EQ(std::pair(lasting->sphere, lasting->other), std::pair(0, 1));
    }
  }
}

}  // namespace
}  // namespace cradle
