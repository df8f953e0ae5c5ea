// Balls without friction and loss: closed forms, symmetries and conservation laws, all in closed form between
// collisions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "experiments/experiment.h"

namespace cradle {
namespace {

constexpr double kBallRadius = 0.1;

struct Ball {
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
  double mass = 1, radius = kBallRadius;
};

std::string bodyText(const std::string& name, const std::string& shape, const Vec3& position, const std::string& more) {
  return fmt::format(R"({{"name": "{}", "material": "m", "shape": {}, "position": {}, {}}})", name, shape,
                     vectorText(position), more);
}

std::string ballText(int index, const Ball& ball) {
  return bodyText(fmt::format("ball{}", index), fmt::format(R"({{"sphere": {{"radius": {}}}}})", ball.radius),
                  ball.position,
                  fmt::format(R"("mass": {}, "linearVelocity": {})", ball.mass, vectorText(ball.velocity)));
}

std::string fixedText(const std::string& name, const std::string& shape, const Vec3& position,
                      const std::string& orientation = R"({"axis": [1, 0, 0], "angleDegrees": 0})") {
  return bodyText(name, shape, position, R"("motion": "static", "orientation": )" + orientation);
}

std::string planeText(const std::string& name, const Vec3& position, const Vec3& normal) {
  return fixedText(name, R"({"plane": {"normal": )" + vectorText(normal) + "}}", position);
}

const std::string kFloorText = planeText("floor", Vec3::Zero(), Vec3::UnitY());

struct Setting {
  double duration = 1;
  Vec3 gravity = Vec3::Zero();
  double framesPerSecond = 60;
  double restitution = 1;
};

Scene sceneOfBalls(const std::vector<Ball>& balls, const std::vector<std::string>& fixed, const Setting& setting) {
  std::string bodies;
  for (std::size_t i = 0; i < balls.size(); ++i) bodies += (i ? ", " : "") + ballText(static_cast<int>(i), balls[i]);
  for (const std::string& body : fixed) bodies += ", " + body;
  return cradle::sceneWith(fmt::format(R"("duration": {}, "gravity": {}, "output": {{"framesPerSecond": {}}},
    "materials": {{"m": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [{}])",
                                       setting.duration, vectorText(setting.gravity), setting.framesPerSecond,
                                       setting.restitution, bodies));
}

/// Fails if another method was taken.
Trajectory runOf(const std::vector<Ball>& balls, const std::vector<std::string>& fixed, const Setting& setting) {
  Trajectory trajectory = simulate(sceneOfBalls(balls, fixed, setting));
  EXPECT_EQ(trajectory.header.method, "closed form between collisions");
  return trajectory;
}

constexpr double kFloorFall = 0.45152364098573090445;  // s: sqrt(2 / 9.81)
const Vec3 kGravityDown(0, -9.81, 0);

// They meet when the centres are two radii apart, wherever both have fallen to by then.
TEST(ElasticBalls, ExchangeMomentumHeadOnAsTheirMassesTell) {
  const Trajectory trajectory =
      runOf({{Vec3(-1, 0, 0), Vec3(3, 0, 0), 2}, {Vec3(1, 0, 0), Vec3(-1, 0, 0), 5}}, {}, {1, kGravityDown, 10});
  ASSERT_EQ(trajectory.events.size(), 1u);
  const Event& event = trajectory.events[0];
  const double time = (2 - 0.2) / 4;
  EXPECT_NEAR(event.time, time, 1e-15);
  EXPECT_NEAR(event.impulse, 2 * (2.0 * 5 / 7) * 4, 1e-14);
  EXPECT_LT((event.normal - Vec3::UnitX()).norm(), 1e-15);
  EXPECT_LT((event.point - Vec3(-1 + 3 * time + 0.1, -9.81 / 2 * time * time, 0)).norm(), 1e-15);
  const double common = (2 * 3 - 5 * 1) / 7.0;  // the centre of mass's velocity: both are reflected about it
  EXPECT_NEAR(trajectory.frames.back().states[0].linearVelocity.x(), 2 * common - 3, 1e-14);
  EXPECT_NEAR(trajectory.frames.back().states[1].linearVelocity.x(), 2 * common + 1, 1e-14);
}

// Equal balls that meet under 30 degrees, one of them at rest: they exchange what is along the line of centres and part
// at a right angle.
TEST(ElasticBalls, PartAtARightAngleAfterAnObliqueHit) {
  const double lever = 2 * kBallRadius * 0.5;
  const Trajectory trajectory = runOf({{Vec3(-1, lever, 0), Vec3(2, 0, 0)}, {}}, {}, {1, Vec3::Zero(), 10});
  const Vec3 line(std::sqrt(0.75), -0.5, 0);
  const Vec3 first = trajectory.frames.back().states[0].linearVelocity;
  const Vec3 second = trajectory.frames.back().states[1].linearVelocity;
  EXPECT_NEAR(trajectory.events.at(0).time, (1 - 2 * kBallRadius * std::sqrt(0.75)) / 2, 1e-15);
  EXPECT_LT((second - 2 * std::sqrt(0.75) * line).norm(), 1e-14);
  EXPECT_NEAR(first.dot(second), 0, 1e-14);
}

TEST(ElasticBalls, PassMomentumThroughATouchingRow) {
  std::vector<Ball> row = {{Vec3(-1, 0, 0), Vec3(1, 0, 0)}};
  for (int i = 0; i < 4; ++i) row.push_back({Vec3(2 * kBallRadius * i, 0, 0)});
  const Trajectory trajectory = runOf(row, {}, {1, Vec3::Zero(), 10});
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_LT((trajectory.frames.back().states[i].linearVelocity - (i == 4 ? Vec3(1, 0, 0) : Vec3(0, 0, 0))).norm(),
              1e-12);
  EXPECT_EQ(trajectory.events.size(), 4u);
  for (const Event& event : trajectory.events) EXPECT_NEAR(event.time, 0.8, 1e-15);
}

// A rack of ten on a table: all touch at once, and the table carries them. Mirrored in the cue ball's line the picture
// stays the same.
TEST(ElasticBalls, BreakARackSymmetrically) {
  std::vector<Ball> balls = {{Vec3(-2, kBallRadius, 0), Vec3(3, 0, 0)}};
  std::vector<std::pair<std::size_t, std::size_t>> mirrored;
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i <= row; ++i) {
      mirrored.emplace_back(balls.size(), balls.size() + static_cast<std::size_t>(row - 2 * i));
      balls.push_back({Vec3(kBallRadius * std::sqrt(3.0) * row, kBallRadius, kBallRadius * (2 * i - row))});
    }
  const Trajectory trajectory = runOf(balls, {kFloorText}, {1.5, kGravityDown, 20});
  double spread = 0;
  for (const Frame& frame : trajectory.frames) {
    EXPECT_NEAR(frame.energy.kinetic, 4.5, 1e-13);
    for (const auto& [a, b] : mirrored) {
      const BodyState &first = frame.states[a], &second = frame.states[b];
      EXPECT_LT((first.position - Vec3(1, 1, -1).cwiseProduct(second.position)).norm(), 1e-12);
      EXPECT_LT((first.linearVelocity - Vec3(1, 1, -1).cwiseProduct(second.linearVelocity)).norm(), 1e-12);
      EXPECT_NEAR(first.position.y(), kBallRadius, 1e-15);
      spread = std::max(spread, first.linearVelocity.z());
    }
  }
  EXPECT_GT(spread, 0.5);
}

TEST(ElasticBalls, BounceOnAPlaneLikeTheReference) {
  const Trajectory trajectory = runOf({{Vec3(0, 1.1, 0)}}, {kFloorText}, {10, kGravityDown, 60});
  ASSERT_EQ(trajectory.events.size(), 11u);
  for (std::size_t n = 0; n < 11; ++n)
    EXPECT_NEAR(trajectory.events[n].time, kFloorFall * (1 + 2 * static_cast<double>(n)), 1e-13) << n;
  EXPECT_NEAR(trajectory.frames[60].states[0].position.y() - 0.1, 0.95389383614004034532, 1e-13);
  EXPECT_NEAR(trajectory.frames[120].states[0].linearVelocity.y(), -1.9022123277199193094, 1e-12);
}

// Thrown at an edge and a corner of a box from 1 m away, beside the line through it by a quarter of the radius: the
// normal then leans by asin(1/4), and what is along it is reflected.
TEST(ElasticBalls, ReboundFromEdgesAndCornersAlongTheNormalThere) {
  const std::string box = fixedText("box", R"({"box": {"size": [2, 2, 2]}})", Vec3::Zero());
  for (const Vec3& feature : {Vec3(1, 1, 0), Vec3(1, 1, 1)}) {
    const Vec3 outward = feature.normalized(), aside = Vec3(1, -1, 0).normalized();
    const Trajectory trajectory =
        runOf({{feature + outward + kBallRadius / 4 * aside, -2 * outward}}, {box}, {1, Vec3::Zero(), 10});
    const double cosine = std::sqrt(1 - 1.0 / 16);
    const Vec3 normal = cosine * outward + aside / 4;
    ASSERT_EQ(trajectory.events.size(), 1u);
    EXPECT_NEAR(trajectory.events[0].time, (1 - kBallRadius * cosine) / 2, 1e-14);
    EXPECT_LT((trajectory.events[0].normal + normal).norm(), 1e-13);
    EXPECT_LT((trajectory.events[0].point - feature).norm(), 1e-14);
    const Vec3 expected = -2 * outward + 4 * cosine * normal;
    EXPECT_LT((trajectory.frames.back().states[0].linearVelocity - expected).norm(), 1e-13);
  }
}

// A ball between a wall and one that is 100^n times as heavy bounces as often as the first n + 1 digits of pi tell:
// G. Galperin, "Playing pool with pi", Regular and Chaotic Dynamics 8, 2003.
TEST(ElasticBalls, CountTheDigitsOfPi) {
  const std::string wall = planeText("wall", Vec3(-1, 0, 0), Vec3::UnitX());
  for (const auto& [ratio, expected] : {std::pair(1e2, 31), std::pair(1e4, 314), std::pair(1e6, 3141)}) {
    const Trajectory trajectory =
        runOf({{Vec3::Zero()}, {Vec3(1, 0, 0), Vec3(-1, 0, 0), ratio}}, {wall}, {10, Vec3::Zero(), 1});
    EXPECT_EQ(trajectory.events.size(), static_cast<std::size_t>(expected));
    EXPECT_NEAR(trajectory.frames.back().energy.kinetic, ratio / 2, 1e-12 * ratio);
  }
}

// Two touching balls fall on a plane. The lower one, three times as heavy, gives all that it has to the upper one,
// which rises four times as high, and lies on the plane from then on until it is hit again: then all goes backwards.
TEST(ElasticBalls, LieOnAPlaneOnceTheyHaveGivenAwayAllTheirSpeed) {
  const double fall = kFloorFall, speed = 9.81 * fall;
  const Trajectory trajectory =
      runOf({{Vec3(0, 1.1, 0), Vec3::Zero(), 3}, {Vec3(0, 1.3, 0)}}, {kFloorText}, {6 * fall, kGravityDown, 4 / fall});
  const Frame& top = trajectory.frames[12];  // 2 v up for 2 fall times
  EXPECT_NEAR(trajectory.events.at(0).time, fall, 1e-14);
  EXPECT_LT((top.states[0].position - Vec3(0, 0.1, 0)).norm(), 1e-13);
  EXPECT_LT(top.states[0].linearVelocity.norm(), 1e-13);
  EXPECT_NEAR(top.states[1].position.y(), 0.3 + 4, 1e-12);
  const Frame& end = trajectory.frames[24];
  EXPECT_NEAR(end.states[0].position.y(), 1.1, 1e-12);
  EXPECT_NEAR(end.states[1].position.y(), 1.3, 1e-12);
  EXPECT_NEAR(trajectory.frames[22].states[0].linearVelocity.y(), speed / 2, 1e-12);
}

// A box is no plane: where it ends the ball would roll over its edge.
TEST(ElasticBalls, SayThatTheyCannotLieOnABox) {
  const std::string box = fixedText("box", R"({"box": {"size": [2, 2, 2]}})", Vec3(0, -1, 0));
  try {
    runOf({{Vec3(0, 1.1, 0), Vec3::Zero(), 3}, {Vec3(0, 1.3, 0)}}, {box}, {2, kGravityDown, 60});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::limit);
    EXPECT_THAT(error.what(), testing::HasSubstr(R"("ball0" comes to lie on "box" at 0.451524 s)"));
  }
}

std::vector<std::string> cubeOfPlanes(double half) {
  std::vector<std::string> walls;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const Vec3 normal = sign * Vec3::Unit(axis);
      walls.push_back(planeText(fmt::format("wall{}{}", axis, sign), -half * normal, normal));
    }
  return walls;
}

/// Balls on a lattice of 0.3 m with speeds of about 1 m/s and masses between 1 and 2 kg.
std::vector<Ball> gas(int perAxis, const Vec3& corner) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Ball> balls;
  for (int i = 0; i < perAxis * perAxis * perAxis; ++i) {
    const Vec3 place(i % perAxis, i / perAxis % perAxis, i / perAxis / perAxis);
    const Vec3 velocity{uniform(random), uniform(random), uniform(random)};
    balls.push_back({corner + 0.3 * place, velocity, 1.5 + 0.5 * uniform(random)});
  }
  return balls;
}

double leastGapOf(const Frame& frame, const std::vector<Ball>& balls) {
  double least = 1;
  for (std::size_t i = 0; i < balls.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(
          least, (frame.states[i].position - frame.states[j].position).norm() - balls[i].radius - balls[j].radius);
  return least;
}

/// The balls again by the event log alone: parabolas from impulse to impulse. Expects what meets to touch there, and to
/// get the impulse of a lossless impact; returns the balls at the end.
std::vector<Ball> replay(const Trajectory& trajectory, std::vector<Ball> balls, const Vec3& gravity) {
  std::vector<double> times(balls.size(), 0.0);
  const auto moveTo = [&](std::size_t ball, double time) {
    const double passed = time - std::exchange(times[ball], time);
    balls[ball].position += passed * (balls[ball].velocity + passed / 2 * gravity);
    balls[ball].velocity += passed * gravity;
  };
  for (const Event& event : trajectory.events) {
    double closing = 0, inverseMass = 0;
    for (const auto& [body, sign] : {std::pair(event.bodyA, 1.0), std::pair(event.bodyB, -1.0)}) {
      if (body >= std::ssize(balls)) continue;
      Ball& ball = balls[static_cast<std::size_t>(body)];
      moveTo(static_cast<std::size_t>(body), event.time);
      EXPECT_LT((ball.position + sign * ball.radius * event.normal - event.point).norm(), 1e-13);
      closing += sign * event.normal.dot(ball.velocity);
      inverseMass += 1 / ball.mass;
      ball.velocity -= sign * event.impulse / ball.mass * event.normal;
    }
    EXPECT_NEAR(event.impulse, 2 * closing / inverseMass, 1e-12);
  }
  for (std::size_t ball = 0; ball < balls.size(); ++ball) moveTo(ball, trajectory.frames.back().time);
  return balls;
}

// 64 balls of two sizes in a closed cube, under gravity. Had a collision been missed, balls would overlap.
TEST(ElasticBalls, OfAGasKeepTheirEnergyAndApart) {
  std::vector<Ball> balls = gas(4, Vec3(-0.45, -0.45, -0.45));
  for (std::size_t i = 0; i < balls.size(); i += 3) balls[i].radius = 0.05;
  const Trajectory trajectory = runOf(balls, cubeOfPlanes(0.6), {3, kGravityDown, 20});
  EXPECT_GT(trajectory.events.size(), 1000u);
  const double energy = energyConstantOf(trajectory.frames[0]);
  for (const Frame& frame : trajectory.frames) {
    EXPECT_NEAR(energyConstantOf(frame), energy, 1e-12 * frame.energy.kinetic);
    EXPECT_GT(leastGapOf(frame, balls), -1e-13);
    for (const BodyState& state : frame.states) EXPECT_LT(state.position.cwiseAbs().maxCoeff(), 0.55 + 1e-13);
  }
  const std::vector<Ball> replayed = replay(trajectory, balls, kGravityDown);
  for (std::size_t i = 0; i < balls.size(); ++i)
    EXPECT_LT((replayed[i].position - trajectory.frames.back().states[i].position).norm(), 1e-12);
  EXPECT_TRUE(std::is_sorted(trajectory.events.begin(), trajectory.events.end(),
                             [](const Event& a, const Event& b) { return a.time < b.time; }));
}

// Nothing around them: momentum and angular momentum too.
TEST(ElasticBalls, ThatBurstApartKeepTheirMomenta) {
  std::vector<Ball> balls = gas(3, Vec3(-0.3, -0.3, -0.3));
  for (Ball& ball : balls) ball.velocity -= 3 * ball.position;  // inwards first
  const Trajectory trajectory = runOf(balls, {}, {3, Vec3::Zero(), 2});
  EXPECT_GT(trajectory.events.size(), 27u);
  for (const Frame& frame : trajectory.frames) {
    EXPECT_LT((frame.energy.momentum - trajectory.frames[0].energy.momentum).norm(), 1e-12);
    EXPECT_LT((frame.energy.angularMomentum - trajectory.frames[0].energy.angularMomentum).norm(), 1e-12);
    EXPECT_NEAR(frame.energy.kinetic, trajectory.frames[0].energy.kinetic, 1e-12);
  }
}

// A box that is turned and a ball in the way, and walls that are boxes.
TEST(ElasticBalls, BounceOffEverythingFixed) {
  std::vector<std::string> fixed = {fixedText("block", R"({"box": {"size": [0.6, 0.4, 0.5]}})", Vec3(0.3, -0.9, 0.1),
                                              R"({"axis": [1, 2, 3], "angleDegrees": 40})"),
                                    fixedText("dome", R"({"sphere": {"radius": 0.4}})", Vec3(0, -1.4, -0.8))};
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const Vec3 size = Vec3(4, 4, 4) - 3 * Vec3::Unit(axis);
      fixed.push_back(fixedText(fmt::format("slab{}{}", axis, sign), R"({"box": {"size": )" + vectorText(size) + "}}",
                                sign * 2 * Vec3::Unit(axis)));
    }
  const std::vector<Ball> balls = gas(3, Vec3(-0.3, 0.2, -0.3));
  const Trajectory trajectory = runOf(balls, fixed, {3, kGravityDown, 20});
  const double energy = energyConstantOf(trajectory.frames[0]);
  std::vector<int> hits(fixed.size(), 0);
  for (const Event& event : trajectory.events)
    for (std::size_t i = 0; i < fixed.size(); ++i)
      hits[i] += event.bodyA == static_cast<int>(balls.size() + i) || event.bodyB == static_cast<int>(balls.size() + i);
  for (const int body : {0, 1}) EXPECT_GT(hits[static_cast<std::size_t>(body)], 5) << body;
  for (const Frame& frame : trajectory.frames) {
    EXPECT_NEAR(energyConstantOf(frame), energy, 1e-12 * energy);
    EXPECT_GT(leastGapOf(frame, balls), -1e-13);
    for (const BodyState& state : frame.states) {
      EXPECT_LT(state.position.cwiseAbs().maxCoeff(), 1.4 + 1e-13);
      EXPECT_GT((state.position - Vec3(0, -1.4, -0.8)).norm(), 0.5 - 1e-13);
    }
  }
}

// Forth and, with all velocities turned round, back: each collision makes an error larger by about 2 x free path /
// radius, here below 20; twelve in a row would turn 1e-16 into 1. Eight balls meet each other some 4 times each.
TEST(ElasticBalls, ComeBackWhenTimeRunsBackwards) {
  std::vector<Ball> balls = gas(2, Vec3(-0.15, -0.15, -0.15));
  for (Ball& ball : balls) ball.velocity -= 4 * ball.position;
  const Setting setting{0.6, kGravityDown, 10};
  const std::vector<std::string> walls = cubeOfPlanes(0.5);
  const Trajectory forth = runOf(balls, walls, setting);
  std::vector<Ball> reversed = balls;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    reversed[i].position = forth.frames.back().states[i].position;
    reversed[i].velocity = -forth.frames.back().states[i].linearVelocity;
  }
  const Trajectory back = runOf(reversed, walls, setting);
  EXPECT_GT(forth.events.size(), 15u);
  EXPECT_EQ(back.events.size(), forth.events.size());
  for (std::size_t i = 0; i < balls.size(); ++i)
    EXPECT_LT((back.frames.back().states[i].position - balls[i].position).norm(), 1e-16 * std::pow(20, 6)) << i;
}

// The order of bodies in the scene decides nothing but the order of sums.
TEST(ElasticBalls, MoveTheSameInAnyOrder) {
  std::vector<Ball> balls = gas(3, Vec3(-0.3, -0.3, -0.3));
  const Setting setting{0.3, kGravityDown, 10};
  const Trajectory trajectory = runOf(balls, cubeOfPlanes(0.45), setting);
  std::reverse(balls.begin(), balls.end());
  const Trajectory other = runOf(balls, cubeOfPlanes(0.45), setting);
  EXPECT_GT(trajectory.events.size(), 50u);
  EXPECT_EQ(trajectory.events.size(), other.events.size());
  for (std::size_t i = 0; i < balls.size(); ++i)
    EXPECT_LT((trajectory.frames.back().states[i].position - other.frames.back().states[balls.size() - 1 - i].position)
                  .norm(),
              1e-9);
}

// A spin is nobody's business: it stays, and the orientation turns by it.
TEST(ElasticBalls, KeepTheirSpins) {
  const std::string spinning =
      bodyText("ball", R"({"sphere": {"radius": 0.1}})", Vec3(0, 0.3, 0), R"("angularVelocity": [0, 0, 2])");
  const Trajectory trajectory = simulate(cradle::sceneWith(fmt::format(R"("duration": 1,
    "materials": {{"m": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [{}, {}])",
                                                                       spinning, kFloorText)));
  EXPECT_EQ(trajectory.header.method, "closed form between collisions");
  EXPECT_GT(trajectory.events.size(), 1u);
  EXPECT_EQ(endOf(trajectory).angularVelocity, Vec3(0, 0, 2));
  EXPECT_NEAR(orientationError(endOf(trajectory).orientation, Quat(std::cos(1), 0, 0, std::sin(1))), 0, 1e-15);
}

std::string methodFor(const std::vector<Ball>& balls, const std::vector<std::string>& fixed, const Setting& setting) {
  return simulate(sceneOfBalls(balls, fixed, setting)).header.method.substr(0, 6);
}

// Lying on a plane is sliding along it; lying on a ball or a box is no straight line in general.
TEST(ElasticBalls, ThatLieOnEachOtherAreLeftToOtherMethods) {
  const std::string box = fixedText("box", R"({"box": {"size": [2, 2, 2]}})", Vec3(0, -1, 0));
  const Setting setting{0.05, kGravityDown, 60};
  const std::vector<Ball> alone = {{Vec3(0, 0.1, 0)}}, pair = {{Vec3(0, 0.1, 0)}, {Vec3(0, 0.3, 0)}};
  EXPECT_EQ(methodFor(alone, {kFloorText}, setting), "closed");
  EXPECT_NE(methodFor(alone, {box}, setting), "closed");
  EXPECT_NE(methodFor(pair, {kFloorText}, setting), "closed");
  EXPECT_EQ(methodFor(pair, {kFloorText}, {0.05, Vec3::Zero(), 60}), "closed");
  EXPECT_NE(methodFor(alone, {kFloorText}, {0.05, kGravityDown, 60, 0.9}), "closed");
}

// Down a slope of 30 degrees with g sin 30 = 4.905 m/s^2, on one plane; in a gutter of two, at rest across it.
TEST(ElasticBalls, SlideDownPlanesThatCarryThem) {
  const double root = std::sqrt(0.5);
  const Vec3 slope(-0.5, std::sqrt(0.75), 0), left(0, root, root), right(0, root, -root);
  const Trajectory plane =
      runOf({{kBallRadius * slope}}, {planeText("slope", Vec3::Zero(), slope)}, {1, kGravityDown, 1});
  const Vec3 expected = kBallRadius * slope - 4.905 / 2 * Vec3(std::sqrt(0.75), 0.5, 0);
  EXPECT_LT((endOf(plane).position - expected).norm(), 1e-14);
  const Trajectory gutter =
      runOf({{Vec3(0, kBallRadius / root, 0), Vec3(2, 0, 0)}},
            {planeText("left", Vec3::Zero(), left), planeText("right", Vec3::Zero(), right)}, {1, kGravityDown, 1});
  EXPECT_LT((endOf(gutter).position - Vec3(2, kBallRadius / root, 0)).norm(), 1e-14);
  EXPECT_TRUE(gutter.events.empty());
}

}  // namespace
}  // namespace cradle
