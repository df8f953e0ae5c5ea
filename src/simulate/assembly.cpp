#include "simulate/assembly.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "simulate/colliders.h"

namespace cradle {
namespace {

constexpr double kVelocityRounding = 1e-12;  // m/s a m of rod: less is no violation, only decimal digits
constexpr std::size_t kMostFaults = 50;

/// Index of each scene body among the moving ones, or kFixed.
std::vector<int> movingIndices(const Scene& scene) {
  std::vector<int> indices;
  int next = 0;
  for (const Body& body : scene.bodies) indices.push_back(body.motion == Motion::dynamic ? next++ : kFixed);
  return indices;
}

Attachment attach(const Anchor& anchor, const Scene& scene, const std::vector<int>& moving) {
  if (anchor.body == kWorld) return {kFixed, anchor.point};
  const std::size_t index = static_cast<std::size_t>(anchor.body);
  const Body& body = scene.bodies[index];
  if (moving[index] == kFixed) return {kFixed, body.worldFromBody * anchor.point};
  return {moving[index], anchor.point - body.massProperties.centerOfMass};
}

void addBodies(const Scene& scene, Assembly& assembly) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].motion != Motion::dynamic) continue;
    assembly.sceneBodies.push_back(static_cast<int>(i));
    assembly.mechanism.bodies.push_back(makeRigidBody(scene.bodies[i].massProperties));
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

void addLinks(const Scene& scene, const std::vector<int>& moving, Assembly& assembly) {
  for (const Spring& spring : scene.springs)
    assembly.mechanism.springs.push_back({attach(spring.anchorA, scene, moving), attach(spring.anchorB, scene, moving),
                                          spring.stiffness, spring.damping, spring.restLength});
  for (const Rod& rod : scene.rods)
    assembly.mechanism.constraints.rods.push_back(
        {attach(rod.anchorA, scene, moving), attach(rod.anchorB, scene, moving), rod.length});
  for (const Rope& rope : scene.ropes) {
    assembly.ropes.push_back(
        {attach(rope.anchorA, scene, moving), attach(rope.anchorB, scene, moving), rope.maxLength, rope.restitution});
    assembly.ropeBodies.emplace_back(rope.anchorA.body, rope.anchorB.body);
  }
}

void satisfyRods(const Scene& scene, Assembly& assembly) {
  const Mechanism& mechanism = assembly.mechanism;
  ConstraintSolver solver(mechanism.constraints, mechanism.bodies);
  const VectorX before = assembly.state;
  solver.factorize(before);
  const double violation = solver.largestRate(before);
  solver.constrainVelocities(assembly.state);
  if (violation > kVelocityRounding)
    assembly.warnings.push_back(
        fmt::format("{}: the start velocities would stretch or shorten rods by up to {:.3g} m/s; they were changed by "
                    "up to {:.3g} to fit",
                    scene.path, violation, (assembly.state - before).cwiseAbs().maxCoeff()));
}

struct ColliderIndices {
  std::vector<int> colliders, planes;  // of each scene body, or -1
};

ColliderIndices addColliders(const Scene& scene, const std::vector<int>& moving, ContactGeometry& geometry) {
  ColliderIndices indices;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    indices.colliders.push_back(-1);
    indices.planes.push_back(-1);
    const auto* plane = std::get_if<Plane>(&body.shape);
    if (plane && body.collision != CollisionChoice::none) {
      indices.planes.back() = static_cast<int>(geometry.planes.size());
      geometry.planes.push_back({body.worldFromBody.translation, body.worldFromBody.rotation * plane->normal});
    }
    auto collider = colliderOf(body, scene, moving[i]);
    if (!collider) continue;
    indices.colliders.back() = static_cast<int>(geometry.colliders.size());
    geometry.colliders.push_back(std::move(*collider));
  }
  return indices;
}

void addContactGeometry(const Scene& scene, const std::vector<int>& moving, Assembly& assembly) {
  ContactGeometry& geometry = assembly.geometry;
  const ColliderIndices indices = addColliders(scene, moving, geometry);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    for (std::size_t j = i + 1; j < scene.bodies.size(); ++j) {
      if (!mayTouch(scene.bodies[i], scene.bodies[j])) continue;
      // Planes stand second.
      const bool swapped = indices.planes[i] >= 0;
      const std::size_t a = swapped ? j : i, b = swapped ? i : j;
      const bool againstPlane = indices.planes[b] >= 0;
      const std::size_t first = static_cast<std::size_t>(indices.colliders[a]);
      const std::size_t second = static_cast<std::size_t>(againstPlane ? indices.planes[b] : indices.colliders[b]);
      const SurfacePair& surface = scene.surfacePairs[static_cast<std::size_t>(scene.bodies[a].material)]
                                                     [static_cast<std::size_t>(scene.bodies[b].material)];
      const ColliderPair pair{
          first, second, againstPlane, {surface.restitution, surface.staticFriction, surface.dynamicFriction}};
      if (canSolveContact(geometry.colliders[first], againstPlane ? nullptr : &geometry.colliders[second])) {
        geometry.pairs.push_back(pair);
        assembly.pairBodies.emplace_back(static_cast<int>(a), static_cast<int>(b));
      } else {
        geometry.unsolvedPairs.push_back(pair);
      }
    }
}

}  // namespace

Assembly assemble(const Scene& scene) {
  Assembly assembly;
  const std::vector<int> moving = movingIndices(scene);
  assembly.movingBodies = moving;
  assembly.mechanism.gravity = scene.gravity;
  addBodies(scene, assembly);
  addLinks(scene, moving, assembly);
  addContactGeometry(scene, moving, assembly);
  satisfyRods(scene, assembly);
  return assembly;
}

void refuseUnsupported(const Scene& scene) {
  std::vector<std::string> faults;
  const auto refuse = [&](const std::string& where, const char* what) {
    faults.push_back(fmt::format(
        "{}: {} cannot be simulated yet; springs, rods, ropes, pushes and contacts can; take it out", where, what));
  };
  for (const BallJoint& joint : scene.ballJoints) refuse(joint.where, "a ball joint");
  for (const Hinge& hinge : scene.hinges) refuse(hinge.where, "a hinge");
  if (scene.method && scene.method->name == MethodName::dop853)
    faults.push_back(scene.method->where +
                     ": method dop853 is not there yet; explicitEuler, semiImplicitEuler and rk4 are");
  for (const std::string& fault : unsupportedContacts(scene)) faults.push_back(fault);
  if (faults.empty()) return;
  std::string text = faults[0];
  for (std::size_t i = 1; i < std::min(faults.size(), kMostFaults); ++i) text += "\n" + faults[i];
  if (faults.size() > kMostFaults) text += fmt::format("\nand {} more", faults.size() - kMostFaults);
  throw Error(ErrorKind::scene, "", text);
}

std::vector<std::string> unusedRequests(const Scene& scene) {
  if (!scene.namesAccuracy) return {};
  return {fmt::format("{}: \"accuracy\" is not used yet; the time step of \"method\" decides", scene.path)};
}

}  // namespace cradle
