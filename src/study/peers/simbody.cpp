// Simbody 3.7 (M. A. Sherman, A. Seth, S. L. Delp, "Simbody: multibody dynamics for biomedical research", Procedia
// IUTAM 2, 2011).

#include "study/peers/simbody.h"

#include <SimTKcommon/internal/common.h>

// Simbody's headers compare indices of a type in a way that C++20 finds ambiguous: the types get an operator that fits.
#undef SimTK_DEFINE_UNIQUE_INDEX_TYPE
#define SimTK_DEFINE_UNIQUE_INDEX_TYPE(NAME)                                                   \
  SimTK_DEFINE_AND_EXPORT_UNIQUE_LOCAL_INDEX_TYPE(, , , NAME) static const NAME Invalid##NAME; \
  inline bool operator==(NAME a, NAME b) {                                                     \
    return int(a) == int(b);                                                                   \
  }
#include <Simbody.h>

#include <cmath>

#include "core/error.h"
#include "math/principal_axes.h"
#include "math/rotation.h"
#include "study/peers/joint_tree.h"
#include "study/peers/peer_shapes.h"

namespace cradle {
namespace {

SimTK::Vec3 toSimbody(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
SimTK::Rotation toSimbody(const Quat& q) {
  return SimTK::Rotation(SimTK::Quaternion(q.w(), q.x(), q.y(), q.z()));
}
Vec3 fromSimbody(const SimTK::Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// Which of its integrators.
enum class SimbodyIntegrator { merson, feldberg };

/// The joint's frame in its body's: Simbody's pins turn about z, its sliders go along x.
Quat bodyFromJointOf(const TreeLink& link) {
  if (link.kind == TreeLink::Kind::hinge) return rotationBetween(Vec3::UnitZ(), link.axis);
  if (link.kind == TreeLink::Kind::slider) return rotationBetween(Vec3::UnitX(), link.axis);
  return Quat::Identity();
}

/// A free body that moves as is prescribed: its coordinates are a quaternion and a position.
class SimbodyDrive : public SimTK::Motion::Custom::Implementation {
 public:
  explicit SimbodyDrive(const PrescribedMotion& motion) : motion_(motion) {}

  SimTK::Motion::Level getLevel(const SimTK::State&) const override { return SimTK::Motion::Position; }
  void calcPrescribedPosition(const SimTK::State& state, int, double* q) const override {
    const PoseMotion now = motionAt(motion_, state.getTime());
    put(now.pose.rotation, now.pose.translation, q);
  }
  void calcPrescribedPositionDot(const SimTK::State& state, int, double* rates) const override {
    const PoseMotion now = motionAt(motion_, state.getTime());
    put(orientationRate(now.pose.rotation, now.angularVelocity), now.velocity, rates);
  }
  void calcPrescribedPositionDotDot(const SimTK::State& state, int, double* rates) const override {
    const PoseMotion now = motionAt(motion_, state.getTime());
    const Quat rate = orientationRate(now.pose.rotation, now.angularVelocity);
    const Quat rateOfRate = Quat(orientationRate(now.pose.rotation, now.angularAcceleration).coeffs() +
                                 orientationRate(rate, now.angularVelocity).coeffs());
    put(rateOfRate, now.acceleration, rates);
  }

 private:
  static void put(const Quat& turn, const Vec3& place, double* values) {
    values[0] = turn.w();
    Vec3::Map(values + 1) = turn.vec();
    Vec3::Map(values + 4) = place;
  }

  PrescribedMotion motion_;
};

class SimbodyWorld : public PeerWorld {
 public:
  SimbodyWorld(const Assembly& assembly, SimbodyIntegrator kind, double accuracy);
  void advance(double time) override;
  void read(VectorX& state) override;
  long evaluations() const override { return integrator_->getNumRealizations(); }

 private:
  void addLink(const TreeLink& link, const Assembly& assembly);
  void addForces(const Assembly& assembly);
  void addConstraints(const Assembly& assembly, const JointTree& tree);
  void start(const Assembly& assembly, const JointTree& tree, double accuracy);
  void setStart(const TreeLink& link, const Assembly& assembly, SimTK::State& state);
  SimTK::MobilizedBody& bodyOf(int body);

  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_{system_};
  SimTK::GeneralForceSubsystem forces_{system_};
  std::vector<SimTK::MobilizedBody> bodies_;  // in the order of the assembly
  std::unique_ptr<SimTK::Integrator> integrator_;
};

SimbodyWorld::SimbodyWorld(const Assembly& assembly, SimbodyIntegrator kind, double accuracy)
    : bodies_(assembly.mechanism.bodies.size()) {
  const JointTree tree = jointTreeOf(assembly);
  for (const TreeLink& link : tree.links) addLink(link, assembly);
  for (const DrivenBody& driven : assembly.mechanism.driven)
    SimTK::Motion::Custom(bodyOf(driven.body), new SimbodyDrive(driven.motion));  // the system deletes it
  addForces(assembly);
  addConstraints(assembly, tree);
  system_.realizeTopology();
  if (kind == SimbodyIntegrator::merson) integrator_ = std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system_);
  if (kind == SimbodyIntegrator::feldberg) integrator_ = std::make_unique<SimTK::RungeKuttaFeldbergIntegrator>(system_);
  start(assembly, tree, accuracy);
}

SimTK::MobilizedBody& SimbodyWorld::bodyOf(int body) {
  return body == kFixed ? static_cast<SimTK::MobilizedBody&>(matter_.updGround())
                        : bodies_[static_cast<std::size_t>(body)];
}

void SimbodyWorld::addLink(const TreeLink& link, const Assembly& assembly) {
  const RigidBody& body = assembly.mechanism.bodies[static_cast<std::size_t>(link.body)];
  const Mat3 inertia =
      body.isDriven() ? Mat3(Mat3::Identity()) : body.inertiaTensor;  // any: what is prescribed needs no force
  const SimTK::Body::Rigid rigid(SimTK::MassProperties(
      body.isDriven() ? 1 : body.mass, SimTK::Vec3(0),
      SimTK::Inertia(inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2))));
  const Quat parentFromBody = startOf(link, assembly).parentFromBody;
  const Quat bodyFromJoint = bodyFromJointOf(link);
  const SimTK::Transform inBody(toSimbody(bodyFromJoint), toSimbody(link.anchor));
  const SimTK::Transform inParent(toSimbody(parentFromBody * bodyFromJoint), toSimbody(link.parentAnchor));
  SimTK::MobilizedBody& parent = bodyOf(link.parent);
  SimTK::MobilizedBody& added = bodies_[static_cast<std::size_t>(link.body)];
  switch (link.kind) {
    case TreeLink::Kind::free:
      added = SimTK::MobilizedBody::Free(parent, rigid);
      break;
    case TreeLink::Kind::ball:
      added = SimTK::MobilizedBody::Ball(parent, inParent, rigid, inBody);
      break;
    case TreeLink::Kind::hinge:
      added = SimTK::MobilizedBody::Pin(parent, inParent, rigid, inBody);
      break;
    case TreeLink::Kind::slider:
      added = SimTK::MobilizedBody::Slider(parent, inParent, rigid, inBody);
      break;
    case TreeLink::Kind::weld:
      added = SimTK::MobilizedBody::Weld(parent, inParent, rigid, inBody);
      break;
  }
  if (link.motorForce != 0) SimTK::Force::MobilityConstantForce(forces_, added, 0, link.motorForce);
}

void SimbodyWorld::addForces(const Assembly& assembly) {
  SimTK::Force::UniformGravity(forces_, matter_, toSimbody(assembly.mechanism.gravity));
  for (const SpringForce& spring : assembly.mechanism.springs) {
    const SimTK::MobilizedBody &a = bodyOf(spring.anchorA.body), &b = bodyOf(spring.anchorB.body);
    const SimTK::Vec3 pointA = toSimbody(spring.anchorA.point), pointB = toSimbody(spring.anchorB.point);
    SimTK::Force::TwoPointLinearSpring(forces_, a, pointA, b, pointB, spring.stiffness, spring.restLength);
    if (spring.damping > 0) SimTK::Force::TwoPointLinearDamper(forces_, a, pointA, b, pointB, spring.damping);
  }
}

void SimbodyWorld::addConstraints(const Assembly& assembly, const JointTree& tree) {
  const auto pointOf = [](const Attachment& attachment) { return toSimbody(attachment.point); };
  const Constraints& constraints = assembly.mechanism.constraints;
  forEachOf<RodConstraint>(constraints, [&](const Attachment& a, const Attachment& b, const RodConstraint& rod) {
    SimTK::Constraint::Rod(bodyOf(a.body), pointOf(a), bodyOf(b.body), pointOf(b), rod.length);
  });
  const auto addPoint = [&](const Attachment& a, const Attachment& b, const auto&) {
    SimTK::Constraint::Ball(bodyOf(a.body), pointOf(a), bodyOf(b.body), pointOf(b));
  };
  const auto keepOrientation = [&](const Attachment& a, const Attachment& b, const Mat3& aFromB) {
    SimTK::Constraint::ConstantOrientation(bodyOf(a.body), toSimbody(Quat(aFromB)), bodyOf(b.body), SimTK::Rotation());
  };
  forEachOf<BallJointConstraint>(tree.loops, addPoint);
  forEachOf<HingeConstraint>(tree.loops, [&](const Attachment& a, const Attachment& b, const HingeConstraint& hinge) {
    addPoint(a, b, hinge);
    for (const Vec3& across : hinge.acrossB)
      SimTK::Constraint::ConstantAngle(bodyOf(a.body), SimTK::UnitVec3(toSimbody(hinge.axisA)), bodyOf(b.body),
                                       SimTK::UnitVec3(toSimbody(across)));
  });
  forEachOf<SliderConstraint>(tree.loops, [&](const Attachment& a, const Attachment& b, const auto& slider) {
    SimTK::Constraint::PointOnLine(bodyOf(b.body), SimTK::UnitVec3(toSimbody(slider.axisB())), pointOf(b),
                                   bodyOf(a.body), pointOf(a));
    keepOrientation(a, b, slider.aFromB);
  });
  forEachOf<WeldConstraint>(tree.loops, [&](const Attachment& a, const Attachment& b, const auto& weld) {
    addPoint(a, b, weld);
    keepOrientation(a, b, weld.aFromB);
  });
}

/// A joint starts at no turn; a free body has its pose and velocity as coordinates.
void SimbodyWorld::setStart(const TreeLink& link, const Assembly& assembly, SimTK::State& state) {
  const SimTK::MobilizedBody& body = bodyOf(link.body);
  const Quat turn = orientation(assembly.state, link.body);
  const LinkStart start = startOf(link, assembly);
  if (link.kind == TreeLink::Kind::free) {
    const Vec3 place = centerOfMass(assembly.state, link.body), velocity = linearVelocity(assembly.state, link.body);
    body.setQToFitTransform(state, SimTK::Transform(toSimbody(turn), toSimbody(place)));
    body.setUToFitVelocity(state, SimTK::SpatialVec(toSimbody(turn * start.relativeSpin), toSimbody(velocity)));
    return;
  }
  const Quat jointFromBody = bodyFromJointOf(link).conjugate();
  if (link.kind == TreeLink::Kind::slider)
    body.setUToFitLinearVelocity(state, toSimbody(jointFromBody * start.relativeVelocity));
  else
    body.setUToFitAngularVelocity(state, toSimbody(jointFromBody * start.relativeSpin));
}

void SimbodyWorld::start(const Assembly& assembly, const JointTree& tree, double accuracy) {
  SimTK::State state = system_.getDefaultState();
  system_.realizeModel(state);
  for (const TreeLink& link : tree.links) setStart(link, assembly, state);
  integrator_->setAccuracy(accuracy);
  integrator_->setAllowInterpolation(false);  // steps end where they are looked at: interpolants are of order 3
  integrator_->initialize(state);
}

void SimbodyWorld::advance(double time) {
  try {
    while (integrator_->getTime() < time) integrator_->stepTo(time);
  } catch (const SimTK::Exception::Base& fault) {
    throw Error(ErrorKind::limit, "", std::string("Simbody gave up: ") + fault.getMessageText());
  }
}

void SimbodyWorld::read(VectorX& state) {
  const SimTK::State& now = integrator_->getState();
  system_.realize(now, SimTK::Stage::Velocity);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Index index = static_cast<Eigen::Index>(i);
    const SimTK::Quaternion turn = bodies_[i].getBodyRotation(now).convertRotationToQuaternion();
    centerOfMass(state, index) = fromSimbody(bodies_[i].getBodyOriginLocation(now));
    setOrientation(state, index, Quat(turn[0], turn[1], turn[2], turn[3]));
    linearVelocity(state, index) = fromSimbody(bodies_[i].getBodyOriginVelocity(now));
    angularVelocity(state, index) = fromSimbody(bodies_[i].getBodyAngularVelocity(now));
  }
}

std::string missingInSimbody(const Scene& scene, const Assembly& assembly) {
  if (!scene.ropes.empty()) return "ropes";
  if (const std::string missing = missingInEveryPeer(scene); !missing.empty()) return missing;
  if (const std::string missing = missingMotors(jointTreeOf(assembly), assembly); !missing.empty()) return missing;
  const ContactGeometry& geometry = assembly.geometry;
  const auto moves = [](const Collider& collider) { return collider.body != kFixed; };
  const bool anyMoves = std::any_of(geometry.colliders.begin(), geometry.colliders.end(), moves);
  if (anyMoves && geometry.colliders.size() + geometry.planes.size() > 1)
    return "contact of rigid bodies (its contacts have a stiffness, which scenes do not)";
  return "";
}

Peer peerOf(const std::string& name, const std::string& title, SimbodyIntegrator integrator) {
  Peer peer{"simbody", "3.7", name, title, "", SettingKind::accuracy, missingInSimbody, {}};
  peer.configuration =
      std::string(integrator == SimbodyIntegrator::merson ? "Runge-Kutta-Merson" : "Runge-Kutta-Fehlberg") +
      ", joints as coordinates, rods as constraints";
  peer.open = [integrator](const Scene&, const Assembly& assembly, double accuracy) {
    return std::make_unique<SimbodyWorld>(assembly, integrator, accuracy);
  };
  return peer;
}

}  // namespace

std::vector<Peer> simbodyPeers() {
  return {peerOf("simbody", "Simbody, RK-Merson", SimbodyIntegrator::merson),
          peerOf("simbodyFehlberg", "Simbody, RK-Fehlberg", SimbodyIntegrator::feldberg)};
}

}  // namespace cradle
