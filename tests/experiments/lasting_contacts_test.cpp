#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "experiments/experiment.h"

// Contacts that last, and their forces, under all that moves bodies.

namespace cradle {
namespace {

std::string box(const std::string& name, const Vec3& size, double mass, const Vec3& position,
                const std::string& more = "") {
  return fmt::format(R"(, {{"name": "{}", "shape": {{"box": {{"size": {}}}}}, "mass": {}, "position": {},
    "material": "m"{}}})",
                     name, vectorText(size), mass, vectorText(position), more);
}

/// What acts on bodies of a scene "m" on the ground, whose text those of other bodies follow.
Trajectory runOnGround(const std::string& bodies, double staticFriction, double dynamicFriction,
                       const std::string& members) {
  return simulate(sceneWith(fmt::format(
      R"({}, "materials": {{"m": {{"restitution": 0, "staticFriction": {}, "dynamicFriction": {}}},
        "smooth": {{"restitution": 0, "staticFriction": 0, "dynamicFriction": 0}}}},
      "bodies": [{{"name": "ground", "motion": "static", "material": "m", "shape": {{"plane": {{}}}}}}{}])",
      members, staticFriction, dynamicFriction, bodies)));
}

/// The wrench of two bodies at a frame; zero if they do not touch.
ContactWrench wrenchOf(const Frame& frame, int bodyA, int bodyB) {
  for (const ContactWrench& wrench : frame.contacts)
    if (wrench.bodyA == bodyA && wrench.bodyB == bodyB) return wrench;
  return {};
}

/// N and N m: what lasting contacts do to a body about its centre of mass.
struct Sum {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};
Sum onBody(const Frame& frame, int body, const BodyState& state) {
  Sum sum;
  for (const ContactWrench& wrench : frame.contacts) {
    if (wrench.bodyA != body && wrench.bodyB != body) continue;
    const double sign = wrench.bodyB == body ? 1 : -1;
    sum.force += sign * wrench.force;
    sum.torque += sign * (wrench.torque + (wrench.point - state.position).cross(wrench.force));
  }
  return sum;
}

// Each carries all that is above it. Bodies at rest have the forces that the search for rest left, to 1e-6 g, and here
// to rounding of the solution.
TEST(LastingContacts, OfAStackCarryWhatIsAboveThem) {
  const Trajectory run =
      runOnGround(box("a", {1, 1, 1}, 1, {0, 0.5, 0}) + box("b", {0.8, 0.8, 0.8}, 2, {0.05, 1.4, 0}) +
                      box("c", {0.5, 0.5, 0.5}, 3, {0, 2.05, 0.1}),
                  0.5, 0.4, R"("duration": 1)");
  ASSERT_EQ(run.contacts.size(), 3u);
  for (const LastingContact& contact : run.contacts) {
    EXPECT_EQ(contact.begin, 0);
    EXPECT_EQ(contact.end, 1);
  }
  for (const Frame& frame : run.frames) {
    ASSERT_EQ(frame.contacts.size(), 3u);
    EXPECT_LT((wrenchOf(frame, 1, 0).force - Vec3(0, -6 * kGravity, 0)).norm(), 1e-9);
    EXPECT_LT((wrenchOf(frame, 1, 2).force - Vec3(0, 5 * kGravity, 0)).norm(), 1e-9);
    EXPECT_LT((wrenchOf(frame, 2, 3).force - Vec3(0, 3 * kGravity, 0)).norm(), 1e-9);
    // Each force goes through the centre of mass of what is above.
    EXPECT_LT((wrenchOf(frame, 2, 3).point - Vec3(0, 1.8, 0.1)).norm(), 1e-9);
    EXPECT_LT((wrenchOf(frame, 1, 2).point - Vec3(0.1 / 5, 1, 0.3 / 5)).norm(), 1e-9);
    EXPECT_LT((wrenchOf(frame, 1, 0).point - Vec3(0.1 / 6, 0, 0.3 / 6)).norm(), 1e-9);
    for (const ContactWrench& wrench : frame.contacts) EXPECT_LT(wrench.torque.norm(), 1e-8);
  }
}

// The ladder's face touches the ground and a smooth wall with its lower and its upper edge. Moments about the lower one
// give the force of the wall, which friction of the ground holds.
TEST(LastingContacts, OfALadderAtASmoothWallAreThoseOfStatics) {
  constexpr double a = 0.05, b = 1, degrees = 20, mass = 7;
  const double sine = std::sin(degrees * std::numbers::pi / 180), cosine = std::cos(degrees * std::numbers::pi / 180);
  const Trajectory run = runOnGround(
      box("ladder", {2 * a, 2 * b, 0.4}, mass, {a * cosine + b * sine, a * sine + b * cosine, 0},
          fmt::format(R"(, "orientation": {{"axis": [0, 0, 1], "angleDegrees": {}}})", degrees)) +
          R"(, {"name": "wall", "motion": "static", "material": "smooth", "shape": {"plane": {"normal": [1, 0, 0]}}})",
      0.5, 0.4, R"("duration": 0.5)");
  const double weight = mass * kGravity, push = weight * (b * sine - a * cosine) / (2 * b * cosine);
  for (const Frame& frame : run.frames) {
    const ContactWrench wall = wrenchOf(frame, 1, 2), ground = wrenchOf(frame, 1, 0);
    EXPECT_LT((wall.force - Vec3(-push, 0, 0)).norm(), 1e-6 * weight);
    EXPECT_LT((wall.point - Vec3(0, 2 * b * cosine, 0)).norm(), 1e-6);
    EXPECT_LT((ground.force - Vec3(push, -weight, 0)).norm(), 1e-6 * weight);
    EXPECT_LT((ground.normalForce - Vec3(0, -weight, 0)).norm(), 1e-6 * weight);
    EXPECT_LT((ground.point - Vec3(2 * b * sine, 0, 0)).norm(), 1e-6);
  }
}

// On a slope of 30 degrees, gravity being turned: friction is the coefficient times the normal force, and goes on as
// long as the block does. It stands on three times the distance to its centre of mass below that, where the resultant
// goes through it: the accelerating block does not turn.
TEST(LastingContacts, OfASlidingBlockHaveTheFrictionOfItsWeight) {
  const double cosine = std::cos(std::numbers::pi / 6), mass = 3, friction = 0.2;
  const Trajectory run =
      runOnGround(box("block", {1, 0.4, 1}, mass, {0, 0.2, 0}), 0.25, friction,
                  fmt::format(R"("duration": 0.6, "gravity": [{}, {}, 0])", 0.5 * kGravity, -cosine * kGravity));
  const double normal = mass * kGravity * cosine;
  for (const Frame& frame : run.frames) {
    const ContactWrench ground = wrenchOf(frame, 1, 0);
    EXPECT_LT((ground.normalForce - Vec3(0, -normal, 0)).norm(), 1e-6 * normal);
    EXPECT_LT((ground.force - ground.normalForce - Vec3(friction * normal, 0, 0)).norm(), 1e-6 * normal);
    EXPECT_LT(onBody(frame, 1, frame.states[0]).torque.norm(), 1e-6 * normal);
    EXPECT_NEAR(ground.point.x() - frame.states[0].position.x(), 0.2 * friction, 1e-6);
  }
}

// It lands at sqrt(2 h / g); from 0.8 s on it is lifted by more than its weight.
TEST(LastingContacts, BeginWhereABallLandsAndEndWhereItIsLifted) {
  const double height = 0.5;
  const Trajectory run = runOnGround(
      fmt::format(R"(, {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "material": "m",
        "position": [0, {}, 0]}})",
                  height + 0.1),
      0, 0,
      R"("duration": 1.5, "pushes": [{"body": "ball", "point": [0, 0, 0], "force": [0, 12, 0], "start": 0.45,
        "duration": 0.35}, {"body": "ball", "point": [0, 0, 0], "force": [0, 30, 0], "start": 0.8, "duration": 0.7}])");
  ASSERT_EQ(run.contacts.size(), 1u);
  EXPECT_NEAR(run.contacts[0].begin, std::sqrt(2 * height / kGravity), 1e-9);
  EXPECT_NEAR(*run.contacts[0].end, 0.8, 1e-12);
  for (const Frame& frame : run.frames) {
    const double normal = -wrenchOf(frame, 1, 0).force.y();
    const bool isPressed = frame.time > run.contacts[0].begin && frame.time < 0.8 - 1e-9;
    const double push = frame.time < 0.45 - 1e-9 ? 0 : 12;
    EXPECT_NEAR(normal, isPressed ? 2 * kGravity - push : 0, 1e-9) << frame.time;
  }
}

// Two balls far apart are islands in time of one group; each lands for itself.
TEST(LastingContacts, BeginExactlyInIslandsOfAGroup) {
  std::string balls;
  for (const double height : {0.5, 0.3, 0.7})
    balls += fmt::format(R"(, {{"name": "b{0}", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2, "material": "m",
      "position": [{1}, {2}, 0], "linearVelocity": [{3}, 0, 0]}})",
                         height, 10 * height, height + 0.1, height == 0.5 ? 0 : 0.5 - height);
  const Trajectory run = runOnGround(balls, 0.1, 0.1, R"("duration": 0.6)");
  ASSERT_EQ(run.contacts.size(), 3u);
  const double heights[] = {0.3, 0.5, 0.7};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(run.contacts[i].begin, std::sqrt(2 * heights[i] / kGravity), 1e-9);
    EXPECT_EQ(*run.contacts[i].end, run.frames.back().time);
  }
  for (const Frame& frame : run.frames)
    EXPECT_EQ(frame.contacts.size(),
              static_cast<std::size_t>(std::ranges::count_if(
                  run.contacts, [&](const auto& contact) { return contact.begin <= frame.time; })));
}

// In steps of one length the forces of a stack are the mean of those of the steps, and what rattles is no event.
TEST(LastingContacts, OfStepsBalanceWeights) {
  const Trajectory run = runOnGround(box("a", {1, 1, 1}, 1, {0, 0.5, 0}) + box("b", {0.8, 0.8, 0.8}, 2, {0.05, 1.4, 0}),
                                     0.5, 0.4, R"("duration": 0.5, )" + methodText("rk4", 1.0 / 480));
  ASSERT_EQ(run.contacts.size(), 2u);
  EXPECT_TRUE(eventsOf(run, EventKind::impact).empty());
  for (const LastingContact& contact : run.contacts) EXPECT_EQ(contact.begin, 0);
  for (std::size_t i = 1; i < run.frames.size(); ++i) {
    EXPECT_LT((wrenchOf(run.frames[i], 1, 0).force - Vec3(0, -3 * kGravity, 0)).norm(), 1e-4 * kGravity);
    EXPECT_LT((wrenchOf(run.frames[i], 1, 2).force - Vec3(0, 2 * kGravity, 0)).norm(), 1e-4 * kGravity);
  }
}

// A step's impulses, and those of impacts that were told, are all that changes momentum beside gravity, but for what
// the removal of overlaps takes: 3e-4 of the weight in one frame.
TEST(LastingContacts, OfStepsChangeMomentumWithTheImpacts) {
  const Trajectory run = runOnGround(
      box("a", {0.4, 0.2, 0.3}, 1, {0, 0.6, 0}, R"(, "angularVelocity": [0.3, 0.2, 1], "linearVelocity": [1, 0, 0.2])"),
      0.5, 0.4, R"("duration": 1.5, "output": {"framesPerSecond": 60}, )" + methodText("rk4", 1.0 / 960));
  for (std::size_t i = 1; i < run.frames.size(); ++i) {
    const Frame &before = run.frames[i - 1], &now = run.frames[i];
    double impulse = 0;  // N s, along y
    for (const Event& event : run.events)
      if (event.kind == EventKind::impact && event.time > before.time && event.time <= now.time + 1e-12)
        impulse += event.impulse;
    const double change = now.states[0].linearVelocity.y() - before.states[0].linearVelocity.y();
    const double force = onBody(now, 1, now.states[0]).force.y();
    EXPECT_NEAR(change, impulse + (force - kGravity) / 60, 1e-3 * kGravity / 60) << now.time;
  }
}

// A box of 10 kg lies, and is struck by a ball: it has one contact with the ground all the time, which carries its
// weight and, once it is awake, what the ball gives besides.
TEST(LastingContacts, OfStepsGoOnWhereBodiesWake) {
  const auto runAt = [](double framesPerSecond) {
    return runOnGround(box("a", {1, 1, 1}, 10, {0, 0.5, 0}) +
                           R"(, {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 0.1, "material": "m",
                             "position": [0, 2, 0]})",
                       0.5, 0.4,
                       fmt::format(R"("duration": 0.7, "output": {{"framesPerSecond": {}}}, {})", framesPerSecond,
                                   methodText("rk4", 1.0 / 480)));
  };
  const Trajectory run = runAt(85);
  std::vector<LastingContact> ofBox;
  std::ranges::copy_if(run.contacts, std::back_inserter(ofBox),
                       [](const LastingContact& contact) { return contact.bodyA == 1 && contact.bodyB == 0; });
  ASSERT_EQ(ofBox.size(), 1u);
  EXPECT_EQ(ofBox[0].begin, 0);
  EXPECT_EQ(*ofBox[0].end, run.frames.back().time);
  for (const double framesPerSecond : {60.0, 200.0}) {
    const Trajectory struck = runAt(framesPerSecond);
    ASSERT_FALSE(eventsOf(struck, EventKind::wake).empty());
    for (const Frame& frame : struck.frames)
      EXPECT_GT(-wrenchOf(frame, 1, 0).force.y(), 0.999 * 10 * kGravity) << frame.time;
  }
}

// Of 20 stacks in a heap of 60 boxes by soft contact, on a slope: awake, the mean of the sub-steps; asleep, what holds
// them still. Sub-steps leave 2e-3 of the weights while bodies come to rest.
TEST(LastingContacts, OfSoftContactBalanceWeights) {
  std::string bodies;
  for (int i = 0; i < 20; ++i)
    for (int k = 0; k < 3; ++k)
      bodies += box(fmt::format("b{}_{}", i, k), {0.5, 0.5, 0.5}, 1 + k, {1.2 * i, 0.25 + 0.5 * k, 0});
  const Vec3 gravity(1, -9.5, 0.5);
  const Trajectory run = runOnGround(
      bodies, 0.5, 0.4, fmt::format(R"("duration": 1.5, "accuracy": 1e-3, "gravity": {})", vectorText(gravity)));
  ASSERT_EQ(run.contacts.size(), 60u);
  ASSERT_EQ(eventsOf(run, EventKind::rest).size(), 60u);
  const Frame &before = run.frames[14], &after = run.frames[15], &end = run.frames.back();
  for (int i = 0; i < 60; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Vec3 change = after.states[at].linearVelocity - before.states[at].linearVelocity;
    EXPECT_LT((onBody(after, i + 1, after.states[at]).force / (1 + i % 3) + gravity - 60 * change).norm(), 1e-6) << i;
  }
  for (int i = 0; i < 20; ++i) {
    const ContactWrench ground = wrenchOf(end, 3 * i + 1, 0), lower = wrenchOf(end, 3 * i + 1, 3 * i + 2),
                        upper = wrenchOf(end, 3 * i + 2, 3 * i + 3);
    EXPECT_LT((ground.force - 6 * gravity).norm(), 0.02 * kGravity);
    EXPECT_LT((lower.force + 5 * gravity).norm(), 0.02 * kGravity);
    EXPECT_LT((upper.force + 3 * gravity).norm(), 0.02 * kGravity);
    EXPECT_LT((upper.normalForce + Vec3(0, 3 * gravity.y(), 0)).norm(), 0.02 * kGravity);
    // The resultant on the upper box goes through its centre of mass, 0.25 m above.
    const Vec3 shift(-0.25 / gravity.y() * gravity.x(), -0.25, -0.25 / gravity.y() * gravity.z());
    EXPECT_LT((upper.point - end.states[static_cast<std::size_t>(3 * i + 2)].position - shift).norm(), 0.005);
  }
}

// Balls that bounce without loss beside one that lies in a groove of two planes: each carries m g / sqrt 2.
TEST(LastingContacts, OfHardSpheresCarryWhatLiesInAGroove) {
  const double half = std::sqrt(0.5);
  const std::string planes = fmt::format(
      R"({{"name": "left", "motion": "static", "material": "m", "shape": {{"plane": {{"normal": [{0}, {0}, 0]}}}}}},
         {{"name": "right", "motion": "static", "material": "m", "shape": {{"plane": {{"normal": [-{0}, {0}, 0]}}}}}})",
      half);
  const Trajectory run = simulate(sceneWith(fmt::format(
      R"("duration": 0.5, "materials": {{"m": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}}}, "bodies": [{},
        {{"name": "lying", "material": "m", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2,
          "position": [0, {}, 0]}},
        {{"name": "bouncing", "material": "m", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1,
          "position": [0, 1, 3]}}])",
      planes, 0.1 / half)));
  EXPECT_EQ(run.header.method, "closed form between collisions");
  for (const Frame& frame : run.frames) {
    EXPECT_LT((wrenchOf(frame, 2, 0).force + 2 * kGravity * half * Vec3(half, half, 0)).norm(), 1e-9);
    EXPECT_LT((wrenchOf(frame, 2, 1).force + 2 * kGravity * half * Vec3(-half, half, 0)).norm(), 1e-9);
    EXPECT_LT((wrenchOf(frame, 2, 0).point - Vec3(-0.1 * half, 0.1 * half, 0)).norm(), 1e-9);
  }
}

// In a corner of three planes through one line, of which the steeper ones would have to pull: the floor carries all.
TEST(LastingContacts, OfHardSpheresNeverPull) {
  std::string bodies;
  for (const double degrees : {0.0, 80.0, 85.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    bodies += fmt::format(R"({}{{"name": "p{}", "motion": "static", "material": "m", "position": [0, 0, 0],
      "shape": {{"plane": {{"normal": [{}, {}, 0]}}}}}})",
                          bodies.empty() ? "" : ", ", degrees, std::sin(angle), std::cos(angle));
  }
  const double side = 0.1 * std::tan(85 * std::numbers::pi / 360);  // where the ball touches floor and the last plane
  const Trajectory run = simulate(sceneWith(fmt::format(
      R"("duration": 0.2, "materials": {{"m": {{"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}}},
      "bodies": [{}, {{"name": "lying", "material": "m", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 2,
        "position": [{}, 0.1, 0]}}])",
      bodies, side)));
  EXPECT_EQ(run.header.method, "closed form between collisions");
  for (const Frame& frame : run.frames) {
    EXPECT_LT((wrenchOf(frame, 3, 0).force - Vec3(0, -2 * kGravity, 0)).norm(), 1e-9);
    EXPECT_EQ(frame.contacts.size(), 1u);
  }
}

}  // namespace
}  // namespace cradle
