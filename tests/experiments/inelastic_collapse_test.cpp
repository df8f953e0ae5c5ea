// Impacts that follow each other at gaps far smaller than bodies: infinitely many in a finite time, as of a light ball
// between a floor and a heavier ball that falls on it (S. McNamara, W. R. Young, Physics of Fluids A 4(3), 1992), and
// those of rows of balls with gaps of nanometres. References: closed forms, and impacts pair by pair in the order of
// time, with the gaps as variables, at places that do not change.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "experiments/experiment.h"

namespace cradle {
namespace {

constexpr double kColumnRadius = 0.05;  // m
const double kCollapseAccuracies[] = {1e-3, 1e-6, 1e-10};

/// Balls along y above a fixed floor, or in a row without one: from the lowest to the highest.
struct BallColumn {
  bool hasFloor = true;
  double restitution = 0, friction = 0;
  std::vector<double> masses, speeds, gaps;  // kg, m/s, m; with a floor the first gap is that over it
  std::vector<double> sideSpeeds;            // m/s along x; none: all 0
  double gravity = 0;                        // m/s^2
  double tilt = 0;                           // rad, towards x: of all contacts' normals but the floor's
};

/// What velocity and spin a ball has after the impacts.
struct BallAfter {
  double speed, sideSpeed, spin;  // m/s along y and x, rad/s about z
};

std::string columnText(const BallColumn& column, const char* shape) {
  std::string text = column.hasFloor
                         ? R"({"name": "floor", "shape": {"plane": {}}, "motion": "static",
    "material": "m"})"
                         : R"({"name": "far", "shape": {"plane": {}}, "position": [0, -100, 0], "motion": "static",
    "material": "m"})";
  Vec3 place(0, column.hasFloor ? kColumnRadius + column.gaps[0] : 0, 0);
  const Vec3 along(std::sin(column.tilt), std::cos(column.tilt), 0);
  for (std::size_t i = 0; i < column.masses.size(); ++i) {
    if (i > 0) place += (2 * kColumnRadius + column.gaps[column.hasFloor ? i : i - 1]) * along;
    const double side = column.sideSpeeds.empty() ? 0 : column.sideSpeeds[i];
    text += fmt::format(R"(, {{"name": "b{}", "shape": {}, "mass": {:.17g}, "material": "m", "position": {},
      "linearVelocity": {}}})",
                        i, shape, column.masses[i], vectorText(place), vectorText(Vec3(side, column.speeds[i], 0)));
  }
  return text;
}

constexpr const char* kColumnBall = R"({"sphere": {"radius": 0.05}})";
constexpr const char* kColumnBox = R"({"box": {"size": [0.1, 0.1, 0.1]}})";

Trajectory runColumn(const BallColumn& column, double accuracy, double duration, const char* shape = kColumnBall) {
  return simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": {}, "gravity": [0, {}, 0], "output": {{"framesPerSecond": {:.17g}}},
      "materials": {{"m": {{"restitution": {:.17g}, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [{}])",
      duration, accuracy, -column.gravity, 1 / duration, column.restitution, column.friction, column.friction,
      columnText(column, shape))));
}

/// The column's impacts one by one, in long double: the contact that closes first gets its two-body impulse, Newton's
/// restitution and Coulomb's friction, until nothing closes by more than 1e-14 of the speeds.
class PairByPair {
 public:
  using Real = long double;

  explicit PairByPair(const BallColumn& column) : column_(column), gaps_(column.gaps.begin(), column.gaps.end()) {
    for (std::size_t i = 0; i < column.masses.size(); ++i)
      balls_.push_back({column.speeds[i], column.sideSpeeds.empty() ? 0 : column.sideSpeeds[i], 0});
  }

  /// The number of impacts, at most so many.
  int resolve(int most) {
    for (int count = 0; count < most; ++count) {
      std::size_t next = gaps_.size();
      Real wait = std::numeric_limits<Real>::infinity();
      for (std::size_t i = 0; i < gaps_.size(); ++i)
        if (opening(i) < -1e-14L && gaps_[i] / -opening(i) < wait) next = i, wait = gaps_[i] / -opening(i);
      if (next == gaps_.size()) return count;
      for (std::size_t i = 0; i < gaps_.size(); ++i) gaps_[i] += wait * opening(i);
      gaps_[next] = 0;
      strike(next);
    }
    return most;
  }

  BallAfter of(std::size_t ball) const {
    return {static_cast<double>(balls_[ball].y), static_cast<double>(balls_[ball].x),
            static_cast<double>(balls_[ball].spin)};
  }

 private:
  struct Ball {
    Real y, x, spin;
  };
  bool isOnFloor(std::size_t contact) const { return column_.hasFloor && contact == 0; }
  std::size_t upper(std::size_t contact) const { return column_.hasFloor ? contact : contact + 1; }
  /// Components along x and y: of a contact's normal, up, and of what is across it.
  std::pair<Real, Real> normalOf(std::size_t contact) const {
    const Real tilt = isOnFloor(contact) ? 0 : Real(column_.tilt);
    return {std::sin(tilt), std::cos(tilt)};
  }
  Real opening(std::size_t contact) const {
    const auto [nx, ny] = normalOf(contact);
    const Ball& above = balls_[upper(contact)];
    const Ball below = isOnFloor(contact) ? Ball{} : balls_[upper(contact) - 1];
    return ny * (above.y - below.y) + nx * (above.x - below.x);
  }

  /// A solid ball: its spin answers to friction with 5/2 of what its centre does.
  void strike(std::size_t contact) {
    Ball& above = balls_[upper(contact)];
    const auto [nx, ny] = normalOf(contact);
    const Real inverseAbove = 1 / Real(column_.masses[upper(contact)]);
    const Real inverseBelow = isOnFloor(contact) ? 0 : 1 / Real(column_.masses[upper(contact) - 1]);
    const Real radius = kColumnRadius, closing = -opening(contact);
    const Real normal = (1 + Real(column_.restitution)) * closing / (inverseAbove + inverseBelow);
    const auto alongContact = [&, x = ny, y = -nx](const Ball& ball) { return ball.x * x + ball.y * y; };
    Real sliding = alongContact(above) + radius * above.spin;
    if (!isOnFloor(contact)) {
      const Ball& below = balls_[upper(contact) - 1];
      sliding -= alongContact(below) - radius * below.spin;
    }
    const Real stopping = sliding / (3.5L * (inverseAbove + inverseBelow));
    const Real most = Real(column_.friction) * normal;
    const Real side = std::abs(stopping) <= most ? stopping : std::copysign(most, sliding);
    const Real impulseX = normal * nx - side * ny, impulseY = normal * ny + side * nx;
    above.x += impulseX * inverseAbove, above.y += impulseY * inverseAbove;
    above.spin -= 2.5L * side * inverseAbove / radius;
    if (isOnFloor(contact)) return;
    Ball& below = balls_[upper(contact) - 1];
    below.x -= impulseX * inverseBelow, below.y -= impulseY * inverseBelow;
    below.spin -= 2.5L * side * inverseBelow / radius;
  }

  const BallColumn& column_;
  std::vector<Real> gaps_;
  std::vector<Ball> balls_;
};

// m/s. Closing by 1e-12 of the fastest speed, 4 m/s, is none; a heavy body's velocity is rounded to 1e-15 m/s, which a
// body 4000 times as light answers to with 4e-12 m/s.
constexpr double kCollapseRounding = 1e-11;

/// Whether two contacts of a ball between a floor and a mass M times its own repeat their impacts for ever: the
/// eigenvalues of a round are real.
bool collapses(double restitution, double ratio) {
  return (1 + restitution) * (1 + restitution) * ratio / (1 + ratio) >= 4 * restitution;
}

TEST(InelasticCollapse, ABallBetweenTheFloorAndAHeavyBodyStopsWithIt) {
  for (const char* shape : {kColumnBall, kColumnBox})
    for (const double accuracy : kCollapseAccuracies)
      for (const double restitution : {0.05, 0.1, 0.3, 0.5})
        for (const double ratio : {12.0, 100.0, 4000.0}) {
          ASSERT_TRUE(collapses(restitution, ratio));
          const BallColumn column{true, restitution, 0, {2, 2 * ratio}, {-1, -4}, {0.04, 0.05}, {}, 0};
          const Trajectory trajectory = runColumn(column, accuracy, 0.05, shape);
          const Frame &start = trajectory.frames.front(), &end = trajectory.frames.back();
          SCOPED_TRACE(fmt::format("{} accuracy {} e {} ratio {}", shape, accuracy, restitution, ratio));
          for (const BodyState& body : end.states) {
            EXPECT_LT(body.linearVelocity.norm(), kCollapseRounding);
            EXPECT_LT(kColumnRadius * body.angularVelocity.norm(), kCollapseRounding);
          }
          EXPECT_NEAR(end.energy.dissipated, start.energy.kinetic, 1e-12 * start.energy.kinetic);
        }
}

// Gravity presses on what has collapsed: it rests, the upper ball on the lower one, as deep as gaps are found.
TEST(InelasticCollapse, UnderGravityTheBallsRestOnEachOther) {
  for (const double accuracy : kCollapseAccuracies)
    for (const double restitution : {0.1, 0.3}) {
      const BallColumn column{true, restitution, 0, {2, 31}, {-1, -4}, {0.04, 0.05}, {}, kGravity};
      const Frame end = runColumn(column, accuracy, 0.1).frames.back();
      for (const BodyState& body : end.states) EXPECT_LT(body.linearVelocity.norm(), kCollapseRounding);
      EXPECT_NEAR(end.states[0].position.y(), kColumnRadius, 1e-9 * kColumnRadius);
      EXPECT_NEAR(end.states[1].position.y(), 3 * kColumnRadius, 1e-9 * kColumnRadius);
    }
}

// Fast sideways, frozen places last for less time than the collapse: it goes on from impact to impact wherever it is
// cut.
TEST(InelasticCollapse, FastMotionAcrossDoesNotCutItShort) {
  for (const double accuracy : {1e-8, 1e-9, 1e-10})
    for (const double restitution : {0.1, 0.3, 0.5})
      for (int i = 0; i < 16; ++i) {
        const double part = i / 16.0, ratio = 12 + 40 * part, side = 3 + 20 * part;
        const BallColumn column{
            true, restitution, 0, {2, 2 * ratio}, {-1, -3 - part}, {1e-5, 1e-3 * (1 + part)}, {side, side}, kGravity};
        SCOPED_TRACE(fmt::format("accuracy {} e {} ratio {}", accuracy, restitution, ratio));
        const Frame end = runColumn(column, accuracy, 0.1).frames.back();
        for (const BodyState& body : end.states) {
          EXPECT_NEAR(body.linearVelocity.y(), 0, kCollapseRounding);
          EXPECT_NEAR(body.linearVelocity.x(), side, kCollapseRounding);
        }
        EXPECT_LT(std::abs(end.energy.numerical), accuracy * end.energy.kinetic);
      }
}

TEST(InelasticCollapse, ABallBetweenTwoHeavyOnesEndsWithTheirCommonVelocity) {
  for (const double accuracy : kCollapseAccuracies)
    for (const double restitution : {0.05, 0.1, 0.3}) {
      const BallColumn column{false, restitution, 0, {40, 1, 90}, {2, 0.3, -3}, {0.02, 0.03}, {}, 0};
      const double common = (40 * 2 + 0.3 - 90 * 3) / 131;  // momentum stays
      const Frame end = runColumn(column, accuracy, 0.05).frames.back();
      for (const BodyState& body : end.states) EXPECT_NEAR(body.linearVelocity.y(), common, kCollapseRounding);
    }
}

// Below the critical mass, or above the critical restitution, the impacts come to an end.
TEST(InelasticCollapse, WhatDoesNotCollapseRebounds) {
  for (const double accuracy : kCollapseAccuracies)
    for (const auto& [restitution, ratio] : {std::pair(0.5, 6.0), {0.5, 1.3}, {0.3, 1.5}, {0.8, 50.0}, {0.95, 100.0}}) {
      ASSERT_FALSE(collapses(restitution, ratio));
      const BallColumn column{true, restitution, 0, {2, 2 * ratio}, {-1, -4}, {0.04, 0.05}, {}, 0};
      PairByPair reference(column);
      ASSERT_LT(reference.resolve(1000), 1000);
      const Frame end = runColumn(column, accuracy, 2).frames.back();
      SCOPED_TRACE(fmt::format("accuracy {} e {} ratio {}", accuracy, restitution, ratio));
      for (std::size_t i = 0; i < 2; ++i)
        EXPECT_NEAR(end.states[i].linearVelocity.y(), reference.of(i).speed, kCollapseRounding);
    }
}

// The heavy ball also moves sideways, over a gap so small that it stays above the other: in 1e-7 s by 3e-7 m, which
// turns the normal by 3e-6. What is left of 4000 impacts by the reference is below that.
TEST(InelasticCollapse, FrictionGivesWhatItGivesImpactByImpact) {
  for (const double accuracy : kCollapseAccuracies)
    for (const double friction : {0.02, 0.1, 0.6})
      for (const double restitution : {0.1, 0.3}) {
        const BallColumn column{true, restitution, friction, {2, 31}, {-1, -4}, {1e-7, 2e-7}, {0.5, 3}, 0};
        PairByPair reference(column);
        reference.resolve(4000);
        const Frame end = runColumn(column, accuracy, 1e-5).frames.back();
        SCOPED_TRACE(fmt::format("accuracy {} friction {} e {}", accuracy, friction, restitution));
        for (std::size_t i = 0; i < 2; ++i) {
          const auto [speed, sideSpeed, spin] = reference.of(i);
          EXPECT_NEAR(end.states[i].linearVelocity.y(), speed, 2e-5);
          EXPECT_NEAR(end.states[i].linearVelocity.x(), sideSpeed, 2e-5);
          EXPECT_NEAR(kColumnRadius * end.states[i].angularVelocity.z(), kColumnRadius * spin, 4e-5);
        }
      }
}

// The heavy ball comes down beside the light one's middle, which leaves towards the other side as fast as 30 m/s. Until
// the frame that turns the normal by 30 m/s 1e-7 s / 0.1 m = 3e-5, and velocities with it, four times as much along it.
TEST(InelasticCollapse, ObliqueOnesGiveWhatImpactByImpactGives) {
  for (const double accuracy : kCollapseAccuracies)
    for (const double friction : {0.0, 0.1, 0.6})
      for (const double restitution : {0.05, 0.3, 0.5})
        for (const double tilt : {0.05, 0.3}) {
          BallColumn column{true, restitution, friction, {2, 31}, {0, -4}, {1e-8, 2e-8}, {0, 0}, 0, tilt};
          PairByPair reference(column);
          reference.resolve(4000);
          const Frame end = runColumn(column, accuracy, 1e-7).frames.back();
          SCOPED_TRACE(fmt::format("accuracy {} friction {} e {} tilt {}", accuracy, friction, restitution, tilt));
          for (std::size_t i = 0; i < 2; ++i) {
            const auto [speed, sideSpeed, spin] = reference.of(i);
            EXPECT_NEAR(end.states[i].linearVelocity.y(), speed, 1e-4);
            EXPECT_NEAR(end.states[i].linearVelocity.x(), sideSpeed, 1e-4);
            EXPECT_NEAR(kColumnRadius * end.states[i].angularVelocity.z(), kColumnRadius * spin, 1e-4);
          }
        }
}

/// A ball that hits a row at rest: `count` balls whose gaps are `gap`, more or less.
BallColumn rowWithGaps(std::size_t count, double restitution, double gap, bool haveOneMass) {
  BallColumn row{false, restitution, 0, {1}, {1}, {0.02}, {}, 0};
  for (std::size_t i = 1; i < count; ++i) {
    row.masses.push_back(haveOneMass ? 1 : 1 + 0.3 * std::fmod(2.7 * static_cast<double>(i), 2.0));
    row.speeds.push_back(0);
    if (i > 1) row.gaps.push_back(gap * (1 + std::fmod(0.37 * static_cast<double>(i), 1.0)));
  }
  return row;
}

// Places are rounded to 1e-16 m, a part of 1e-6 of the least gap, and impacts are found to 5e-14 m: the order of the
// few dozen impacts is that of the reference.
TEST(RowOfBalls, GapsSayWhichImpactComesFirst) {
  for (const double accuracy : {1e-3, 1e-6, 1e-9})
    for (const double gap : {1e-6, 1e-8, 1e-9})
      for (const auto& [count, restitution] : {std::pair(std::size_t{3}, 0.3), {4, 0.7}, {5, 0.9}, {8, 0.9}, {6, 1.0}})
        for (const bool haveOneMass : {true, false}) {
          const BallColumn row = rowWithGaps(count, restitution, gap, haveOneMass);
          PairByPair reference(row);
          ASSERT_LT(reference.resolve(1000), 1000);
          const Trajectory trajectory = runColumn(row, accuracy, 0.1);
          SCOPED_TRACE(fmt::format("accuracy {} gap {} e {} balls {}", accuracy, gap, restitution, count));
          for (std::size_t i = 0; i < count; ++i)
            EXPECT_NEAR(trajectory.frames.back().states[i].linearVelocity.y(), reference.of(i).speed, 1e-11);
        }
}

// Some hundred impacts of twenty balls, farther apart than a sequence of impacts reaches: what one sequence moves must
// be where the others are at its time, for the next impact is a matter of gaps as small.
TEST(RowOfBalls, GapsOfManyUnequalBallsSayWhichImpactComesFirst) {
  for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8, 1e-10})
    for (const double restitution : {0.8, 0.9})
      for (const double start : {0.1, 0.4, 0.7}) {
        BallColumn row{false, restitution, 0, {1}, {1}, {0.02}, {}, 0};
        for (double i = 1; i < 20; ++i) {
          row.masses.push_back(0.3 + 2.7 * std::fmod(start + 0.7548776662 * i, 1.0));
          row.speeds.push_back(0);
          if (i > 1) row.gaps.push_back(1e-9 * (0.2 + 1.6 * std::fmod(start + 0.6180339887 * i, 1.0)));
        }
        PairByPair reference(row);
        ASSERT_LT(reference.resolve(1000), 1000);
        const Trajectory trajectory = runColumn(row, accuracy, 0.1);
        SCOPED_TRACE(fmt::format("accuracy {} e {} from {}", accuracy, restitution, start));
        for (std::size_t i = 0; i < 20; ++i)
          EXPECT_NEAR(trajectory.frames.back().states[i].linearVelocity.y(), reference.of(i).speed, 1e-11);
      }
}

// Rows that cluster: gaps shrink below what places show while impacts go on, and the next one of each is a matter of
// the gap that the last one has left. Where a gap of 1e-13 m was closed before its time, speeds were off by up to 3e-4
// m/s; gaps that nothing but places tell, to 1e-14 m, leave up to 7e-5 m/s.
TEST(RowOfBalls, ClustersHaveTheirImpactsInTurn) {
  for (const double accuracy : {1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10})
    for (const auto& [count, restitution] : {std::pair(std::size_t{20}, 0.75), {18, 0.7}, {14, 0.65}}) {
      BallColumn row{false, restitution, 0, {1}, {1}, {0.02}, {}, 0};
      for (std::size_t i = 1; i < count; ++i) {
        row.masses.push_back(1), row.speeds.push_back(0);
        if (i > 1) row.gaps.push_back(1e-9);
      }
      PairByPair reference(row);
      ASSERT_LT(reference.resolve(2000), 2000);
      const Trajectory trajectory = runColumn(row, accuracy, 0.1);
      SCOPED_TRACE(fmt::format("accuracy {} e {} balls {}", accuracy, restitution, count));
      for (std::size_t i = 0; i < count; ++i)
        EXPECT_NEAR(trajectory.frames.back().states[i].linearVelocity.y(), reference.of(i).speed, 1e-4);
    }
}

// A ball comes down on two that lie side by side, both gaps the same: the impacts are at one instant.
TEST(RowOfBalls, EqualGapsOnBothSidesStaySymmetric) {
  const double side = 1.5 * kColumnRadius, height = std::sqrt(4 * kColumnRadius * kColumnRadius - side * side);
  for (const double accuracy : kCollapseAccuracies)
    for (const double gap : {0.0, 1e-10, 1e-9, 1e-7})
      for (const double restitution : {0.2, 0.6, 1.0}) {
        const auto ballText = [&](const char* name, double mass, const Vec3& place, double speed) {
          return fmt::format(R"({{"name": "{}", "shape": {}, "mass": {}, "material": "m", "position": {},
            "linearVelocity": {}}})",
                             name, kColumnBall, mass, vectorText(place), vectorText(Vec3(0, speed, 0)));
        };
        const Trajectory trajectory = simulate(sceneWith(fmt::format(
            R"("duration": 0.02, "accuracy": {}, "gravity": [0, 0, 0], "output": {{"framesPerSecond": 50}},
            "materials": {{"m": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}},
            "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}}, {}, {}, {}])",
            accuracy, restitution, ballText("left", 1, Vec3(-side, kColumnRadius + gap, 0), 0),
            ballText("right", 1, Vec3(side, kColumnRadius + gap, 0), 0),
            ballText("top", 20, Vec3(0, kColumnRadius + 2 * gap + height + 0.01, 0), -2))));
        const std::vector<BodyState>& states = trajectory.frames.back().states;
        SCOPED_TRACE(fmt::format("accuracy {} gap {} e {}", accuracy, gap, restitution));
        EXPECT_NEAR(states[0].linearVelocity.x(), -states[1].linearVelocity.x(), kCollapseRounding);
        EXPECT_NEAR(states[0].linearVelocity.y(), states[1].linearVelocity.y(), kCollapseRounding);
        EXPECT_NEAR(states[2].linearVelocity.x(), 0, kCollapseRounding);
        EXPECT_GT(states[1].linearVelocity.x(), 0.1);
      }
}

/// A cube of 0.1 m and 1 kg, turned about z by 0.3, its lowest edge over a floor, and a ball over its highest edge: all
/// impulses are vertical.
struct TiltedCubeUnderABall {
  double gap = 0, ballGap = 0;         // m
  double ballMass = 0, ballSpeed = 0;  // kg; m/s, downwards
  double restitution = 0;
};

constexpr double kCubeTilt = 0.3;
const double kCubeEdge = kColumnRadius * (std::cos(kCubeTilt) - std::sin(kCubeTilt)),  // m from the centre, along x
    kCubeHeight = kColumnRadius * (std::cos(kCubeTilt) + std::sin(kCubeTilt));         // m from the centre, along y

/// m/s: of the cube, of its edges by its spin, and of the ball, upwards, after all impacts in the order of time.
Vec3 speedsAfterImpacts(const TiltedCubeUnderABall& scene) {
  const double inertia = 4 * kColumnRadius * kColumnRadius / 6, turning = kCubeEdge * kCubeEdge / inertia;
  Vec3 speeds(0, 0, -scene.ballSpeed);  // of the highest edge by the spin
  double gap = scene.gap, ballGap = scene.ballGap;
  while (true) {
    const double opening = speeds[0] - speeds[1], ballOpening = speeds[2] - speeds[0] - speeds[1];
    const double time = opening < -1e-14 ? gap / -opening : INFINITY,
                 ballTime = ballOpening < -1e-14 ? ballGap / -ballOpening : INFINITY;
    const double next = std::min(time, ballTime);
    if (std::isinf(next)) return speeds;
    gap = time == next ? 0 : gap + next * opening;
    ballGap = ballTime <= time ? 0 : ballGap + next * ballOpening;
    if (ballTime <= time) {
      const double impulse = -(1 + scene.restitution) * ballOpening / (1 + turning + 1 / scene.ballMass);
      speeds += impulse * Vec3(-1, -turning, 1 / scene.ballMass);
    } else {
      speeds += -(1 + scene.restitution) * opening / (1 + turning) * Vec3(1, -turning, 0);
    }
  }
}

// A cube that floats over the floor by less than any accuracy is not on it when the ball hits: the impacts follow each
// other. Until then, 1e-7 s, it falls by less than 1e-13 m; to the end speeds change by 1e-4 m/s.
TEST(SmallGaps, AreNotClosedBeforeTheImpact) {
  for (const double accuracy : {1e-4, 1e-6, 1e-8, 1e-10})
    for (const double gap : {2e-11, 1e-10, 3e-10})
      for (const double restitution : {0.5, 0.8, 1.0}) {
        const TiltedCubeUnderABall column{gap, 1e-7, 3, 1, restitution};
        const Frame end = simulate(sceneWith(fmt::format(
                                       R"("duration": 1e-5, "accuracy": {}, "output": {{"framesPerSecond": 1e5}},
            "materials": {{"m": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [
            {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
            {{"name": "cube", "shape": {}, "mass": 1, "material": "m", "position": [0, {:.17g}, 0],
              "orientation": {{"w": {:.17g}, "x": 0, "y": 0, "z": {:.17g}}}}},
            {{"name": "ball", "shape": {}, "mass": {}, "material": "m", "position": [{:.17g}, {:.17g}, 0],
              "linearVelocity": [0, {}, 0]}}])",
                                       accuracy, restitution, kColumnBox, kCubeHeight + gap, std::cos(kCubeTilt / 2),
                                       std::sin(kCubeTilt / 2), kColumnBall, column.ballMass, kCubeEdge,
                                       2 * kCubeHeight + kColumnRadius + gap + column.ballGap, -column.ballSpeed)))
                              .frames.back();
        SCOPED_TRACE(fmt::format("accuracy {} gap {} e {}", accuracy, gap, restitution));
        const Vec3 expected = speedsAfterImpacts(column);
        EXPECT_NEAR(end.states[0].linearVelocity.y(), expected[0], 1e-3);
        EXPECT_NEAR(kCubeEdge * end.states[0].angularVelocity.z(), expected[1], 1e-3);
        EXPECT_NEAR(end.states[1].linearVelocity.y(), expected[2], 1e-3);
      }
}

// A light box between two heavy ones, the lower of which leaves the floor by less than rounding of its place shows
// before it is struck again. At 1e-9 frozen places last for a part of the impacts only: the gap has to be known from
// one part to the next. Velocities are rounded to 1e-15 m/s, 37 times; the light box answers with 67 times as much.
TEST(SmallGaps, AreKnownFromTheSpeedsSinceTheLastImpact) {
  for (const double accuracy : {1e-6, 1e-9})
    for (const std::array<double, 2>& gaps : {std::array{1.1e-11, 1.8e-11}, std::array{1.3e-11, 2.1e-11}}) {
      const BallColumn column{true, 0.9, 0, {20, 0.3, 20}, {0, 0, -1}, {gaps[0], gaps[1], 0}, {}, 0};
      PairByPair expected(column);
      ASSERT_LT(expected.resolve(100), 100);
      const Frame end = runColumn(column, accuracy, 1e-3, kColumnBox).frames.back();
      SCOPED_TRACE(fmt::format("accuracy {} gaps {} {}", accuracy, gaps[0], gaps[1]));
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(end.states[i].linearVelocity.y(), expected.of(i).speed, 37 * 67 * 1e-15);
    }
}

// A cube's two lower edges, one lower than the other by the tilt: an impulse j at one changes its speed by
// (1/m + r^2 / I) j = 2.5 j/m and that of the other by (1/m - r^2 / I) j = -0.5 j/m. From 1 m/s, the first goes up by
// e, the other comes down by 1.2 + 0.2 e, and its rebound leaves the first e - 0.2 (1 + e) (1.2 + 0.2 e), upwards.
TEST(SmallGaps, EdgesOfATiltedCubeMeetTheFloorOneAfterTheOther) {
  for (const double accuracy : {1e-3, 1e-4, 1e-6, 1e-8, 1e-10})
    for (const double tilt : {1e-9, 1e-8, 1e-7, 1e-6})
      for (const double restitution : {0.5, 0.8, 1.0}) {
        const double half = kColumnRadius, height = half * (std::cos(tilt) + std::sin(tilt));
        const Trajectory run = simulate(sceneWith(fmt::format(
            R"("duration": 2e-4, "accuracy": {}, "gravity": [0, 0, 0], "output": {{"framesPerSecond": 5000}},
            "materials": {{"m": {{"restitution": {}, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [
            {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
            {{"name": "cube", "shape": {}, "mass": 2, "material": "m", "position": [0, {:.17g}, 0],
              "orientation": {{"w": {:.17g}, "x": 0, "y": 0, "z": {:.17g}}}, "linearVelocity": [0, -1, 0]}}])",
            accuracy, restitution, kColumnBox, height + 1e-5, std::cos(tilt / 2), std::sin(tilt / 2))));
        const double second = restitution * (1.2 + 0.2 * restitution),
                     first = restitution - 0.2 * (1 + restitution) * (1.2 + 0.2 * restitution);
        const BodyState end = endOf(run);
        SCOPED_TRACE(fmt::format("accuracy {} tilt {} e {}", accuracy, tilt, restitution));
        EXPECT_NEAR(end.linearVelocity.y(), (first + second) / 2, 1e-5);
        EXPECT_NEAR(half * std::abs(end.angularVelocity.z()), (second - first) / 2, 1e-5);
      }
}

}  // namespace
}  // namespace cradle
