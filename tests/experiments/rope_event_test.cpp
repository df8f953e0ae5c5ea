// Ropes going taut and slack, one at a time and together, between steps as long as the accuracy allows.

#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/tie_error.h"

namespace cradle {
namespace {

std::string rope(const std::string& body, const Vec3& anchor, double restitution) {
  return fmt::format(R"({{"bodyA": "{}", "anchorA": [0, 0, 0], "anchorB": {}, "maxLength": 1, "restitution": {}}})",
                     body, vectorText(anchor), restitution);
}

Trajectory runOnRopes(double duration, const std::string& bodies, const std::string& ropes,
                      double framesPerSecond = 10) {
  return simulate(sceneWith(fmt::format(
      R"("duration": {}, "accuracy": 1e-10, "output": {{"framesPerSecond": {}}}, "bodies": [{}], "ropes": [{}])",
      duration, framesPerSecond, bodies, ropes)));
}

const double kDrop = 0.8;  // m
const double kFall = std::sqrt(2 * kDrop / kGravity), kSpeed = kGravity * kFall;

Trajectory dropBelowItsAnchor(double restitution, double duration) {
  return runOnRopes(duration, ball("ball", Vec3(0, kDrop - 1, 0)), rope("ball", Vec3::Zero(), restitution));
}

TEST(FallIntoARope, WithoutRestitutionEndsThere) {
  const Trajectory fall = dropBelowItsAnchor(0, 2);
  ASSERT_EQ(fall.events.size(), 1u);
  EXPECT_EQ(fall.events[0].kind, EventKind::taut);
  EXPECT_NEAR(fall.events[0].time, kFall, 1e-12);
  EXPECT_NEAR(fall.events[0].impulse, kSpeed, 1e-11);
  EXPECT_LT((fall.events[0].normal - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((endOf(fall).position - Vec3(0, -1, 0)).norm(), 1e-12);
  EXPECT_LT(endOf(fall).linearVelocity.norm(), 1e-11);
  EXPECT_NEAR(fall.frames.back().energy.dissipated, kSpeed * kSpeed / 2, 1e-11);
}

// Each flight between two pulls lasts 2 e^k v / g: they get shorter for ever, and end at t (1 + 2 e / (1 - e)) = 3 t
// for e = 1/2. Rebounds slower than 1e-6 sqrt(g L) = 3.1e-6 m/s are not followed: with all that come after them they
// would have lasted up to 2 v / (g (1 - e)) = 1.3e-6 s.
TEST(FallIntoARope, WithHalfItsSpeedComesToRestInThreeTimesTheFall) {
  const Trajectory fall = dropBelowItsAnchor(0.5, 2);
  const std::vector<Event> taut = eventsOf(fall, EventKind::taut);
  ASSERT_GT(taut.size(), 20u);
  EXPECT_LT(taut.size(), 26u);
  double time = kFall, speed = kSpeed;
  for (std::size_t i = 0; i + 1 < taut.size(); ++i) {
    EXPECT_NEAR(taut[i].time, time, 1e-10) << i;
    EXPECT_NEAR(taut[i].impulse, 1.5 * speed, 1e-9) << i;
    speed /= 2;
    time += 2 * speed / kGravity;
  }
  EXPECT_NEAR(taut.back().time, 3 * kFall, 1.3e-6);
  EXPECT_LT((endOf(fall).position - Vec3(0, -1, 0)).norm(), 1e-12);
  EXPECT_LT(endOf(fall).linearVelocity.norm(), 1e-11);
  EXPECT_NEAR(fall.frames.back().energy.dissipated, kSpeed * kSpeed / 2, 1e-10);
}

// Elastic: up to the start and down again, for ever, in parabolas.
TEST(FallIntoARope, WithAllItsSpeedRepeatsItself) {
  const Trajectory fall = dropBelowItsAnchor(1, 10);
  const std::vector<Event> taut = eventsOf(fall, EventKind::taut);
  ASSERT_EQ(taut.size(), 12u);  // 0.404 s x (2 k + 1) < 10 s
  for (std::size_t i = 0; i < taut.size(); ++i) {
    EXPECT_NEAR(taut[i].time, kFall * (2 * static_cast<double>(i) + 1), 1e-10) << i;
    EXPECT_NEAR(taut[i].impulse, 2 * kSpeed, 1e-9) << i;
  }
  for (const Frame& frame : fall.frames) {
    const double phase = std::remainder(frame.time, 2 * kFall);
    EXPECT_NEAR(frame.states[0].position.y(), kDrop - 1 - kGravity * phase * phase / 2, 1e-9) << frame.time;
  }
  EXPECT_LT(largestEnergyError(fall), 1e-9);
}

// The ball of the reference goes slack at 0.96 s and taut again at 1.26 s: a parabola in between.
TEST(SlackRope, LeavesAParabola) {
  const Trajectory thrown =
      runOnRopes(1.25, ball("ball", Vec3(0.9, 0, 0), Vec3(0, -2, 0)), rope("ball", Vec3::Zero(), 0), 100);
  ASSERT_EQ(thrown.events.size(), 2u);
  const Event& slack = thrown.events[1];
  ASSERT_EQ(slack.kind, EventKind::slack);
  const Frame& first = thrown.frames[97];
  ASSERT_GT(first.time, slack.time);
  for (std::size_t i = 97; i < thrown.frames.size(); ++i) {
    const double since = thrown.frames[i].time - first.time;
    const Vec3 expected =
        first.states[0].position + since * first.states[0].linearVelocity - Vec3(0, kGravity * since * since / 2, 0);
    EXPECT_LT((thrown.frames[i].states[0].position - expected).norm(), 1e-13) << since;
  }
}

// A bob on a rod answers to its rope along its circle alone: with n along the rope and t along the circle, the inverse
// mass is (n.t)^2 / m, and the rope's end comes in with v n.t.
TEST(RopeOnARodPendulum, PullsAsHardAsTheRodLetsTheBobAnswer) {
  const Vec3 at(-0.6, -0.8, 0), tangent(0.8, -0.6, 0), anchor(-0.9, 0, 0);
  const double restitution = 0.5, speed = std::sqrt(2 * kGravity * 0.8), length = (at - anchor).norm();
  const Trajectory swing = simulate(sceneWith(fmt::format(
      R"("duration": 1, "accuracy": 1e-10, "bodies": [{}],
      "rods": [{{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]}}],
      "ropes": [{{"bodyA": "bob", "anchorA": [0, 0, 0], "anchorB": {}, "maxLength": {}, "restitution": {}}}])",
      ball("bob", Vec3(-1, 0, 0)), vectorText(anchor), length, restitution)));
  ASSERT_FALSE(swing.events.empty());
  EXPECT_LT((swing.events[0].point - at).norm(), 1e-9);
  const double along = (at - anchor).dot(tangent) / length;
  EXPECT_NEAR(swing.events[0].impulse, (1 + restitution) * speed / along, 1e-8);
  const auto after = std::find_if(swing.frames.begin(), swing.frames.end(),
                                  [&](const Frame& frame) { return frame.time > swing.events[0].time; });
  EXPECT_NEAR(after->energy.dissipated, (1 - restitution * restitution) * speed * speed / 2, 1e-8);
}

/// A ball that falls from between two anchors, on a rope from each.
Trajectory dropBetweenAnchors(double restitution, double duration) {
  return runOnRopes(duration, ball("ball", Vec3::Zero()),
                    rope("ball", Vec3(0.6, 0, 0), restitution) + ", " + rope("ball", Vec3(-0.6, 0, 0), restitution));
}

// Both ropes are straight 0.8 m below.
TEST(TwoRopesAtOnce, StopABallWithoutRestitution) {
  const Trajectory fall = dropBetweenAnchors(0, 2);
  const std::vector<Event> taut = eventsOf(fall, EventKind::taut);
  ASSERT_EQ(taut.size(), 2u);
  for (const Event& event : taut) EXPECT_NEAR(event.time, kFall, 1e-12);
  EXPECT_EQ(taut[0].time, taut[1].time);
  EXPECT_LT((endOf(fall).position - Vec3(0, -0.8, 0)).norm(), 1e-12);
  EXPECT_LT(endOf(fall).linearVelocity.norm(), 1e-11);
}

TEST(TwoRopesAtOnce, ThrowABallBackStraight) {
  for (const double restitution : {0.5, 1.0}) {
    const Trajectory fall = dropBetweenAnchors(restitution, 1);
    for (const Frame& frame : fall.frames) EXPECT_LT(std::abs(frame.states[0].position.x()), 1e-12) << frame.time;
    // Each rope's end comes back with the part e of its speed, which the upright one alone does to both.
    const Frame& after = fall.frames[5];
    const double since = after.time - kFall;
    EXPECT_NEAR(after.states[0].linearVelocity.y(), restitution * kSpeed - kGravity * since, 1e-10);
  }
}

// Two balls on ropes of their own, tied by a slack spring without force: one island, two events at one instant.
TEST(TwoRopesAtOnce, OnTwoBallsKeepTheMirrorsSymmetry) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    const Trajectory fall = simulate(sceneWith(fmt::format(
        R"("duration": 3, "accuracy": 1e-8, "bodies": [{}, {}], "ropes": [{}, {}],
        "springs": [{{"bodyA": "left", "anchorA": [0, 0, 0], "bodyB": "right", "anchorB": [0, 0, 0], "stiffness": 3}}])",
        ball("left", Vec3(-1, 0, 0)), ball("right", Vec3(1, 0, 0)), rope("left", Vec3(-1.7, 0, 0), restitution),
        rope("right", Vec3(1.7, 0, 0), restitution))));
    const std::vector<Event> taut = eventsOf(fall, EventKind::taut);
    ASSERT_GE(taut.size(), 2u);
    for (const Frame& frame : fall.frames) {
      const BodyState &left = frame.states[0], &right = frame.states[1];
      EXPECT_LT((left.position - Vec3(-right.position.x(), right.position.y(), 0)).norm(), 1e-12)
          << restitution << " at " << frame.time;
    }
  }
}

// Two balls come in from both sides, mirror images of each other, and meet one between them just as the ropes that hold
// them go taut at 45 degrees. With all restitutions 1 the velocity (v, -w) of one becomes (-v, w): contact and rope
// reflect at once, the contact with impulse 2 (v - w) m. One after the other it would be (-v, -w), or (-w, v).
TEST(RopeAndContactAtOnce, ReflectTogether) {
  const double v = 1, w = 0.5, time = 0.5, side = std::sqrt(0.5);
  const auto ballText = [&](const std::string& name, double sign, double speed) {
    return fmt::format(
        R"({{"name": "{}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "material": "m", "position": [{}, {}, 0],
             "linearVelocity": [{}, {}, 0]}})",
        name, sign * (0.2 + v * time) * speed, w * time * speed, -sign * v * speed, -w * speed);
  };
  const auto ropeText = [&](const std::string& name, double sign) {
    return fmt::format(
        R"({{"bodyA": "{}", "anchorA": [0, 0, 0], "anchorB": [{}, {}, 0], "maxLength": 1, "restitution": 1}})", name,
        sign * (0.2 + side), side);
  };
  const Trajectory run = simulate(sceneWith(fmt::format(
      R"("duration": 0.75, "gravity": [0, 0, 0], "accuracy": 1e-10, "output": {{"framesPerSecond": 4}},
         "materials": {{"m": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}}},
         "bodies": [{}, {}, {}], "ropes": [{}, {}])",
      ballText("left", -1, 1), ballText("right", 1, 1), ballText("middle", 0, 0), ropeText("left", -1),
      ropeText("right", 1))));
  const auto& states = run.frames.back().states;
  EXPECT_LT((states[0].linearVelocity - Vec3(-v, w, 0)).norm(), 1e-10);
  EXPECT_LT((states[1].linearVelocity - Vec3(v, w, 0)).norm(), 1e-10);
  EXPECT_LT(states[2].linearVelocity.norm(), 1e-12);
  for (const EventKind kind : {EventKind::impact, EventKind::taut}) {
    const std::vector<Event> events = eventsOf(run, kind);
    EXPECT_EQ(events.size(), 2u);
    for (const Event& event : events) {
      EXPECT_NEAR(event.time, time, 1e-10);
      EXPECT_NEAR(event.impulse, kind == EventKind::taut ? 4 * side * w : 2 * (v - w), 1e-10);
    }
  }
}

// A ball that hangs on a taut rope is struck from below by one of the same mass: a rope holds nothing back, the struck
// ball flies on with all of the speed.
TEST(RopeAndContactAtOnce, ATautRopeDoesNotHoldBackWhatIsStruckFromBelow) {
  const Trajectory run = simulate(sceneWith(
      R"("duration": 0.3, "accuracy": 1e-10, "output": {"framesPerSecond": 10},
         "materials": {"m": {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}},
         "bodies": [{"name": "hung", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "m", "position": [0, 0, 0]},
                    {"name": "striker", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "material": "m",
                     "position": [0, -0.6, 0], "linearVelocity": [0, 4, 0]}],
         "ropes": [{"bodyA": "hung", "anchorA": [0, 0, 0], "anchorB": [0, 1, 0]}])"));
  // The striker needs t with 4 t - g t^2 / 2 = 0.4 and arrives with 4 - g t.
  const double g = 9.81, arrival = std::sqrt(16 - 2 * g * 0.4), time = (4 - arrival) / g;
  const double since = run.frames.back().time - time;
  EXPECT_NEAR(run.frames.back().states[0].position.y(), arrival * since - g * since * since / 2, 1e-9);
  EXPECT_NEAR(run.frames.back().states[1].position.y(), -0.2 - g * since * since / 2, 1e-9);
}

// A ball at rest on a rope just as long as the way to it, in no gravity: a spring to another ball, which flies off with
// v, starts to pull at it once the flight has begun. The rope holds the ball, and the other one swings: v / w sin w t,
// w = sqrt(k). Until 1e-9 m are gone the rope is not found to be pulled at; by then the ball has a speed of about
// k v t^2 / 2 with k v t^3 / 6 = 1e-9 m: 1e-5 m/s at most, lost with 1e-10 J.
TEST(RopeAtItsLength, HoldsWhatIsPulledOnlyLater) {
  const double stiffness = 4, speed = 1, frequency = 2;
  const Trajectory swing = simulate(sceneWith(fmt::format(
      R"("duration": 1.5, "gravity": [0, 0, 0], "accuracy": 1e-10, "bodies": [{}, {}], "ropes": [{}],
         "springs": [{{"bodyA": "held", "anchorA": [0, 0, 0], "bodyB": "flying", "anchorB": [0, 0, 0],
                       "stiffness": {}, "restLength": 1}}])",
      ball("held", Vec3(1, 0, 0)), ball("flying", Vec3(2, 0, 0), Vec3(speed, 0, 0)), rope("held", Vec3::Zero(), 0),
      stiffness)));
  for (const Frame& frame : swing.frames) {
    EXPECT_NEAR(frame.states[0].position.x(), 1, 2e-9) << frame.time;
    const double way = speed / frequency * std::sin(frequency * frame.time);
    EXPECT_NEAR(frame.states[1].position.x(), 2 + way, 1e-8) << frame.time;
  }
}

// A ball that spins on the ground, and a light rope up from it that another one, flying upwards, has just stretched:
// while the first one stays there, the pull of gravity is the stronger one at the second, which nothing holds back; in
// the air a spring pulls at the second alone. Both fly on together with m2 v / M, in the swing of M = m1 + m2 on the
// spring.
TEST(RopeAtItsLength, IsPulledAtOnceItHasLiftedWhatLay) {
  const double masses = 3, stiffness = 10, speed = 2. / 3, time = 0.1;
  const Trajectory lift = simulate(sceneWith(
      R"("duration": 0.1, "accuracy": 1e-10, "output": {"framesPerSecond": 10},
         "bodies": [{"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static"},
                    {"name": "lying", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0, 0.1, 0],
                     "angularVelocity": [0, 5, 0]},
                    {"name": "flying", "shape": {"sphere": {"radius": 0.1}}, "mass": 2, "position": [0, 1.1, 0],
                     "linearVelocity": [0, 1, 0]}],
         "ropes": [{"bodyA": "lying", "anchorA": [0, 0, 0], "bodyB": "flying", "anchorB": [0, 0, 0], "maxLength": 1,
                    "restitution": 0}],
         "springs": [{"bodyA": "flying", "anchorA": [0, 0, 0], "anchorB": [0, 3.1, 0], "stiffness": 10,
                      "restLength": 1}])"));
  const double middle = 2.1 - masses * kGravity / stiffness, frequency = std::sqrt(stiffness / masses);
  const double height =
      middle + (1.1 - middle) * std::cos(frequency * time) + speed / frequency * std::sin(frequency * time);
  const auto& states = lift.frames.back().states;
  EXPECT_NEAR(states[1].position.y(), height, 1e-8);
  EXPECT_NEAR(states[0].position.y(), height - 1, 1e-8);
  EXPECT_LT(largestEnergyError(lift), 1e-8);
}

// Nothing is computed for what lies still; its rope is taut all the same while another ball of the same island bounces.
TEST(TautRope, StaysTautWhileWhatItHoldsRests) {
  const Trajectory fall = simulate(sceneWith(
      R"("duration": 2, "accuracy": 1e-8, "materials": {"m": {"restitution": 0.8}},
         "bodies": [{"name": "floor", "shape": {"plane": {"normal": [0, 1, 0]}}, "motion": "static", "material": "m"},
                    {"name": "hung", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0, 1, 0]},
                    {"name": "bouncing", "shape": {"sphere": {"radius": 0.1}}, "mass": 1, "position": [0.5, 1, 0],
                     "material": "m"}],
         "ropes": [{"bodyA": "hung", "anchorA": [0, 0, 0], "anchorB": [0, 2, 0], "maxLength": 1.2, "restitution": 0},
                   {"bodyA": "hung", "anchorA": [0, 0, 0], "bodyB": "bouncing", "anchorB": [0, 0, 0], "maxLength": 2}])"));
  EXPECT_EQ(eventsOf(fall, EventKind::taut).size(), 1u);
  EXPECT_TRUE(eventsOf(fall, EventKind::slack).empty());
  EXPECT_GE(eventsOf(fall, EventKind::impact).size(), 3u);
  EXPECT_NEAR(endOf(fall).position.y(), 0.8, 1e-12);
}

// A ball that hangs at rest is lifted by a push of twice its weight: its rope does not push back for an instant. By
// events, and in steps.
TEST(TautRope, LetsGoAsAPushLiftsWhatItHolds) {
  for (const char* method : {"", R"("method": {"name": "rk4", "timeStep": 0.001}, )"}) {
    const Trajectory lift = simulate(sceneWith(
        std::string(method) +
        R"("duration": 0.5, "accuracy": 1e-8, "bodies": [{"name": "hung", "shape": {"sphere": {"radius": 0.1}}, "mass": 1,
         "position": [0, 1, 0]}],
         "ropes": [{"bodyA": "hung", "anchorA": [0, 0, 0], "anchorB": [0, 2, 0], "maxLength": 1}],
         "pushes": [{"body": "hung", "point": [0, 0, 0], "force": [0, 19.62, 0], "start": 0.2, "duration": 0.3}])"));
    for (const Frame& frame : lift.frames) {
      const double t = std::max(0.0, frame.time - 0.2);
      EXPECT_NEAR(frame.states[0].position.y(), 1 + kGravity * t * t / 2, 1e-9) << frame.time;
    }
  }
}

// A ball whose rope is taut already pulls at it before it has gone the way that is left to the floor, however short
// that is: first the rope, with its direction d, then the floor, and both again as long as they close.
TEST(RopeAtItsLength, PullsBeforeAGapCloses) {
  constexpr double kRadius = 0.05, kOfRope = 0.5, kOfFloor = 0.3;
  const Vec3 along = Vec3(-0.9, 1, 0).normalized(), before(0.2, -0.8, 0.3);
  Vec3 expected = before;
  for (int i = 0; i < 100; ++i) {
    if (expected.dot(along) < 0) expected -= (1 + kOfRope) * expected.dot(along) * along;
    if (expected.y() < 0) expected.y() *= -kOfFloor;
  }
  ASSERT_GE(expected.dot(along), 0);
  for (const double accuracy : {1e-3, 1e-6, 1e-9})
    for (const double gap : {1e-11, 1e-10, 1e-9}) {
      SCOPED_TRACE(fmt::format("accuracy {} gap {} m", accuracy, gap));
      const Vec3 place(0, kRadius + gap, 0);
      const Trajectory run = simulate(sceneWith(fmt::format(
          R"("duration": 1e-4, "accuracy": {}, "gravity": [0, 0, 0], "materials": {{"m": {{"restitution": {},
          "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [
          {{"name": "floor", "shape": {{"plane": {{}}}}, "motion": "static", "material": "m"}},
          {{"name": "ball", "shape": {{"sphere": {{"radius": {}}}}}, "mass": 1, "material": "m", "position": {},
            "linearVelocity": {}}}],
          "ropes": [{{"bodyA": "ball", "anchorA": [0, 0, 0], "anchorB": {}, "maxLength": 0.4, "restitution": {}}}])",
          accuracy, kOfFloor, kRadius, vectorText(place), vectorText(before), vectorText(place + 0.4 * along),
          kOfRope)));
      // In 1e-4 s the rope's direction turns by 1e-4 at most, which no impulse is left to see.
      EXPECT_LT((endOf(run).linearVelocity - expected).norm(), 1e-6);
    }
}

}  // namespace
}  // namespace cradle
