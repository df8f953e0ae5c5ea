#include "simulate/events/contact_changes.h"

#include <gmock/gmock.h>

#include <cmath>

#include "dynamics/integrators/dop853.h"
#include "simulate/events/contact_classification.h"
#include "simulate/events/on_plane.h"

namespace cradle {
namespace {

using testing::SizeIs;

using Change = ContactChange::Kind;

/// A smooth ball on top of a smooth fixed one; their centres are 1 m apart.
const char* const kTwoBalls = R"({"name": "dome", "shape": {"sphere": {"radius": 0.8}}, "motion": "static",
    "material": "smooth", "position": [0, 1, 0]},
  {"name": "ball", "shape": {"sphere": {"radius": 0.2}}, "mass": 3, "material": "smooth", "position": [0, 2, 0]})";

/// Where it is after a slide from the top, for the cosine of its place: v^2 = 2 g R (1 - cos).
void slideTo(double cosine, VectorX& state) {
  const double sine = std::sqrt(1 - cosine * cosine);
  centerOfMass(state, 0) = Vec3(sine, 1 + cosine, 0);
  linearVelocity(state, 0) = std::sqrt(2 * kGravity * (1 - cosine)) * Vec3(cosine, -sine, 0);
}

// N = m (g cos - v^2 / R) = m g (3 cos - 2): it leaves at 2/3. Margins are in parts of the force m g of the start.
TEST(ContactChanges, AreReleasesWhereABallLeavesADome) {
  OnPlane at(kTwoBalls);
  slideTo(0.9, at.state());
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(1));
  VectorX state = at.state();
  for (const double cosine : {0.95, 0.8, 2.0 / 3, 0.6}) {
    slideTo(cosine, state);
    EXPECT_NEAR(at.active.margin({Change::release, 0, 0}, state), 3 * cosine - 2, 1e-14) << cosine;
  }
}

// On the interpolant of a step, which is of degree 7: what it leaves out is (h sqrt(g / R))^8 / 8! of R.
TEST(ContactChanges, FindTheReleaseInsideAStep) {
  OnPlane at(kTwoBalls);
  slideTo(0.75, at.state());
  at.classify();
  dop853(at.island.rightHandSide, at.state(), 0, 0.1, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  const auto change = at.active.firstChange();
  ASSERT_TRUE(change);
  EXPECT_EQ(change->kind, Change::release);
  VectorX state;
  interpolate(at.island.step, change->fraction, state);
  EXPECT_NEAR(centerOfMass(state, 0).y() - 1, 2.0 / 3, std::pow(0.1 * std::sqrt(kGravity), 8) / 40320);

  OnPlane before(kTwoBalls);
  slideTo(0.95, before.state());
  before.classify();
  dop853(before.island.rightHandSide, before.state(), 0, 0.01, before.island.step);
  prepareInterpolant(before.island.rightHandSide, before.island.step);
  EXPECT_FALSE(before.active.firstChange());
}

// A ball that rolls on the slope and slides: T = mu N - j / (1 + j) m g sin is left of its friction, in parts of the
// force m g' for the effective mass of the normal direction, m.
TEST(ContactChanges, AreSlipsWhereFrictionIsUsedUp) {
  const double tangent = 1.2, cosine = 1 / std::hypot(1, tangent);
  OnPlane at(std::string(kBall) + "}", slopeOf(tangent));
  at.classify();
  const double left = cosine * (kStaticFriction - 0.3 / 1.3 * tangent);
  EXPECT_NEAR(at.active.margin({Change::slip, 0, 0}, at.state()), left, 1e-14);
}

// What slides sticks where the velocity of the surfaces, v + w r here, ends.
TEST(ContactChanges, AreSticksWhereTheSlidingEnds) {
  OnPlane at(std::string(kBall) + R"(, "linearVelocity": [1, 0, 0]})");
  at.classify();
  VectorX state = at.state();
  for (const double slip : {0.3, -0.1}) {
    angularVelocity(state, 0).z() = (slip - 1) / 0.2;
    EXPECT_NEAR(at.active.margin({Change::stick, 0, 0}, state), slip, 1e-15);
  }
}

// Friction mu' g m slows the ball down and turns it: the slip v falls by mu' g (1 + 1 / j), and ends after
// v / (mu' g (1 + 1 / j)).
TEST(ContactChanges, FindTheEndOfSlidingInsideAStep) {
  OnPlane at(std::string(kBall) + R"(, "linearVelocity": [1, 0, 0]})");
  at.classify();
  dop853(at.island.rightHandSide, at.state(), 0, 0.15, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  const auto change = at.active.firstChange();
  ASSERT_TRUE(change);
  EXPECT_EQ(change->kind, Change::stick);
  // The velocity is straight in time, on the interpolant too: located to 1e-11 of the step.
  EXPECT_NEAR(change->fraction * 0.15, 1 / (kDynamicFriction * kGravity * (1 + 1 / 0.3)), 1e-11);
}

// Of two balls the slower one sticks first, whichever is the first of the bodies.
TEST(ContactChanges, AreTheFirstOfAll) {
  for (const auto& [speed, other] : {std::pair{1.0, 0.8}, {0.8, 1.0}}) {
    std::string second = kBall;
    second.replace(second.find("ball"), 4, "other");
    OnPlane at(kBall + fmt::format(R"(, "linearVelocity": [{}, 0, 0]}}, )", speed) + second +
               fmt::format(R"(, "linearVelocity": [0, 0, {}]}})", other));
    centerOfMass(at.state(), 1).z() = 3;
    at.classify();
    dop853(at.island.rightHandSide, at.state(), 0, 0.15, at.island.step);
    prepareInterpolant(at.island.rightHandSide, at.island.step);
    const auto change = at.active.firstChange();
    ASSERT_TRUE(change);
    EXPECT_EQ(at.contacts()[change->contact].centerA.body, speed < other ? 0 : 1);
  }
}

/// A smooth box of 0.2 m that slides with 1 m/s over the edge of a smooth table, at x = 0.5 m. Its front corners are a
/// way (m) before it.
struct OverAnEdge : OnPlane {
  explicit OverAnEdge(double way)
      : OnPlane(R"({"name": "table", "shape": {"box": {"size": [1, 0.2, 1]}}, "motion": "static", "material": "smooth",
          "position": [0, 1, 0]}, {"name": "box", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "mass": 1,
          "material": "smooth", "position": [0, 1.2, 0], "linearVelocity": [1, 0, 0]})") {
    centerOfMass(state(), 0).x() = 0.4 - way;
    classify();
  }
  /// One of the contacts at the front.
  std::size_t front() {
    std::size_t found = 0;
    for (std::size_t i = 0; i < contacts().size(); ++i)
      if (contacts()[i].centerA.point.x() > 0) found = i;
    return found;
  }
};

// Beyond the border of a face its nearest point is as far as the corner is beyond it; leaving is to be there by half of
// the touch tolerance, 1e-9 times the part that is left of that.
TEST(ContactChanges, AreLeavesBeyondTheBorderOfAFace) {
  OverAnEdge at(0.01);
  ASSERT_THAT(at.contacts(), SizeIs(4));
  VectorX state = at.state();
  for (const double part : {-1e9, 0.5, 1.0, 1.5, 1e3}) {
    centerOfMass(state, 0).x() = 0.4 + part * at.tolerances.leaving;
    // Places of 0.5 m are rounded to 1e-16 m, 1e-4 of the distance.
    EXPECT_NEAR(at.active.margin({Change::leave, 0, at.front()}, state), 1e-9 * std::max(-1.0, 1 - std::max(0.0, part)),
                1e-12)
        << part;
  }
}

TEST(ContactChanges, FindWhereABoxComesToTheBorder) {
  for (const double way : {0.004, 0.02}) {
    OverAnEdge at(way);
    dop853(at.island.rightHandSide, at.state(), 0, 0.01, at.island.step);
    prepareInterpolant(at.island.rightHandSide, at.island.step);
    const auto change = at.active.firstChange();
    ASSERT_EQ(change.has_value(), way < 0.01);
    if (!change) continue;
    EXPECT_EQ(change->kind, Change::leave);
    EXPECT_GT(at.contacts()[change->contact].centerA.point.x(), 0);
    EXPECT_NEAR(change->fraction * 0.01, way, 2 * at.tolerances.leaving);
  }
}

// The normal force at the end of a step without changes: m g (3 cos - 2) of the ball on the dome.
TEST(ContactChanges, KnowTheNormalForceAtTheEndOfAStep) {
  OnPlane at(kTwoBalls);
  slideTo(0.95, at.state());
  at.classify();
  ConstraintSolver solver(at.mechanism().constraints, at.mechanism().bodies);
  std::vector<BodyFrame> frames;
  findBodyFrames(at.mechanism().bodies, at.state(), frames);
  const std::vector<Contact> touching = at.contactsWithin(at.tolerances.touch);
  std::vector<ContactConstraint> active;  // a classification asks for the forces without contact
  std::swap(active, at.mechanism().contacts);
  const auto records = classifyContacts({touching, {}, frames, false, at.tolerances}, solver, at.island).active;
  std::swap(active, at.mechanism().contacts);
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_NEAR(1 / records[0].mass, 1 / 3.0, 1e-15);
  dop853(at.island.rightHandSide, at.state(), 0, 0.01, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  ContactChanges changes(at.island, at.tolerances);
  ASSERT_FALSE(changes.first(records));
  const double cosine = centerOfMass(at.island.step.state, 0).y() - 1;
  EXPECT_NEAR(changes.normalForceAtEnd(0, records), 3 * kGravity * (3 * cosine - 2), 1e-8);  // after a step's error
}

// A heavy body goes away with v and draws a box by a spring, with k v t: that the four corners stick, whose forces are
// not unique, ends where it exceeds mu m g. It is found
// where forces lack a millionth of the accelerations, 1e-6 m g / (k v) later.
TEST(ContactChanges, AreOfAllIndeterminateContactsWhereNoForcesKeepThem) {
  OnPlane at(std::string(kBox) + R"(}, {"name": "tractor", "shape": {"sphere": {"radius": 0.1}}, "mass": 1e9,
               "collision": "none", "position": [1, 0.1, 0], "linearVelocity": [2, 0, 0]})",
             R"("gravity": [0, -9.81, 0], "springs": [{"bodyA": "box", "anchorA": [0, 0, 0], "bodyB": "tractor",
               "anchorB": [0, 0, 0], "stiffness": 100, "restLength": 1}])");
  at.mechanism().pushes = {{{1, Vec3::Zero()}, Vec3(0, 1e9 * kGravity, 0)}};  // against its weight
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  const double expected = kStaticFriction * 3 * kGravity / (100 * 2);
  dop853(at.island.rightHandSide, at.state(), 0, 0.1, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  const auto change = at.active.firstChange();
  ASSERT_TRUE(change);
  EXPECT_EQ(change->kind, Change::redundant);
  EXPECT_NEAR(change->fraction * 0.1, expected, 1.001e-6 * expected / kStaticFriction);
}

// A pillar of 3 kg, of half widths a and of height 2 h, h / a = 3, under gravity that pulls sideways, f in x and in z:
// a corner is idle where 3 (f + f) > g. A tractor draws the pillar back along x by k v t, through its middle, until 3
// (2 f
// - k v t / m) = g. The corner then begins to carry 3 k v / 4 a second; it is told at 1e-7 of the force on one.
TEST(ContactChanges, AreOfAnIdleContactThatComesToCarryLoad) {
  const double sideways = 0.2 * kGravity;
  OnPlane at(R"({"name": "pillar", "shape": {"box": {"size": [0.2, 0.6, 0.2]}}, "mass": 3, "position": [0, 0.3, 0],
               "material": "rough"}, {"name": "tractor", "shape": {"sphere": {"radius": 0.1}}, "mass": 1e9,
               "collision": "none", "position": [-1, 0.3, 0], "linearVelocity": [-2, 0, 0]})",
             fmt::format(R"("gravity": [{0}, -9.81, {0}], "springs": [{{"bodyA": "pillar", "anchorA": [0, 0, 0],
               "bodyB": "tractor", "anchorB": [0, 0, 0], "stiffness": 6, "restLength": 1}}])",
                         sideways));
  at.mechanism().pushes = {{{1, Vec3::Zero()}, 1e9 * Vec3(-sideways, kGravity, -sideways)}};  // against its weight
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(3));
  const double expected = (0.4 - 1 / 3.0) * kGravity * 3 / (6 * 2);
  dop853(at.island.rightHandSide, at.state(), 0, 0.5, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  const auto change = at.active.firstChange();
  ASSERT_TRUE(change);
  EXPECT_EQ(change->kind, Change::load);
  EXPECT_NEAR(change->fraction * 0.5, expected, 1e-7 * 3 * kGravity / (3 * 6 * 2 / 4.0));
}

// A capsule along x rolls along z on the floor and slides along a wall, x = 0. Friction of the floor may hold it along
// x as well as the wall: of gravity's push F along x the rows take a part by the wall, of the sign of F. Where F leads
// away from the wall, that pulls, and its friction would drive the capsule.
TEST(ContactChanges, AreOfIndeterminateContactsThatFrictionWouldDrive) {
  for (const double push : {1.0, -1.0}) {
    OnPlane at(R"({"name": "wall", "shape": {"plane": {}}, "motion": "static", "material": "rough",
        "orientation": {"axis": [0, 0, 1], "angleDegrees": 90}},
      {"name": "capsule", "shape": {"capsule": {"radius": 0.1, "length": 0.4}}, "mass": 2, "material": "rough",
        "position": [-0.3, 0.1, 0], "orientation": {"axis": [0, 0, 1], "angleDegrees": 90},
        "linearVelocity": [0, 0, 0.5], "angularVelocity": [5, 0, 0]})",
               R"("gravity": [1, -9.81, 0])");
    at.classify();
    ASSERT_THAT(at.contacts(), SizeIs(3));
    at.mechanism().gravity.x() = push;
    dop853(at.island.rightHandSide, at.state(), 0, 0.01, at.island.step);
    prepareInterpolant(at.island.rightHandSide, at.island.step);
    const auto change = at.active.firstChange();
    EXPECT_EQ(change.has_value(), push < 0);
    EXPECT_TRUE(!change || change->kind == Change::redundant);
  }
}

}  // namespace
}  // namespace cradle
