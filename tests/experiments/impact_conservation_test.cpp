#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "collision/random_poses.h"
#include "experiments/experiment.h"
#include "math/rotation.h"

// Random pairs of bodies that fly at each other without gravity, turning: whatever the impact does, momentum and
// angular momentum stay, and energy is kept (e = 1, no friction) or lost, never gained.

namespace cradle {
namespace {

struct Flight {
  std::string shape;
  double mass = 1;  // kg; 0: static
  Vec3 position = Vec3::Zero(), axis = Vec3::UnitY(), velocity = Vec3::Zero(), spin = Vec3::Zero();

  std::string text(const std::string& name) const {
    const std::string motion = mass == 0
                                   ? R"("motion": "static")"
                                   : fmt::format(R"("mass": {:.17g}, "linearVelocity": {}, "angularVelocity": {})",
                                                 mass, vectorText(velocity), vectorText(spin));
    return fmt::format(R"({{"name": "{}", "shape": {}, "material": "m", "position": {}, {},
      "orientation": {{"axis": {}, "angleDegrees": 77}}}})",
                       name, shape, vectorText(position), motion, vectorText(axis));
  }
};

struct Surface {
  double restitution, friction;
};

Trajectory collide(const Flight& a, const Flight& b, const Surface& surface) {
  return simulate(sceneOf(fmt::format(R"({{"schema": "cradle-scene/1", "name": "Impact", "duration": 1,
    "gravity": [0, 0, 0], "output": {{"framesPerSecond": 20}}, {},
    "materials": {{"m": {{"restitution": {:.17g}, "staticFriction": {:.17g}, "dynamicFriction": {:.17g}}}}},
    "bodies": [{}, {}]}})",
                                      methodText("rk4", 1.0 / 2000), surface.restitution, surface.friction,
                                      surface.friction, a.text("a"), b.text("b"))));
}

std::string someShape(bool isBox, RandomPoses& random) {
  if (!isBox) return fmt::format(R"({{"sphere": {{"radius": {:.17g}}}}})", random.number(0.1, 0.4));
  return fmt::format(R"({{"box": {{"size": {}}}}})", vectorText(Vec3(0.5, 0.5, 0.5) + random.vector(0.3)));
}

/// Two bodies of masses from 10 g to 100 kg that meet about half way, off-centre. `boxes`: how many of the two are.
std::pair<Flight, Flight> someFlights(int boxes, RandomPoses& random) {
  const Vec3 apart = random.direction();
  const auto mass = [&] { return std::pow(10, random.number(-2, 2)); };
  const Flight a{someShape(boxes == 2, random),
                 mass(),
                 Vec3(0.2, -0.1, 0.3),
                 random.direction(),
                 random.vector(0.3),
                 random.vector(3)};
  const Flight b{someShape(boxes >= 1, random),         mass(),
                 Vec3(a.position + 1.5 * apart),        random.direction(),
                 Vec3(-3 * apart + random.vector(0.2)), random.vector(3)};
  return {a, b};
}

int impactsIn(const Trajectory& run) {
  return static_cast<int>(std::count_if(run.events.begin(), run.events.end(),
                                        [](const Event& event) { return event.kind == EventKind::impact; }));
}

// RK4 turns a body at w = 5 rad/s with an error of (w h)^4 / 120 = 3e-13 of its angular momentum and energy per radian;
// impacts with light bodies leave spins of some 50 rad/s: 3e-9. Momentum is kept to rounding.
constexpr double kMomentumError = 1e-12, kTurningError = 1e-8;  // relative
// Where bodies stay together after a slow impact and roll on each other, each step takes out the overlap that an
// acceleration of some w^2 r = 50 m/s^2 makes, 50 h^2 / 2, and with it work: 50 h t / 2 in all. Momenta stay.
constexpr double kRollingError = 50.0 / 2000 / 2;  // relative

double errorOf(const Trajectory& run) {
  return impactsIn(run) == 1 ? kTurningError : kRollingError;
}

void expectMomentaKept(const Trajectory& run, const std::string& what) {
  const EnergyBalance& start = run.frames.front().energy;
  const double momentum = start.momentum.norm() + 1, angular = start.angularMomentum.norm() + momentum;
  for (const Frame& frame : run.frames) {
    EXPECT_LT((frame.energy.momentum - start.momentum).norm(), kMomentumError * momentum) << what;
    EXPECT_LT((frame.energy.angularMomentum - start.angularMomentum).norm(), kTurningError * angular) << what;
  }
}

// m: of the arms. States within a step are interpolated; the spring swings with w = 35 rad/s: (w h)^2 / 8 of 0.75 m.
constexpr double kInterpolated = 1.2e-4;

// A spring between a body's middle and a point off the other's draws bodies onto and along each other: all forces are
// between the two, and their momenta stay zero, relative to what each of them has.
TEST(BodiesThatASpringPressesTogether, KeepTheirMomentaWhateverTheirShapes) {
  for (const char* const shape :
       {R"({"capsule": {"radius": 0.25, "length": 0.125}})", R"({"cylinder": {"radius": 0.25, "length": 0.4}})",
        R"({"box": {"size": [0.4, 0.5, 0.3]}})", R"({"sphere": {"radius": 0.25}})"})
    for (const double friction : {0.0, 0.6})
      for (const double density : {1000.0, 10.0}) {
        const Trajectory run = simulate(sceneWith(fmt::format(
            R"("duration": 0.05, "gravity": [0, 0, 0], "output": {{"framesPerSecond": 960}},
      "materials": {{"m": {{"density": 1000, "staticFriction": {0}, "dynamicFriction": {0}}},
                     "n": {{"density": {1}, "staticFriction": {0}, "dynamicFriction": {0}}}}},
      "bodies": [{{"name": "a", "shape": {{"sphere": {{"radius": 0.5}}}}, "material": "m"}},
                 {{"name": "b", "shape": {2}, "material": "n", "position": [0.03, 0.02, -0.76],
                   "orientation": {{"axis": [0, 0, 1], "angleDegrees": 90}}}}],
      "springs": [{{"bodyA": "b", "anchorA": [0, 0, 0], "bodyB": "a", "anchorB": [0.34, 0.11, -0.21],
                    "stiffness": {3}, "restLength": 0}}])",
            friction, density, shape, 98.1 * density)));
        double most = 0;  // N s, of one body
        for (const Frame& frame : run.frames)
          most = std::max(most, 1000 * 4.19 * 0.125 * frame.states[0].linearVelocity.norm());
        for (const Frame& frame : run.frames) {
          EXPECT_LT(frame.energy.momentum.norm(), 1e-10 * most) << shape;
          EXPECT_LT(frame.energy.angularMomentum.norm(), kInterpolated * most) << shape << friction << " " << density;
        }
      }
}

// Bodies that fall on and lean against each other, on a floor without friction and with friction between them: nothing
// acts along the floor, nor turns them about the vertical, whatever contact steps do of their energy, and until they
// rest.
TEST(BodiesOnASmoothFloor, KeepTheirMomentaAlongItInContactSteps) {
  for (const char* const shape :
       {R"({"capsule": {"radius": 0.1, "length": 0.2}})", R"({"cylinder": {"radius": 0.15, "length": 0.1}})",
        R"({"box": {"size": [0.3, 0.2, 0.1]}})"})
    for (const double friction : {0.0, 0.5})
      for (const double speed : {0.0, 0.002, 0.3})
        for (const double duration : {0.1, 0.2, 0.3}) {
          // A step ends with the run: states there are not interpolated.
          const Trajectory run = simulate(sceneWith(fmt::format(
              R"("duration": {}, {}, "output": {{"framesPerSecond": {:.17g}}},
      "materials": {{"ice": {{"staticFriction": 0, "dynamicFriction": 0, "restitution": 0}},
                     "m": {{"staticFriction": {}, "dynamicFriction": {}, "restitution": 0}}}},
      "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "ice"}},
                 {{"name": "a", "shape": {{"box": {{"size": [0.3, 0.3, 0.3]}}}}, "material": "m", "mass": 20,
                   "position": [0, 0.15, 0], "linearVelocity": [{}, 0, 0.1]}},
                 {{"name": "b", "shape": {}, "material": "m", "mass": 5, "position": [0.36, 0.25, 0.03],
                   "orientation": {{"axis": [1, 2, 3], "angleDegrees": 50}}, "linearVelocity": [-0.3, 0, 0]}},
                 {{"name": "c", "shape": {}, "material": "m", "mass": 1, "position": [0.05, 0.52, 0.02],
                   "orientation": {{"axis": [1, 0, 3], "angleDegrees": 20}}}}])",
              duration, methodText("rk4", 1.0 / 960), 1 / duration, friction, friction, speed, shape, shape)));
          SCOPED_TRACE(fmt::format("{} friction {} speed {} duration {}", shape, friction, speed, duration));
          const EnergyBalance &start = run.frames.front().energy, &end = run.frames.back().energy;
          const Vec3 change = end.momentum - start.momentum;
          EXPECT_LT(Vec3(change.x(), 0, change.z()).norm(), kMomentumError * 20);
          EXPECT_NEAR(end.angularMomentum.y(), start.angularMomentum.y(), kTurningError * 20);
        }
}

// Too slow to lift it by 1e-7 of its size, a box on a floor without friction goes on for ever.
TEST(BodiesOnASmoothFloor, GoOnHoweverSlowTheyAre) {
  for (const double speed : {1e-5, 1e-4, 1e-3}) {
    const Trajectory run = simulate(sceneWith(fmt::format(
        R"("duration": 0.5, {}, "materials": {{"ice": {{"staticFriction": 0, "dynamicFriction": 0, "restitution": 0}}}},
      "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "ice"}},
                 {{"name": "box", "shape": {{"box": {{"size": [0.3, 0.3, 0.3]}}}}, "material": "ice", "mass": 2,
                   "position": [0, 0.15, 0], "linearVelocity": [{}, 0, 0]}}])",
        methodText("rk4", 1.0 / 960), speed)));
    EXPECT_NEAR(endOf(run).position.x(), 0.5 * speed, 1e-10 * speed);
    EXPECT_THAT(eventsOf(run, EventKind::rest), testing::IsEmpty());
  }
}

TEST(Impact, WithoutLossKeepsMomentumAngularMomentumAndEnergyForEveryPairOfShapes) {
  RandomPoses random(11);
  for (int boxes = 0; boxes <= 2; ++boxes) {
    int hits = 0;
    for (int trial = 0; trial < 25; ++trial) {
      const auto [a, b] = someFlights(boxes, random);
      const Trajectory run = collide(a, b, {1, 0});
      const std::string what = fmt::format("{} boxes, trial {}", boxes, trial);
      hits += impactsIn(run) > 0 ? 1 : 0;
      expectMomentaKept(run, what);
      for (const Frame& frame : run.frames)
        EXPECT_NEAR(frame.energy.kinetic / run.frames[0].energy.kinetic, 1, kTurningError) << what;
    }
    EXPECT_GT(hits, 15) << boxes;
  }
}

TEST(Impact, WithFrictionAndLossKeepsTheMomentaAndAccountsForTheEnergy) {
  RandomPoses random(12);
  int once = 0;
  for (int boxes = 0; boxes <= 2; ++boxes)
    for (int trial = 0; trial < 25; ++trial) {
      const auto [a, b] = someFlights(boxes, random);
      const Trajectory run = collide(a, b, {random.number(0, 1), random.number(0, 1.5)});
      const std::string what = fmt::format("{} boxes, trial {}", boxes, trial);
      expectMomentaKept(run, what);
      const double start = run.frames[0].energy.kinetic;
      double last = start;
      for (const Frame& frame : run.frames) {
        EXPECT_LE(frame.energy.kinetic, last + kTurningError * start) << what << " gains energy at " << frame.time;
        EXPECT_NEAR(energyConstantOf(frame), start, errorOf(run) * start) << what;
        last = frame.energy.kinetic;
      }
      once += impactsIn(run) == 1 ? 1 : 0;
    }
  EXPECT_GT(once, 50);  // those with the sharp tolerance
}

// Friction alone, on a perfectly elastic pair: the worst case for gaining energy by Newton's law of restitution.
TEST(Impact, WithFrictionAndFullRestitutionNeverGainsEnergy) {
  RandomPoses random(13);
  for (int trial = 0; trial < 50; ++trial) {
    const auto [a, b] = someFlights(2, random);
    const Trajectory run = collide(a, b, {1, random.number(0, 2)});
    EXPECT_LE(run.frames.back().energy.kinetic, run.frames[0].energy.kinetic * (1 + kTurningError)) << trial;
  }
}

// The ball leaves a fixed body as light leaves a mirror: v' = v - 2 (v.n) n, its spin untouched. Rounding: the
// normal, 1e-15 off, is taken 2 x 3 m/s x 2 times; a lever of 1e-16 m times 2 m x 3 m/s over the least inertia of a
// ball of 0.1 m, 0.004 m, is a spin of 1.5e-13 / 1 rad/s at most.
constexpr double kReflectionRounding = 1.5e-13;
TEST(Impact, OfABallWithAFixedBodyIsAnExactReflection) {
  RandomPoses random(14);
  for (const char* shape : {R"({"sphere": {"radius": 0.3}})", R"({"box": {"size": [0.6, 0.4, 0.7]}})",
                            R"({"plane": {"normal": [0.1, 1, -0.2]}})"}) {
    int hits = 0;
    for (int trial = 0; trial < 20; ++trial) {
      auto [fixed, ball] = someFlights(0, random);
      fixed.shape = shape, fixed.mass = 0;
      if (std::string(shape).find("plane") != std::string::npos) {
        const Vec3 normal = rotationAbout(fixed.axis.normalized(), 77 * M_PI / 180) * Vec3(0.1, 1, -0.2).normalized();
        ball.position = fixed.position + 1.5 * normal, ball.velocity = -3 * normal + random.vector(1.5);
      }
      const Trajectory run = collide(fixed, ball, {1, 0});
      if (impactsIn(run) != 1) continue;
      ++hits;
      const Vec3 n = run.events[0].normal, before = run.frames[0].states[0].linearVelocity;
      EXPECT_LT((endOf(run).linearVelocity - (before - 2 * before.dot(n) * n)).norm(), kReflectionRounding)
          << shape << trial;
      EXPECT_LT((endOf(run).angularVelocity - ball.spin).norm(), kReflectionRounding) << shape << trial;
    }
    EXPECT_GT(hits, 10) << shape;
  }
}

// A body of 1e12 kg is a wall: what rebounds from it differs by the ratio of the masses, 1e-12 x 2 x 3 m/s, and by what
// the position where they meet changes that: nothing, as the wall stands still until then.
TEST(Impact, WithAnImmenselyHeavyBodyIsThatWithAFixedOne) {
  RandomPoses random(15);
  for (int boxes = 1; boxes <= 2; ++boxes)
    for (int trial = 0; trial < 20; ++trial) {
      auto [wall, flyer] = someFlights(boxes, random);
      wall.velocity = wall.spin = Vec3::Zero();
      flyer.mass = 1;
      wall.mass = 1e12;
      const BodyState free = collide(flyer, wall, {0.7, 0.3}).frames.back().states[0];
      wall.mass = 0;
      const BodyState fixed = endOf(collide(flyer, wall, {0.7, 0.3}));
      EXPECT_LT((free.linearVelocity - fixed.linearVelocity).norm(), 1e-9) << boxes << ' ' << trial;
      EXPECT_LT((free.angularVelocity - fixed.angularVelocity).norm(), 1e-8) << boxes << ' ' << trial;
    }
}

}  // namespace
}  // namespace cradle
