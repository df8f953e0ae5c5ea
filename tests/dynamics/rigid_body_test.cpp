#include "dynamics/rigid_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kBodyRounding = 1e-14;  // of a dozen operations on numbers below 10

const Mat3 kLopsided = (Mat3() << 0.4, 0.1, -0.05, 0.1, 0.6, 0.02, -0.05, 0.02, 0.5).finished();  // kg m^2

/// A lopsided body that moves in all ways; its quaternion is not quite of unit length, as integrators leave it.
struct LopsidedBody {
  std::vector<RigidBody> bodies = {makeRigidBody({2.5, Vec3(0.1, 0, 0), kLopsided})};
  VectorX state = VectorX::Zero(stateSize(1));
  Quat turn = rotationAbout(Vec3(1, -2, 0.5), 1.1);
  Attachment attachment{0, Vec3(0.3, -0.2, 0.5)};

  LopsidedBody() {
    centerOfMass(state, 0) = Vec3(1, 2, -1);
    setOrientation(state, 0, Quat((1 + 1e-6) * turn.coeffs()));
    linearVelocity(state, 0) = Vec3(0.4, -1, 2), angularVelocity(state, 0) = Vec3(1, -2, 0.5);
  }
  Mat3 worldInertia() const {
    const Mat3 rotation = turn.toRotationMatrix();
    return rotation * kLopsided * rotation.transpose();
  }
  std::vector<BodyFrame> frames() const {
    std::vector<BodyFrame> found;
    findBodyFrames(bodies, state, found);
    return found;
  }
};

TEST(RigidBody, HasTheInversesOfItsMassAndInertia) {
  const RigidBody body = LopsidedBody().bodies[0];
  EXPECT_EQ(body.inverseMass, 0.4);
  EXPECT_EQ(body.centerOfMass, Vec3(0.1, 0, 0));
  EXPECT_LT((body.inverseInertia * kLopsided - Mat3::Identity()).norm(), kBodyRounding);
  EXPECT_FALSE(body.isSpherical);
  const RigidBody ball = makeRigidBody({2, Vec3::Zero(), 0.25 * Mat3::Identity()});
  EXPECT_TRUE(ball.isSpherical);
  EXPECT_EQ(ball.inverseInertia, Mat3(4 * Mat3::Identity()));
}

// Of a box with the sides a, b, c: the mean square of x^2 + y^2 + z^2 is (a^2 + b^2 + c^2) / 12.
TEST(RigidBody, HasTheGyrationRadiusOfItsMass) {
  const double a = 0.3, b = 0.7, c = 1.1, mass = 4;
  const Vec3 moments = mass / 12 * Vec3(b * b + c * c, c * c + a * a, a * a + b * b);
  const Mat3 turn = rotationAbout(Vec3(1, 2, 3), 0.8).toRotationMatrix();
  RigidBody box = makeRigidBody({mass, Vec3::Zero(), turn * moments.asDiagonal() * turn.transpose()});
  EXPECT_NEAR(gyrationRadius(box), std::sqrt((a * a + b * b + c * c) / 12), 1e-15);
  box.inverseMass = 0;
  EXPECT_EQ(gyrationRadius(box), 0);
}

TEST(RigidBody, CarriesItsPointsAlong) {
  const LopsidedBody at;
  const Vec3 arm = at.turn * Vec3(0.3, -0.2, 0.5), spin(1, -2, 0.5);
  const Vec3 velocity = Vec3(0.4, -1, 2) + spin.cross(arm);
  for (const AttachmentMotion& motion :
       {motionOf(at.attachment, at.state), motionOf(at.attachment, at.state, at.frames())}) {
    EXPECT_LT((motion.arm - arm).norm(), kBodyRounding);
    EXPECT_LT((motion.position - Vec3(1, 2, -1) - arm).norm(), kBodyRounding);
    EXPECT_LT((motion.velocity - velocity).norm(), kBodyRounding);
  }
  const Vec3 place = Vec3(1, 2, -1) + arm;
  EXPECT_LT((pointVelocity(0, place, at.state) - velocity).norm(), kBodyRounding);
  // a + w' x r + w x (w x r)
  VectorX rates = VectorX::Zero(at.state.size());
  linearVelocity(rates, 0) = Vec3(3, 1, -2), angularVelocity(rates, 0) = Vec3(-1, 0.5, 4);
  const Vec3 acceleration =
      Vec3(3, 1, -2) + Vec3(-1, 0.5, 4).cross(arm) + spin.dot(arm) * spin - spin.squaredNorm() * arm;
  EXPECT_LT((pointAcceleration(0, place, at.state, rates) - acceleration).norm(), kBodyRounding);
}

TEST(RigidBody, LeavesWhatIsFixedAlone) {
  LopsidedBody at;
  const VectorX before = at.state;
  const Vec3 point(1, 2, 3);
  for (const AttachmentMotion& motion :
       {motionOf({kFixed, point}, at.state), motionOf({kFixed, point}, at.state, at.frames())}) {
    EXPECT_EQ(motion.position, point);
    EXPECT_EQ(motion.arm, Vec3::Zero());
    EXPECT_EQ(motion.velocity, Vec3::Zero());
  }
  EXPECT_EQ(pointVelocity(kFixed, point, at.state), Vec3::Zero());
  EXPECT_EQ(pointAcceleration(kFixed, point, at.state, at.state), Vec3::Zero());
  EXPECT_EQ(inverseMassAlong(Vec3::UnitX(), {kFixed, point}, at.bodies, at.state), 0);
  applyImpulse(at.bodies, kFixed, point, Vec3::UnitX(), at.state);
  EXPECT_EQ(at.state, before);
}

// p = m dv and r x p = I dw; the point of the impulse gains its inverse mass along the impulse.
TEST(RigidBody, GainsTheMomentumAndAngularMomentumOfAnImpulse) {
  LopsidedBody at;
  const VectorX before = at.state;
  const Vec3 impulse = 1.5 * Vec3(2, -1, 2) / 3, arm = at.turn * at.attachment.point;
  applyImpulse(at.bodies, 0, arm, impulse, at.state);
  const Vec3 gained = linearVelocity(at.state, 0) - linearVelocity(before, 0),
             turned = angularVelocity(at.state, 0) - angularVelocity(before, 0);
  EXPECT_LT((2.5 * gained - impulse).norm(), kBodyRounding);
  EXPECT_LT((at.worldInertia() * turned - arm.cross(impulse)).norm(), kBodyRounding);
  const Vec3 direction = impulse.normalized();
  EXPECT_NEAR(1.5 * inverseMassAlong(direction, at.attachment, at.bodies, before),
              direction.dot(gained + turned.cross(arm)), kBodyRounding);
}

TEST(BodyFrames, AreOfUnitLengthAndFollowTheOrientation) {
  LopsidedBody at;
  std::vector<BodyFrame> frames = at.frames();
  EXPECT_LT((frames[0].rotation - at.turn.toRotationMatrix()).norm(), kBodyRounding);
  EXPECT_LT((frames[0].inverseInertia * at.worldInertia() - Mat3::Identity()).norm(), kBodyRounding);
  EXPECT_LT((worldInverseInertia(at.bodies[0], orientation(at.state, 0)) - frames[0].inverseInertia).norm(),
            kBodyRounding);
  at.turn = rotationAbout(Vec3(0, 1, 1), 2);
  setOrientation(at.state, 0, at.turn);
  findBodyFrames(at.bodies, at.state, frames);
  EXPECT_LT((frames[0].rotation - at.turn.toRotationMatrix()).norm(), kBodyRounding);
  EXPECT_LT((frames[0].inverseInertia * at.worldInertia() - Mat3::Identity()).norm(), kBodyRounding);
}

TEST(TurnBody, TurnsAboutAnAxisOfTheWorld) {
  LopsidedBody at;
  const Vec3 rotation = 2.3 * Vec3(1, 2, 2) / 3;
  turnBody(at.state, 0, rotation);
  EXPECT_NEAR(orientation(at.state, 0).norm(), 1, 1e-15);
  for (const Vec3& mark : {Vec3(1, 0, 0), Vec3(0, 1, 0)}) {  // x' = x cos a + (u x x) sin a + u (u.x) (1 - cos a)
    const Vec3 before = at.turn * mark, axis = rotation / 2.3;
    const Vec3 expected =
        std::cos(2.3) * before + std::sin(2.3) * axis.cross(before) + (1 - std::cos(2.3)) * axis.dot(before) * axis;
    EXPECT_LT((orientation(at.state, 0) * mark - expected).norm(), kBodyRounding);
  }
  LopsidedBody other;
  turnBody(other.state, 0, Vec3::Zero());
  EXPECT_EQ(other.state, LopsidedBody().state);
  normalizeOrientations(other.state);
  EXPECT_LT((orientation(other.state, 0).coeffs() - at.turn.coeffs()).norm(), 1e-15);
}

}  // namespace
}  // namespace cradle
