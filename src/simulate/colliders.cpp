#include "simulate/colliders.h"

#include <fmt/format.h>

#include <algorithm>

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

/// Fills a collider from shapes, each placed in the collider's frame.
struct ColliderBuilder {
  Collider collider;
  RigidTransform frame;  // colliderFromShape

  void operator()(const Sphere& sphere) {
    collider.points = {frame.translation};
    collider.radius = sphere.radius;
  }
  void operator()(const Capsule& capsule) {
    const Vec3 end = capsule.length / 2 * Vec3::UnitY();
    collider.points = {frame * end, frame * -end};
    collider.radius = capsule.radius;
  }
  void operator()(const Box& box) {
    collider.polytope = polytopeOf(box, frame);
    collider.points = collider.polytope->vertices;
  }
  void operator()(const Cylinder&) {}  // refused before, see unsupportedContacts
  void operator()(const Plane&) {}     // no collider of this kind
};

void addMesh(const TriangleMesh& mesh, CollisionChoice choice, ColliderBuilder& builder) {
  const bool asPrimitive =
      choice == CollisionChoice::automatic || choice == CollisionChoice::sphere || choice == CollisionChoice::box;
  const RecognisedShape recognised = asPrimitive ? recogniseShape(mesh) : RecognisedShape{};
  if (recognised.primitive && !std::holds_alternative<Cylinder>(recognised.primitive->shape)) {
    builder.frame = builder.frame * recognised.primitive->bodyFromShape;
    std::visit(builder, recognised.primitive->shape);
    return;
  }
  for (const Vec3& vertex : mesh.vertices) builder.collider.points.push_back(builder.frame * vertex);
}

void enclose(Collider& collider) {
  const Vec3 radius = Vec3::Constant(collider.radius);
  for (const Vec3& point : collider.points) {
    collider.boundingRadius = std::max(collider.boundingRadius, point.norm() + collider.radius);
    collider.bounds.extend(Vec3(point - radius));
    collider.bounds.extend(Vec3(point + radius));
  }
}

/// That of a mesh that is no solid is not known.
bool hasSurface(const Collider& collider) {
  return collider.kind() != ColliderKind::mesh || collider.mesh;
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
  ColliderBuilder builder;
  builder.collider.body = movingBody;
  builder.frame = colliderFromShape(body, movingBody);
  std::visit(
      [&](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, ModelShape>)
          addMesh(scene.models[static_cast<std::size_t>(shape.model)].solid, body.collision, builder);
        else
          builder(shape);
      },
      body.shape);
  builder.collider.surface = body.material;
  enclose(builder.collider);
  return std::move(builder.collider);
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
    if (!surfaces[model] && checkSolid(mesh).isSolid)
      surfaces[model] = std::make_shared<const MeshSurface>(surfaceOf(mesh));
    collider.mesh = surfaces[model];
    collider.bodyFromMesh = colliderFromShape(body, collider.body);
  }
}

bool mayTouch(const Body& a, const Body& b) {
  return a.collision != CollisionChoice::none && b.collision != CollisionChoice::none &&
         (a.motion == Motion::dynamic || b.motion == Motion::dynamic);
}

bool canSolveContact(const Collider& a, const Collider* b) {
  if (a.points.empty()) return false;
  if (!b) return true;
  const bool hasCylinder = a.kind() == ColliderKind::cylinder || b->kind() == ColliderKind::cylinder;
  return !b->points.empty() && hasSurface(a) && hasSurface(*b) && !(hasCylinder && hasMesh(a, *b));
}

/// Where something fixed may be touched, for canSolveContact.
static void addSurfacesToFixed(const Scene& scene, std::vector<std::optional<Collider>>& colliders) {
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(), isFixedObstacle)) return;
  std::vector<int> bodies;
  std::vector<Collider> present;
  for (std::size_t i = 0; i < colliders.size(); ++i)
    if (colliders[i]) bodies.push_back(static_cast<int>(i)), present.push_back(*colliders[i]);
  addSurfaces(scene, bodies, present);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    colliders[static_cast<std::size_t>(bodies[i])] = std::move(present[i]);
}

std::vector<std::string> unsupportedContacts(const Scene& scene) {
  std::vector<std::string> faults;
  std::vector<std::optional<Collider>> colliders;
  for (const Body& body : scene.bodies) colliders.push_back(colliderOf(body, scene, kFixed));
  addSurfacesToFixed(scene, colliders);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    for (std::size_t j = i + 1; j < scene.bodies.size(); ++j) {
      const Body &a = scene.bodies[i], &b = scene.bodies[j];
      const bool bothMove = a.motion == Motion::dynamic && b.motion == Motion::dynamic;
      if (bothMove || !mayTouch(a, b)) continue;
      const auto &first = isPlane(a) ? colliders[j] : colliders[i], &second = isPlane(a) ? colliders[i] : colliders[j];
      if (!canSolveContact(*first, second ? &*second : nullptr))
        faults.push_back(fmt::format(
            "{}: contact between \"{}\" and \"{}\" cannot be simulated yet; all shapes but cylinders can, and "
            "meshes that are solids; give one of them \"collision\": \"none\"",
            b.where, a.name, b.name));
    }
  return faults;
}

}  // namespace cradle
