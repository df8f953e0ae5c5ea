// Bodies on a table that shakes, against an exact solution: they stick, slip, stick again, and turn back on the way.
//
// Along the table's direction x = A sin(w t). A body goes along with its centre accelerated by x'' / k while it sticks,
// k = 1, or rolls, k = 1 + m R^2 / I: as long as |x''| <= k mu_s g. It slides with the velocity u of its contact
// relative to the table: u' = -(sign u) k mu_d g - x'', and its centre is accelerated by -(sign u) mu_d g. When u comes
// to zero, it sticks, or slides the other way.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "experiments/expect_ledger.h"

namespace cradle {
namespace {

constexpr double kPi = std::numbers::pi;

struct Shaking {
  double staticFriction, dynamicFriction;
  double frequency;  // 1/s
  double strength;   // A w^2 in mu_d g
  double gain = 1;   // k

  double rate() const { return 2 * kPi * frequency; }
  double peak() const { return strength * dynamicFriction * kGravity; }  // m/s^2
  double amplitude() const { return peak() / (rate() * rate()); }
  double tableVelocity(double t) const { return amplitude() * rate() * std::cos(rate() * t); }
  double tableAcceleration(double t) const { return -peak() * std::sin(rate() * t); }
};

/// The exact motion, from a start with the velocity that the table gives the centre.
class ExactMotion {
 public:
  explicit ExactMotion(const Shaking& shaking)
      : shaking_(shaking), center_{0, shaking.tableVelocity(0) / shaking.gain}, atStart_(center_) {}

  /// m: place of the centre, for times that grow.
  double placeAt(double time) {
    while (time_ < time) advance(time);
    return center_.place;
  }

  int changes = 0;  // of sticking and sliding
  int slips = 0;    // of what stuck
  double late = 0;  // s: the longest time in which the table goes on to accelerate by 1e-6 g after a slip

 private:
  struct Center {
    double place, velocity;  // m, m/s
  };

  // Whether the phase that began at start_ goes on at a time.
  bool lasts(double t) const {
    if (sign_ == 0)
      return std::abs(shaking_.tableAcceleration(t)) <= shaking_.gain * shaking_.staticFriction * kGravity;
    return sign_ * slidingAt(t) >= 0;
  }
  double slidingAt(double t) const {  // u
    return -sign_ * shaking_.gain * shaking_.dynamicFriction * kGravity * (t - start_) -
           (shaking_.tableVelocity(t) - shaking_.tableVelocity(start_));
  }
  Center centerAt(double t) const {
    const double past = t - start_, slow = -sign_ * shaking_.dynamicFriction * kGravity, k = shaking_.gain;
    if (sign_ != 0)
      return {atStart_.place + atStart_.velocity * past + slow * past * past / 2, atStart_.velocity + slow * past};
    const double before = shaking_.tableVelocity(start_) / k, rate = shaking_.rate();
    const double way = shaking_.amplitude() * (std::sin(rate * t) - std::sin(rate * start_)) / k;
    return {atStart_.place + (atStart_.velocity - before) * past + way,
            atStart_.velocity - before + shaking_.tableVelocity(t) / k};
  }
  void advance(double end) {
    const double next = std::min(end, time_ + 1e-3 / shaking_.frequency);
    if (lasts(next)) return goTo(next);
    double before = time_, after = next;
    while (after - before > 1e-15) {
      const double middle = (before + after) / 2;
      if (middle == before || middle == after) break;
      (lasts(middle) ? before : after) = middle;
    }
    goTo(after);
    begin();
  }
  void goTo(double t) { time_ = t, center_ = centerAt(t); }
  void begin() {
    const bool stuck = sign_ == 0;
    const double table = shaking_.tableAcceleration(time_), most = shaking_.gain * shaking_.staticFriction * kGravity;
    const double growth = shaking_.peak() * shaking_.rate() * std::abs(std::cos(shaking_.rate() * time_));
    ++changes;
    if (stuck) ++slips, late = std::max(late, 1e-6 * kGravity / growth);
    sign_ = stuck || std::abs(table) > most ? (table > 0 ? -1 : 1) : 0;
    start_ = time_, atStart_ = center_;
  }

  Shaking shaking_;
  int sign_ = 0;  // of u; 0: sticks
  double time_ = 0, start_ = 0;
  Center center_, atStart_;
};

struct ShakenBody {
  const char* name;
  const char* shape;   // and place, for a table with its top at 0
  double rollingGain;  // k
};

// Four corners, two of a capsule that lies along x, and one.
const ShakenBody kShakenBox{"box", R"("shape": {"box": {"size": [0.4, 0.2, 0.3]}}, "position": [0, 0.1, 0])", 1};
const ShakenBody kShakenCapsule{"capsule",
                                R"("shape": {"capsule": {"radius": 0.1, "length": 0.4}}, "position": [0, 0.1, 0],
  "orientation": {"axis": [0, 0, 1], "angleDegrees": 90})",
                                1};
const ShakenBody kShakenBall{"ball", R"("shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.1, 0])", 3.5};

struct ShakenRun {
  Trajectory run;
  std::vector<std::string> warnings;
};

ShakenRun runWithWarnings(const Scene& scene) {
  ShakenRun made;
  simulate(scene, {[&](const Frame& frame) { made.run.frames.push_back(frame); }, [](const Event&) {},
                   [&](const std::string& text) { made.warnings.push_back(text); }});
  return made;
}

/// Two seconds, or less at more than 5 Hz.
double durationOf(const Shaking& shaking) {
  return std::min(2.0, 10 / shaking.frequency);
}

ShakenRun runShaken(const Shaking& shaking, const Vec3& direction, const ShakenBody& body, double accuracy) {
  const double speed = shaking.tableVelocity(0) / shaking.gain;
  Vec3 spin = Vec3::Zero();  // of a ball that rolls: v - R w x up is the table's velocity
  if (shaking.gain > 1) spin = Vec3::UnitY().cross(direction) * (speed - shaking.tableVelocity(0)) / 0.1;
  const Scene scene = sceneWith(fmt::format(
      R"("duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 240}}, "materials": {{
      "m": {{"restitution": 0, "staticFriction": {}, "dynamicFriction": {}}}}}, "bodies": [
      {{"name": "table", "material": "m", "motion": "driven", "shape": {{"box": {{"size": [8, 0.2, 8]}}}},
        "position": [0, -0.1, 0], "oscillation": {{"direction": {}, "amplitude": {}, "frequency": {}}}}},
      {{"name": "{}", "material": "m", "mass": 2, "linearVelocity": {}, "angularVelocity": {}, {}}}])",
      durationOf(shaking), accuracy, shaking.staticFriction, shaking.dynamicFriction, vectorText(direction),
      shaking.amplitude(), shaking.frequency, body.name, vectorText(speed * direction), vectorText(spin), body.shape));
  return runWithWarnings(scene);
}

/// A contact of several corners slips when forces lack 1e-6 g: the longest delay d of a slip, in which static friction
/// in place of dynamic gives (mu_s - mu_d) g d. That lasts to the end. Else the accuracy is kept: it is promised.
void expectExact(const Shaking& shaking, const Vec3& direction, const ShakenBody& body, double accuracy) {
  const ShakenRun made = runShaken(shaking, direction, body, accuracy);
  const std::string what = fmt::format("{} mu {} {} at {} Hz, {} mu g, accuracy {}", body.name, shaking.staticFriction,
                                       shaking.dynamicFriction, shaking.frequency, shaking.strength, accuracy);
  EXPECT_TRUE(made.warnings.empty()) << what << ": " << made.warnings[0];
  ExactMotion exact(shaking);
  double largest = 0, allowed = accuracy;
  for (const Frame& frame : made.run.frames) {
    const Vec3 place = exact.placeAt(frame.time) * direction;
    const Vec3& found = frame.states[1].position;
    largest = std::max(largest, (found - Vec3(place.x(), found.y(), place.z())).norm());
    const double faster = (shaking.staticFriction - shaking.dynamicFriction) * kGravity * 1.1 * exact.late;
    allowed = accuracy + exact.slips * faster * frame.time;
    ASSERT_LT(largest, allowed) << what << " at " << frame.time;
  }
  if (shaking.strength * shaking.dynamicFriction > 1.01 * shaking.gain * shaking.staticFriction) {
    EXPECT_GT(exact.changes, 2) << what;
  }
}

const Vec3 kAlong = Vec3::UnitX(), kOblique = Vec3(0.8, 0, -0.6);

TEST(ShakenTable, BoxSlipsAndSticksWithOneFriction) {
  for (const double accuracy : {1e-2, 1e-4, 1e-6})
    for (const Vec3& direction : {kAlong, kOblique}) {
      expectExact({0.3, 0.3, 1.5, 1.5}, direction, kShakenBox, accuracy);
      if (accuracy < 1e-2) expectExact({0.1, 0.1, 0.5, 1.2}, direction, kShakenBox, accuracy);
      expectExact({0.5, 0.5, 5, 3}, direction, kShakenBox, accuracy);
    }
}

TEST(ShakenTable, BoxSlipsAndSticksWithMoreStaticFriction) {
  for (const double accuracy : {1e-2, 1e-4, 1e-6})
    for (const Vec3& direction : {kAlong, kOblique}) {
      expectExact({0.301, 0.3, 1.5, 1.5}, direction, kShakenBox, accuracy);
      if (accuracy < 1e-2) expectExact({0.31, 0.3, 1.5, 1.5}, direction, kShakenBox, accuracy);
      expectExact({0.8, 0.6, 4, 2}, direction, kShakenBox, accuracy);
    }
}

/// Above some 2.2 mu g a body never sticks: it turns back at once.
TEST(ShakenTable, BoxThatNeverSticksTurnsBack) {
  expectExact({0.3, 0.3, 2, 5}, kOblique, kShakenBox, 1e-2);
  for (const double accuracy : {1e-2, 1e-4}) expectExact({0.8, 0.6, 8, 5}, kOblique, kShakenBox, accuracy);
}

TEST(ShakenTable, FastShakingIsFollowed) {
  for (const double accuracy : {1e-4, 1e-6}) expectExact({0.8, 0.8, 20, 1.7}, kOblique, kShakenBox, accuracy);
  expectExact({0.4, 0.4, 20, 5}, kOblique, kShakenBox, 1e-4);
}

/// Slips that hardly begin: the table's acceleration comes to 1.03 mu g. And none.
TEST(ShakenTable, BoxThatHardlySlips) {
  for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
    if (accuracy < 1e-2) expectExact({0.3, 0.3, 1.5, 1.03}, kAlong, kShakenBox, accuracy);
    expectExact({0.3, 0.3, 1.5, 0.3}, kOblique, kShakenBox, accuracy);
  }
}

TEST(ShakenTable, CapsuleSlipsAndSticksAlongItsAxis) {
  for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
    expectExact({0.3, 0.3, 1.5, 1.5}, kAlong, kShakenCapsule, accuracy);
    expectExact({0.5, 0.4, 3, 4}, kAlong, kShakenCapsule, accuracy);
  }
}

TEST(ShakenTable, BallRollsAndSlips) {
  for (const double accuracy : {1e-2, 1e-4, 1e-6})
    for (const double strength : {2.0, 4.2, 5.0, 12.0}) {
      expectExact({0.1, 0.1, 1.5, strength, 3.5}, kAlong, kShakenBall, accuracy);
      expectExact({0.12, 0.1, 1.5, strength, 3.5}, kAlong, kShakenBall, accuracy);
    }
}

/// The table hangs to one side, so that friction turns: with u the velocity of the box relative to the table, and d its
/// direction, u' = -mu g_n d - x'' + g_z. The reference takes it by fourth-order steps of 2e-7 s from the instant of
/// the slip on. These are stable from u = mu g h / 2.8 on, and have the direction there by h: no more than 1e-9 m.
TEST(ShakenTable, FrictionTurnsWithThePushOnATableThatHangs) {
  const double friction = 0.3, across = 1.5, amplitude = 0.05, rate = 2 * kPi * 1.5, end = 0.2, step = 2e-7;
  const double limit = friction * kGravity,
               begin = std::asin(std::sqrt(limit * limit - across * across) / (amplitude * rate * rate)) / rate;
  const auto pushAt = [&](double t) { return Vec3(amplitude * rate * rate * std::sin(rate * t), 0, across); };
  const auto accelerationAt = [&](double t, const Vec3& u) {
    const Vec3 push = pushAt(t);
    return Vec3(push - limit * (u.norm() > 0 ? u : push).normalized());
  };
  Vec3 velocity = Vec3::Zero(), place = Vec3::Zero();  // relative to the table
  const long steps = std::lround((end - begin) / step);
  const double h = (end - begin) / static_cast<double>(steps);
  for (long i = 0; i < steps; ++i) {
    const double t = begin + static_cast<double>(i) * h;
    const Vec3 k1 = accelerationAt(t, velocity), k2 = accelerationAt(t + h / 2, velocity + h / 2 * k1);
    const Vec3 k3 = accelerationAt(t + h / 2, velocity + h / 2 * k2), k4 = accelerationAt(t + h, velocity + h * k3);
    place += h * velocity + h * h / 6 * (k1 + k2 + k3);
    velocity += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  place.x() += amplitude * std::sin(rate * end);
  for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const ShakenRun made = runWithWarnings(sceneWith(fmt::format(
        R"("duration": {}, "accuracy": {}, "gravity": [0, {}, {}], "materials": {{
        "m": {{"restitution": 0, "staticFriction": 0.3, "dynamicFriction": 0.3}}}}, "bodies": [
        {{"name": "table", "material": "m", "motion": "driven", "shape": {{"box": {{"size": [8, 0.2, 8]}}}},
          "position": [0, -0.1, 0], "oscillation": {{"direction": [1, 0, 0], "amplitude": 0.05, "frequency": 1.5}}}},
        {{"name": "box", "material": "m", "mass": 2, "linearVelocity": [{}, 0, 0], {}}}])",
        end, accuracy, -kGravity, across, amplitude * rate, kShakenBox.shape)));
    EXPECT_TRUE(made.warnings.empty()) << made.warnings[0];
    const Vec3 found = made.run.frames.back().states[1].position;
    EXPECT_LT(std::hypot(found.x() - place.x(), found.z() - place.z()), accuracy) << accuracy;
  }
}

/// Boxes beside each other on one table are as alone: what is driven hands no force on.
TEST(ShakenTable, BoxesDoNotFeelEachOther) {
  const auto boxes = [](int count) {
    std::string bodiesText;
    for (int i = 0; i < count; ++i)
      bodiesText +=
          fmt::format(R"(, {{"name": "box{}", "material": "m", "shape": {{"box": {{"size": [0.2, 0.1, 0.2]}}}},
        "mass": {}, "linearVelocity": [0.4, 0, 0], "position": [0, 0.05, {}]}})",
                      i, 1 + i, 0.3 * i);
    ShakenRun made = runWithWarnings(sceneWith(R"("duration": 1, "accuracy": 1e-6, "materials": {
          "m": {"restitution": 0, "staticFriction": 0.3, "dynamicFriction": 0.3}}, "bodies": [
          {"name": "table", "material": "m", "motion": "driven", "shape": {"box": {"size": [4, 0.2, 8]}},
           "position": [0, -0.1, 0], "oscillation": {"direction": [1, 0, 0], "amplitude": 0.05, "frequency": 1.5}})" +
                                               bodiesText + "]"));
    EXPECT_TRUE(made.warnings.empty()) << made.warnings[0];
    return made.run;
  };
  const Trajectory alone = boxes(1), together = boxes(6);
  for (std::size_t i = 0; i < alone.frames.size(); ++i)
    for (std::size_t box = 1; box <= 6; ++box) {
      const Vec3 offset(0, 0, 0.3 * (static_cast<double>(box) - 1));
      EXPECT_LT((together.frames[i].states[box].position - offset - alone.frames[i].states[1].position).norm(), 1e-7)
          << "box " << box << " at " << alone.frames[i].time;
    }
}

}  // namespace
}  // namespace cradle
