#include "simulate/events/contact_classification.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "simulate/events/on_plane.h"

namespace cradle {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::SizeIs;
using testing::StrEq;

const auto isOf = [](ContactMotion motion) { return Field(&ContactConstraint::motion, motion); };

TEST(ContactClassification, SticksOnSlopesBelowTheAngleOfFriction) {
  OnPlane at(std::string(kBox) + "}", slopeOf(0.99 * kStaticFriction));
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  EXPECT_THAT(at.contacts(), Each(isOf(ContactMotion::sticking)));
  EXPECT_LT(at.acceleration(0).norm(), 1e-13);
  EXPECT_NEAR(at.normalForces(), 3 * kGravity / std::hypot(1, 0.99 * kStaticFriction), 1e-12);
}

// Above it they slide downwards: a = g (sin - mu' cos), with the dynamic friction mu'.
TEST(ContactClassification, SlidesDownwardsAboveTheAngleOfFriction) {
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
TEST(ContactClassification, OfASlidingBlockIsThatWhichItsFrictionLeaves) {
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
TEST(ContactClassification, SlidesAlongTheVelocity) {
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
TEST(ContactClassification, RollsUpToTheAngleThatInertiaAndFrictionGive) {
  for (const double part : {0.99, 1.01}) {
    const double tangent = part * kStaticFriction * 1.3 / 0.3, cosine = 1 / std::hypot(1, tangent);
    OnPlane at(std::string(kBall) + "}", slopeOf(tangent));
    at.classify();
    EXPECT_THAT(at.contacts(), ElementsAre(isOf(part < 1 ? ContactMotion::sticking : ContactMotion::sliding)));
    const double expected = kGravity * cosine * (part < 1 ? tangent / 1.3 : tangent - kDynamicFriction);
    EXPECT_NEAR(at.acceleration(0).x(), expected, 1e-12);
  }
}

TEST(ContactClassification, OfSmoothBodiesHasNoFriction) {
  OnPlane at(R"({"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "position": [0, 0.1, 0],
    "linearVelocity": [0.5, 0, 0], "material": "smooth"})");
  at.classify();
  ASSERT_THAT(at.contacts(), SizeIs(4));
  EXPECT_THAT(at.contacts(), Each(isOf(ContactMotion::frictionless)));
}

// A push of F upwards leaves m g - F for the floor, and nothing if it is more. The weight is 9.81 N.
TEST(ContactClassification, TakesWhatForcesPressTogether) {
  for (const double push : {9.8, 9.82}) {
    OnPlane at(std::string(kBall) + "}");
    at.mechanism().pushes = {{{0, Vec3::Zero()}, Vec3(0, push, 0)}};
    at.classify();
    EXPECT_THAT(at.contacts(), SizeIs(push < 9.81 ? 1 : 0));
    EXPECT_NEAR(at.acceleration(0).y(), std::max(0.0, push - 9.81), 1e-14);
    EXPECT_NEAR(at.normalForces(), std::max(0.0, 9.81 - push), 1e-14);
  }
}

// What a contact carries is nothing if it gives less than 1e-9 of the largest acceleration, here that of gravity; where
// another contact is released less than 1e-6, for what is symmetric is released at once.
TEST(ContactClassification, LeavesOutMoreWhereAContactIsReleased) {
  using Change = ContactChange::Kind;
  for (const auto& [change, least] : {std::pair(Change::slip, 1e-9), {Change::release, 1e-6}})
    for (const double part : {0.5, 2.0}) {
      OnPlane at(std::string(kBall) + "}");
      at.classify();
      ASSERT_THAT(at.contacts(), SizeIs(1));
      at.acceleration(0);  // which notes the force
      at.mechanism().pushes = {{{0, Vec3::Zero()}, Vec3(0, (1 - part * least) * kGravity, 0)}};
      at.classify(ContactChange{change, 0, 0});
      EXPECT_EQ(at.active.empty(), part < 1) << least;
    }
}

// Faster than the last bounce, 1e-7 sqrt(g size) = 1.4e-7 m/s here, is leaving.
TEST(ContactClassification, LeavesOutWhatOpens) {
  const double still = 1e-7 * std::sqrt(kGravity * 0.2) + 1e-12;
  for (const double part : {0.99, 1.01}) {
    OnPlane at(std::string(kBall) + "}");
    linearVelocity(at.state(), 0).y() = part * still;
    at.classify();
    EXPECT_EQ(at.active.empty(), part > 1) << part;
  }
}

// Two balls on each other, and one beside: the floor carries the weight of both.
TEST(ContactClassification, OfAStackHasTheWeightOfAll) {
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

// A cylinder of 0.1 m and 0.4 m stands on slopes up to tan = 0.1 / 0.2.
TEST(ContactClassification, DoesNotServeACylinderThatTips) {
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

// Sticking boxes have 12 rows each, of rank 6: four on each other have 24 rows too many, which is served, five 30.
TEST(ContactClassification, DoesNotServeManyThatPressAtOnce) {
  std::string bodies = std::string(kBox) + "}";
  for (const int boxes : {1, 2, 3, 4, 5}) {
    if (boxes > 1)
      bodies += fmt::format(R"(, {{"name": "b{}", "shape": {{"box": {{"size": [0.4, 0.2, 0.6]}}}}, "mass": 3,
        "position": [0, {}, 0], "material": "rough"}})",
                            boxes, 0.2 * boxes - 0.1);
    OnPlane at(bodies);
    at.classify();
    ASSERT_THAT(at.contacts(), SizeIs(4 * boxes));
    EXPECT_THAT(std::string(at.active.fallbackReason()), StrEq(boxes < 5 ? "" : "too many contacts press at once"));
    if (boxes == 5) {
      EXPECT_THAT(at.active.fallbackBodies(), ElementsAre(0, 1, 2, 3, 4, 5));
    }
  }
}

}  // namespace
}  // namespace cradle
