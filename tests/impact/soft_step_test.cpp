// Small piles by the fast contact step. Its method is of order 1 in the sub-step of 1/240 s.

#include "impact/soft_step.h"

#include <gtest/gtest.h>

#include "impact/dropped_bodies.h"
#include "impact/soft_parameters.h"

namespace cradle {
namespace {

const ContactMaterial kLaw{0, 0.5, 0.5};
constexpr double kDeepest = 3.5e-3;  // m: what the eye may see of 0.2 m

enum class Kind { balls, cubes, turnedCubes, octahedra, capsules };

/// 40 bodies in a tray 0.9 m wide, on a grid that is a little irregular.
void drop(Kind kind, DroppedBodies& bodies) {
  bodies.addTray(0.9);
  const bool isWide = kind != Kind::balls && kind != Kind::cubes;
  const double pitch = isWide ? 0.36 : 0.22;
  const int side = isWide ? 2 : 3;
  for (int i = 0; i < 40; ++i) {
    const int column = i % side, row = i / side % side, layer = i / (side * side);
    const double offset = 0.003 * (i * 7 % 5 - 2), first = -pitch * (side - 1) / 2;
    const Vec3 position(first + pitch * column + offset, 0.2 + pitch * layer, first + pitch * row - offset);
    const Quat turn(0.3 + 0.1 * (i % 3), 0.2 * (i % 5) - 0.4, 0.3 * (i % 4) - 0.5, 0.1 * (i % 7));
    if (kind == Kind::balls)
      bodies.addSphere(position);
    else if (kind == Kind::octahedra)
      bodies.addOctahedron(position, turn.normalized());
    else if (kind == Kind::capsules)
      bodies.addCapsule(position, turn.normalized());
    else
      bodies.addCube(position, kind == Kind::cubes ? Quat::Identity() : turn.normalized());
  }
}

class Piles : public ::testing::TestWithParam<Kind> {};

TEST_P(Piles, OverlapLittleWhileTheyFallAndComeToRest) {
  DroppedBodies bodies;
  drop(GetParam(), bodies);
  bodies.begin(kLaw);
  double deepest = 0;
  for (int step = 0; step < 480 && !bodies.step().allAsleep(); ++step) {
    bodies.advance();
    if (step < 120) deepest = std::max(deepest, bodies.deepestOverlap());
  }
  deepest = std::max(deepest, bodies.deepestOverlap());
  EXPECT_LT(deepest, kDeepest);
  EXPECT_TRUE(bodies.step().allAsleep());
}

TEST_P(Piles, HaveNeverMoreEnergyThanAtTheStart) {
  DroppedBodies bodies;
  drop(GetParam(), bodies);
  bodies.begin(kLaw);
  const double start = bodies.energy();
  for (int step = 0; step < 120; ++step) {
    bodies.advance();
    ASSERT_LE(bodies.energy(), start * (1 + 1e-13)) << step;
  }
}

// Contacts give as springs do: what an impact presses in comes back in part. Documented: 1.5 % of the kinetic energy.
TEST_P(Piles, RegainLittleOfTheEnergyThatAnImpactTook) {
  DroppedBodies bodies;
  drop(GetParam(), bodies);
  bodies.begin(kLaw);
  const double start = bodies.energy();
  double least = start, regained = 0, fastest = 0;
  for (int step = 0; step < 150; ++step) {
    bodies.advance();
    const double energy = bodies.energy();
    regained = std::max(regained, energy - least), least = std::min(least, energy);
    double kinetic = 0;
    for (int i = 0; i < bodies.count(); ++i) kinetic += linearVelocity(bodies.state(), i).squaredNorm() / 2;
    fastest = std::max(fastest, kinetic);
  }
  EXPECT_LT(regained, 0.015 * fastest);
}

TEST_P(Piles, AreTheSameWithAnyNumberOfThreads) {
  std::vector<VectorX> states;
  for (const int threads : {1, 2}) {
    DroppedBodies bodies;
    drop(GetParam(), bodies);
    bodies.begin(kLaw, Vec3(0, -9.81, 0), threads);
    bodies.advance(20);
    states.push_back(bodies.state());
  }
  EXPECT_EQ(states[1], states[0]);
}

// Two balls in contact elsewhere take lanes beside those of the pile: the first pairs share a block with others.
TEST_P(Piles, DoNotDependOnWhatStandsInTheOtherLane) {
  std::vector<VectorX> states;
  for (const bool hasOthers : {false, true}) {
    DroppedBodies bodies;
    drop(GetParam(), bodies);
    if (hasOthers) bodies.addSphere(Vec3(0, 20, 0)), bodies.addSphere(Vec3(0.2, 20, 0));
    bodies.begin(kLaw);
    bodies.advance(40);
    VectorX poses(7 * 40);
    poses = bodies.state().head(7 * 40);
    states.push_back(poses);
  }
  EXPECT_EQ(states[1], states[0]);
}

INSTANTIATE_TEST_SUITE_P(All, Piles,
                         ::testing::Values(Kind::balls, Kind::cubes, Kind::turnedCubes, Kind::octahedra,
                                           Kind::capsules));

// Towers of cubes beside each other, each cube a little off the one below, fall by at most 0.49 m, for 0.32 s, and
// sleep after 0.5 s of being slow: 49 steps, if nothing moved after the fall. With eight sub-steps the cubes went on
// slipping for 0.7 s.
TEST(PileAtRest, CreepsNoMoreAfterTheFall) {
  DroppedBodies bodies;
  bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
  for (int i = 0; i < 9 * 13; ++i) {
    const int column = i % 3, row = i / 3 % 3, layer = i / 9;
    const double x = 0.002 * (i * 7 % 5 - 2), z = 0.002 * (i * 3 % 7 - 3);
    bodies.addCube(Vec3(0.22 * (column - 1) + x, 0.2 + 0.231 * layer, 0.22 * (row - 1) + z));
  }
  bodies.begin(kLaw);
  int steps = 0;
  for (; steps < 300 && !bodies.step().allAsleep(); ++steps) bodies.advance();
  EXPECT_LT(steps, 49 + 16);
}

// More sub-steps bring balls to rest no sooner, and cost as much as for others: a cube beside them changes nothing.
TEST(HeapOfBalls, DoesNotDependOnACubeThatSlidesFarAway) {
  std::vector<VectorX> states;
  for (const bool hasCube : {false, true}) {
    DroppedBodies bodies;
    bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
    for (int i = 0; i < 12; ++i)
      bodies.addSphere(Vec3(0.21 * (i % 2) + 0.01 * (i % 3), 0.11 + 0.21 * (i / 4), 0.21 * (i / 2 % 2)));
    if (hasCube) bodies.addCube(Vec3(0, 0.1, 20));
    bodies.begin(kLaw);
    if (hasCube) linearVelocity(bodies.state(), 12) = Vec3(3, 0, 0);
    bodies.advance(30);
    states.emplace_back(bodies.state().head(7 * 12));
  }
  EXPECT_EQ(states[1], states[0]);
}

// Layers of capsules along each other, each a little aslant: they touch in lines, and lie still. With one point for
// each line they turned about it, overlapped by 28 mm and did not come to rest.
TEST(PileAtRest, LiesStillWhereCapsulesTouchInLines) {
  DroppedBodies bodies;
  bodies.addTray(0.5);
  for (int i = 0; i < 30; ++i) {
    const int layer = i / 3, column = i % 3;
    const Vec3 position(0.13 * (column - 1) + (layer % 2 ? 0.05 : -0.05), 0.08 + 0.13 * layer, 0.01 * (i % 4 - 1));
    bodies.addCapsule(position, Quat(1, 1 + 0.02 * (i % 3 - 1), 0.02 * (i % 5 - 2), 0.02 * (i % 5 - 2)).normalized());
  }
  bodies.begin(kLaw);
  double deepest = 0;
  int steps = 0;
  for (; steps < 300 && !bodies.step().allAsleep(); ++steps) {
    bodies.advance();
    deepest = std::max(deepest, bodies.deepestOverlap());
  }
  EXPECT_LT(deepest, kDeepest);
  EXPECT_LT(steps, 300);
}

TEST(PileAtRest, IsLookedAtNoMoreUntilSomethingHitsIt) {
  DroppedBodies bodies;
  bodies.addTray(2);
  for (int i = 0; i < 4; ++i)
    bodies.addSphere(Vec3(0.1, 0.1 + 0.2 * i, 0));     // one on the other: they do not fall aside
  bodies.addSphere(Vec3(-0.6, 12, 0));                 // falls for 1.56 s, far from the others
  bodies.addSphere(Vec3(0.1, 25, 0), Vec3(0, -4, 0));  // hits the uppermost after 1.83 s
  bodies.begin(kLaw);
  bodies.advance(60);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(bodies.step().isAsleep(i)) << i;
  const Vec3 before = bodies.position(0);
  bodies.advance(30);
  EXPECT_EQ(bodies.position(0), before);
  bodies.advance(30);
  EXPECT_FALSE(bodies.step().isAsleep(3));
  bodies.advance(900);
  ASSERT_TRUE(bodies.step().allAsleep());
  const long detections = bodies.step().detections();
  bodies.advance(100);
  EXPECT_EQ(bodies.step().detections(), detections);
}

// A ball rolls along a row of cubes: those that it does not touch sleep, and do not stop it. It lies 0.06 mm deep in
// the cube below, and climbs to the next: 3.5 degrees, 3 % of its speed each time, and it comes by three.
TEST(PileAtRest, SleepsBesideABodyThatRollsOverIt) {
  DroppedBodies bodies;
  bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
  for (int i = 0; i < 10; ++i) bodies.addCube(Vec3(0.2 * i, 0.1, 0));
  bodies.addSphere(Vec3(0, 0.3, 0), Vec3(0.5, 0, 0));
  bodies.begin(kLaw);
  angularVelocity(bodies.state(), 10) = Vec3(0, 0, -5);
  bodies.advance(75);
  EXPECT_NEAR(bodies.position(10).x(), 0.6, 0.05);
  EXPECT_FALSE(bodies.step().isAsleep(10));
  EXPECT_FALSE(bodies.step().isAsleep(3));
  for (std::size_t i = 6; i < 10; ++i) EXPECT_TRUE(bodies.step().isAsleep(i)) << i;
  EXPECT_GT(linearVelocity(bodies.state(), 10).x(), 0.45);
}

// A ball strikes the end of a row of sleeping cubes on ice: all of them move, with its momentum.
TEST(PileAtRest, TakesUpTheMomentumOfABlow) {
  DroppedBodies bodies;
  bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
  for (int i = 0; i < 5; ++i) bodies.addCube(Vec3(0.2 * i, 0.1, 0));
  bodies.addSphere(Vec3(-4.1, 0.1, 0), Vec3(4, 0, 0));  // there after 0.97 s
  bodies.begin({0, 0, 0});
  bodies.advance(45);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(bodies.step().isAsleep(i)) << i;
  bodies.advance(30);
  double momentum = 0;
  for (int i = 0; i < 6; ++i) momentum += linearVelocity(bodies.state(), i).x();
  EXPECT_NEAR(momentum, 4, 1e-9);
  EXPECT_GT(linearVelocity(bodies.state(), 4).x(), 0.1);
}

// Dropped by 10 mm and more: each cube may come to lie 2 mm off the one below.
TEST(Stack, OfTenCubesStands) {
  DroppedBodies bodies;
  bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
  for (int i = 0; i < 10; ++i) bodies.addCube(Vec3(0.01 * (i % 2), 0.11 + 0.205 * i, 0));
  bodies.begin(kLaw);
  bodies.advance(300);
  EXPECT_TRUE(bodies.step().allAsleep());
  for (int i = 0; i < 10; ++i) {
    EXPECT_NEAR(bodies.position(i).y(), 0.1 + 0.2 * i, 2e-3 * (i + 1)) << i;
    EXPECT_NEAR(bodies.position(i).x(), 0.01 * (i % 2), 2e-3 * (i + 1)) << i;
  }
}

/// Equal boxes one above the other.
struct Tower {
  int height;
  Vec3 size;   // m
  double gap;  // m, below each
  double restitution;
};

MassProperties solidBox(const Vec3& size) {
  MassProperties properties = massProperties(Box{size}, 1);
  properties.inertiaTensor /= properties.mass, properties.mass = 1;
  return properties;
}

/// The farthest (m) that a body goes sideways in two seconds.
double sidewaysIn2s(DroppedBodies& bodies) {
  std::vector<Vec3> starts;
  for (int i = 0; i < bodies.count(); ++i) starts.push_back(bodies.position(i));
  double farthest = 0;
  for (int step = 0; step < 120; ++step) {
    bodies.advance();
    for (int i = 0; i < bodies.count(); ++i) {
      const Vec3 way = bodies.position(i) - starts[static_cast<std::size_t>(i)];
      farthest = std::max({farthest, std::abs(way.x()), std::abs(way.z())});
    }
  }
  return farthest;
}

// The load is the same on all four corners, and no corner comes before another. Rounding, 1e-16 m, grows where a tower
// is slender: a limit of 1e-9 m leaves 16 e-foldings.
TEST(Tower, OfEqualBoxesStaysStraight) {
  for (const Tower& tower : {Tower{5, Vec3::Constant(0.05), 0.02, 0.1}, Tower{25, Vec3::Constant(0.05), 0.02, 0.1},
                             Tower{40, Vec3::Constant(0.2), 0.02, 0.5}, Tower{25, Vec3::Constant(0.2), 0, 0},
                             Tower{25, Vec3::Constant(0.05), 0.002, 0.3}, Tower{13, Vec3(0.05, 0.1, 0.05), 0.01, 0},
                             Tower{25, Vec3(0.2, 0.05, 0.1), 0.02, 0.1}, Tower{20, Vec3(0.02, 0.05, 0.08), 0.02, 0.1},
                             Tower{10, Vec3::Constant(0.02), 0, 0}, Tower{25, Vec3::Constant(0.005), 1e-3, 0.1}}) {
    DroppedBodies bodies;
    bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
    for (const Vec3& place : {Vec3(0, 0, 0), Vec3(0.37, 0, -0.41)})
      for (int i = 0; i < tower.height; ++i) {
        const Vec3 position = place + ((tower.size.y() + tower.gap) * (i + 1) - tower.size.y() / 2) * Vec3::UnitY();
        bodies.add(colliderOf(Box{tower.size}, {}), solidBox(tower.size).inertiaTensor, position, Quat::Identity(),
                   Vec3::Zero());
      }
    bodies.begin({tower.restitution, 0.5, 0.5});
    EXPECT_LT(sidewaysIn2s(bodies), 1e-9) << tower.height << " of " << tower.size.transpose() << ", " << tower.gap;
  }
}

// Froude's similarity: under the same gravity a heap of 1/16 of the size does the same in a quarter of the time. All
// factors are powers of two, so the bits are the same but for the exponents, if no length, time or speed of the method
// is left as it is. The larger one has the inner radius from which the parameters hold as they are.
TEST(SmallHeap, MovesAsALargeOneDoes) {
  std::vector<VectorX> states;
  for (const double size : {1.0, 1.0 / 16}) {
    const double radius = size * SoftParameters::kFullRadius, speed = std::sqrt(size);
    DroppedBodies bodies;
    bodies.addTray(8 * radius);
    for (int i = 0; i < 27; ++i) {
      const Vec3 cell(i % 3 - 1, 1 + i / 9, i / 3 % 3 - 1);
      const Vec3 position = radius * (2.5 * cell + 0.25 * Vec3(i % 2, 0, i % 4));
      const Quat turn = Quat(8, i % 5 - 2, i % 3, i % 7 - 3).normalized();
      const Vec3 velocity = speed * Vec3(0, i % 5 == 0 ? -3 : 0, 0.5);
      if (i % 3 == 0)
        bodies.add(colliderOf(Sphere{radius}, {}), 0.5 * radius * radius * Mat3::Identity(), position, turn, velocity);
      else if (i % 3 == 1)
        bodies.add(colliderOf(Box{Vec3::Constant(2 * radius)}, {}), 0.5 * radius * radius * Mat3::Identity(), position,
                   turn, velocity);
      else
        bodies.add(colliderOf(Capsule{radius, 2 * radius}, {}), 0.5 * radius * radius * Mat3::Identity(), position,
                   turn, velocity);
    }
    bodies.begin({0.25, 0.5, 0.5});
    EXPECT_EQ(bodies.step().scale().length, size);
    bodies.advance(100);
    VectorX state = bodies.state();
    for (int i = 0; i < bodies.count(); ++i) {
      centerOfMass(state, i) /= size;
      linearVelocity(state, i) /= speed;
      angularVelocity(state, i) *= speed;
    }
    states.push_back(state);
  }
  EXPECT_EQ(states[1], states[0]);
}

/// How far (m) a cube slides in 1 s down a slope with friction 0.5, after half a second in which it may settle.
double slideOn(double degrees) {
  const double angle = degrees * 3.14159265358979 / 180;
  DroppedBodies bodies;
  bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
  bodies.addCube(Vec3(0, 0.1, 0));
  bodies.begin(kLaw, 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0));
  bodies.advance(60);
  return bodies.position(0).x();
}

// The friction cone's angle is atan 0.5 = 26.6 degrees. The contact gives by 0.2 mm while it takes up the load.
TEST(Slope, HoldsACubeThatFrictionCanHold) {
  EXPECT_NEAR(slideOn(0), 0, 1e-6);
  EXPECT_NEAR(slideOn(25), 0, 1e-3);
}

// a = g (sin - 0.5 cos); velocities are a step of h = 1/240 s ahead, x = a t (t + h) / 2, and the first contact may be
// found an instant late: 1 %.
TEST(Slope, LetsACubeSlideAsFrictionAllows) {
  const double angle = 35 * 3.14159265358979 / 180;
  const double expected = 9.81 * (std::sin(angle) - 0.5 * std::cos(angle)) / 2;
  EXPECT_NEAR(slideOn(35), expected, 0.01 * expected);
}

// The speed at which the ball lands is that of the look before: at most 3e-3 m / 0.6 of approach earlier, at 4.4 m/s
// 0.5 % of the speed less, and 1 % of the height.
TEST(Rebound, HasTheHeightOfItsRestitution) {
  DroppedBodies bodies;
  bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
  bodies.addSphere(Vec3(0, 1.1, 0));
  bodies.begin({0.8, 0.5, 0.5});
  double highest = 0;
  for (int step = 0; step < 60; ++step) {
    bodies.advance();
    if (linearVelocity(bodies.state(), 0).y() > 0) highest = std::max(highest, bodies.position(0).y() - 0.1);
  }
  EXPECT_NEAR(highest, 0.64, 0.015 * 0.64);
}

// Momentum is kept, and the spheres part at `restitution` times the speed at which they met: without gravity each has
// restitution times its own speed, backwards, whatever sub-step of a step they meet in. Sums of some impulses of 1 kg
// and 1 m/s leave a few units in the last place of each.
TEST(Rebound, OfSpheresThatMeetInTheAirHasTheSpeedOfTheirRestitution) {
  for (const double restitution : {0.5, 0.8, 1.0})
    for (const double speed : {1.0, 2.0})
      for (int gap = 0; gap <= 20; ++gap) {
        DroppedBodies bodies;
        const double apart = DroppedBodies::kHalf + gap * 2.5e-4;
        bodies.addSphere(Vec3(-apart, 0, 0), Vec3(speed, 0, 0));
        bodies.addSphere(Vec3(apart, 0, 0), Vec3(-speed, 0, 0));
        bodies.begin({restitution, 0, 0}, Vec3::Zero());
        bodies.advance(6);
        for (int i = 0; i < 2; ++i)
          EXPECT_NEAR(linearVelocity(bodies.state(), i).x(), (i == 0 ? -1 : 1) * restitution * speed, 1e-13)
              << restitution << ", " << speed << " m/s, a gap of " << 2 * gap * 2.5e-4 << " m";
      }
}

TEST(FallingBody, ThatTouchesNothingFallsExactly) {
  DroppedBodies bodies;
  bodies.addPlane(Vec3::Zero(), Vec3::UnitY());
  bodies.addSphere(Vec3(0, 100, 0), Vec3(1, 2, 0));
  bodies.begin(kLaw);
  bodies.advance(120);
  EXPECT_LT((bodies.position(0) - Vec3(2, 100 + 4 - 9.81 * 2, 0)).norm(), 1e-11);
}

// Free rotation about an axis between the principal ones: without the gyroscopic term the spin would stay; energy and
// the direction of the angular momentum stay by construction.
TEST(TumblingBody, KeepsEnergyAndDirectionOfAngularMomentum) {
  DroppedBodies bodies;
  const Mat3 inertia = Vec3(0.004, 0.0104, 0.0136).asDiagonal();
  bodies.add(colliderOf(Box{Vec3(0.3, 0.2, 0.1)}, {}), inertia, Vec3::Zero(), Quat::Identity(), Vec3::Zero());
  bodies.begin(kLaw, Vec3::Zero());
  angularVelocity(bodies.state(), 0) = Vec3(0.5, 3, 1);
  const auto momentum = [&]() -> Vec3 {
    const Mat3 turn = orientation(bodies.state(), 0).toRotationMatrix();
    return turn * inertia * turn.transpose() * angularVelocity(bodies.state(), 0);
  };
  const double energy = bodies.energy();
  const Vec3 direction = momentum().normalized(), spin = angularVelocity(bodies.state(), 0);
  bodies.advance(120);
  EXPECT_NEAR(bodies.energy(), energy, 1e-12 * energy);
  EXPECT_LT((momentum().normalized() - direction).norm(), 1e-12);
  EXPECT_GT((angularVelocity(bodies.state(), 0) - spin).norm(), 0.5);
}

}  // namespace
}  // namespace cradle
