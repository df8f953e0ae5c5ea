#include "simulate/limit_events.h"

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/rk4.h"
#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kGravities[] = {0, 9.81};  // m/s^2

std::string ropeOf(const std::string& body, const Vec3& anchorB, double length, double restitution = 0) {
  return fmt::format(R"("ropes": [{{"bodyA": "{}", "anchorA": [0, 0, 0], "anchorB": {}, "maxLength": {},
    "restitution": {}}}])",
                     body, vectorText(anchorB), length, restitution);
}

std::string ballOn(const Vec3& position, const Vec3& velocity, const std::string& rope, double gravity = kGravity) {
  return fmt::format(R"("duration": 9, "gravity": [0, {}, 0], "bodies": [{}], {})", -gravity,
                     cradle::ball("ball", position, velocity), rope);
}

void takeStepOf(IslandState& island, Integrator integrate, double length) {
  integrate(island.rightHandSide, island.state, 0, length, island.step);
  prepareInterpolant(island.rightHandSide, island.step);
}

// A ball flies by an anchor on a straight line at the distance b: |x| = sqrt(L^2 - b^2) is where the rope becomes taut.
// It comes in from |x| > L only as far as the rope lets it, so it starts in the middle.
TEST(LimitEvents, FindWhereAFlightComesToTheLength) {
  for (const double speed : {0.7, 3.0, 40.0}) {
    OneIsland at(ballOn(Vec3(-0.1, 0.3, 0), Vec3(speed, 0, 0), ropeOf("ball", Vec3::Zero(), 0.5), 0));
    LimitEvents ropes(at.island);
    takeStepOf(at.island, rk4, 1);
    const auto change = ropes.firstChange(at.island.step);
    ASSERT_TRUE(change) << speed;
    EXPECT_NEAR(change->fraction, 0.5 / speed, 2e-12) << speed;  // (0.4 + 0.1) / v; roots are found to 1e-12
    EXPECT_EQ(change->limit, 0u);
    VectorX state;
    interpolate(at.island.step, change->fraction, state);
    EXPECT_NEAR(ropes.margin(*change, state), 0, 1e-12 * speed / 0.5);
    interpolate(at.island.step, 0.9 * change->fraction, state);
    EXPECT_NEAR(ropes.margin(*change, state), 1 - std::hypot(0.35, 0.3) / 0.5,
                1e-12 * speed / 0.5);  // the slack, in lengths
  }
}

// A throw that turns back before the length, within the step, and one that does not quite: v^2 / 2 g = 0.5 m.
TEST(LimitEvents, FindFlightsThatReachTheLengthForAnInstant) {
  for (const double part : {0.9999, 1.0001}) {
    const double speed = std::sqrt(2 * kGravity * 0.5) * std::sqrt(part);
    OneIsland at(ballOn(Vec3::Zero(), Vec3(0, speed, 0), ropeOf("ball", Vec3::Zero(), 0.5)));
    LimitEvents ropes(at.island);
    takeStepOf(at.island, rk4, 1.5 * speed / kGravity);
    const auto change = ropes.firstChange(at.island.step);
    ASSERT_EQ(change.has_value(), part > 1);
    if (change) {
      // v t - g t^2 / 2 = L, the earlier root
      const double time = (speed - std::sqrt(speed * speed - 2 * kGravity * 0.5)) / kGravity;
      // 1e-12 of the step; and the rounding of 0.5 m, at a speed that is a hundredth of the start's.
      EXPECT_NEAR(change->fraction * at.island.step.timeStep, time, 1e-13 + 2e-16 / (0.01 * speed));
    }
  }
}

// Of two ropes the one that becomes taut first.
TEST(LimitEvents, AreInTheOrderOfTime) {
  OneIsland at(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [)" +
               cradle::ball("one", Vec3::Zero(), Vec3(1, 0, 0)) + ", " +
               cradle::ball("two", Vec3(0, 5, 0), Vec3(0, 0, 2)) + R"(], "ropes": [
    {"bodyA": "one", "anchorB": [0, 0, 0], "maxLength": 0.4}, {"bodyA": "two", "anchorB": [0, 5, 0], "maxLength": 0.6}])");
  LimitEvents ropes(at.island);
  takeStepOf(at.island, rk4, 1);
  const auto change = ropes.firstChange(at.island.step);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->limit, 1u);
  EXPECT_NEAR(change->fraction, 0.3, 2e-12);
}

// An anchor at r = 0.3 m on a body that spins about its centre, D = 0.8 m from the fixed end: by the law of cosines the
// rope of 1 m is taut at cos(phi) = (D^2 + r^2 - L^2) / (2 D r), phi the angle between the arm and the fixed end. The
// interpolant of orientations has an error of (w h)^4 / 384 rad.
TEST(LimitEvents, FollowAnchorsThatTurn) {
  OneIsland at(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [{"name": "box", "collision": "none",
      "shape": {"box": {"size": [0.7, 0.7, 0.1]}}, "mass": 2, "angularVelocity": [0, 0, 3]}],
    "ropes": [{"bodyA": "box", "anchorA": [0.3, 0, 0], "anchorB": [0.8, 0, 0], "maxLength": 1}])");
  const double turn = std::acos((0.64 + 0.09 - 1) / (2 * 0.8 * 0.3));
  setOrientation(at.state(), 0, rotationAbout(Vec3::UnitZ(), turn - 0.1));
  LimitEvents ropes(at.island);
  takeStepOf(at.island, rk4, 0.1);
  const auto change = ropes.firstChange(at.island.step);
  ASSERT_TRUE(change);
  EXPECT_NEAR(change->fraction * 0.3, 0.1, std::pow(0.3, 4) / 384);
}

/// Two boxes that a rope between their corners joins, at its length, while both move and turn.
OneIsland stretched(double restitution) {
  return OneIsland(fmt::format(R"("duration": 9, "gravity": [0, 0, 0], "bodies": [
    {{"name": "a", "collision": "none", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "mass": 2,
      "orientation": {{"axis": [1, 2, 3], "angleDegrees": 40}}, "linearVelocity": [1, 0.5, 0],
      "angularVelocity": [0.3, -1, 2]}},
    {{"name": "b", "collision": "none", "shape": {{"box": {{"size": [0.3, 0.5, 0.1]}}}}, "mass": 5,
      "position": [-1, 0.2, 0.4], "angularVelocity": [1, 1, -0.5]}}],
    "ropes": [{{"bodyA": "a", "anchorA": [0.2, 0.1, -0.3], "bodyB": "b", "anchorB": [0.15, -0.25, 0.05],
      "restitution": {}}}])",
                               restitution));
}

struct Ends {
  Vec3 armA, armB, along;  // m, m, unit from B to A; world
  double lengthening;      // m/s
};

Ends endsOf(const VectorX& state) {
  Ends ends;
  ends.armA = orientation(state, 0) * Vec3(0.2, 0.1, -0.3), ends.armB = orientation(state, 1) * Vec3(0.15, -0.25, 0.05);
  ends.along = (centerOfMass(state, 0) + ends.armA - centerOfMass(state, 1) - ends.armB).normalized();
  const Vec3 a = linearVelocity(state, 0) + Vec3(angularVelocity(state, 0)).cross(ends.armA);
  const Vec3 b = linearVelocity(state, 1) + Vec3(angularVelocity(state, 1)).cross(ends.armB);
  ends.lengthening = ends.along.dot(a - b);
  return ends;
}

// p = (1 + e) v / (1/m + 1/m' + (r x n).I^-1 (r x n) + ...), against the line of the rope on either body.
TEST(LimitEvents, PullWithTheImpulseOfNewtonsRestitution) {
  for (const double restitution : {0.0, 0.6}) {
    OneIsland at = stretched(restitution);
    const VectorX before = at.state();
    const Ends ends = endsOf(before);
    ASSERT_GT(ends.lengthening, 0.5);
    const Mat3 inertiaA = worldInertia(at.mechanism().bodies[0], 0, before),
               inertiaB = worldInertia(at.mechanism().bodies[1], 1, before);
    const Vec3 leverA = ends.armA.cross(ends.along), leverB = ends.armB.cross(ends.along);
    const double impulse =
        (1 + restitution) * ends.lengthening /
        (1 / 2.0 + 1 / 5.0 + leverA.dot(inertiaA.inverse() * leverA) + leverB.dot(inertiaB.inverse() * leverB));
    const double kinetic = kineticEnergy(at.mechanism().bodies, before);

    LimitEvents ropes(at.island);
    EXPECT_TRUE(ropes.resolve(0.5, at.state()));
    constexpr double kRounding = 1e-14;  // of velocities below 5 m/s
    EXPECT_NEAR(endsOf(at.state()).lengthening, -restitution * ends.lengthening, kRounding);
    EXPECT_LT((linearVelocity(at.state(), 0) - linearVelocity(before, 0) + impulse / 2 * ends.along).norm(), kRounding);
    EXPECT_LT((linearVelocity(at.state(), 1) - linearVelocity(before, 1) - impulse / 5 * ends.along).norm(), kRounding);
    EXPECT_LT(
        (angularVelocity(at.state(), 0) - angularVelocity(before, 0) + inertiaA.inverse() * leverA * impulse).norm(),
        10 * kRounding);
    EXPECT_LT(
        (angularVelocity(at.state(), 1) - angularVelocity(before, 1) - inertiaB.inverse() * leverB * impulse).norm(),
        10 * kRounding);
    EXPECT_NEAR(impactEnergy(at.state()), kinetic - kineticEnergy(at.mechanism().bodies, at.state()), kRounding);
    // Nothing pulls at the rope afterwards but what the ends' turning does: it is a rod if it does not rebound.
    EXPECT_EQ(at.mechanism().constraints.size(), restitution > 0 ? 0u : 1u);

    const std::vector<Event> events = at.island.log.take();
    ASSERT_THAT(events, SizeIs(1));
    EXPECT_EQ(events[0].kind, EventKind::taut);
    EXPECT_EQ(events[0].time, 0.5);
    EXPECT_NEAR(events[0].impulse, impulse, kRounding);
    EXPECT_LT((events[0].normal + ends.along).norm(), kRounding);
  }
}

// As a contact the rope closes as fast as it lengthens, by what is slack.
TEST(LimitEvents, CloseAsContactsWhereTheyLengthen) {
  OneIsland at = stretched(0.6);
  centerOfMass(at.state(), 0) -= 0.1 * endsOf(at.state()).along;
  const ImpactContact contact = LimitEvents::contactOf(at.island.assembly.limits[0], at.state());
  EXPECT_NEAR(openingSpeed(contact.contact, at.state()), -endsOf(at.state()).lengthening, 1e-14);
  EXPECT_NEAR(contact.contact.separation, 0.1, 1e-15);
  EXPECT_EQ(contact.material.restitution, 0.6);
  EXPECT_EQ(contact.material.staticFriction, 0);
}

// A ball on a rope of length L at the angle phi from the top of its circle: it is pulled by m (v^2 / L - g cos(phi)). A
// rope that would push lets go, and one that pulls stays a rod.
TEST(LimitEvents, LetGoWhereTheTensionEnds) {
  const double length = 0.7, phi = 0.6;
  const double slackSpeed = std::sqrt(kGravity * length * std::cos(phi));
  for (const double part : {0.99, 1.01}) {
    OneIsland at(ballOn(Vec3(0, -length, 0), Vec3(1, 0, 0), ropeOf("ball", Vec3::Zero(), length)));
    LimitEvents ropes(at.island);
    ASSERT_TRUE(ropes.resolve(0, at.state()));
    ASSERT_THAT(at.mechanism().constraints, SizeIs(1));
    EXPECT_EQ(std::get<RodConstraint>(at.mechanism().constraints[0].kind).length, length);
    EXPECT_NEAR(ropes.margin({0.5, 0}, at.state()), 1 / length + kGravity, 1e-13);  // N: of 1 kg, in parts of 1 N
    centerOfMass(at.state(), 0) = length * Vec3(std::sin(phi), std::cos(phi), 0);
    linearVelocity(at.state(), 0) = part * slackSpeed * Vec3(-std::cos(phi), std::sin(phi), 0);
    at.island.log.take();
    EXPECT_EQ(ropes.resolve(1, at.state()), part < 1);
    EXPECT_THAT(at.mechanism().constraints, SizeIs(part < 1 ? 0 : 1));
    const std::vector<Event> events = at.island.log.take();
    ASSERT_THAT(events, SizeIs(part < 1 ? 1 : 0));
    if (part < 1) {
      EXPECT_EQ(events[0].kind, EventKind::slack);
    }
  }
}

// Without gravity, m v^2 / L = 1e-15 N is no tension: the rope is not pulled at, to be released in the same instant,
// over and over. A tension that is one holds.
TEST(LimitEvents, AreNotPulledAtByWhatIsNoTension) {
  const double length = 0.7;
  for (const double tension : {1e-15, 1e-3}) {
    const double speed = std::sqrt(tension * length);  // of 1 kg
    OneIsland at(ballOn(Vec3(0, -length, 0), Vec3(speed, 0, 0), ropeOf("ball", Vec3::Zero(), length), 0));
    LimitEvents ropes(at.island);
    const bool isPulled = tension > 1e-9;
    EXPECT_EQ(ropes.resolve(0, at.state()), isPulled);
    EXPECT_THAT(at.mechanism().constraints, SizeIs(isPulled ? 1 : 0));
    EXPECT_FALSE(ropes.resolve(0, at.state()));
    EXPECT_THAT(at.mechanism().constraints, SizeIs(isPulled ? 1 : 0));
  }
}

// The ball rises on its rope, v^2 = v0^2 - 2 g L (cos(phi) + 1) from the bottom: its tension ends where v^2 / L =
// g cos(phi), cos(phi) = (v0^2 / (g L) - 2) / 3. The margin is zero there, and in parts of the tension at the step's
// start.
TEST(LimitEvents, FindWhereInAStepTheTensionEnds) {
  const double length = 0.7, start2 = 3.2 * kGravity * length, cosine = (3.2 - 2) / 3;
  OneIsland at(ballOn(Vec3(0, -length, 0), Vec3(std::sqrt(start2), 0, 0), ropeOf("ball", Vec3::Zero(), length)));
  LimitEvents ropes(at.island);
  ASSERT_TRUE(ropes.resolve(0, at.state()));
  const auto placeAt = [&](double height, VectorX& state) {  // of the cosine, on the way up
    const double sine = std::sqrt(1 - height * height);
    centerOfMass(state, 0) = length * Vec3(sine, height, 0);
    linearVelocity(state, 0) = std::sqrt(start2 - 2 * kGravity * length * (height + 1)) * Vec3(-height, sine, 0);
  };
  placeAt(0, at.state());  // where the tension is v^2 / L = 1.2 g
  takeStepOf(at.island, dop853, 0.25);
  ASSERT_GT(centerOfMass(at.island.step.state, 0).y(), 0.5 * length);
  const auto change = ropes.firstChange(at.island.step);
  ASSERT_TRUE(change);
  VectorX state;
  interpolate(at.island.step, change->fraction, state);
  EXPECT_NEAR(centerOfMass(state, 0).y() / length, cosine, 0.03);  // found by chords over quarters of the step
  placeAt(cosine, state);
  EXPECT_NEAR(ropes.margin(*change, state), 0, 1e-14);
  placeAt(0, state);
  EXPECT_NEAR(ropes.margin(*change, state), 1, 1e-13);
}

// Two balls rise on ropes: with v0^2 = 2.6 g L the tension ends at the cosine 0.2, earlier than with 3.2 g L.
TEST(LimitEvents, FindTheFirstOfTensionsThatEnd) {
  const double length = 0.7;
  OneIsland at(fmt::format(R"("duration": 9, "bodies": [{}, {}], "ropes": [
      {{"bodyA": "slow", "anchorB": [0, 0, 0], "maxLength": {}}}, {{"bodyA": "fast", "anchorB": [5, 0, 0],
       "maxLength": {}}}])",
                           cradle::ball("slow", Vec3(0, -length, 0), Vec3(1, 0, 0)),
                           cradle::ball("fast", Vec3(5, -length, 0), Vec3(1, 0, 0)), length, length));
  LimitEvents ropes(at.island);
  ASSERT_TRUE(ropes.resolve(0, at.state()));
  for (const Eigen::Index body : {0, 1}) {
    centerOfMass(at.state(), body) = Vec3(5.0 * static_cast<double>(body) + length, 0, 0);
    linearVelocity(at.state(), body) = Vec3(0, std::sqrt((body == 0 ? 0.6 : 1.2) * kGravity * length), 0);
  }
  takeStepOf(at.island, dop853, 0.2);
  const auto change = ropes.firstChange(at.island.step);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->limit, 0u);
}

// Without gravity nothing pulls at a rope that has stopped a ball: it holds by impulses alone, and is no rod.
TEST(LimitEvents, BecomeRodsOnlyIfSmoothForcesPull) {
  for (const double gravity : kGravities) {
    OneIsland at(ballOn(Vec3(0, -0.5, 0), Vec3(0, -2, 0), ropeOf("ball", Vec3::Zero(), 0.5), gravity));
    LimitEvents ropes(at.island);
    EXPECT_TRUE(ropes.resolve(0, at.state()));
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), 0, 1e-15);
    EXPECT_THAT(at.mechanism().constraints, SizeIs(gravity > 0 ? 1 : 0));
    EXPECT_NEAR(impactEnergy(at.state()), 2, 1e-14);  // m v^2 / 2
  }
}

// A rebound with e v that lasts less than two steps is not resolved: e v < 2 g h, here with v = 2 m/s.
TEST(LimitEvents, DoNotReboundWithinTwoSteps) {
  for (const double part : {0.99, 1.01}) {
    OneIsland at(ballOn(Vec3(0, -0.5, 0), Vec3(0, -2, 0), ropeOf("ball", Vec3::Zero(), 0.5, 0.25)));
    LimitEvents ropes(at.island);
    ropes.setTimeStep(0.5 / (2 * kGravity) / part);
    EXPECT_TRUE(ropes.resolve(0, at.state()));
    EXPECT_NEAR(linearVelocity(at.state(), 0).y(), part < 1 ? 0 : 0.5, 1e-14);
  }
}

// An impact takes taut ropes as members, and gives them back as rods unless their ends come together.
TEST(LimitEvents, GoSlackInImpactsThatShortenThem) {
  for (const double after : {-1.0, 0.0}) {
    OneIsland at(ballOn(Vec3(0, -0.5, 0), Vec3(1, 0, 0), ropeOf("ball", Vec3::Zero(), 0.5)));
    LimitEvents ropes(at.island);
    ASSERT_TRUE(ropes.resolve(0, at.state()));
    std::vector<ImpactContact> members = ropes.beginImpact(at.state());
    ASSERT_THAT(members, SizeIs(1));
    EXPECT_THAT(at.mechanism().constraints, IsEmpty());
    linearVelocity(at.state(), 0).y() = -after;
    at.island.log.take();
    ropes.endImpact(0, members, at.state());
    EXPECT_THAT(at.mechanism().constraints, SizeIs(after < 0 ? 0 : 1));
    EXPECT_THAT(at.island.log.take(), SizeIs(after < 0 ? 1 : 0));
  }
}

// Within reach of a contact step is what both ends could close by in it, twice over: here 2 m/s x 0.01 s x 2, and a
// thousandth of the length.
TEST(LimitEvents, AreWithinReachOfAStepByTheirSpeeds) {
  for (const double part : {0.99, 1.01}) {
    const double slack = part * (0.04 + 1e-3);
    OneIsland at(ballOn(Vec3(0, -1 + slack, 0), Vec3(2, 0, 0), ropeOf("ball", Vec3::Zero(), 1)));
    LimitEvents ropes(at.island);
    EXPECT_THAT(ropes.withinReach(at.state(), at.state(), 0.01), SizeIs(part < 1 ? 1 : 0));
  }
}

}  // namespace
}  // namespace cradle
