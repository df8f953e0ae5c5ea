#include "simulate/colliders.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "collision/mesh_collider.h"
#include "collision/mesh_surface.h"
#include "mesh/recognise_shape.h"
#include "mesh/solid.h"

namespace cradle {
namespace {

bool isPlane(const Body& body) {
  return std::holds_alternative<Plane>(body.shape);
}

/// The shape's frame in the collider's: that of the centre of mass of a body that moves, else the world.
RigidTransform colliderFromShape(const Body& body, int movingBody) {
  if (movingBody == kFixed) return body.worldFromBody;
  return {Quat::Identity(), -body.massProperties.centerOfMass};
}

Collider wholeMesh(const TriangleMesh& mesh, const RigidTransform& frame) {
  Collider collider;
  collider.points.reserve(mesh.vertices.size());
  for (const Vec3& vertex : mesh.vertices) {
    collider.points.push_back(frame * vertex);
    collider.boundingRadius = std::max(collider.boundingRadius, collider.points.back().norm());
    collider.bounds.extend(collider.points.back());
  }
  return collider;
}

Collider ofModel(const Scene& scene, const Body& body, const RigidTransform& frame) {
  const auto model = static_cast<std::size_t>(std::get<ModelShape>(body.shape).model);
  const auto& [recognised, hull] = scene.modelCollisions[model];
  const bool asPrimitive = body.collision != CollisionChoice::hull && body.collision != CollisionChoice::mesh;
  if (recognised.primitive && asPrimitive) {
    const RigidTransform place = frame * recognised.primitive->bodyFromShape;
    return std::visit([&](const auto& shape) { return colliderOf(shape, place); }, recognised.primitive->shape);
  }
  if (hull && (recognised.isConvex || body.collision == CollisionChoice::hull)) return colliderOf(*hull, frame);
  return wholeMesh(scene.models[model].solid, frame);
}

Collider shapedLike(const Body& body, const Scene& scene, const RigidTransform& frame) {
  return std::visit(
      [&](const auto& shape) {
        using Kind = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Kind, ModelShape>)
          return ofModel(scene, body, frame);
        else if constexpr (std::is_same_v<Kind, Plane>)
          return Collider();
        else
          return colliderOf(shape, frame);
      },
      body.shape);
}

/// That of a mesh that is no solid and moves is not known.
bool hasSurface(const Collider& collider) {
  return collider.kind() != ColliderKind::mesh || collider.mesh;
}

/// Whether a body that moves has an open mesh as its collider: which side of it is inside is not known.
bool isMovingSheet(const Body& body, const Scene& scene) {
  const auto collider = colliderOf(body, scene, kFixed);
  if (!collider || collider->kind() != ColliderKind::mesh) return false;
  return !checkSolid(scene.models[static_cast<std::size_t>(std::get<ModelShape>(body.shape).model)].solid).isClosed;
}

bool isFixedObstacle(const Body& body) {
  return body.motion == Motion::fixed && body.collision != CollisionChoice::none && !isPlane(body);
}

bool isMesh(const Collider& collider) {
  return collider.kind() == ColliderKind::mesh;
}

}  // namespace

std::optional<Collider> colliderOf(const Body& body, const Scene& scene, int movingBody) {
  if (body.collision == CollisionChoice::none || isPlane(body)) return std::nullopt;
  Collider collider = shapedLike(body, scene, colliderFromShape(body, movingBody));
  collider.body = movingBody;
  collider.surface = body.material;
  return collider;
}

void addSurfaces(const Scene& scene, const std::vector<int>& bodies, std::vector<Collider>& colliders) {
  if (colliders.size() < 2 || std::none_of(colliders.begin(), colliders.end(), isMesh)) return;
  std::vector<std::shared_ptr<const MeshSurface>> surfaces(scene.models.size());
  for (std::size_t i = 0; i < colliders.size(); ++i) {
    Collider& collider = colliders[i];
    if (collider.kind() == ColliderKind::polytope) collider.mesh = surfaceOf(*collider.polytope);
    if (!isMesh(collider)) continue;
    const Body& body = scene.bodies[static_cast<std::size_t>(bodies[i])];
    const auto model = static_cast<std::size_t>(std::get<ModelShape>(body.shape).model);
    const TriangleMesh& mesh = scene.models[model].solid;
    if (!surfaces[model])
      surfaces[model] =
          std::make_shared<const MeshSurface>(checkSolid(mesh).isClosed ? surfaceOf(mesh) : sheetOf(mesh));
    if (surfaces[model]->isSheet && body.motion == Motion::dynamic) continue;
    collider.mesh = surfaces[model];
    collider.bodyFromMesh = colliderFromShape(body, collider.body);
  }
}

std::set<std::pair<int, int>> pairsKeptFromTouching(const Scene& scene) {
  std::set<std::pair<int, int>> joined, colliding;
  const auto add = [&](const auto& joints) {
    for (const auto& joint : joints)
      (joint.collide ? colliding : joined).insert(std::minmax(joint.anchorA.body, joint.anchorB.body));
  };
  add(scene.ballJoints), add(scene.hinges), add(scene.sliders);
  for (const auto& pair : colliding) joined.erase(pair);
  return joined;
}

bool mayTouch(const Body& a, const Body& b) {
  return a.collision != CollisionChoice::none && b.collision != CollisionChoice::none &&
         (a.motion == Motion::dynamic || b.motion == Motion::dynamic);
}

bool canSolveContact(const Collider& a, const Collider* b) {
  if (a.points.empty()) return false;
  if (!b) return true;
  return !b->points.empty() && hasSurface(a) && hasSurface(*b);
}

std::vector<std::string> unsupportedContacts(const Scene& scene) {
  std::vector<std::string> faults;
  std::vector<std::size_t> obstacles, lacking;
  std::map<std::pair<int, CollisionChoice>, bool> isKnown;  // one answer for all copies
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (isFixedObstacle(body)) obstacles.push_back(i);
    const auto* shape = std::get_if<ModelShape>(&body.shape);
    if (!shape || body.motion == Motion::fixed) continue;
    const auto [known, isNew] = isKnown.emplace(std::pair(shape->model, body.collision), false);
    if (isNew) known->second = isMovingSheet(body, scene);
    if (known->second) lacking.push_back(i);
  }
  for (const std::size_t moving : lacking)
    for (const std::size_t obstacle : obstacles) {
      if (faults.size() == kMaxFaultsCounted) return faults;
      const auto [first, second] = std::minmax({moving, obstacle});
      const Body &a = scene.bodies[first], &b = scene.bodies[second];
      faults.push_back(
          fmt::format("{}: contact between \"{}\" and \"{}\" cannot be simulated: a mesh that moves and is no solid "
                      "can touch nothing but planes; give one of them \"collision\": \"none\"",
                      b.where, a.name, b.name));
    }
  return faults;
}

}  // namespace cradle
