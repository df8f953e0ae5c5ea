#include "simulate/assembly.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "collision/broad_phase.h"
#include "core/error.h"
#include "core/printable.h"
#include "simulate/pinned_contacts.h"
#include "simulate/steps/step_limit.h"

namespace cradle {
namespace {

constexpr double kVelocityRounding = 1e-12;  // m/s a m of rod: less is no violation, only decimal digits

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
void forEachLink(LinkKind kind, const Links& links, const Scene& scene, const IslandPlan& island,
                 const std::vector<int>& sceneBodies, const Add& add) {
  for (const LinkIndex& place : island.links) {
    if (place.kind != kind) continue;
    const auto& link = links[place.index];
    const Attachment a = attach(link.anchorA, scene, sceneBodies), b = attach(link.anchorB, scene, sceneBodies);
    if (a.body != kFixed || b.body != kFixed) add(link, a, b);
  }
}

/// The hinge's axis is given in body A's frame; B's directions across it follow from the bodies' places at the start.
HingeConstraint hingeAt(const Hinge& hinge, const Attachment& a, const Attachment& b, const Scene& scene) {
  const auto worldFromBody = [&](const Anchor& anchor) -> Quat {
    if (anchor.body == kWorld) return Quat::Identity();
    return scene.bodies[static_cast<std::size_t>(anchor.body)].worldFromBody.rotation;
  };
  const Vec3 axis = worldFromBody(hinge.anchorA) * hinge.axis;
  const Vec3 across = axis.unitOrthogonal();
  const Quat bodyFromWorldA = a.body == kFixed ? Quat::Identity() : worldFromBody(hinge.anchorA).conjugate();
  const Quat bodyFromWorldB = b.body == kFixed ? Quat::Identity() : worldFromBody(hinge.anchorB).conjugate();
  return {bodyFromWorldA * axis, {bodyFromWorldB * across, bodyFromWorldB * axis.cross(across)}};
}

void addLinks(const Scene& scene, const IslandPlan& island, Assembly& assembly) {
  Mechanism& mechanism = assembly.mechanism;
  forEachLink(LinkKind::spring, scene.springs, scene, island, assembly.sceneBodies,
              [&](const Spring& spring, const Attachment& a, const Attachment& b) {
                mechanism.springs.push_back({a, b, spring.stiffness, spring.damping, spring.restLength});
                assembly.names.springs.push_back(spring.name);
              });
  const auto addConstraint = [&](const char* kind, const std::string& name, const Constraint& constraint) {
    mechanism.constraints.push_back(constraint);
    assembly.names.constraints.push_back(fmt::format("{} \"{}\"", kind, name));
  };
  forEachLink(LinkKind::rod, scene.rods, scene, island, assembly.sceneBodies,
              [&](const Rod& rod, const Attachment& a, const Attachment& b) {
                addConstraint("rod", rod.name, {a, b, RodConstraint{rod.length}});
              });
  forEachLink(LinkKind::ballJoint, scene.ballJoints, scene, island, assembly.sceneBodies,
              [&](const BallJoint& joint, const Attachment& a, const Attachment& b) {
                addConstraint("ball joint", joint.name, {a, b, BallJointConstraint()});
              });
  forEachLink(LinkKind::hinge, scene.hinges, scene, island, assembly.sceneBodies,
              [&](const Hinge& hinge, const Attachment& a, const Attachment& b) {
                addConstraint("hinge", hinge.name, {a, b, hingeAt(hinge, a, b, scene)});
              });
  forEachLink(LinkKind::rope, scene.ropes, scene, island, assembly.sceneBodies,
              [&](const Rope& rope, const Attachment& a, const Attachment& b) {
                assembly.ropes.push_back({a, b, rope.maxLength, rope.restitution});
                assembly.ropeBodies.emplace_back(rope.anchorA.body, rope.anchorB.body);
              });
}

void satisfyConstraints(const Scene& scene, Assembly& assembly) {
  const Mechanism& mechanism = assembly.mechanism;
  ConstraintSolver solver(mechanism.constraints, mechanism.bodies);
  if (!solver.hasConstraints()) return;
  const VectorX before = assembly.state;
  solver.factorize(before);
  const double violation = solver.largestRate(before);
  // Spins that a scene gives are kept where velocities of the centres of mass can follow them.
  std::vector<RigidBody> nonRotating = mechanism.bodies;
  for (RigidBody& body : nonRotating) body.inverseInertia.setZero();
  ConstraintSolver linear(mechanism.constraints, nonRotating);
  linear.factorize(before);
  linear.constrainVelocities(assembly.state);
  solver.constrainVelocities(assembly.state);
  if (violation > kVelocityRounding)
    assembly.warnings.push_back(fmt::format(
        "{}: the start velocities would stretch or shorten rods or pull joints apart by up to {:.3g} m/s; they were "
        "changed by up to {:.3g} to fit",
        scene.path, violation, (assembly.state - before).cwiseAbs().maxCoeff()));
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

}  // namespace

Assembly assemble(const Scene& scene, const IslandPlan& island) {
  Assembly assembly;
  assembly.mechanism.gravity = scene.gravity;
  assembly.pushes = island.pushes;
  addBodies(scene, island, assembly);
  addLinks(scene, island, assembly);
  addColliders(scene, island, assembly);
  excludeJoined(scene, assembly);
  excludeUnsolved(assembly.geometry);
  std::sort(assembly.geometry.excluded.begin(), assembly.geometry.excluded.end());
  BroadPhase().update(assembly.state, std::vector<double>(assembly.mechanism.bodies.size(), 0.0), 0, assembly.geometry);
  constrainPinnedContacts(assembly);
  satisfyConstraints(scene, assembly);
  warnOfSteps(scene, island.method, assembly);
  return assembly;
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
