#include "simulate/spheres/hard_spheres.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "constraints/invariants.h"
#include "experiments/experiment.h"
#include "math/rotation.h"

namespace cradle {
namespace {

using testing::SizeIs;

const char* const kLossless = R"("materials": {"hard": {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}})";

std::string hardBall(const std::string& name, double radius, double mass, const Vec3& position, const Vec3& velocity,
                     const std::string& more = "") {
  return fmt::format(R"({{"name": "{}", "shape": {{"sphere": {{"radius": {}}}}}, "mass": {}, "material": "hard",
    "position": {}, "linearVelocity": {}{}}})",
                     name, radius, mass, vectorText(position), vectorText(velocity), more);
}

std::string wallAt(const std::string& name, const Vec3& position, const Vec3& normal) {
  return fmt::format(R"({{"name": "{}", "shape": {{"plane": {{"normal": {}}}}}, "motion": "static", "material": "hard",
    "position": {}}})",
                     name, vectorText(normal), vectorText(position));
}

struct Flying {
  Flying(const std::string& bodies, double duration, const std::string& more = "")
      : scene(sceneWith(fmt::format(R"("duration": {}, {}, "bodies": [{}]{})", duration, kLossless, bodies, more))),
        spheres(scene, assemble(scene, planOf(scene).islands.at(0)),
                hardSpheresOf(scene, planOf(scene).islands.at(0)).value()) {}

  Scene scene;
  HardSpheres spheres;
};

using Wide = long double;
using Wide3 = Eigen::Matrix<Wide, 3, 1>;

/// The oracle: all spheres go from collision to collision of all pairs and walls, in long double.
struct Billiard {
  struct Ball {
    Wide3 position, velocity;
    Wide radius, mass;
  };
  struct Wall {
    Wide3 point, normal;
  };
  std::vector<Ball> balls;
  std::vector<Wall> walls;
  Wide3 gravity = Wide3(0, -Wide(9.81), 0);
  std::vector<std::pair<Wide, std::pair<int, int>>> collisions;  // s; ball and ball, or ~wall

  Wide timeOfPair(const Ball& a, const Ball& b) const {
    const Wide3 apart = b.position - a.position, velocity = b.velocity - a.velocity;
    const Wide reach = a.radius + b.radius, slope = apart.dot(velocity), speed2 = velocity.squaredNorm();
    const Wide root = slope * slope - speed2 * (apart.squaredNorm() - reach * reach);
    return slope < 0 && root > 0 ? (-slope - std::sqrt(root)) / speed2 : Wide(kNever);
  }
  Wide timeOfWall(const Ball& ball, const Wall& wall) const {
    const Wide gap = wall.normal.dot(ball.position - wall.point) - ball.radius, speed = wall.normal.dot(ball.velocity),
               bend = wall.normal.dot(gravity);
    // The ball is inside: the later root of a parabola that bends to the wall, the earlier one of another.
    if (bend == 0) return speed < 0 ? gap / -speed : Wide(kNever);
    const Wide root = speed * speed - 2 * bend * gap;
    if (bend < 0) return (-speed - std::sqrt(root)) / bend;
    return speed < 0 && root > 0 ? (-speed - std::sqrt(root)) / bend : Wide(kNever);
  }
  void fly(Wide time) {
    for (Ball& ball : balls) {
      ball.position += time * (ball.velocity + time / 2 * gravity);
      ball.velocity += time * gravity;
    }
  }
  void run(Wide duration) {
    Wide now = 0;
    for (;;) {
      Wide first = kNever;
      std::pair<int, int> who;
      const auto consider = [&](Wide time, int a, int b) {
        if (time < first) first = time, who = {a, b};
      };
      for (int a = 0; a < std::ssize(balls); ++a) {
        for (int b = a + 1; b < std::ssize(balls); ++b)
          consider(timeOfPair(balls[static_cast<std::size_t>(a)], balls[static_cast<std::size_t>(b)]), a, b);
        for (int wall = 0; wall < std::ssize(walls); ++wall)
          consider(timeOfWall(balls[static_cast<std::size_t>(a)], walls[static_cast<std::size_t>(wall)]), a, ~wall);
      }
      if (now + first >= duration) return fly(duration - now);
      fly(first), now += first;
      collisions.push_back({now, who});
      Ball& a = balls[static_cast<std::size_t>(who.first)];
      if (who.second < 0) {
        const Wide3& normal = walls[static_cast<std::size_t>(~who.second)].normal;
        a.velocity -= 2 * normal.dot(a.velocity) * normal;
      } else {
        Ball& b = balls[static_cast<std::size_t>(who.second)];
        const Wide3 normal = (b.position - a.position).normalized();
        const Wide impulse = 2 * normal.dot(a.velocity - b.velocity) / (1 / a.mass + 1 / b.mass);
        a.velocity -= impulse / a.mass * normal, b.velocity += impulse / b.mass * normal;
      }
    }
  }
};

// Ten spheres of different sizes and masses in a room with a slanting floor. Errors grow with each collision: by how
// much tells a second run of the oracle, from places that are 1e-9 m off.
TEST(HardSpheres, MoveAsAllPairsInLongDoubleDo) {
  constexpr double kDuration = 1.2;  // s
  const Vec3 slant = Vec3(0.1, 1, 0.05).normalized();
  const std::vector<std::pair<Vec3, Vec3>> walls = {{Vec3::Zero(), slant},           {Vec3(-1, 0, 0), Vec3::UnitX()},
                                                    {Vec3(1, 0, 0), -Vec3::UnitX()}, {Vec3(0, 0, -1), Vec3::UnitZ()},
                                                    {Vec3(0, 0, 1), -Vec3::UnitZ()}, {Vec3(0, 2, 0), -Vec3::UnitY()}};
  Billiard billiard;
  std::string bodies;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    bodies += wallAt(fmt::format("w{}", i), walls[i].first, walls[i].second) + ", ";
    billiard.walls.push_back({walls[i].first.cast<Wide>(), walls[i].second.cast<Wide>()});
  }
  for (int i = 0; i < 10; ++i) {
    const double radius = 0.1 + 0.013 * (i * 7 % 10), mass = 0.5 + 0.3 * (i * 3 % 10);
    const Vec3 position(-0.6 + 0.6 * (i % 3), 0.5 + 0.4 * (i / 4), -0.6 + 0.4 * (i % 4));
    const Vec3 velocity(1.7 * (i % 4) - 2.1, 0.9 * (i % 3) - 1, 1.3 * (i % 5) - 2.2);
    bodies += (i > 0 ? ", " : "") + hardBall(fmt::format("b{}", i), radius, mass, position, velocity);
    billiard.balls.push_back({position.cast<Wide>(), velocity.cast<Wide>(), radius, mass});
  }
  Flying flying(bodies, 2);
  const VectorX start = flying.spheres.assembly().state;
  for (std::size_t i = 0; i < walls.size(); ++i)  // as the scene has normalised them
    billiard.walls[i].normal.normalize();
  Billiard other = billiard;
  for (int i = 0; i < 10; ++i) other.balls[static_cast<std::size_t>(i)].position[i % 3] += 1e-9;
  billiard.run(kDuration), other.run(kDuration);
  ASSERT_GT(billiard.collisions.size(), 40u);
  ASSERT_EQ(billiard.collisions.size(), other.collisions.size());
  double growth = 1;
  for (std::size_t i = 0; i < 10; ++i)
    growth =
        std::max(growth, static_cast<double>((other.balls[i].position - billiard.balls[i].position).norm()) / 1e-9);
  ASSERT_LT(growth, 1e6);

  const VectorX state = flying.spheres.stateAt(kDuration);
  // Each collision adds a rounding of a place below 2 m, which grows; 10 for the velocities (1/s).
  const double tolerance = 4e-16 * static_cast<double>(billiard.collisions.size()) * growth;
  for (Eigen::Index i = 0; i < 10; ++i) {
    const Billiard::Ball& ball = billiard.balls[static_cast<std::size_t>(i)];
    EXPECT_LT((centerOfMass(state, i) - ball.position.cast<double>()).norm(), tolerance) << i;
    EXPECT_LT((linearVelocity(state, i) - ball.velocity.cast<double>()).norm(), 10 * tolerance) << i;
  }
  const std::vector<Event> events = flying.spheres.takeEvents();
  ASSERT_EQ(events.size(), billiard.collisions.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto& [time, who] = billiard.collisions[i];
    EXPECT_EQ(events[i].kind, EventKind::impact);
    EXPECT_NEAR(events[i].time, static_cast<double>(time), tolerance);
    const int a = 6 + who.first, b = who.second < 0 ? ~who.second : 6 + who.second;
    EXPECT_EQ(std::pair(events[i].bodyA, events[i].bodyB), std::pair(a, b)) << i;
  }
  const Mechanism& mechanism = flying.spheres.assembly().mechanism;
  const double energy = energyConstant(mechanism, start);
  EXPECT_NEAR(energyConstant(mechanism, state), energy, 1e-14 * energy);
  EXPECT_NEAR(mechanicalEnergy(mechanism, state), energy, 1e-14 * energy);  // and it loses none
}

// A thin gas of 100 spheres, which are in cells: each meets what comes into the cells around it.
TEST(HardSpheres, OfAGasMeetAllThatTheyFlyTo) {
  constexpr double kDuration = 1;  // s
  Billiard gas;
  gas.gravity.setZero();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> speed(-3, 3);
  std::string bodies;
  for (int i = 0; i < 100; ++i) {
    const Vec3 position(0.3 * (i % 5), 0.3 * (i / 5 % 5) + 0.03 * (i % 3), 0.3 * (i / 25) + 0.02 * (i % 7));
    const Vec3 velocity{speed(random), speed(random), speed(random)};
    const double radius = 0.05 + 0.01 * (i % 4), mass = 1 + 0.5 * (i % 3);
    bodies += (i > 0 ? ", " : "") + hardBall(fmt::format("b{}", i), radius, mass, position, velocity);
    gas.balls.push_back({position.cast<Wide>(), velocity.cast<Wide>(), radius, mass});
  }
  Flying flying(bodies, 2, R"(, "gravity": [0, 0, 0])");
  Billiard other = gas;
  for (std::size_t i = 0; i < 100; ++i) other.balls[i].position[static_cast<Eigen::Index>(i % 3)] += 1e-9;
  gas.run(kDuration), other.run(kDuration);
  ASSERT_GT(gas.collisions.size(), 20u);
  double growth = 1;
  for (std::size_t i = 0; i < 100; ++i)
    growth = std::max(growth, static_cast<double>((other.balls[i].position - gas.balls[i].position).norm()) / 1e-9);
  ASSERT_LT(growth, 1e6);
  const VectorX state = flying.spheres.stateAt(kDuration);
  EXPECT_THAT(flying.spheres.takeEvents(), SizeIs(gas.collisions.size()));
  // Each collision adds a rounding of a place below 8 m, which grows.
  const double tolerance = 1e-15 * static_cast<double>(gas.collisions.size()) * growth;
  for (Eigen::Index i = 0; i < 100; ++i)
    EXPECT_LT((centerOfMass(state, i) - gas.balls[static_cast<std::size_t>(i)].position.cast<double>()).norm(),
              tolerance)
        << i;
}

// 1000 bounces of a fall from 1 m: the period is 2 sqrt(2 h / g). Each bounce rounds the place (1e-16 m at 4.4 m/s) and
// the time since the last; the sum of the times is kept with twice the digits.
TEST(HardSpheres, KeepThePhaseOfAThousandBounces) {
  Flying flying(wallAt("floor", Vec3::Zero(), Vec3::UnitY()) + ", " +
                    hardBall("ball", 0.1, 2, Vec3(0, 1.1, 0), Vec3(0.25, 0, 0), R"(, "angularVelocity": [0, 0, 2])"),
                1000);
  const double period = 2 * std::sqrt(2 / kGravity), time = 1000 * period;
  const VectorX state = flying.spheres.stateAt(time + 0.1);
  const double tolerance = 1000 * 3e-16 + 3e-13;  // s x 1 m/s; and the rounding of 900 s and of 1000 periods
  EXPECT_NEAR(centerOfMass(state, 0).y(), 1.1 - kGravity * 0.01 / 2, tolerance);
  // Each bounce rounds a place of up to 256 m to 2^-46 m.
  EXPECT_NEAR(centerOfMass(state, 0).x(), 0.25 * (time + 0.1), std::ldexp(1000, -46));
  EXPECT_NEAR(linearVelocity(state, 0).y(), -0.1 * kGravity, kGravity * tolerance);
  EXPECT_THAT(flying.spheres.takeEvents(), SizeIs(1000));
  EXPECT_EQ(angularVelocity(state, 0), Vec3(0, 0, 2));
  EXPECT_LT(orientationError(orientation(state, 0), rotationAbout(Vec3::UnitZ(), 2 * (time + 0.1))), 2 * tolerance);
}

// A sphere on a slope slides by g sin t^2 / 2, and strikes a fixed ball there.
TEST(HardSpheres, SlideOnPlanesThatCarryThem) {
  const Vec3 slope(0.6, 0.8, 0), along(0.8, -0.6, 0);
  Flying flying(wallAt("slope", Vec3::Zero(), slope) + ", " +
                    fmt::format(R"({{"name": "stop", "shape": {{"sphere": {{"radius": 0.1}}}}, "motion": "static",
        "material": "hard", "position": {}}}, )",
                                vectorText(0.1 * slope + 1.2 * along)) +
                    hardBall("ball", 0.1, 2, 0.1 * slope, Vec3::Zero()),
                2);
  const double pull = 0.6 * kGravity;
  VectorX state = flying.spheres.stateAt(0.5);
  EXPECT_LT((centerOfMass(state, 0) - 0.1 * slope - pull / 8 * along).norm(), 1e-15);
  // After 1 m it turns back as fast as it came, and is at the start again after twice the time.
  const double time = std::sqrt(2 / pull);
  state = flying.spheres.stateAt(2 * time);
  EXPECT_LT((centerOfMass(state, 0) - 0.1 * slope).norm(), 1e-14);
  EXPECT_LT(linearVelocity(state, 0).norm(), 1e-14);
  EXPECT_THAT(flying.spheres.takeEvents(), SizeIs(1));
}

TEST(HardSpheres, DoNotTakeWhatLiesOnAnythingButPlanes) {
  const auto take = [](const std::string& below, double height) {
    const Scene scene =
        sceneWith(fmt::format(R"("duration": 1, {}, "bodies": [{{"name": "below", "motion": "static",
        "material": "hard", "shape": {}}}, {}])",
                              kLossless, below, hardBall("ball", 0.1, 2, Vec3(0, height, 0), Vec3::Zero())));
    return hardSpheresOf(scene, planOf(scene).islands.at(0)).has_value();
  };
  EXPECT_TRUE(take(R"({"plane": {}})", 0.1));
  EXPECT_FALSE(take(R"({"box": {"size": [1, 1, 1]}})", 0.6));
  EXPECT_TRUE(take(R"({"box": {"size": [1, 1, 1]}})", 0.601));
  EXPECT_FALSE(take(R"({"sphere": {"radius": 0.5}})", 0.6));
}

}  // namespace
}  // namespace cradle
