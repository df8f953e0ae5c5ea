#include "constraints/contact_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "constraints/contact_motion.h"
#include "constraints/invariants.h"
#include "dynamics/free_bodies.h"

namespace cradle {
namespace {

enum class Shape { point, rim, line };
struct Kind {
  std::string name;
  int bodyA, bodyB;
  double radiusA, radiusB;
  Shape a = Shape::point, b = Shape::point;
};
constexpr double kFace = std::numeric_limits<double>::infinity();
const std::vector<Kind> kKinds = {{"corner on fixed face", 0, kFixed, 0, kFace},
                                  {"ball on fixed face", 0, kFixed, 0.3, kFace},
                                  {"corner on face", 0, 1, 0, kFace},
                                  {"ball on face", 0, 1, 0.3, kFace},
                                  {"fixed ball on face", kFixed, 1, 0.3, kFace},
                                  {"ball on fixed ball", 0, kFixed, 0.3, 0.7},
                                  {"ball on ball", 0, 1, 0.3, 0.7},
                                  {"corner on ball", 0, 1, 0, 0.7},
                                  {"ball on fixed edge", 0, kFixed, 0.7, 0, Shape::point, Shape::line},
                                  {"ball on edge", 0, 1, 0.7, 0, Shape::point, Shape::line},
                                  {"edge on fixed ball", 0, kFixed, 0, 0.7, Shape::line, Shape::point},
                                  {"corner on side", 0, 1, 0, 0.4, Shape::point, Shape::line},
                                  {"edge on fixed edge", 0, kFixed, 0, 0, Shape::line, Shape::line},
                                  {"edge on edge", 0, 1, 0, 0, Shape::line, Shape::line},
                                  {"fixed edge on side", kFixed, 1, 0, 0.4, Shape::line, Shape::line},
                                  {"side on side", 0, 1, 0.3, 0.4, Shape::line, Shape::line},
                                  {"rim on fixed face", 0, kFixed, 0.3, kFace, Shape::rim},
                                  {"rim on face", 0, 1, 0.3, kFace, Shape::rim},
                                  {"fixed rim on face", kFixed, 1, 0.3, kFace, Shape::rim}};

/// Lines across the normal that cross at that angle (rad).
void setLines(const Kind& kind, double angle, SurfaceContact& surfaces) {
  const Vec3 along = surfaces.normal.unitOrthogonal();
  if (kind.a == Shape::line) surfaces.lineA = rotationAbout(surfaces.normal, angle) * along;
  if (kind.b == Shape::line) surfaces.lineB = along;
}

/// Two lopsided bodies that move at random and touch in a contact of that kind, somewhere.
struct Touching {
  Mechanism mechanism;
  VectorX state, rate;  // rate: of positions as the state says, of velocities at random

  Touching(const Kind& kind, Random& random, ContactMotion motion = ContactMotion::frictionless) {
    mechanism.bodies = {lopsided(1.5), lopsided(0.8, rotationAbout(Vec3(-1, 0.5, 2), 1.9))};
    state = VectorX::Zero(stateSize(2));
    rate = VectorX::Zero(stateSize(2));
    for (Eigen::Index body = 0; body < 2; ++body) {
      centerOfMass(state, body) = random.vector();
      setOrientation(state, body, random.rotation());
      linearVelocity(state, body) = 2 * random.vector();
      angularVelocity(state, body) = 3 * random.vector();
      linearVelocity(rate, body) = 5 * random.vector();
      angularVelocity(rate, body) = 5 * random.vector();
    }
    evaluatePoseRates(mechanism.bodies, state, rate);
    const Vec3 normal = random.vector().normalized();
    SurfaceContact surfaces{kind.bodyA, kind.bodyB, random.vector(), normal, 0, kind.radiusA, kind.radiusB};
    setLines(kind, (random.between(-1, 1) > 0 ? 1 : -1) * random.between(0.5, 2.5), surfaces);
    // A disc 30 degrees from upright, whose lowest point moves around it.
    if (kind.a == Shape::rim)
      surfaces.rimAxis = (std::sqrt(3.0) * normal.cross(random.vector()).normalized() + normal) / 2;
    ContactConstraint contact = constraintOf(surfaces, state);
    contact.motion = motion;
    contact.friction = 0.4;
    setSlidingDirection(contact, normal.cross(random.vector()), state);
    mechanism.contacts = {contact};
  }
};

/// Two rows along the surfaces, then that of the gap; the gap's alone is the same.
ConstraintBlock blockAt(const Touching& pair, const ContactKinematics& place) {
  ConstraintBlock block, alone;
  findRows(pair.mechanism.contacts[0], place, true, block), findRows(pair.mechanism.contacts[0], place, false, alone);
  EXPECT_EQ(block.rows, 3);
  EXPECT_EQ(alone.rows, 1);
  for (const auto part : {&ConstraintBlock::linear, &ConstraintBlock::angularA, &ConstraintBlock::angularB})
    EXPECT_EQ((alone.*part).row(0), (block.*part).row(2));
  EXPECT_EQ(alone.velocityProduct[0], block.velocityProduct[2]);
  return block;
}

/// Central difference of fourth order of a function of the state along its rate: its time derivative.
template <class Function>
auto fourthOrderDerivative(const VectorX& state, const VectorX& rate, const Function& function) {
  const double step = 1e-4;  // s
  using Value = decltype(function(state));
  const auto at = [&](double steps) { return function(VectorX(state + steps * step * rate)); };
  return Value((8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step));
}
// Normals turn at up to 20/s, speeds reach 20 m/s: step^4 f^(5) / 30 is up to 1e-16 x 6e7 / 30 = 2e-10, for a few times
// that rate more; rounding of 1e-14 / step is 1e-10.
constexpr double kDifference = 3e-9;

TEST(ContactRows, GapAndItsTwoDerivativesAgreeForAllKindsOfSurfaces) {
  Random random;
  for (const Kind& kind : kKinds)
    for (int i = 0; i < 20; ++i) {
      const Touching pair(kind, random);
      const auto blockIn = [&](const VectorX& state) { return blockAt(pair, placeIn(pair.mechanism, 0, state)); };
      const ConstraintBlock block = blockIn(pair.state);
      EXPECT_NEAR(block.value[2], 0, 3e-15) << kind.name;
      const auto gap = [&](const VectorX& state) { return blockIn(state).value[2]; };
      EXPECT_NEAR(rateOf(block, 2, pair.state), fourthOrderDerivative(pair.state, pair.rate, gap), kDifference)
          << kind.name;
      const auto gapRate = [&](const VectorX& state) { return rateOf(blockIn(state), 2, state); };
      EXPECT_NEAR(rateOf(block, 2, pair.rate) + block.velocityProduct[2],
                  fourthOrderDerivative(pair.state, pair.rate, gapRate), kDifference)
          << kind.name;
    }
}

TEST(ContactRows, TangentialVelocityIsThatOfTheMaterialWhereTheSurfacesTouch) {
  Random random;
  for (const Kind& kind : kKinds) {
    const Touching pair(kind, random);
    const ContactKinematics place = placeIn(pair.mechanism, 0, pair.state);
    // Points marked on both bodies at the place of contact.
    Vec3 velocity = Vec3::Zero();
    const ContactConstraint& contact = pair.mechanism.contacts[0];
    for (const auto& [body, sign] : {std::pair(contact.centerA.body, 1.0), std::pair(contact.surfaceB.body, -1.0)}) {
      if (body == kFixed) continue;
      const Quat bodyFromWorld = orientation(pair.state, body).normalized().conjugate();
      const Attachment mark{body, bodyFromWorld * (place.point - centerOfMass(pair.state, body))};
      velocity += sign * motionOf(mark, pair.state).velocity;
    }
    EXPECT_LT((velocity - place.velocity).norm(), 1e-14) << kind.name;
    const ConstraintBlock block = blockAt(pair, place);
    EXPECT_NEAR(place.normal.dot(velocity), rateOf(block, 2, pair.state), 1e-14);
    for (const int row : {0, 1}) {
      const Vec3 direction = block.linear.row(row);
      EXPECT_NEAR(direction.norm(), 1, 1e-15);
      EXPECT_NEAR(direction.dot(place.normal), 0, 1e-15);
      EXPECT_NEAR(rateOf(block, row, pair.state), direction.dot(tangentialVelocity(place)), 1e-14) << kind.name;
    }
    EXPECT_NEAR(block.linear.row(0).dot(block.linear.row(1)), 0, 1e-15);
  }
}

// The rolling ball's point of contact is another one in each instant; the corner's is not.
TEST(ContactRows, RateOfTheTangentialVelocityAgreesForAllKindsOfSurfaces) {
  Random random;
  for (const Kind& kind : kKinds)
    for (int i = 0; i < 20; ++i) {
      const Touching pair(kind, random);
      const Vec3 expected = fourthOrderDerivative(pair.state, pair.rate, [&](const VectorX& state) {
        return Vec3(tangentialVelocity(placeIn(pair.mechanism, 0, state)));
      });
      const ConstraintBlock block = blockAt(pair, placeIn(pair.mechanism, 0, pair.state));
      for (const int row : {0, 1})
        EXPECT_NEAR(rateOf(block, row, pair.rate) + block.velocityProduct[static_cast<std::size_t>(row)],
                    block.linear.row(row).dot(expected), kDifference)
            << kind.name;
    }
}

TEST(ContactRows, AFaceOfAIsAFaceOfBWithTheBodiesExchanged) {
  Random random;
  const Touching pair(kKinds[3], random);
  const ContactKinematics place = placeIn(pair.mechanism, 0, pair.state);
  Mechanism exchanged = pair.mechanism;
  exchanged.contacts = {constraintOf({1, 0, place.point, place.normal, 0, kFace, 0.3}, pair.state)};
  const ContactKinematics other = placeIn(exchanged, 0, pair.state);
  EXPECT_EQ(exchanged.contacts[0].centerA.body, 0);
  EXPECT_LT((other.normal - place.normal).norm(), 1e-15);
  EXPECT_LT((other.velocity - place.velocity).norm(), 1e-14);
}

TEST(ContactRows, SurfacesApartKeepTheirDistanceInTheGap) {
  const VectorX state = restingState(2);
  for (const Kind& kind : kKinds) {
    Mechanism mechanism;
    const Vec3 normal = Vec3(2, -1, 2) / 3;
    mechanism.bodies = {lopsided(1), lopsided(1)};
    SurfaceContact surfaces{kind.bodyA, kind.bodyB, Vec3(1, 2, 3), normal, 0.01, kind.radiusA, kind.radiusB};
    setLines(kind, -0.7, surfaces);
    mechanism.contacts = {constraintOf(surfaces, state)};
    EXPECT_NEAR(placeIn(mechanism, 0, state).gap, 0.01, 3e-15) << kind.name;
  }
}

// What the solver makes of the rows: no gap, no sliding, and the sums that do not care about forces inside.
TEST(ContactForces, KeepGapAndMomentaForAllKindsOfSurfaces) {
  Random random;
  for (const Kind& kind : kKinds)
    for (const ContactMotion motion : {ContactMotion::frictionless, ContactMotion::sliding, ContactMotion::sticking}) {
      const Touching pair(kind, random, motion);
      const VectorX rate = rateOf(pair.mechanism, pair.state);
      const ContactKinematics place = placeIn(pair.mechanism, 0, pair.state);
      const ConstraintBlock block = blockAt(pair, place);
      for (int row = motion == ContactMotion::sticking ? 0 : 2; row < 3; ++row)
        EXPECT_NEAR(rateOf(block, row, rate) + block.velocityProduct[static_cast<std::size_t>(row)], 0, 1e-12)
            << kind.name;
      if (kind.bodyA == kFixed || kind.bodyB == kFixed) continue;
      const auto sum = [&](auto member) {
        return Vec3(fourthOrderDerivative(
            pair.state, rate, [&](const VectorX& state) { return Vec3(invariantsOf(pair.mechanism, state).*member); }));
      };
      EXPECT_LT(sum(&Invariants::momentum).norm(), kDifference) << kind.name;
      EXPECT_LT(sum(&Invariants::angularMomentum).norm(), kDifference) << kind.name;
    }
}

// Velocities that keep gap and grip: then energy changes by what sliding dissipates alone.
TEST(ContactForces, TakeNoEnergyButBySliding) {
  Random random;
  for (const Kind& kind : kKinds)
    for (const ContactMotion motion : {ContactMotion::frictionless, ContactMotion::sliding, ContactMotion::sticking}) {
      Touching pair(kind, random, motion);
      pair.mechanism.gravity = Vec3(1, -9, 2);
      EquationsOfMotion equations(pair.mechanism);
      equations.project(pair.state);
      const Vec3 velocity = placeIn(pair.mechanism, 0, pair.state).velocity;
      setSlidingDirection(pair.mechanism.contacts[0], velocity, pair.state);
      VectorX rate;
      equations.evaluate(0, pair.state, rate);
      const ContactForce& force = equations.contactForces()[0];
      const double power = fourthOrderDerivative(
          pair.state, rate, [&](const VectorX& state) { return energyConstant(pair.mechanism, state); });
      EXPECT_NEAR(power, 0, kDifference) << kind.name;
      if (motion != ContactMotion::sliding) {
        EXPECT_EQ(dissipatedEnergy(rate), 0);
        continue;
      }
      EXPECT_NEAR(dissipatedEnergy(rate), 0.4 * force.normal * velocity.norm(), 1e-12) << kind.name;
      EXPECT_LT((force.tangential + 0.4 * force.normal * velocity.normalized()).norm(), 1e-12);
    }
}

TEST(SlidingDirection, IsThatOfTheVelocityAboveAHundredMicrometresASecond) {
  Mechanism mechanism;
  mechanism.bodies = {lopsided(1)};
  mechanism.contacts = {ballOnFace({0, Vec3(0.1, -0.5, 0.2)}, 0, {}, Vec3::UnitY(), ContactMotion::sliding, 0.3)};
  VectorX state = restingState(1);
  std::vector<BodyFrame> frames;
  findBodyFrames(mechanism.bodies, state, frames);
  double time = 0;
  const auto direction = [&](const Vec3& velocity) {
    linearVelocity(state, 0) = velocity;
    return slidingDirection(mechanism.contacts[0], kinematicsOf(mechanism.contacts[0], state, frames), frames, time);
  };
  EXPECT_LT((direction(Vec3(6e-5, 0, 8e-5)) - Vec3(0.6, 0, 0.8)).norm(), 1e-15);
  EXPECT_LT((direction(Vec3(3, 0, 4)) - Vec3(0.6, 0, 0.8)).norm(), 1e-15);
  // Slower, it goes over into the direction given; beyond the turn it stays on its side, mirrored.
  EXPECT_LT((direction(Vec3(0, 0, 1e-9)) - Vec3::UnitX()).norm(), 2e-3);
  EXPECT_EQ(direction(Vec3::Zero()), Vec3::UnitX());
  EXPECT_EQ(direction(Vec3(-2, 0, 0)), Vec3::UnitX());
  EXPECT_LT((direction(Vec3(-3, 0, 4)) - Vec3(0.6, 0, 0.8)).norm(), 1e-15);
  // A contact that keeps its direction has it at any speed.
  mechanism.contacts[0].keepsDirection = true;
  EXPECT_EQ(direction(Vec3(3, 0, 4)), Vec3::UnitX());
  // It turns: after 0.5 s at 1.5 rad/s to the side, its tangent is 3/4.
  mechanism.contacts[0].directionTime = 2, mechanism.contacts[0].directionRate = Vec3(0, 0, 1.5);
  time = 2.5;
  EXPECT_LT((direction(Vec3(3, 0, 4)) - Vec3(0.8, 0, 0.6)).norm(), 1e-15);
}

}  // namespace
}  // namespace cradle
