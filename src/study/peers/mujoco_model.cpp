// MJCF, MuJoCo 2.2.2 (https://mujoco.readthedocs.io, "XML reference", "Computation", "Modeling"). Contacts and other
// constraints are springs with dampers there (solref) and give way by a part of what acts on them (solimp).

#include "study/peers/mujoco_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/principal_axes.h"
#include "math/rotation.h"
#include "study/peers/peer_shapes.h"

namespace cradle {
namespace {

constexpr const char* kDefaultGiving = R"(solref="0.02 1")";
constexpr double kTunedTime = 2;        // steps: the shortest time constant that the manual advises
constexpr double kBouncePhase = 0.2;    // rad a step of a contact that bounces: 16 steps a contact
constexpr double kMaxFrequency = 2000;  // rad/s of a contact that bounces
constexpr double kDrivenMass = 1e9;     // of driven bodies, times all others': rounding is 1e-16 of it
constexpr double kSpinFriction = 0.005, kRollFriction = 0.0001;         // m: not used by contacts of three dimensions
const Quat kLongAxis(0.70710678118654752, -0.70710678118654752, 0, 0);  // from z, MuJoCo's, to y, ours

std::string text(const Vec3& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}
std::string text(const Quat& q) {
  return fmt::format("{} {} {} {}", q.w(), q.x(), q.y(), q.z());
}
std::string place(const Vec3& position, const Quat& turn) {
  return fmt::format(R"(pos="{}" quat="{}")", text(position), text(turn));
}

struct GeomText {
  RigidTransform frameFromShape;

  std::string operator()(const Sphere& sphere) const {
    return fmt::format(R"(type="sphere" size="{}" {})", sphere.radius, placed(Quat::Identity()));
  }
  std::string operator()(const Box& box) const {
    return fmt::format(R"(type="box" size="{}" {})", text(Vec3(box.size / 2)), placed(Quat::Identity()));
  }
  std::string operator()(const Cylinder& cylinder) const {
    return fmt::format(R"(type="cylinder" size="{} {}" {})", cylinder.radius, cylinder.length / 2, placed(kLongAxis));
  }
  std::string operator()(const Capsule& capsule) const {
    return fmt::format(R"(type="capsule" size="{} {}" {})", capsule.radius, capsule.length / 2, placed(kLongAxis));
  }
  std::string operator()(const Plane& plane) const {
    return fmt::format(R"(type="plane" size="0 0 1" {})", placed(rotationBetween(Vec3::UnitZ(), plane.normal)));
  }
  std::string placed(const Quat& shapeFromGeom) const {
    return place(frameFromShape.translation, frameFromShape.rotation * shapeFromGeom);
  }
};

class ModelText {
 public:
  ModelText(const Scene& scene, const Assembly& assembly, const JointTree& tree, const MujocoSettings& settings,
            double timeStep)
      : scene_(scene),
        assembly_(assembly),
        tree_(tree),
        timeStep_(timeStep),
        isTuned_(settings.isTuned),
        giving_(isTuned_ ? fmt::format(R"(solref="{} 1" solimp="0.99 0.999 0.001")", kTunedTime * timeStep)
                         : kDefaultGiving) {
    text_ = fmt::format(R"(<mujoco><compiler angle="radian" inertiafromgeom="false"/>)"
                        R"(<option timestep="{}" gravity="{}" integrator="{}"{}/>)",
                        timeStep, text(scene.gravity), settings.integrator,
                        isTuned_ ? R"( cone="elliptic" impratio="10")" : "");
    if (!assembly.mechanism.driven.empty()) add(R"(<statistic meaninertia="{}"/>)", meanInertia());
    text_ += "<worldbody>";
    addFixedGeoms();
    addSites(kFixed);
    addChildren(kFixed);
    text_ += "</worldbody><tendon>";
    addTendons();
    text_ += "</tendon><equality>";
    addEqualities();
    text_ += "</equality><contact>";
    addContacts();
    text_ += "</contact></mujoco>";
  }

  std::string take() { return std::move(text_); }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    text_ += fmt::format(format, std::forward<Values>(values)...);
  }

  void addFixedGeoms() {
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      if (scene_.bodies[i].motion == Motion::fixed) addGeom(i, scene_.bodies[i].worldFromBody);
  }

  void addGeom(std::size_t sceneBody, const RigidTransform& frameFromBody) {
    const auto shape = peerShapeOf(scene_.bodies[sceneBody], scene_);
    if (!shape) return;
    touching_.push_back(sceneBody);
    add(R"(<geom name="geom{}" contype="0" conaffinity="0" {}/>)", sceneBody,
        std::visit(GeomText{frameFromBody * shape->bodyFromShape}, shape->shape));
  }

  void addChildren(int parent) {
    for (const TreeLink& link : tree_.links)
      if (link.parent == parent) addBody(link);
  }

  void addBody(const TreeLink& link) {
    const std::size_t index = static_cast<std::size_t>(link.body);
    const RigidBody& body = assembly_.mechanism.bodies[index];
    const PrincipalAxes principal = principalAxes(body.inertiaTensor);
    const double mass = body.isDriven() ? kDrivenMass * massOfOthers() : body.mass;
    const Vec3 moments = body.isDriven() ? Vec3(Vec3::Constant(mass)) : principal.moments;
    add(R"(<body name="body{}" {}>)", link.body, placeInParent(link));
    add(R"(<inertial mass="{}" diaginertia="{}" {}/>)", mass, text(moments), place(Vec3::Zero(), Quat(principal.axes)));
    if (link.kind == TreeLink::Kind::free) text_ += "<freejoint/>";
    if (link.kind == TreeLink::Kind::ball) add(R"(<joint type="ball" pos="{}"/>)", text(link.anchor));
    if (link.kind == TreeLink::Kind::hinge)
      add(R"(<joint type="hinge" pos="{}" axis="{}"/>)", text(link.anchor), text(link.axis));
    if (link.kind == TreeLink::Kind::slider) add(R"(<joint type="slide" axis="{}"/>)", text(link.axis));
    const std::size_t sceneBody = static_cast<std::size_t>(assembly_.sceneBodies[index]);
    addGeom(sceneBody, {Quat::Identity(), -scene_.bodies[sceneBody].massProperties.centerOfMass});
    addSites(link.body);
    addChildren(link.body);
    text_ += "</body>";
  }

  double massOfOthers() const {
    double sum = 0;
    for (const RigidBody& body : assembly_.mechanism.bodies) sum += body.mass;
    return sum;
  }

  /// What the solver's tolerance is measured by (kg, kg m^2): the mean over coordinates, without driven bodies.
  double meanInertia() const {
    double sum = 0;
    for (const RigidBody& body : assembly_.mechanism.bodies) sum += 3 * body.mass + body.inertiaTensor.trace();
    const std::size_t count = assembly_.mechanism.bodies.size() - assembly_.mechanism.driven.size();
    return sum / (6 * static_cast<double>(count));
  }

  std::string placeInParent(const TreeLink& link) const {
    const Vec3 position = centerOfMass(assembly_.state, link.body);
    const Quat turn = startOf(link, assembly_).parentFromBody;
    if (link.parent == kFixed) return place(position, turn);
    const Vec3 away = position - centerOfMass(assembly_.state, link.parent);
    return place(orientation(assembly_.state, link.parent).conjugate() * away, turn);
  }

  /// Those of the constraints that are rods.
  std::vector<std::size_t> rods() const {
    const Constraints& constraints = assembly_.mechanism.constraints;
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < constraints.size(); ++i)
      if (std::holds_alternative<RodConstraint>(constraints[i].kind)) indices.push_back(i);
    return indices;
  }

  /// The ends of springs and rods that a body has.
  void addSites(int body) {
    const auto addSite = [&](const Attachment& attachment, const char* kind, std::size_t number, char end) {
      if (attachment.body == body) add(R"(<site name="{}{}{}" pos="{}"/>)", kind, number, end, text(attachment.point));
    };
    const Mechanism& mechanism = assembly_.mechanism;
    for (std::size_t i = 0; i < mechanism.springs.size(); ++i) {
      addSite(mechanism.springs[i].anchorA, "spring", i, 'A');
      addSite(mechanism.springs[i].anchorB, "spring", i, 'B');
    }
    for (const std::size_t i : rods()) {
      addSite(mechanism.constraints[i].anchorA, "rod", i, 'A');
      addSite(mechanism.constraints[i].anchorB, "rod", i, 'B');
    }
  }

  void addTendons() {
    const Mechanism& mechanism = assembly_.mechanism;
    for (std::size_t i = 0; i < mechanism.springs.size(); ++i) {
      const SpringForce& spring = mechanism.springs[i];
      add(R"(<spatial springlength="{1}" stiffness="{2}" damping="{3}"><site site="spring{0}A"/><site site="spring{0}B"/></spatial>)",
          i, spring.restLength, spring.stiffness, spring.damping);
    }
    for (const std::size_t i : rods())
      add(R"(<spatial name="rod{0}"><site site="rod{0}A"/><site site="rod{0}B"/></spatial>)", i);
  }

  /// A rod starts with its length, so that to keep it is to keep the tendon as it is. A hinge that closes a loop is two
  /// points on its axis.
  void addEqualities() {
    for (const std::size_t i : rods()) add(R"(<tendon tendon1="rod{}" {}/>)", i, giving_);
    forEachOf<BallJointConstraint>(
        tree_.loops, [&](const Attachment& a, const Attachment& b, const auto&) { addConnection(a, b, Vec3::Zero()); });
    forEachOf<HingeConstraint>(
        tree_.loops, [&](const Attachment& a, const Attachment& b, const HingeConstraint& hinge) {
          const Vec3 axis = a.body == kFixed ? hinge.axisA : orientation(assembly_.state, a.body) * hinge.axisA;
          addConnection(a, b, axis / 2);
          addConnection(a, b, -axis / 2);
        });
    forEachOf<WeldConstraint>(tree_.loops, [&](const Attachment& a, const Attachment& b, const auto&) {
      const auto [body, other] = bodiesOf(a, b);
      add(R"(<weld body1="body{}"{} {}/>)", body, nameOfSecond(other), giving_);
    });
  }

  /// The bodies of an equality, the one that moves first.
  static std::pair<int, int> bodiesOf(const Attachment& a, const Attachment& b) {
    return a.body != kFixed ? std::pair(a.body, b.body) : std::pair(b.body, a.body);
  }

  static std::string nameOfSecond(int body) { return body == kFixed ? "" : fmt::format(R"( body2="body{}")", body); }

  void addConnection(const Attachment& a, const Attachment& b, const Vec3& aside) {
    const auto [body, other] = bodiesOf(a, b);
    const Vec3 point = motionOf(a, assembly_.state).position + aside - centerOfMass(assembly_.state, body);
    add(R"(<connect body1="body{}"{} anchor="{}" {}/>)", body, nameOfSecond(other),
        text(Vec3(orientation(assembly_.state, body).conjugate() * point)), giving_);
  }

  void addContacts() {
    const auto joined = joinedBodies(scene_);
    std::sort(touching_.begin(), touching_.end());
    for (const std::size_t a : touching_)
      for (const std::size_t b : touching_) {
        if (a >= b || (scene_.bodies[a].motion != Motion::dynamic && scene_.bodies[b].motion != Motion::dynamic))
          continue;
        if (joined.count({static_cast<int>(a), static_cast<int>(b)}) > 0) continue;
        addPair(a, b);
      }
  }

  void addPair(std::size_t a, std::size_t b) {
    const SurfacePair& law = scene_.surfacePairs[static_cast<std::size_t>(scene_.bodies[a].material)]
                                                [static_cast<std::size_t>(scene_.bodies[b].material)];
    const double friction = law.dynamicFriction;
    add(R"(<pair geom1="geom{}" geom2="geom{}" condim="{}" friction="{} {} {} {} {}" {}/>)", a, b, friction > 0 ? 3 : 1,
        friction, friction, kSpinFriction, kRollFriction, kRollFriction,
        law.restitution > 0 ? bouncing(law.restitution) : giving_);
  }

  /// solref = (-k, -b) of an oscillator that leaves with e times the speed it came with: e = exp(-pi z / sqrt(1 - z^2))
  /// for a damping ratio z, half a turn after contact.
  std::string bouncing(double restitution) const {
    constexpr double kPi = 3.14159265358979324;
    const double frequency = std::min(kBouncePhase / timeStep_, kMaxFrequency);
    const double decay = -std::log(restitution) / kPi;
    const double ratio = decay / std::sqrt(1 + decay * decay);
    return fmt::format(R"(solref="{} {}")", -frequency * frequency, -2 * ratio * frequency);
  }

  const Scene& scene_;
  const Assembly& assembly_;
  const JointTree& tree_;
  double timeStep_;  // s
  bool isTuned_;
  std::string giving_;                 // of constraints that do not bounce
  std::vector<std::size_t> touching_;  // scene bodies with a geom
  std::string text_;
};

}  // namespace

std::string mujocoModelOf(const Scene& scene, const Assembly& assembly, const JointTree& tree,
                          const MujocoSettings& settings, double timeStep) {
  return ModelText(scene, assembly, tree, settings, timeStep).take();
}

}  // namespace cradle
