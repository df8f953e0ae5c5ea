// ODE 0.16.2 (R. Smith, https://www.ode.org, user's guide). Errors of constraints are taken back by ERP a step, and
// constraints give way by CFM. Bodies have their frames at the centre of mass, with the body's own axes.

#include "study/peers/ode.h"

#include <fmt/format.h>
#include <ode/ode.h>

#include <array>

#include "core/error.h"
#include "study/peers/peer_drives.h"
#include "study/peers/peer_shapes.h"

namespace cradle {
namespace {

constexpr double kOdeBounceFrom = 0.01;       // m/s; ODE has no default
constexpr int kMaxContacts = 8;               // of a pair: those of a face on a face
constexpr double kTunedErrorReduction = 0.8;  // the largest that the guide advises
constexpr unsigned long kSeed = 0;            // of the order in which iterations go through rows
constexpr dReal kLongAxis[4] = {0.70710678118654752, -0.70710678118654752, 0, 0};  // from z, ODE's, to y, ours

struct OdeSettings {
  int iterations = 0;                         // of dWorldQuickStep; 0: dWorldStep
  std::optional<double> errorReduction = {};  // ERP
};

/// What ODE gives up with: its own handler would end the program.
[[noreturn]] void giveUp(int, const char*, va_list) {
  throw Error(ErrorKind::unstable, "", "ODE stopped at an internal error");
}
void ignore(int, const char*, va_list) {}

void startOde() {
  static const bool isStarted = [] {
    dInitODE2(0);
    dSetErrorHandler(giveUp);
    dSetDebugHandler(giveUp);
    dSetMessageHandler(ignore);
    return dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll)) != 0;
  }();
  CRADLE_CHECK(isStarted);
  dRandSetSeed(kSeed);
}

struct GeomMaker {
  dGeomID operator()(const Sphere& sphere) const { return dCreateSphere(nullptr, sphere.radius); }
  dGeomID operator()(const Box& box) const { return dCreateBox(nullptr, box.size.x(), box.size.y(), box.size.z()); }
  dGeomID operator()(const Cylinder& cylinder) const {
    return dCreateCylinder(nullptr, cylinder.radius, cylinder.length);
  }
  dGeomID operator()(const Capsule& capsule) const { return dCreateCapsule(nullptr, capsule.radius, capsule.length); }
  dGeomID operator()(const Plane&) const { return nullptr; }  // made of its place in the world
};

class OdeWorld : public SteppedWorld {
 public:
  OdeWorld(const Scene& scene, const Assembly& assembly, const OdeSettings& settings, double timeStep);
  ~OdeWorld() override;
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;
  void read(VectorX& state) override;

 private:
  void step() override;
  void addBody(const RigidBody& body, Eigen::Index index);
  void addGeom(int sceneBody);
  void addJoints();
  void setMotor(const Constraint& joint, dJointID id, void (*set)(dJointID, int, dReal));
  void setMotion(dBodyID body, Eigen::Index index);
  void addForces();
  void leadDriven();
  void placeDriven();
  void addContacts(dGeomID a, dGeomID b);
  dBodyID bodyOf(const Attachment& attachment) const;

  const Scene& scene_;
  const Assembly& assembly_;
  bool isQuick_;
  std::set<std::pair<int, int>> joined_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<dBodyID> bodies_;  // in the order of the assembly
  std::vector<int> geomBodies_;  // scene body of each geom, which points here
  VectorX state_;                // at the last look
};

OdeWorld::OdeWorld(const Scene& scene, const Assembly& assembly, const OdeSettings& settings, double timeStep)
    : SteppedWorld(timeStep),
      scene_(scene),
      assembly_(assembly),
      isQuick_(settings.iterations > 0),
      joined_(joinedBodies(scene)),
      state_(assembly.state) {
  startOde();
  world_ = dWorldCreate();
  space_ = dHashSpaceCreate(nullptr);
  contacts_ = dJointGroupCreate(0);
  dWorldSetGravity(world_, scene.gravity.x(), scene.gravity.y(), scene.gravity.z());
  if (isQuick_) dWorldSetQuickStepNumIterations(world_, settings.iterations);
  if (settings.errorReduction) dWorldSetERP(world_, *settings.errorReduction);
  for (std::size_t i = 0; i < assembly.mechanism.bodies.size(); ++i)
    addBody(assembly.mechanism.bodies[i], static_cast<Eigen::Index>(i));
  geomBodies_.reserve(scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) addGeom(static_cast<int>(i));
  addJoints();
}

OdeWorld::~OdeWorld() {
  dJointGroupDestroy(contacts_);
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
}

void OdeWorld::addBody(const RigidBody& body, Eigen::Index index) {
  const dBodyID added = dBodyCreate(world_);
  if (body.isDriven()) {
    dBodySetKinematic(added);
  } else {
    const Mat3& inertia = body.inertiaTensor;
    dMass mass;
    dMassSetParameters(&mass, body.mass, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1),
                       inertia(0, 2), inertia(1, 2));
    dBodySetMass(added, &mass);
  }
  setMotion(added, index);
  bodies_.push_back(added);
}

/// Pose and velocity as in state_.
void OdeWorld::setMotion(dBodyID body, Eigen::Index index) {
  const Vec3 place = centerOfMass(state_, index), velocity = linearVelocity(state_, index);
  const Vec3 spin = angularVelocity(state_, index);
  const Quat turn = orientation(state_, index);
  const dReal quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  dBodySetPosition(body, place.x(), place.y(), place.z());
  dBodySetQuaternion(body, quaternion);
  dBodySetLinearVel(body, velocity.x(), velocity.y(), velocity.z());
  dBodySetAngularVel(body, spin.x(), spin.y(), spin.z());
}

void OdeWorld::addGeom(int sceneBody) {
  const Body& body = scene_.bodies[static_cast<std::size_t>(sceneBody)];
  const auto shape = peerShapeOf(body, scene_);
  if (!shape) return;
  const int moving = indexAmong(assembly_.sceneBodies, sceneBody);
  const RigidTransform bodyFromFrame{Quat::Identity(), body.massProperties.centerOfMass};
  const RigidTransform place =
      moving == kFixed ? body.worldFromBody * shape->bodyFromShape : bodyFromFrame.inverse() * shape->bodyFromShape;
  dGeomID geom = std::visit(GeomMaker{}, shape->shape);
  if (const auto* plane = std::get_if<Plane>(&shape->shape)) {
    const Vec3 normal = place.rotation * plane->normal;
    geom = dCreatePlane(nullptr, normal.x(), normal.y(), normal.z(), normal.dot(place.translation));
  } else {
    const bool isLong = std::holds_alternative<Cylinder>(shape->shape) || std::holds_alternative<Capsule>(shape->shape);
    const Quat along = isLong ? Quat(kLongAxis[0], kLongAxis[1], kLongAxis[2], kLongAxis[3]) : Quat::Identity();
    const Quat turn = place.rotation * along;
    const dReal quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
    const Vec3& at = place.translation;
    if (moving == kFixed) {
      dGeomSetPosition(geom, at.x(), at.y(), at.z());
      dGeomSetQuaternion(geom, quaternion);
    } else {
      dGeomSetBody(geom, bodies_[static_cast<std::size_t>(moving)]);
      dGeomSetOffsetPosition(geom, at.x(), at.y(), at.z());
      dGeomSetOffsetQuaternion(geom, quaternion);
    }
  }
  geomBodies_.push_back(sceneBody);
  dGeomSetData(geom, &geomBodies_.back());
  dSpaceAdd(space_, geom);
}

dBodyID OdeWorld::bodyOf(const Attachment& attachment) const {
  return attachment.body == kFixed ? nullptr : bodies_[static_cast<std::size_t>(attachment.body)];
}

void OdeWorld::addJoints() {
  const Constraints& constraints = assembly_.mechanism.constraints;
  const auto placeOf = [&](const Attachment& attachment) { return motionOf(attachment, state_).position; };
  forEachOf<RodConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const RodConstraint& rod) {
    const dJointID joint = dJointCreateDBall(world_, nullptr);
    dJointAttach(joint, bodyOf(a), bodyOf(b));
    const Vec3 atA = placeOf(a), atB = placeOf(b);
    dJointSetDBallAnchor1(joint, atA.x(), atA.y(), atA.z());
    dJointSetDBallAnchor2(joint, atB.x(), atB.y(), atB.z());
    dJointSetDBallDistance(joint, rod.length);
  });
  forEachOf<BallJointConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const auto&) {
    const dJointID joint = dJointCreateBall(world_, nullptr);
    dJointAttach(joint, bodyOf(a), bodyOf(b));
    const Vec3 at = placeOf(a);
    dJointSetBallAnchor(joint, at.x(), at.y(), at.z());
  });
  forEachOf<HingeConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const HingeConstraint& hinge) {
    const dJointID joint = dJointCreateHinge(world_, nullptr);
    dJointAttach(joint, bodyOf(a), bodyOf(b));
    const Vec3 at = placeOf(a);
    const Vec3 axis = a.body == kFixed ? hinge.axisA : orientation(state_, a.body) * hinge.axisA;
    dJointSetHingeAnchor(joint, at.x(), at.y(), at.z());
    dJointSetHingeAxis(joint, axis.x(), axis.y(), axis.z());
    setMotor({a, b, hinge}, joint, dJointSetHingeParam);
  });
  forEachOf<SliderConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const auto& slider) {
    const dJointID joint = dJointCreateSlider(world_, nullptr);
    dJointAttach(joint, bodyOf(a), bodyOf(b));
    const Vec3 axis = b.body == kFixed ? slider.axisB() : orientation(state_, b.body) * slider.axisB();
    dJointSetSliderAxis(joint, axis.x(), axis.y(), axis.z());
    setMotor({a, b, slider}, joint, dJointSetSliderParam);
  });
  forEachOf<WeldConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const auto&) {
    const dJointID joint = dJointCreateFixed(world_, nullptr);
    dJointAttach(joint, bodyOf(a), bodyOf(b));
    dJointSetFixed(joint);
  });
}

/// Gives a joint its motor, if that has a target velocity. A hinge takes a lone body for its first, a slider does not.
void OdeWorld::setMotor(const Constraint& joint, dJointID id, void (*set)(dJointID, int, dReal)) {
  const JointMotor* motor = motorOf(joint, assembly_.mechanism.motors);
  if (!motor || !motor->hasTarget) return;
  const bool isTurned = joint.anchorA.body == kFixed && std::holds_alternative<HingeConstraint>(joint.kind);
  set(id, dParamVel, isTurned ? -motor->targetVelocity : motor->targetVelocity);
  set(id, dParamFMax, motor->maxForce);
}

void OdeWorld::addForces() {
  const Mechanism& mechanism = assembly_.mechanism;
  if (mechanism.springs.empty() && mechanism.motors.empty()) return;
  read(state_);
  const auto addForce = [&](const Attachment& to, const Vec3& force, const Vec3& at) {
    if (to.body != kFixed) dBodyAddForceAtPos(bodyOf(to), force.x(), force.y(), force.z(), at.x(), at.y(), at.z());
  };
  const auto addTorque = [&](const Attachment& to, const Vec3& torque) {
    if (to.body != kFixed) dBodyAddTorque(bodyOf(to), torque.x(), torque.y(), torque.z());
  };
  for (const SpringForce& spring : mechanism.springs) {
    const SpringAction action = actionOf(spring, state_);
    addForce(spring.anchorA, action.forceOnA, action.a.position);
    addForce(spring.anchorB, -action.forceOnA, action.b.position);
  }
  for (const JointMotor& motor : mechanism.motors) {
    if (motor.hasTarget) continue;  // the joint's own
    const MotorAction action = actionOf(motor, state_);
    addForce(motor.joint.anchorA, action.force, action.point), addTorque(motor.joint.anchorA, action.torque);
    addForce(motor.joint.anchorB, -action.force, action.point), addTorque(motor.joint.anchorB, -action.torque);
  }
}

/// Gives driven bodies the velocities that take them to their places at the end of the step: others feel those.
void OdeWorld::leadDriven() {
  for (const DrivenBody& driven : assembly_.mechanism.driven) {
    const MeanVelocity velocity = meanVelocity(driven.motion, time(), endTime());
    const dBodyID body = bodies_[static_cast<std::size_t>(driven.body)];
    dBodySetLinearVel(body, velocity.linear.x(), velocity.linear.y(), velocity.linear.z());
    dBodySetAngularVel(body, velocity.angular.x(), velocity.angular.y(), velocity.angular.z());
  }
}

void OdeWorld::placeDriven() {
  place(assembly_.mechanism.driven, endTime(), state_);
  for (const DrivenBody& driven : assembly_.mechanism.driven)
    setMotion(bodies_[static_cast<std::size_t>(driven.body)], driven.body);
}

void OdeWorld::addContacts(dGeomID a, dGeomID b) {
  const int bodyA = *static_cast<const int*>(dGeomGetData(a)), bodyB = *static_cast<const int*>(dGeomGetData(b));
  const auto isDynamic = [&](int body) {
    return scene_.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic;
  };
  if (!isDynamic(bodyA) && !isDynamic(bodyB)) return;
  if (joined_.count(std::minmax(bodyA, bodyB)) > 0) return;
  const auto materialOf = [&](int body) {
    return static_cast<std::size_t>(scene_.bodies[static_cast<std::size_t>(body)].material);
  };
  const SurfacePair& law = scene_.surfacePairs[materialOf(bodyA)][materialOf(bodyB)];
  std::array<dContactGeom, kMaxContacts> found;
  const int count = dCollide(a, b, kMaxContacts, found.data(), sizeof(dContactGeom));
  for (int i = 0; i < count; ++i) {
    dContact contact{};
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = law.dynamicFriction;
    if (law.restitution > 0) {
      contact.surface.mode |= dContactBounce;
      contact.surface.bounce = law.restitution;
      contact.surface.bounce_vel = kOdeBounceFrom;
    }
    contact.geom = found[static_cast<std::size_t>(i)];
    dJointAttach(dJointCreateContact(world_, contacts_, &contact), dGeomGetBody(a), dGeomGetBody(b));
  }
}

void OdeWorld::step() {
  addForces();
  leadDriven();
  dSpaceCollide(space_, this,
                [](void* self, dGeomID a, dGeomID b) { static_cast<OdeWorld*>(self)->addContacts(a, b); });
  const int isDone = isQuick_ ? dWorldQuickStep(world_, timeStep()) : dWorldStep(world_, timeStep());
  if (!isDone) throw Error(ErrorKind::limit, "", "ODE had no memory for a step");
  dJointGroupEmpty(contacts_);
  placeDriven();
}

void OdeWorld::read(VectorX& state) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Index index = static_cast<Eigen::Index>(i);
    const dReal* turn = dBodyGetQuaternion(bodies_[i]);
    centerOfMass(state, index) = Vec3::Map(dBodyGetPosition(bodies_[i]));
    setOrientation(state, index, Quat(turn[0], turn[1], turn[2], turn[3]));
    linearVelocity(state, index) = Vec3::Map(dBodyGetLinearVel(bodies_[i]));
    angularVelocity(state, index) = Vec3::Map(dBodyGetAngularVel(bodies_[i]));
  }
}

std::string missingInOde(const Scene& scene, const Assembly&) {
  if (!scene.ropes.empty()) return "ropes";
  if (const std::string missing = missingInEveryPeer(scene); !missing.empty()) return missing;
  return meshThatTouches(scene);
}

Peer peerOf(const std::string& name, const std::string& title, const OdeSettings& settings) {
  Peer peer{"ode", "0.16.2", name, title, "", SettingKind::timeStep, missingInOde, {}};
  peer.configuration =
      settings.iterations > 0 ? fmt::format("dWorldQuickStep, {} iterations", settings.iterations) : "dWorldStep";
  peer.configuration += fmt::format(", ERP {}, CFM 1e-10, friction pyramid (dContactApprox1), bounces from {} m/s",
                                    settings.errorReduction.value_or(0.2), kOdeBounceFrom);
  peer.open = [settings](const Scene& scene, const Assembly& assembly, double timeStep) {
    return std::make_unique<OdeWorld>(scene, assembly, settings, timeStep);
  };
  return peer;
}

}  // namespace

std::vector<Peer> odePeers() {
  return {peerOf("ode", "ODE, step", {}), peerOf("odeQuick", "ODE, quick step", {20, {}}),
          peerOf("odeTuned", "ODE, step, ERP 0.8", {0, kTunedErrorReduction}),
          peerOf("odeQuick100", "ODE, quick step, 100 iterations", {100, {}})};
}

}  // namespace cradle
