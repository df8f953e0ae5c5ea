#include "simulate/events/active_contacts.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "dynamics/integrators/dop853.h"
#include "math/rotation.h"
#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StrEq;

constexpr double kStaticFriction = 0.5, kDynamicFriction = 0.3;
using Change = ContactChange::Kind;

/// Gravity over a slope that falls along x with that tangent, y out of it.
std::string slopeOf(double tangent) {
  const double cosine = 1 / std::hypot(1, tangent);
  return fmt::format(R"("gravity": [{}, {}, 0])", kGravity * tangent * cosine, -kGravity * cosine);
}

/// What lies on the plane y = 0, of materials with friction and without.
struct OnPlane : OneIsland {
  explicit OnPlane(const std::string& bodies, const std::string& more = R"("gravity": [0, -9.81, 0])")
      : OneIsland(R"("duration": 1, "materials": {
          "rough": {"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.3},
          "smooth": {"restitution": 0, "staticFriction": 0, "dynamicFriction": 0}}, "bodies": [
          {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"}, )" +
                  bodies + "], " + more),
        tolerances(eventTolerancesOf(eventScalesOf(island))),
        active(island, tolerances),
        solver(mechanism().constraints, mechanism().bodies) {}

  void classify(const std::optional<ContactChange>& change = std::nullopt) {
    active.release(change);
    if (solver.hasConstraints()) solver.factorize(state());
    active.classify(contactsWithin(tolerances.touch), solver);
  }
  const std::vector<ContactConstraint>& contacts() { return mechanism().contacts; }
  /// N, m/s^2: what acts now.
  double normalForces() {
    double sum = 0;
    for (const ContactForce& force : island.equations.contactForces()) sum += force.normal;
    return sum;
  }
  Vec3 acceleration(int body) {
    island.equations.evaluate(state(), derivative);
    return linearVelocity(derivative, body);
  }

  EventTolerances tolerances;
  ActiveContacts active;
  ConstraintSolver solver;
  VectorX derivative;
};

const char* const kBox = R"({"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 3,
  "position": [0, 0.1, 0], "material": "rough")";

/// A ball of 1 kg and 0.2 m with 0.3 m r^2 about z, the axis that it rolls about on the slope.
const char* const kBall = R"({"name": "ball", "shape": {"sphere": {"radius": 0.2}}, "mass": 1, "material": "rough",
  "centerOfMass": [0, 0, 0], "inertiaTensor": [[0.014, 0, 0], [0, 0.01, 0], [0, 0, 0.012]], "position": [0, 0.2, 0])";

const auto isOf = [](ContactMotion motion) { return Field(&ContactConstraint::motion, motion); };

TEST(ActiveContacts, StickOnSlopesBelowTheAngleOfFriction) {
  OnPlane at(std::string(kBox) + "}", slopeOf(0.99 * kStaticFriction));
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  EXPECT_THAT(at.contacts(), Each(isOf(ContactMotion::sticking)));
  EXPECT_LT(at.acceleration(0).norm(), 1e-13);
  EXPECT_NEAR(at.normalForces(), 3 * kGravity / std::hypot(1, 0.99 * kStaticFriction), 1e-12);
}

// Above it they slide downwards: a = g (sin - mu' cos), with the dynamic friction mu'.
TEST(ActiveContacts, SlideDownwardsAboveTheAngleOfFriction) {
  const double tangent = 1.01 * kStaticFriction;
  OnPlane at(std::string(kBox) + "}", slopeOf(tangent));
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  EXPECT_THAT(at.contacts(),
              Each(AllOf(isOf(ContactMotion::sliding), Field(&ContactConstraint::friction, kDynamicFriction))));
  for (const ContactConstraint& contact : at.contacts())
    EXPECT_LT((contact.slidingDirection - Vec3::UnitX()).norm(), 1e-9);
  const Vec3 expected((tangent - kDynamicFriction) * kGravity / std::hypot(1, tangent), 0, 0);
  EXPECT_LT((at.acceleration(0) - expected).norm(), 1e-12);
}

// A block of 0.4 m that slides forward tips over its front edge if its friction has the longer arm: mu' 0.2 m, against
// half of its length. The rear corners carry nothing then.
TEST(ActiveContacts, OfASlidingBlockAreThoseThatItsFrictionLeaves) {
  for (const double half : {0.0595, 0.0605}) {
    OnPlane at(fmt::format(R"({{"name": "block", "shape": {{"box": {{"size": [{}, 0.4, 0.6]}}}}, "mass": 3,
      "position": [0, 0.2, 0], "linearVelocity": [1, 0, 0], "material": "rough"}})",
                           2 * half));
    at.classify();
    EXPECT_THAT(at.contacts(), SizeIs(half < 0.06 ? 2 : 4)) << half;
    EXPECT_THAT(at.contacts(), Each(isOf(ContactMotion::sliding)));
  }
}

// What slides across the slope keeps its direction, whatever pulls it downwards.
TEST(ActiveContacts, SlideAlongTheirVelocity) {
  OnPlane at(std::string(kBox) + R"(, "linearVelocity": [-0.6, 0, 0.8]})", slopeOf(0.2));
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  for (const ContactConstraint& contact : at.contacts()) {
    EXPECT_EQ(contact.motion, ContactMotion::sliding);
    EXPECT_LT((contact.slidingDirection - Vec3(-0.6, 0, 0.8)).norm(), 1e-15);
  }
  const double cosine = 1 / std::hypot(1, 0.2);
  const Vec3 expected = kGravity * cosine * (Vec3(0.2, 0, 0) - kDynamicFriction * Vec3(-0.6, 0, 0.8));
  EXPECT_LT((at.acceleration(0) - expected).norm(), 1e-12);
}

// A ball with the inertia j m r^2 rolls as long as its friction j / (1 + j) m g sin needs no more than mu m g cos: up
// to tan = mu (1 + j) / j; j = 0.3.
TEST(ActiveContacts, RollUpToTheAngleThatInertiaAndFrictionGive) {
  for (const double part : {0.99, 1.01}) {
    const double tangent = part * kStaticFriction * 1.3 / 0.3, cosine = 1 / std::hypot(1, tangent);
    OnPlane at(std::string(kBall) + "}", slopeOf(tangent));
    at.classify();
    EXPECT_THAT(at.contacts(), ElementsAre(isOf(part < 1 ? ContactMotion::sticking : ContactMotion::sliding)));
    const double expected = kGravity * cosine * (part < 1 ? tangent / 1.3 : tangent - kDynamicFriction);
    EXPECT_NEAR(at.acceleration(0).x(), expected, 1e-12);
  }
}

TEST(ActiveContacts, OfSmoothBodiesHaveNoFriction) {
  OnPlane at(R"({"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "position": [0, 0.1, 0],
    "linearVelocity": [0.5, 0, 0], "material": "smooth"})");
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  EXPECT_THAT(at.contacts(), Each(isOf(ContactMotion::frictionless)));
}

// A push of F upwards leaves m g - F for the floor, and nothing if it is more. The weight is 9.81 N.
TEST(ActiveContacts, AreThoseThatForcesPressTogether) {
  for (const double push : {9.8, 9.82}) {
    OnPlane at(std::string(kBall) + "}");
    at.mechanism().pushes = {{{0, Vec3::Zero()}, Vec3(0, push, 0)}};
    at.classify();
    EXPECT_THAT(at.contacts(), SizeIs(push < 9.81 ? 1 : 0));
    EXPECT_NEAR(at.acceleration(0).y(), std::max(0.0, push - 9.81), 1e-14);
    EXPECT_NEAR(at.normalForces(), std::max(0.0, 9.81 - push), 1e-14);
  }
}

// Faster than the last bounce, 1e-7 sqrt(g size) = 1.4e-7 m/s here, is leaving.
TEST(ActiveContacts, DoNotHoldWhatLeaves) {
  const double still = 1e-7 * std::sqrt(kGravity * 0.2) + 1e-12;
  for (const double part : {0.99, 1.01}) {
    OnPlane at(std::string(kBall) + "}");
    linearVelocity(at.state(), 0).y() = part * still;
    at.classify();
    EXPECT_EQ(at.active.empty(), part > 1) << part;
  }
}

// Two balls on each other, and one beside: the floor carries the weight of both.
TEST(ActiveContacts, OfAStackDependOnEachOther) {
  OnPlane at(std::string(kBall) + R"(}, {"name": "upper", "shape": {"sphere": {"radius": 0.1}}, "mass": 2.5,
    "position": [0, 0.5, 0]}, {"name": "other", "shape": {"sphere": {"radius": 0.1}}, "mass": 4,
    "position": [2, 0.1, 0]})");
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(3));
  at.acceleration(0);
  std::multiset<double> forces, expected = {3.5 * kGravity, 2.5 * kGravity, 4 * kGravity};
  for (const ContactForce& force : at.island.equations.contactForces()) forces.insert(force.normal);
  for (auto [a, b] = std::pair(forces.begin(), expected.begin()); b != expected.end(); ++a, ++b)
    EXPECT_NEAR(*a, *b, 1e-12);
}

TEST(ActiveContacts, RecordWhatBecomesOfThem) {
  const auto kindsOf = [](const std::vector<Event>& events) {
    std::vector<EventKind> kinds;
    for (const Event& event : events) kinds.push_back(event.kind);
    return kinds;
  };
  OnPlane at(std::string(kBall) + "}", slopeOf(0.2));
  at.classify();
  EXPECT_THAT(at.island.log.take(), IsEmpty());
  at.classify();  // it rolls on
  EXPECT_THAT(at.island.log.take(), IsEmpty());
  linearVelocity(at.state(), 0).x() = 0.5;
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::slip));
  linearVelocity(at.state(), 0).x() = -0.5;  // the other way
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::slip));
  angularVelocity(at.state(), 0).z() = 0.5 / 0.2;
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::roll));
  linearVelocity(at.state(), 0).x() = 0.5;
  at.classify();
  at.island.log.take();
  linearVelocity(at.state(), 0).setZero(), angularVelocity(at.state(), 0).setZero();
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::stick));
  at.mechanism().pushes = {{{0, Vec3::Zero()}, Vec3(0, 20, 0)}};
  at.classify();
  EXPECT_THAT(kindsOf(at.island.log.take()), ElementsAre(EventKind::release));
}

// Where friction gives way, the contact slides against the friction that it had, though it does not move yet.
TEST(ActiveContacts, SlideAwayFromTheFrictionThatGaveWay) {
  OnPlane at(std::string(kBox) + "}", slopeOf(0.4));
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  at.acceleration(0);
  at.classify(ContactChange{Change::slip, 0, 2});
  ASSERT_THAT(at.contacts(), SizeIs(4));
  EXPECT_THAT(at.contacts()[2].motion, ContactMotion::sliding);
  EXPECT_LT((at.contacts()[2].slidingDirection - Vec3::UnitX()).norm(), 1e-12);
}

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
TEST(ActiveContacts, AreReleasedWhereABallLeavesADome) {
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
TEST(ActiveContacts, FindTheReleaseInsideAStep) {
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
TEST(ActiveContacts, SlipWhereFrictionIsUsedUp) {
  const double tangent = 1.2, cosine = 1 / std::hypot(1, tangent);
  OnPlane at(std::string(kBall) + "}", slopeOf(tangent));
  at.classify();
  const double left = cosine * (kStaticFriction - 0.3 / 1.3 * tangent);
  EXPECT_NEAR(at.active.margin({Change::slip, 0, 0}, at.state()), left, 1e-14);
}

// What slides sticks where the velocity of the surfaces, v + w r here, ends.
TEST(ActiveContacts, StickWhereTheSlidingEnds) {
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
TEST(ActiveContacts, FindTheEndOfSlidingInsideAStep) {
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

TEST(ActiveContacts, FollowTheDirectionOfSliding) {
  OnPlane at(std::string(kBox) + R"(, "linearVelocity": [1, 0, 0]})");
  at.classify();
  dop853(at.island.rightHandSide, at.state(), 0, 1e-3, at.island.step);
  prepareInterpolant(at.island.rightHandSide, at.island.step);
  ASSERT_FALSE(at.active.firstChange());  // which notes the forces at the step's end
  linearVelocity(at.state(), 0) = Vec3(0.8, 0, 0.6);
  at.active.followSliding();
  for (const ContactConstraint& contact : at.contacts())
    EXPECT_LT((contact.slidingDirection - Vec3(0.8, 0, 0.6)).norm(), 1e-15);
}

// Each corner of the box that stands on the floor, and no other, is held.
TEST(ActiveContacts, HoldTheFeaturesThatTouch) {
  OnPlane at(std::string(kBox) + "}");
  at.classify();
  std::set<std::size_t> features;
  for (const ActiveFeature& held : at.active.features()) {
    EXPECT_EQ(held.pair, 0u);
    features.insert(held.feature);
    EXPECT_NEAR(at.island.assembly.geometry.colliders[0].points[held.feature].y(), -0.1, 1e-15);
  }
  EXPECT_THAT(features, SizeIs(4));
}

TEST(ActiveContacts, OfBodiesThatHaveComeToRestAreReleased) {
  OnPlane at(std::string(kBall) +
             R"(}, {"name": "other", "shape": {"sphere": {"radius": 0.1}}, "position": [2, 0.1, 0]})");
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(2));
  at.island.resting.bringToRest({0}, at.state());
  at.active.releaseResting();
  ASSERT_THAT(at.contacts(), SizeIs(1));
  EXPECT_EQ(at.contacts()[0].centerA.body, 1);
  at.classify();
  EXPECT_THAT(at.contacts(), SizeIs(1));
}

// A cylinder of 0.1 m and 0.4 m stands on slopes up to tan = 0.1 / 0.2.
TEST(ActiveContacts, DoNotServeACylinderThatTips) {
  for (const double part : {0.98, 1.02}) {
    OneIsland at(R"("duration": 1, "materials": {"rough": {"staticFriction": 0.9, "dynamicFriction": 0.9}}, "bodies": [
        {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"},
        {"name": "post", "shape": {"cylinder": {"radius": 0.1, "length": 0.4}}, "material": "rough",
         "position": [0, 0.2, 0]}], )" +
                 slopeOf(part * 0.5));
    const EventTolerances tolerances = eventTolerancesOf(eventScalesOf(at.island));
    ActiveContacts active(at.island, tolerances);
    ConstraintSolver solver(at.mechanism().constraints, at.mechanism().bodies);
    active.classify(at.contactsWithin(tolerances.touch), solver);
    EXPECT_THAT(std::string(active.fallbackReason()), StrEq(part < 1 ? "" : "a cylinder tips over its rim"));
  }
}

// Sticking boxes have 12 rows each, of rank 6: two on each other have 12 rows too many, which is served, three 18.
TEST(ActiveContacts, DoNotServeManyThatPressAtOnce) {
  std::string bodies = std::string(kBox) + "}";
  for (const int boxes : {1, 2, 3}) {
    if (boxes > 1)
      bodies += fmt::format(R"(, {{"name": "b{}", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "mass": 3,
        "position": [0, {}, 0], "material": "rough"}})",
                            boxes, 0.2 * boxes - 0.1);
    OnPlane at(bodies);
    at.classify();
    ASSERT_THAT(at.contacts(), SizeIs(4 * boxes));
    EXPECT_THAT(std::string(at.active.fallbackReason()), StrEq(boxes < 3 ? "" : "too many contacts press at once"));
    if (boxes == 3) {
      EXPECT_THAT(at.active.fallbackBodies(), ElementsAre(0, 1, 2, 3));
    }
  }
}

// A box that keeps its speed on a slope of tan = mu': too slow below T sqrt(mu' g A) / 20 in a run of T, with T = 10 s
// and A = 1e-4; gravity g along the slope and across it together.
TEST(ActiveContacts, DoNotServeABoxThatSlidesSlowly) {
  const double slowest = 10 * std::sqrt(kDynamicFriction * kGravity * 1e-4) / 20;
  for (const double part : {0.99, 1.01}) {
    OneIsland at(R"("duration": 10, "accuracy": 1e-4, "materials": {
        "rough": {"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.3}}, "bodies": [
        {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"}, )" +
                 std::string(kBox) + "}], " + slopeOf(kDynamicFriction));
    linearVelocity(at.state(), 0).x() = part * slowest;
    const EventTolerances tolerances = eventTolerancesOf(eventScalesOf(at.island));
    ActiveContacts active(at.island, tolerances);
    ConstraintSolver solver(at.mechanism().constraints, at.mechanism().bodies);
    active.classify(at.contactsWithin(tolerances.touch), solver);
    EXPECT_EQ(active.fallbackReason().empty(), part > 1) << active.fallbackReason();
  }
}

}  // namespace
}  // namespace cradle
