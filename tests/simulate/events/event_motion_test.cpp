#include "simulate/events/event_motion.h"

#include <gmock/gmock.h>

#include <cmath>

#include "collision/time_to_contact.h"
#include "constraints/invariants.h"
#include "rounding.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// s: gaps, ropes and accelerations close to 1e-12 m or less, at speeds above 0.5 m/s; times are below 2 s.
constexpr double kInstantError = 1e-11;

ChosenMethod eventMethodOf(const Scene& scene) {
  ChosenMethod method = planOf(scene).islands.at(0).method;
  method.keepsPromise = false;
  return method;
}

/// An island that the method of its plan moves from event to event.
struct ByEvents : OneIsland {
  explicit ByEvents(const std::string& members, bool isTrial = false)
      : OneIsland(members), ropes(island), motion(island, ropes, eventMethodOf(scene), isTrial) {}

  /// Steps until an event of that kind; none within 1000 steps is a failure.
  Event stepToNext(EventKind kind) {
    for (int i = 0; i < 1000; ++i) {
      for (const Event& event : island.log.take())
        if (event.kind == kind) return event;
      if (island.time >= scene.duration) break;
      motion.advance(kNever);
    }
    ADD_FAILURE() << "no event";
    return {};
  }
  double constant() { return energyConstant(mechanism(), state()); }

  LimitEvents ropes;
  EventMotion motion;
};

const std::string kEventMaterial =
    R"("materials": {"stuff": {"restitution": 0.5, "staticFriction": 0.3, "dynamicFriction": 0.2}}, )";
const std::string kEventFloor = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "stuff"})";

std::string eventBall(const Vec3& position, const Vec3& velocity) {
  return fmt::format(R"({{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "material": "stuff",
    "position": {}, "linearVelocity": {}}})",
                     vectorText(position), vectorText(velocity));
}
std::string eventBox(const Vec3& velocity, const std::string& more = "") {
  return fmt::format(
      R"({{"name": "box", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "mass": 3, "material": "stuff",
    "position": [0, 0.1, 0], "linearVelocity": {}{}}})",
      vectorText(velocity), more);
}

// From 1.25 m: t = sqrt(2 h / g), and then every 2 e^k v / g, with the height in between that of a parabola. Each loses
// m v^2 (1 - e^2) / 2.
TEST(EventMotion, BouncesAtTheInstantsOfTheParabolas) {
  ByEvents at(R"("duration": 2, )" + kEventMaterial + R"("bodies": [)" + kEventFloor + ", " +
              eventBall(Vec3(0, 1.35, 0), Vec3::Zero()) + "]");
  const double constant = at.constant();
  double time = std::sqrt(2 * 1.25 / kGravity), speed = kGravity * time, lost = 0;
  for (int i = 0; i < 4; ++i) {
    const Event impact = at.stepToNext(EventKind::impact);
    EXPECT_NEAR(impact.time, time, kInstantError) << i;
    EXPECT_EQ(at.island.time, impact.time);
    EXPECT_NEAR(impact.impulse, 1.5 * 2 * speed, kInstantError * 2 * kGravity * 10) << i;
    EXPECT_NEAR(centerOfMass(at.state(), 0).y(), 0.1, 1e-12) << i;
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), speed / 2, kInstantError * kGravity) << i;
    lost += speed * speed * 0.75;
    EXPECT_NEAR(impactEnergy(at.state()), lost, kInstantError * 100) << i;
    EXPECT_NEAR(at.constant(), constant, 1e-12) << i;
    speed /= 2, time += 2 * speed / kGravity;
  }
}

// It slides for t = v / (mu g) with the dynamic friction, v^2 / (2 mu g) far, and sticks: the static one holds it.
TEST(EventMotion, EndsAStepWhereSlidingStops) {
  ByEvents at(R"("duration": 2, )" + kEventMaterial + R"("bodies": [)" + kEventFloor + ", " +
              eventBox(Vec3(0.6, 0, 0.8)) + "]");
  EXPECT_FALSE(at.motion.isAtRest());
  at.motion.advance(kNever);
  EXPECT_FALSE(at.motion.contactsOfStep().empty());
  while (!at.motion.isAtRest() && at.island.time < 2) at.motion.advance(kNever);
  const double way = 1 / (2 * 0.2 * kGravity);
  EXPECT_NEAR(at.island.time, 1 / (0.2 * kGravity), 1e-9);
  EXPECT_LT((Vec3(centerOfMass(at.state(), 0)) - Vec3(0.6 * way, 0.1, 0.8 * way)).norm(), 1e-9);
  EXPECT_EQ(Vec3(linearVelocity(at.state(), 0)), Vec3::Zero());
  EXPECT_NEAR(frictionEnergy(at.state()), 1.5, 1e-9);
}

// The arm is slanted as the ball strikes, so that the drift of a step, 1e-9 m at this accuracy, is half a gap: what
// projection leaves has none, but for a thousandth of the touch tolerance, 1e-11 of the ball's size, and a few
// roundings of metres. Two such balls would strike a third at one instant.
TEST(EventMotion, EndsAStepWhereTheProjectedGapCloses) {
  const auto strike = [](double speed, double spin) {
    ByEvents at(R"("duration": 2, "accuracy": 1e-4, )" + kEventMaterial +
                R"("bodies": [{"name": "wall", "shape": {"box": {"size": [1, 6, 6]}}, "motion": "static",
        "material": "stuff", "position": [1, 0, 0]}, )" +
                fmt::format(R"({{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2,
        "material": "stuff", "position": [-0.6, -0.8, 0], "linearVelocity": [0, 0, {}],
        "angularVelocity": [{}, {}, 0]}}, {{"name": "rotor", "shape": {{"box": {{"size": [0.1, 0.2, 0.3]}}}},
        "mass": 1, "position": [-0.3, -0.4, 0], "angularVelocity": [0, 0, {}]}}], "ballJoints": [
        {{"bodyA": "ball", "anchorA": [0.6, 0.8, 0], "anchorB": [0, 0, 0]}},
        {{"bodyA": "rotor", "bodyB": "ball", "anchorA": [0, 0, 0], "anchorB": [0.3, 0.4, 0]}}])",
                            speed, -0.6 * speed, -0.8 * speed, spin));
    at.stepToNext(EventKind::impact);
    EXPECT_NEAR(centerOfMass(at.state(), 0).x(), 0.4, 1e-3 * 1e-11 * 0.1 + 16 * kEpsilon) << speed << ' ' << spin;
  };
  for (const double spin : {3.0, 30.0}) strike(2, spin);
  for (double speed = 1; speed < 6; speed += 0.23) strike(speed, 0);
}

// A box that slides up a slope and across turns round and slides down: by more than 90 degrees, without an event, as
// the direction of its friction follows the sliding from step to step.
TEST(EventMotion, LetsDirectionsOfSlidingFollow) {
  ByEvents at(R"("duration": 2, "gravity": [6, -7, 0], )" + kEventMaterial + R"("bodies": [)" + kEventFloor + ", " +
              eventBox(Vec3(-1, 0, 1)) + "]");
  at.motion.advance(kNever);
  at.island.log.take();
  while (linearVelocity(at.state(), 0).x() < 2) {
    at.motion.advance(kNever);
    const Vec3 direction = linearVelocity(at.state(), 0).normalized();
    ASSERT_FALSE(at.mechanism().contacts.empty());
    for (const ContactConstraint& contact : at.mechanism().contacts)
      EXPECT_LT((contact.slidingDirection - direction).norm(), 1e-9) << at.island.time;
  }
  EXPECT_THAT(at.island.log.take(), IsEmpty());
}

// A rope that is slack by 0.8 m goes taut after sqrt(2 x 0.8 / g), and is a rod from then on: the step that ended there
// did not keep it, the next one does. A pull without restitution takes all that it meets.
TEST(EventMotion, EndsAStepWhereARopeGoesTaut) {
  ByEvents at(R"("duration": 2, "bodies": [)" + cradle::ball("ball", Vec3(0, -0.2, 0)) +
              R"(], "ropes": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0], "maxLength": 1}])");
  const Event taut = at.stepToNext(EventKind::taut);
  EXPECT_NEAR(taut.time, std::sqrt(2 * 0.8 / kGravity), kInstantError);
  EXPECT_FALSE(at.motion.keepsConstraints());
  EXPECT_NEAR(impactEnergy(at.state()), kGravity * 0.8, kInstantError * 100);
  at.motion.advance(kNever);
  EXPECT_TRUE(at.motion.keepsConstraints());
  EXPECT_NEAR(centerOfMass(at.state(), 0).y(), -1, 1e-12);
}

// Steps end where pushes begin and end, and at the end of the run, to the bit. F t / m in between.
TEST(EventMotion, EndsStepsWherePushesBeginAndEnd) {
  ByEvents at(
      R"("duration": 0.7, "gravity": [0, 0, 0], "bodies": [)" + cradle::ball("ball", Vec3::Zero()) +
      R"(], "pushes": [{"body": "ball", "point": [0, 0, 0], "force": [3, 0, 0], "start": 0.3, "duration": 0.2}])");
  std::vector<double> ends;
  while (at.island.time < 0.7) {
    at.motion.advance(kNever);
    for (const double end : {0.3, 0.5, 0.7})
      if (at.island.time == end) ends.push_back(end);
  }
  EXPECT_THAT(ends, ElementsAre(0.3, 0.5, 0.7));
  EXPECT_NEAR(linearVelocity(at.state(), 0).x(), 0.6, 1e-15);
  EXPECT_NEAR(centerOfMass(at.state(), 0).x(), 3 * 0.02 + 0.6 * 0.2, 1e-15);
}

// x = cos(w t): errors add up to less than the accuracy, and the ledger books them. Their number goes with the eighth
// root of the accuracy, the order of the error: to a tenth, as steps begin and end with shorter ones.
TEST(EventMotion, TakesStepsAsLongAsTheAccuracyAllows) {
  std::vector<double> counts;
  for (const double accuracy : {1e-5, 1e-7, 1e-9}) {
    ByEvents at(fmt::format(R"("duration": 1, "accuracy": {}, "gravity": [0, 0, 0], "bodies": [{}],
        "springs": [{{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [-1, 0, 0], "stiffness": 1000, "restLength": 1}}])",
                            accuracy, cradle::ball("ball", Vec3(0.5, 0, 0))));
    const double constant = at.constant();
    int steps = 0;
    for (; at.island.time < 1; ++steps) at.motion.advance(kNever);
    EXPECT_NEAR(centerOfMass(at.state(), 0).x(), 0.5 * std::cos(std::sqrt(1000)), accuracy) << accuracy;
    EXPECT_NEAR(at.constant(), constant, 1e-12) << accuracy;
    counts.push_back(steps);
  }
  const double ratio = std::pow(100, 1.0 / 8);
  for (const std::size_t i : {1u, 2u}) EXPECT_NEAR(counts[i] / counts[i - 1], ratio, 0.1 * ratio);
}

// Where all but orientations is constant, the error of a step goes with its length to the power 8, and the step with
// the eighth root of the tolerance: that of more than 100 rad in the run is a tenth.
TEST(EventMotion, TurnsByManyRadiansWithATenthOfTheTolerance) {
  std::vector<double> lengths;
  for (const double duration : {9.9, 10.1}) {
    ByEvents at(fmt::format(R"("duration": {}, "gravity": [0, 0, 0], "method": {{"name": "dop853"}}, "bodies": [
        {{"name": "box", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "angularVelocity": [0, 10, 0]}}])",
                            duration));
    for (int i = 0; i < 6; ++i) at.motion.advance(kNever);
    lengths.push_back(at.island.step.timeStep);
  }
  EXPECT_NEAR(lengths[1] / lengths[0], std::pow(0.1, 1.0 / 8), 0.03);
}

// A pendulum's rod is projected: its error is rounding, and what that costs is booked.
TEST(EventMotion, KeepsConstraintsToRounding) {
  ByEvents at(R"("duration": 1, "accuracy": 1e-5, "bodies": [)" +
              cradle::ball("ball", Vec3(0.6, -0.8, 0), Vec3(0, 0, 2)) +
              R"(], "rods": [{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}])");
  const double constant = at.constant();
  while (at.island.time < 1) {
    at.motion.advance(kNever);
    EXPECT_NEAR(centerOfMass(at.state(), 0).norm(), 1, 1e-15);
    EXPECT_NEAR(centerOfMass(at.state(), 0).dot(linearVelocity(at.state(), 0)), 0, 1e-14);
    EXPECT_NEAR(at.constant(), constant, 1e-13);
  }
}

// A box that lies still rests at once; time goes to what comes next, a push that it slides of.
TEST(EventMotion, LetsTimePassUntilAPushWakesWhatRests) {
  ByEvents at(
      R"("duration": 2, )" + kEventMaterial + R"("bodies": [)" + kEventFloor + ", " + eventBox(Vec3::Zero()) +
      R"(], "pushes": [{"body": "box", "point": [0, -0.1, 0], "force": [30, 0, 0], "start": 0.5, "duration": 1}])");
  EXPECT_TRUE(at.motion.isAtRest());
  at.motion.restUntil(0.25);
  EXPECT_EQ(at.island.time, 0.25);
  EXPECT_TRUE(at.motion.isAtRest());
  at.motion.restUntil(0.75);
  EXPECT_EQ(at.island.time, 0.5);
  EXPECT_FALSE(at.motion.isAtRest());
  at.motion.advance(kNever);
  const double acceleration = 10 - 0.2 * kGravity;
  EXPECT_NEAR(linearVelocity(at.state(), 0).x(), acceleration * (at.island.time - 0.5), 1e-12);
}

/// A ball that flies to and fro between walls, with `rate` impacts a second. (Friction, which is never felt, keeps it
/// from the closed form of elastic balls.)
std::string betweenWalls(double rate, double accuracy) {
  return fmt::format(R"("duration": 9, "accuracy": {}, "gravity": [0, 0, 0], "materials": {{"stuff": {{"restitution": 1,
    "staticFriction": 0.1, "dynamicFriction": 0.1}}}}, "bodies": [{}, {{"name": "wall", "shape": {{"plane": {{
    "normal": [0, -1, 0]}}}}, "motion": "static", "position": [0, {}, 0], "material": "stuff"}}, {}])",
                     accuracy, kEventFloor, 0.2 + 2 / rate, eventBall(Vec3(0, 0.1 + 1 / rate, 0), Vec3(0, 2, 0)));
}

// Events are counted from the first on for 1/60 s, or 1/4 s at visual accuracies: 500 at most, 60 of a trial and for
// pictures. 1 more is a reason for time stepping, with the bodies of the last.
TEST(EventMotion, GivesUpBeyondTheLargestRateOfEvents) {
  for (const auto& [accuracy, isTrial, most] : {std::tuple(1e-6, false, 500), {1e-6, true, 60}, {1e-3, false, 60}}) {
    ByEvents at(betweenWalls(1e5, accuracy), isTrial);
    int impacts = 0;
    for (int i = 0; i < 3000 && at.motion.fallbackReason().empty(); ++i) {
      at.motion.advance(kNever);
      impacts += !at.island.log.take().empty();
    }
    EXPECT_EQ(impacts, most + 1);
    EXPECT_NEAR(at.island.time, (impacts - 0.5) / 1e5, 1e-9);
    EXPECT_THAT(at.motion.fallbackBodies(), testing::UnorderedElementsAre(2, impacts % 2 ? 1 : 0));
  }
}

// 59 impacts in 1/60 s are not too many, however long they go on.
TEST(EventMotion, CountsEventsInWindows) {
  ByEvents at(betweenWalls(59 * 60, 1e-6), true);
  while (at.island.time < 5.0 / 60) at.motion.advance(kNever);
  EXPECT_THAT(at.motion.fallbackReason(), IsEmpty());
}

std::string pressedCapsule(double accuracy) {
  return fmt::format(R"("duration": 0.05, "accuracy": {}, "materials": {{"stuff": {{"restitution": 0,
    "staticFriction": 0.5, "dynamicFriction": 0.5}}}}, "bodies": [{}, {{"name": "light", "mass": 0.1,
    "shape": {{"capsule": {{"radius": 0.038, "length": 0.018}}}}, "material": "stuff", "position": [0, 0.038, 0],
    "orientation": {{"axis": [0, 0, 1], "angleDegrees": 90}}}}, {{"name": "middle", "mass": 6.9,
    "shape": {{"capsule": {{"radius": 0.062, "length": 0.024}}}}, "material": "stuff",
    "position": [-0.046, 0.124, 0.054]}}, {{"name": "heavy", "mass": 470, "material": "stuff",
    "shape": {{"capsule": {{"radius": 0.048, "length": 0.027}}}}, "position": [-0.065, 0.247, 0.035],
    "orientation": {{"w": -0.596378, "x": -0.582994, "y": 0.546208, "z": 0.078155}},
    "linearVelocity": [0, -1.64, 0]}}])",
                     accuracy, kEventFloor);
}

// After an impact the light capsule starts to slide with a hundredth of what its friction gives it, so that the
// direction of its friction settles within a small part of the first step. The step is right at its end, its
// interpolant shows forces that are none, and a release at which the contacts would come to stick: another solution of
// Coulomb's law. Accuracies of 1e-6 and 1e-9 differ by 4e-11 m without it, and by 3e-4 m with it.
TEST(EventMotion, LeavesChangesThatTheInterpolantAloneShows) {
  ByEvents coarse(pressedCapsule(1e-6)), fine(pressedCapsule(1e-9));
  for (ByEvents* at : {&coarse, &fine})
    while (at->island.time < at->scene.duration) at->motion.advance(kNever);
  for (int body = 0; body < 3; ++body)
    EXPECT_LT((centerOfMass(coarse.state(), body) - centerOfMass(fine.state(), body)).norm(), 1e-8) << body;
}

/// Two balls on the floor, thrown, with a light one on each: x = 0 is a mirror.
std::string thrownPairs() {
  const auto ball = [](const char* name, double radius, double mass, const Vec3& position, const Vec3& velocity) {
    return fmt::format(R"(, {{"name": "{}", "shape": {{"sphere": {{"radius": {}}}}}, "mass": {}, "material": "stuff",
        "position": {}, "linearVelocity": {}}})",
                       name, radius, mass, vectorText(position), vectorText(velocity));
  };
  std::string bodies = kEventFloor;
  for (const double side : {1.0, -1.0}) {
    bodies += ball(side > 0 ? "right" : "left", 0.04154929646835, 3.84612856390322,
                   Vec3(side * 0.0526768440766587, 0.0415492964683502, -0.0052746969424186),
                   Vec3(side * 0.110656432016278, 0.137512052458464, -0.492312706136842));
    bodies += ball(side > 0 ? "rightTop" : "leftTop", 0.0531054717070087, 0.262211226397767,
                   Vec3(side * 0.0531054717070085, 0.136056063645236, 0), Vec3::Zero());
  }
  return R"("duration": 0.3, "accuracy": 1e-5, "materials": {"stuff": {"restitution": 0, "staticFriction": 3,
      "dynamicFriction": 2.7}}, "bodies": [)" +
         bodies + "]";
}

// Both tops begin to slip at one instant, which is two events. The first to slide has no speed yet at the second, and
// does not stick again for that: each would let the other stick, for ever.
TEST(EventMotion, LetsContactsSlipAtOneInstant) {
  ByEvents at(thrownPairs());
  int slips = 0;
  for (int i = 0; i < 3000 && at.island.time < at.scene.duration && at.motion.fallbackReason().empty(); ++i) {
    at.motion.advance(kNever);
    for (const Event& event : at.island.log.take()) slips += event.kind == EventKind::slip;
  }
  EXPECT_THAT(at.motion.fallbackReason(), IsEmpty());
  EXPECT_EQ(at.island.time, at.scene.duration);
  EXPECT_EQ(slips % 2, 0);
  EXPECT_GT(slips, 0);
}

}  // namespace
}  // namespace cradle
