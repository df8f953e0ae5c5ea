// Bullet 3.24 (E. Coumans, https://github.com/bulletphysics/bullet3): semi-implicit Euler, and sequential impulses for
// joints and contacts. Its bodies have their frames at the centre of mass along the principal axes of inertia.

#include "study/peers/bullet.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <btBulletDynamicsCommon.h>

#include <fmt/format.h>

#include <cmath>

#include "math/principal_axes.h"
#include "study/peers/bullet_shapes.h"
#include "study/peers/peer_drives.h"
#include "study/peers/peer_shapes.h"

namespace cradle {
namespace {

constexpr double kBounceFrom = 0.01;     // m/s, if tuned; 0.2 m/s is Bullet's default
constexpr double kSamePlace = 1e-9;      // m: a shape that near the centre of mass needs no compound
constexpr double kSameDirection = 1e-9;  // rad

/// What a collision object points to: its material's row in the table of surface laws.
using LawsOfMaterial = std::vector<SurfacePair>;

const SurfacePair& lawOf(const btCollisionObject* a, const btCollisionObject* b) {
  const auto& laws = *static_cast<const LawsOfMaterial*>(a->getUserPointer());
  return laws[static_cast<std::size_t>(b->getUserIndex())];
}
btScalar restitutionOf(const btCollisionObject* a, const btCollisionObject* b) {
  return lawOf(a, b).restitution;
}
btScalar frictionOf(const btCollisionObject* a, const btCollisionObject* b) {
  return lawOf(a, b).dynamicFriction;
}

/// A massless rod: one row that keeps the distance of two points, as Bullet's own joints keep theirs.
class BulletRod : public btTypedConstraint {
 public:
  BulletRod(btRigidBody& a, btRigidBody& b, const btVector3& anchorA, const btVector3& anchorB, double length)
      : btTypedConstraint(POINT2POINT_CONSTRAINT_TYPE, a, b), anchorA_(anchorA), anchorB_(anchorB), length_(length) {}

  void getInfo1(btConstraintInfo1* info) override { info->m_numConstraintRows = info->nub = 1; }
  void getInfo2(btConstraintInfo2* info) override {
    const btVector3 armA = m_rbA.getWorldTransform().getBasis() * anchorA_;
    const btVector3 armB = m_rbB.getWorldTransform().getBasis() * anchorB_;
    const btVector3 d = m_rbA.getWorldTransform().getOrigin() + armA - m_rbB.getWorldTransform().getOrigin() - armB;
    const btVector3 along = d.normalized(), turnA = armA.cross(along), turnB = along.cross(armB);
    for (int i = 0; i < 3; ++i) {
      info->m_J1linearAxis[i] = along[i];
      info->m_J1angularAxis[i] = turnA[i];
      info->m_J2linearAxis[i] = -along[i];
      info->m_J2angularAxis[i] = turnB[i];
    }
    info->m_constraintError[0] = info->fps * info->erp * (length_ - d.length());
  }
  void setParam(int, btScalar, int) override {}
  btScalar getParam(int, int) const override { return 0; }

 private:
  btVector3 anchorA_, anchorB_;  // m, in the bodies' principal frames
  double length_;                // m
};

/// What is not Bullet's default.
struct BulletSettings {
  int iterations = 10;   // of the sequential impulses in a step
  bool isTuned = false;  // contacts only where bodies touch, all overlap by split impulses, bounces from 0.01 m/s
};

/// Leaves the velocities of driven bodies as they are set: Bullet takes them from poses that are a step old.
class BulletDynamics : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

 private:
  void saveKinematicState(btScalar) override {}
};

class BulletWorld : public SteppedWorld {
 public:
  BulletWorld(const Scene& scene, const Assembly& parts, const BulletSettings& settings, double timeStep);
  void read(VectorX& state) override;

 private:
  void step() override;
  void addBody(const Body& body, const Scene& scene, int index);
  btRigidBody& add(const btRigidBody::btRigidBodyConstructionInfo& info, const Body& body);
  void addJoints();
  void letJoinedOverlap(const Scene& scene);
  void setVelocity(btRigidBody& body, const Vec3& linear, const Vec3& angular);
  void addForces();
  void addMotors();
  void leadDriven();
  void placeDriven();
  AttachmentMotion motionOf(const Attachment& attachment) const;
  btRigidBody& bodyOf(const Attachment& attachment) const;
  btVector3 pointOf(const Attachment& attachment) const;

  const Assembly& assembly_;
  std::vector<LawsOfMaterial> laws_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;  // of the scene
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  std::vector<btRigidBody*> moving_;     // in the order of the assembly
  std::vector<Quat> bodyFromPrincipal_;  // of each moving body
  VectorX state_;                        // at the last look
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadPhase_;
  btSequentialImpulseConstraintSolver solver_;
  BulletDynamics dynamics_{&dispatcher_, &broadPhase_, &solver_, &configuration_};
  btScalar processingThreshold_ = BT_LARGE_FLOAT;  // m: contacts up to this distance are solved
};

BulletWorld::BulletWorld(const Scene& scene, const Assembly& parts, const BulletSettings& settings, double timeStep)
    : SteppedWorld(timeStep), assembly_(parts), laws_(scene.surfacePairs), state_(parts.state) {
  gCalculateCombinedRestitutionCallback = restitutionOf;
  gCalculateCombinedFrictionCallback = frictionOf;
  dynamics_.setGravity(toBullet(scene.gravity));
  btContactSolverInfo& info = dynamics_.getSolverInfo();
  info.m_numIterations = settings.iterations;
  if (settings.isTuned) {
    info.m_splitImpulsePenetrationThreshold = 0;
    info.m_restitutionVelocityThreshold = kBounceFrom;
    processingThreshold_ = 0;
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    addBody(scene.bodies[i], scene, indexAmong(assembly_.sceneBodies, static_cast<int>(i)));
  addJoints();
  letJoinedOverlap(scene);
}

void BulletWorld::addBody(const Body& body, const Scene& scene, int index) {
  PlacedBulletShape placed = bulletShapeOf(body, scene);
  btCollisionShape* shape = placed.shape.get();
  shapes_.push_back(std::move(placed.shape));
  if (index == kFixed) {
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shape);
    info.m_startWorldTransform = toBullet(body.worldFromBody * placed.bodyFromShape);
    add(info, body);
    return;
  }
  const PrincipalAxes principal = principalAxes(body.massProperties.inertiaTensor);
  const RigidTransform bodyFromFrame{Quat(principal.axes), body.massProperties.centerOfMass};
  const RigidTransform frameFromShape = bodyFromFrame.inverse() * placed.bodyFromShape;
  const bool isRound = shape->getShapeType() == SPHERE_SHAPE_PROXYTYPE;
  if (frameFromShape.translation.norm() > kSamePlace ||
      (!isRound && frameFromShape.rotation.angularDistance(Quat::Identity()) > kSameDirection)) {
    auto compound = std::make_unique<btCompoundShape>(true, 1);
    compound->addChildShape(toBullet(frameFromShape), shape);
    shape = compound.get();
    shapes_.push_back(std::move(compound));
  }
  btRigidBody::btRigidBodyConstructionInfo info(body.massProperties.mass, nullptr, shape, toBullet(principal.moments));
  info.m_startWorldTransform = toBullet(body.worldFromBody * bodyFromFrame);
  btRigidBody& rigid = add(info, body);
  setVelocity(rigid, linearVelocity(assembly_.state, index), angularVelocity(assembly_.state, index));
  rigid.setActivationState(DISABLE_DEACTIVATION);
  moving_.push_back(&rigid);
  bodyFromPrincipal_.push_back(bodyFromFrame.rotation);
}

btRigidBody& BulletWorld::add(const btRigidBody::btRigidBodyConstructionInfo& info, const Body& body) {
  bodies_.push_back(std::make_unique<btRigidBody>(info));
  btRigidBody& rigid = *bodies_.back();
  rigid.setUserPointer(&laws_[static_cast<std::size_t>(body.material)]);
  rigid.setUserIndex(body.material);
  rigid.setContactProcessingThreshold(processingThreshold_);
  if (body.motion == Motion::driven) rigid.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  if (body.collision == CollisionChoice::none)
    dynamics_.addRigidBody(&rigid, 0, 0);
  else
    dynamics_.addRigidBody(&rigid);
  return rigid;
}

void BulletWorld::setVelocity(btRigidBody& body, const Vec3& linear, const Vec3& angular) {
  body.setLinearVelocity(toBullet(linear));
  body.setAngularVelocity(toBullet(angular));
}

btRigidBody& BulletWorld::bodyOf(const Attachment& attachment) const {
  if (attachment.body == kFixed) return btTypedConstraint::getFixedBody();
  return *moving_[static_cast<std::size_t>(attachment.body)];
}

btVector3 BulletWorld::pointOf(const Attachment& attachment) const {
  if (attachment.body == kFixed) return toBullet(attachment.point);
  return toBullet(bodyFromPrincipal_[static_cast<std::size_t>(attachment.body)].conjugate() * attachment.point);
}

void BulletWorld::addJoints() {
  const auto add = [&](std::unique_ptr<btTypedConstraint> joint) {
    dynamics_.addConstraint(joint.get());
    joints_.push_back(std::move(joint));
  };
  const auto turned = [&](const Attachment& at, const Vec3& direction) {
    return pointOf({at.body, direction});  // a direction turns as a point at the centre of mass does
  };
  const Constraints& constraints = assembly_.mechanism.constraints;
  const std::vector<JointMotor>& motors = assembly_.mechanism.motors;
  forEachOf<RodConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const RodConstraint& rod) {
    add(std::make_unique<BulletRod>(bodyOf(a), bodyOf(b), pointOf(a), pointOf(b), rod.length));
  });
  forEachOf<BallJointConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const auto&) {
    add(std::make_unique<btPoint2PointConstraint>(bodyOf(a), bodyOf(b), pointOf(a), pointOf(b)));
  });
  forEachOf<HingeConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const HingeConstraint& hinge) {
    auto joint =
        std::make_unique<btHingeConstraint>(bodyOf(a), bodyOf(b), pointOf(a), pointOf(b), turned(a, hinge.axisA),
                                            turned(b, hinge.acrossB[0].cross(hinge.acrossB[1])));
    if (const JointMotor* motor = motorOf({a, b, hinge}, motors); motor && motor->hasTarget)
      joint->enableAngularMotor(true, motor->targetVelocity, motor->maxForce * timeStep());
    add(std::move(joint));
  });
  const auto frameOf = [&](const Attachment& at, const Mat3& axes) {
    const btVector3 x = turned(at, axes.col(0)), y = turned(at, axes.col(1)), z = turned(at, axes.col(2));
    return btTransform(btMatrix3x3(x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z()), pointOf(at));
  };
  forEachOf<SliderConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const auto& slider) {
    Mat3 axes;
    axes << slider.axisB(), slider.acrossB[0], slider.acrossB[1];  // a slider goes along x
    auto joint = std::make_unique<btSliderConstraint>(bodyOf(a), bodyOf(b), frameOf(a, slider.aFromB * axes),
                                                      frameOf(b, axes), true);
    if (const JointMotor* motor = motorOf({a, b, slider}, motors); motor && motor->hasTarget) {
      joint->setPoweredLinMotor(true);
      joint->setTargetLinMotorVelocity(-motor->targetVelocity);  // Bullet's is that of B against A
      joint->setMaxLinMotorForce(motor->maxForce);
    }
    add(std::move(joint));
  });
  forEachOf<WeldConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const auto& weld) {
    add(std::make_unique<btFixedConstraint>(bodyOf(a), bodyOf(b), frameOf(a, weld.aFromB),
                                            frameOf(b, Mat3::Identity())));
  });
}

/// Bodies of a joint do not touch each other, fixed ones neither: for Bullet those are not the joint's.
void BulletWorld::letJoinedOverlap(const Scene& scene) {
  for (const auto& [a, b] : joinedBodies(scene)) {
    if (a == kWorld) continue;
    btRigidBody &bodyA = *bodies_[static_cast<std::size_t>(a)], &bodyB = *bodies_[static_cast<std::size_t>(b)];
    bodyA.setIgnoreCollisionCheck(&bodyB, true), bodyB.setIgnoreCollisionCheck(&bodyA, true);
  }
}

AttachmentMotion BulletWorld::motionOf(const Attachment& attachment) const {
  if (attachment.body == kFixed) return {Vec3::Zero(), attachment.point, Vec3::Zero()};
  const btRigidBody& body = bodyOf(attachment);
  const btVector3 arm = body.getWorldTransform().getBasis() * pointOf(attachment);
  return {fromBullet(arm), fromBullet(body.getWorldTransform().getOrigin() + arm),
          fromBullet(body.getVelocityInLocalPoint(arm))};
}

void BulletWorld::addForces() {
  for (const SpringForce& spring : assembly_.mechanism.springs) {
    const AttachmentMotion a = motionOf(spring.anchorA), b = motionOf(spring.anchorB);
    const Vec3 forceOnA = pullOf(spring, a, b).forceOnA;
    if (spring.anchorA.body != kFixed) bodyOf(spring.anchorA).applyForce(toBullet(forceOnA), toBullet(a.arm));
    if (spring.anchorB.body != kFixed) bodyOf(spring.anchorB).applyForce(toBullet(-forceOnA), toBullet(b.arm));
  }
}

/// Motors of constant force give impulses, not torques: friction does not see torques that act in a step.
void BulletWorld::addMotors() {
  if (assembly_.mechanism.motors.empty()) return;
  read(state_);
  const auto act = [&](const Attachment& on, const MotorAction& action, double sign) {
    if (on.body == kFixed) return;
    btRigidBody& body = bodyOf(on);
    const btVector3 arm = toBullet(action.point) - body.getWorldTransform().getOrigin();
    body.applyImpulse(toBullet(sign * timeStep() * action.force), arm);
    body.applyTorqueImpulse(toBullet(sign * timeStep() * action.torque));
  };
  for (const JointMotor& motor : assembly_.mechanism.motors) {
    if (motor.hasTarget) continue;  // the joint's own
    const MotorAction action = actionOf(motor, state_);
    act(motor.joint.anchorA, action, 1), act(motor.joint.anchorB, action, -1);
  }
}

/// Gives driven bodies the velocities that take them to their places at the end of the step: others feel those.
void BulletWorld::leadDriven() {
  for (const DrivenBody& driven : assembly_.mechanism.driven) {
    const MeanVelocity velocity = meanVelocity(driven.motion, time(), endTime());
    setVelocity(*moving_[static_cast<std::size_t>(driven.body)], velocity.linear, velocity.angular);
  }
}

void BulletWorld::placeDriven() {
  for (const DrivenBody& driven : assembly_.mechanism.driven) {
    const PoseMotion now = motionAt(driven.motion, endTime());
    const std::size_t index = static_cast<std::size_t>(driven.body);
    const RigidTransform bodyFromPrincipal{bodyFromPrincipal_[index], Vec3::Zero()};
    moving_[index]->setCenterOfMassTransform(toBullet(now.pose * bodyFromPrincipal));
    setVelocity(*moving_[index], now.velocity, now.angularVelocity);
  }
}

void BulletWorld::step() {
  addForces();
  addMotors();
  leadDriven();
  dynamics_.stepSimulation(timeStep(), 0);
  placeDriven();
}

void BulletWorld::read(VectorX& state) {
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const btRigidBody& body = *moving_[i];
    const Eigen::Index index = static_cast<Eigen::Index>(i);
    centerOfMass(state, index) = fromBullet(body.getWorldTransform().getOrigin());
    setOrientation(state, index,
                   fromBullet(body.getWorldTransform().getRotation()) * bodyFromPrincipal_[i].conjugate());
    linearVelocity(state, index) = fromBullet(body.getLinearVelocity());
    angularVelocity(state, index) = fromBullet(body.getAngularVelocity());
  }
}

std::string missingInBullet(const Scene& scene, const Assembly&) {
  if (!scene.ropes.empty()) return "ropes";
  if (const std::string missing = missingInEveryPeer(scene); !missing.empty()) return missing;
  for (const Body& body : scene.bodies)
    if (std::holds_alternative<ModelShape>(body.shape) && body.collision != CollisionChoice::none &&
        body.collision != CollisionChoice::hull && !recogniseModel(body, scene).isConvex)
      return "the concave mesh of \"" + body.name + "\"";
  return "";
}

Peer peerOf(const std::string& name, const std::string& title, const BulletSettings& settings) {
  Peer peer{"bullet", "3.24", name, title, "", SettingKind::timeStep, missingInBullet, {}};
  peer.configuration = fmt::format("{} iterations of sequential impulses", settings.iterations);
  if (settings.isTuned)
    peer.configuration += fmt::format(
        ", contact processing threshold 0, split impulse penetration threshold 0, bounces from {} m/s", kBounceFrom);
  peer.open = [settings](const Scene& scene, const Assembly& assembly, double timeStep) {
    return std::make_unique<BulletWorld>(scene, assembly, settings, timeStep);
  };
  return peer;
}

}  // namespace

std::vector<Peer> bulletPeers() {
  return {peerOf("bullet", "Bullet", {10, false}), peerOf("bullet100", "Bullet, 100 iterations", {100, false}),
          peerOf("bulletTuned", "Bullet, tuned", {10, true}),
          peerOf("bulletTuned100", "Bullet, tuned, 100 iterations", {100, true})};
}

}  // namespace cradle
