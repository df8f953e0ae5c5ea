#include "simulate/assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "collision/broad_phase.h"
#include "core/error.h"
#include "core/printable.h"
#include "simulate/pinned_contacts.h"
#include "simulate/steps/step_limit.h"
#include "simulate/welded_bodies.h"

namespace cradle {
namespace {

constexpr double kNearWelded = 2;  // of the sum of two radii: far more than projection moves welded bodies
// m/s a m of rod, and of the fastest velocity if that is above 1: less is no violation, only decimal digits.
constexpr double kVelocityRounding = 1e-12;

Attachment attach(const Anchor& anchor, const Scene& scene, const std::vector<int>& sceneBodies) {
  if (anchor.body == kWorld) return {kFixed, anchor.point};
  const Body& body = scene.bodies[static_cast<std::size_t>(anchor.body)];
  const int moving = indexAmong(sceneBodies, anchor.body);
  if (moving == kFixed) return {kFixed, body.worldFromBody * anchor.point};
  return {moving, anchor.point - body.massProperties.centerOfMass};
}

void addBodies(const Scene& scene, const IslandPlan& island, Assembly& assembly) {
  std::merge(island.bodies.begin(), island.bodies.end(), island.driven.begin(), island.driven.end(),
             std::back_inserter(assembly.sceneBodies));
  for (const int index : assembly.sceneBodies) {
    const Body& body = scene.bodies[static_cast<std::size_t>(index)];
    RigidBody inertia = body.prescribed ? drivenRigidBody() : makeRigidBody(body.massProperties);
    inertia.hasConstantSpin = std::binary_search(island.nonRotating.begin(), island.nonRotating.end(), index);
    if (body.prescribed)
      add(static_cast<int>(assembly.mechanism.bodies.size()), *body.prescribed, assembly.mechanism.driven);
    assembly.mechanism.bodies.push_back(inertia);
    assembly.names.bodies.push_back(body.name);
  }
  VectorX& state = assembly.state;
  state.setZero(stateSize(static_cast<Eigen::Index>(assembly.sceneBodies.size())));
  for (std::size_t i = 0; i < assembly.sceneBodies.size(); ++i) {
    const Body& body = scene.bodies[static_cast<std::size_t>(assembly.sceneBodies[i])];
    const Eigen::Index index = static_cast<Eigen::Index>(i);
    centerOfMass(state, index) = body.worldFromBody * body.massProperties.centerOfMass;
    setOrientation(state, index, body.worldFromBody.rotation);
    linearVelocity(state, index) = body.linearVelocity;
    angularVelocity(state, index) = body.angularVelocity;
  }
}

/// Calls add(link, anchorA, anchorB) for the links of one kind that are attached to a body of the island.
template <class Links, class Add>
void forEachLink(const Links& links, const Scene& scene, const IslandPlan& island, const std::vector<int>& sceneBodies,
                 const Add& add) {
  for (const LinkIndex& place : island.links) {
    if (place.kind != LinkOf<Links>::kKind) continue;
    const auto& link = links[place.index];
    const Attachment a = attach(link.anchorA, scene, sceneBodies), b = attach(link.anchorB, scene, sceneBodies);
    if (a.body != kFixed || b.body != kFixed) add(link, a, b);
  }
}

/// How the bodies of a joint are turned at the start: that of its anchor A in the scene, and both as the mechanism
/// has them, where what is fixed has the world's frame.
struct JointTurns {
  Quat worldFromSceneA, aFromWorld, bFromWorld;
};

JointTurns turnsOf(const Anchor& anchorA, const Anchor& anchorB, const Attachment& a, const Attachment& b,
                   const Scene& scene) {
  const auto worldFromBody = [&](const Anchor& anchor) -> Quat {
    if (anchor.body == kWorld) return Quat::Identity();
    return scene.bodies[static_cast<std::size_t>(anchor.body)].worldFromBody.rotation;
  };
  const auto fromWorld = [&](const Attachment& at, const Anchor& anchor) -> Quat {
    return at.body == kFixed ? Quat::Identity() : worldFromBody(anchor).conjugate();
  };
  return {worldFromBody(anchorA), fromWorld(a, anchorA), fromWorld(b, anchorB)};
}

RodConstraint constraintOf(const Rod& rod, const JointTurns&) {
  return {rod.length};
}

BallJointConstraint constraintOf(const BallJoint&, const JointTurns&) {
  return {};
}

/// Two directions across an axis (unit), and across each other, that turn with body B; all in the world's frame at
/// the start.
std::array<Vec3, 2> acrossInB(const Vec3& axis, const JointTurns& turns) {
  const Vec3 across = axis.unitOrthogonal();
  return {turns.bFromWorld * across, turns.bFromWorld * axis.cross(across)};
}

HingeConstraint constraintOf(const Hinge& hinge, const JointTurns& turns) {
  const Vec3 axis = turns.worldFromSceneA * hinge.axis;
  return {turns.aFromWorld * axis, acrossInB(axis, turns)};
}

WeldConstraint constraintOf(const Weld&, const JointTurns& turns) {
  return {(turns.aFromWorld * turns.bFromWorld.conjugate()).toRotationMatrix()};
}

SliderConstraint constraintOf(const Slider& slider, const JointTurns& turns) {
  return {acrossInB(turns.worldFromSceneA * slider.axis, turns), constraintOf(Weld(), turns).aFromB};
}

JointCoordinate coordinateOf(const Hinge& hinge, const JointTurns& turns) {
  const Vec3 axis = turns.worldFromSceneA * hinge.axis, across = axis.unitOrthogonal();
  return {true, turns.bFromWorld * axis, turns.aFromWorld * across, turns.bFromWorld * across, 0};
}

JointCoordinate coordinateOf(const Slider& slider, const JointTurns& turns) {
  JointCoordinate coordinate;
  coordinate.axisB = turns.bFromWorld * (turns.worldFromSceneA * slider.axis);
  return coordinate;
}

/// m: how far the mass of a body is from an anchor, in the root of the mean square; 0 if no force moves it.
double massDistance(const Attachment& anchor, const std::vector<RigidBody>& bodies) {
  if (anchor.body == kFixed) return 0;
  const RigidBody& body = bodies[static_cast<std::size_t>(anchor.body)];
  return body.isDriven() ? 0 : Vec3(gyrationRadius(body), anchor.point.norm(), 0).norm();
}

/// The coordinate of a joint, which is 0 at the start also where its anchors are apart by an error.
template <class Joint>
Constraint coordinateAtStart(const Joint& joint, const JointTurns& turns, const Attachment& a, const Attachment& b,
                             const Assembly& assembly) {
  JointCoordinate coordinate = coordinateOf(joint, turns);
  if (!coordinate.turns) coordinate.value = -motionOf(Limit(JointLimit{a, b, coordinate}), assembly.state).slackLength;
  return {a, b, coordinate};
}

/// Adds the stops of a joint between two scene bodies; returns their indices into the limits.
std::vector<std::size_t> addStops(const JointRange& range, int bodyA, int bodyB, const Constraint& coordinate,
                                  Assembly& assembly) {
  const auto& [a, b, kind] = coordinate;
  JointLimit stop{a, b, std::get<JointCoordinate>(kind)};
  stop.size = std::max(massDistance(a, assembly.mechanism.bodies), massDistance(b, assembly.mechanism.bodies));
  stop.restitution = range.restitution;
  const double start = stop.bound.value;
  std::vector<std::size_t> added;
  for (const auto& [bound, side] : {std::pair(range.lower, -1.0), {range.upper, 1.0}}) {
    if (!std::isfinite(bound)) continue;
    stop.bound.value = start + bound, stop.side = side;
    added.push_back(assembly.limits.size());
    assembly.limits.emplace_back(stop);
    assembly.limitBodies.emplace_back(bodyA, bodyB);
  }
  return added;
}

JointMotor motorOf(const JointDrive& drive, const Constraint& joint) {
  JointMotor motor{joint};
  motor.hasTarget = drive.targetVelocity.has_value();
  motor.targetVelocity = drive.targetVelocity.value_or(0);
  motor.maxForce = std::abs(drive.force), motor.sign = drive.force < 0 ? -1 : 1;
  return motor;
}

/// What acts on the coordinate of a joint, `index` among the scene's hinges and sliders.
template <class Joint>
void addCoordinate(const Joint& joint, std::size_t index, const Constraint& coordinate, Assembly& assembly) {
  std::vector<JointMotor>& motors = assembly.mechanism.motors;
  AssembledJoint assembled{coordinate, index, joint.motor ? static_cast<int>(motors.size()) : -1, {}, {}};
  if (joint.limits)
    assembled.stops = addStops(*joint.limits, joint.anchorA.body, joint.anchorB.body, coordinate, assembly);
  assembly.joints.push_back(std::move(assembled));
  if (joint.motor) motors.push_back(motorOf(*joint.motor, coordinate));
}

void addLinks(const Scene& scene, const IslandPlan& island, Assembly& assembly) {
  Mechanism& mechanism = assembly.mechanism;
  forEachLink(scene.springs, scene, island, assembly.sceneBodies,
              [&](const Spring& spring, const Attachment& a, const Attachment& b) {
                mechanism.springs.push_back({a, b, spring.stiffness, spring.damping, spring.restLength});
                assembly.names.springs.push_back(spring.name);
              });
  const auto addConstraints = [&](const auto& links) {
    forEachLink(links, scene, island, assembly.sceneBodies,
                [&](const auto& link, const Attachment& a, const Attachment& b) {
                  const JointTurns turns = turnsOf(link.anchorA, link.anchorB, a, b, scene);
                  mechanism.constraints.push_back({a, b, constraintOf(link, turns)});
                  if constexpr (requires { link.limits; }) {
                    const std::size_t before = link.kKind == LinkKind::slider ? scene.hinges.size() : 0;
                    addCoordinate(link, before + static_cast<std::size_t>(&link - links.data()),
                                  coordinateAtStart(link, turns, a, b, assembly), assembly);
                  }
                  assembly.names.constraints.push_back(fmt::format("{} \"{}\"", link.kNoun, link.name));
                });
  };
  addConstraints(scene.rods);
  forEachKindOfJoint(scene, addConstraints);
  forEachLink(scene.ropes, scene, island, assembly.sceneBodies,
              [&](const Rope& rope, const Attachment& a, const Attachment& b) {
                assembly.limits.emplace_back(RopeLimit{a, b, rope.maxLength, rope.restitution});
                assembly.limitBodies.emplace_back(rope.anchorA.body, rope.anchorB.body);
              });
}

void satisfyConstraints(const Scene& scene, Assembly& assembly) {
  const Mechanism& mechanism = assembly.mechanism;
  ConstraintSolver solver(mechanism.constraints, mechanism.bodies);
  if (!solver.hasConstraints()) return;
  const VectorX before = assembly.state;
  solver.factorize(before);
  const ConstraintRate violation = solver.largestRate(before);
  // Spins that a scene gives are kept where velocities of the centres of mass can follow them, and these where no spin
  // is given. What is left changes the kinetic energy least.
  std::vector<RigidBody> following = mechanism.bodies;
  for (std::size_t i = 0; i < following.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    if (angularVelocity(before, index).isZero(0) && !linearVelocity(before, index).isZero(0))
      following[i].inverseMass = 0;
    else
      following[i].inverseInertia.setZero();
  }
  ConstraintSolver first(mechanism.constraints, following);
  first.factorize(before);
  first.constrainVelocities(assembly.state);
  solver.constrainVelocities(assembly.state);
  const Eigen::Index poses = poseComponents(before);
  const double fastest =
      before.segment(poses, before.size() - kLedgerSize - poses).cwiseAbs().maxCoeff();  // m/s, rad/s
  if (violation.rate > kVelocityRounding * std::max(1.0, fastest))
    assembly.warnings.push_back(fmt::format(
        "{}: the start velocities would stretch or shorten rods or pull joints apart, most of all {} with {:.3g} m/s; "
        "they were changed by up to {:.3g} to fit",
        scene.path, assembly.names.constraints[violation.block], violation.rate,
        (assembly.state - before).cwiseAbs().maxCoeff()));
}

Assembly withoutColliders(const Scene& scene, const IslandPlan& island) {
  Assembly assembly;
  assembly.mechanism.gravity = scene.gravity;
  assembly.pushes = island.pushes;
  addBodies(scene, island, assembly);
  addLinks(scene, island, assembly);
  return assembly;
}

/// Colliders of the bodies that may touch.
void addColliders(const Scene& scene, const IslandPlan& island, Assembly& assembly) {
  ContactGeometry& geometry = assembly.geometry;
  assembly.radii.assign(assembly.mechanism.bodies.size(), 0.0);
  for (const int index : island.touching) {
    const Body& body = scene.bodies[static_cast<std::size_t>(index)];
    if (const auto* plane = std::get_if<Plane>(&body.shape)) {
      geometry.planes.push_back(
          {body.worldFromBody.translation, body.worldFromBody.rotation * plane->normal, body.material});
      assembly.planeBodies.push_back(index);
    } else {
      geometry.colliders.push_back(*colliderOf(body, scene, indexAmong(assembly.sceneBodies, index)));
      geometry.colliders.back().isDriven = body.motion == Motion::driven;
      assembly.colliderBodies.push_back(index);
      const Collider& collider = geometry.colliders.back();
      if (collider.body != kFixed) assembly.radii[static_cast<std::size_t>(collider.body)] = collider.boundingRadius;
    }
  }
  addSurfaces(scene, assembly.colliderBodies, geometry.colliders);
  for (const std::vector<SurfacePair>& row : scene.surfacePairs) {
    std::vector<ContactMaterial>& materials = geometry.materials.emplace_back();
    for (const SurfacePair& pair : row)
      materials.push_back({pair.restitution, pair.staticFriction, pair.dynamicFriction});
  }
}

/// Parts of one body whose bounding spheres are near at the start: others stay apart.
void excludeWelded(const Scene& scene, Assembly& assembly) {
  if (scene.welds.empty()) return;
  const std::vector<Collider>& colliders = assembly.geometry.colliders;
  const auto centerOf = [&](const Collider& collider) -> Vec3 {
    return collider.body == kFixed ? Vec3::Zero() : Vec3(centerOfMass(assembly.state, collider.body));
  };
  const auto areNear = [&](const Collider& a, const Collider& b) {
    return (centerOf(a) - centerOf(b)).norm() <= kNearWelded * (a.boundingRadius + b.boundingRadius);
  };
  const WeldedBodies welded(scene);
  std::map<int, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < colliders.size(); ++i) groups[welded.groupOf(assembly.colliderBodies[i])].push_back(i);
  for (const auto& [group, parts] : groups)
    for (const std::size_t a : parts) {
      if (colliders[a].body == kFixed) continue;
      for (const std::size_t b : parts)
        if ((a < b || colliders[b].body == kFixed) && areNear(colliders[a], colliders[b]))
          assembly.geometry.excluded.emplace_back(std::min(a, b), std::max(a, b));
    }
}

void excludeJoined(const Scene& scene, Assembly& assembly) {
  for (const auto& [bodyA, bodyB] : pairsKeptFromTouching(scene)) {
    const int a = indexAmong(assembly.colliderBodies, bodyA), b = indexAmong(assembly.colliderBodies, bodyB);
    if (a >= 0 && b >= 0) assembly.geometry.excluded.emplace_back(std::min(a, b), std::max(a, b));
  }
}

/// Contact that cannot be computed is not searched for, but must not come about.
void excludeUnsolved(ContactGeometry& geometry) {
  const auto isSolved = [](const Collider& collider) { return canSolveContact(collider, &collider); };
  if (std::all_of(geometry.colliders.begin(), geometry.colliders.end(), isSolved)) return;
  const std::vector<std::pair<std::size_t, std::size_t>> joined = geometry.excluded;
  for (std::size_t a = 0; a < geometry.colliders.size(); ++a)
    for (std::size_t b = a + 1; b < geometry.colliders.size(); ++b) {
      const Collider &first = geometry.colliders[a], &second = geometry.colliders[b];
      if ((first.isHeld() && second.isHeld()) || canSolveContact(first, &second)) continue;
      if (std::find(joined.begin(), joined.end(), std::pair(a, b)) != joined.end()) continue;
      geometry.unsolvedPairs.push_back({a, b, false, {}});
      geometry.excluded.emplace_back(a, b);
    }
}

/// Springs that fixed steps are too long for: they blow up, or keep still where they should swing.
void warnOfSteps(const Scene& scene, const ChosenMethod& method, Assembly& assembly) {
  auto fault = stepFault(assembly.mechanism, assembly.state, method, scene.duration);
  if (!fault) fault = energyChangeByStep(assembly.mechanism, assembly.state, method, scene.duration);
  if (!fault) return;
  assembly.hasLongSteps = true;
  assembly.warnings.push_back(
      fmt::format("{}: spring \"{}\" {}", scene.path, assembly.names.springs[fault->spring], fault->text));
}

/// Calls visit(a, b), by the part's indices, for each pair of the whole's colliders that are both in the part. Pairs
/// are ascending; collidersOf(pair): the two in the whole; `wholeOfPart`: the index there of each collider of the part.
template <class Pairs, class CollidersOf, class Visit>
void forEachPairOfPart(const Pairs& pairs, const CollidersOf& collidersOf, const std::vector<std::size_t>& wholeOfPart,
                       const Visit& visit) {
  const auto partOf = [&](std::size_t whole) {
    const auto found = std::lower_bound(wholeOfPart.begin(), wholeOfPart.end(), whole);
    return found != wholeOfPart.end() && *found == whole ? std::optional(found - wholeOfPart.begin()) : std::nullopt;
  };
  for (std::size_t a = 0; a < wholeOfPart.size(); ++a) {
    auto pair = std::lower_bound(pairs.begin(), pairs.end(), wholeOfPart[a], [&](const auto& other, std::size_t first) {
      return collidersOf(other).first < first;
    });
    for (; pair != pairs.end() && collidersOf(*pair).first == wholeOfPart[a]; ++pair)
      if (const auto b = partOf(collidersOf(*pair).second)) visit(a, static_cast<std::size_t>(*b));
  }
}

/// Colliders of the bodies that may touch, from an island that has them all.
void takeColliders(const Assembly& whole, const IslandPlan& part, Assembly& assembly) {
  ContactGeometry& geometry = assembly.geometry;
  assembly.radii.assign(assembly.mechanism.bodies.size(), 0.0);
  std::vector<std::size_t> wholeOfPart;
  for (const int index : part.touching) {
    if (const int plane = indexAmong(whole.planeBodies, index); plane >= 0) {
      geometry.planes.push_back(whole.geometry.planes[static_cast<std::size_t>(plane)]);
      assembly.planeBodies.push_back(index);
      continue;
    }
    wholeOfPart.push_back(static_cast<std::size_t>(indexAmong(whole.colliderBodies, index)));
    Collider& collider = geometry.colliders.emplace_back(whole.geometry.colliders[wholeOfPart.back()]);
    collider.body = indexAmong(assembly.sceneBodies, index);
    collider.pins.clear();
    assembly.colliderBodies.push_back(index);
    if (collider.body != kFixed) assembly.radii[static_cast<std::size_t>(collider.body)] = collider.boundingRadius;
  }
  geometry.materials = whole.geometry.materials;
  const auto itself = [](const auto& pair) { return pair; };
  forEachPairOfPart(whole.geometry.excluded, itself, wholeOfPart,
                    [&](std::size_t a, std::size_t b) { geometry.excluded.emplace_back(a, b); });
  const auto collidersOf = [](const ColliderPair& pair) { return std::pair(pair.a, pair.b); };
  forEachPairOfPart(whole.geometry.unsolvedPairs, collidersOf, wholeOfPart, [&](std::size_t a, std::size_t b) {
    geometry.unsolvedPairs.push_back({a, b, false, {}});
  });
}

void findPairsAtStart(Assembly& assembly) {
  BroadPhase().update(assembly.state, std::vector<double>(assembly.mechanism.bodies.size(), 0.0), 0, assembly.geometry);
}

}  // namespace

Assembly assemble(const Scene& scene, const IslandPlan& island) {
  Assembly assembly = withoutColliders(scene, island);
  addColliders(scene, island, assembly);
  excludeJoined(scene, assembly);
  excludeWelded(scene, assembly);
  excludeUnsolved(assembly.geometry);
  std::sort(assembly.geometry.excluded.begin(), assembly.geometry.excluded.end());
  assembly.smallestSize = smallestSize(assembly.geometry);
  findPairsAtStart(assembly);
  constrainPinnedContacts(assembly);
  satisfyConstraints(scene, assembly);
  warnOfSteps(scene, island.method, assembly);
  return assembly;
}

Assembly assemblePart(const Scene& scene, const IslandPlan& part, const Assembly& whole) {
  Assembly assembly = withoutColliders(scene, part);
  takeColliders(whole, part, assembly);
  assembly.smallestSize = whole.smallestSize;
  findPairsAtStart(assembly);
  constrainPinnedContacts(assembly);
  return assembly;
}

void beginAt(double time, const VectorX& state, const std::vector<JointState>& joints, std::vector<StartedPush> pushes,
             Assembly& assembly) {
  assembly.startTime = time;
  assembly.state = state;
  assembly.startedPushes = std::move(pushes);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    AssembledJoint& joint = assembly.joints[i];
    joint.start = joints[i];
    for (const std::size_t index : joint.stops) {
      auto& stop = std::get<JointLimit>(assembly.limits[index]);
      stop.turned = joints[i].coordinate, stop.rate = joints[i].velocity;
    }
  }
}

Constraints tiesOf(const Assembly& assembly) {
  const Constraints& all = assembly.mechanism.constraints;
  return {all.begin(), all.begin() + std::ssize(assembly.names.constraints)};
}

int indexAmong(const std::vector<int>& bodies, int body) {
  const auto found = std::lower_bound(bodies.begin(), bodies.end(), body);
  return found != bodies.end() && *found == body ? static_cast<int>(found - bodies.begin()) : kFixed;
}

std::pair<int, int> bodiesOf(const Assembly& assembly, const ColliderPair& pair) {
  return {assembly.colliderBodies[pair.a],
          (pair.againstPlane ? assembly.planeBodies : assembly.colliderBodies)[pair.b]};
}

void refuse(const std::vector<std::string>& faults) {
  if (faults.empty()) return;
  const std::size_t told = std::min(faults.size(), kMaxFaultsTold);
  std::string text = printableLine(faults.front());
  for (std::size_t i = 1; i < told; ++i) text.append("\n").append(printableLine(faults[i]));
  const char* atLeast = faults.size() < kMaxFaultsCounted ? "" : "at least ";
  if (faults.size() > told) text += fmt::format("\nand {}{} more", atLeast, faults.size() - told);
  throw Error::ofLines(ErrorKind::scene, text);
}

void refuseUnsupported(const Scene& scene) {
  refuse(unsupportedContacts(scene));
}

}  // namespace cradle
