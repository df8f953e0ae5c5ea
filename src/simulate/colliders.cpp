#include "simulate/colliders.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/recognise_shape.h"

namespace cradle {
namespace {

bool isPlane(const Body& body) {
  return std::holds_alternative<Plane>(body.shape);
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

enum class ContactKind { plane, ball, polytope, points, none };

ContactKind contactKindOf(const Body& body, const Scene& scene) {
  if (isPlane(body)) return ContactKind::plane;
  const auto collider = colliderOf(body, scene, kFixed);
  if (!collider || collider->points.empty()) return ContactKind::none;
  if (collider->isBall()) return ContactKind::ball;
  return collider->polytope ? ContactKind::polytope : ContactKind::points;
}

bool canTouch(ContactKind a, ContactKind b) {
  if (a == ContactKind::none || b == ContactKind::none) return false;
  if (a == ContactKind::plane || b == ContactKind::plane) return true;
  return a != ContactKind::points && b != ContactKind::points;
}

}  // namespace

std::optional<Collider> colliderOf(const Body& body, const Scene& scene, int movingBody) {
  if (body.collision == CollisionChoice::none || isPlane(body)) return std::nullopt;
  ColliderBuilder builder;
  builder.collider.body = movingBody;
  builder.frame = body.worldFromBody;
  if (movingBody != kFixed) builder.frame = {Quat::Identity(), -body.massProperties.centerOfMass};
  std::visit(
      [&](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, ModelShape>)
          addMesh(scene.models[static_cast<std::size_t>(shape.model)].solid, body.collision, builder);
        else
          builder(shape);
      },
      body.shape);
  for (const Vec3& point : builder.collider.points)
    builder.collider.boundingRadius = std::max(builder.collider.boundingRadius, point.norm() + builder.collider.radius);
  return std::move(builder.collider);
}

bool mayTouch(const Body& a, const Body& b) {
  return a.collision != CollisionChoice::none && b.collision != CollisionChoice::none &&
         (a.motion == Motion::dynamic || b.motion == Motion::dynamic);
}

std::vector<std::string> unsupportedContacts(const Scene& scene) {
  std::vector<std::string> faults;
  std::vector<ContactKind> kinds;
  for (const Body& body : scene.bodies) kinds.push_back(contactKindOf(body, scene));
  for (std::size_t a = 0; a < scene.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < scene.bodies.size(); ++b)
      if (mayTouch(scene.bodies[a], scene.bodies[b]) && !canTouch(kinds[a], kinds[b]))
        faults.push_back(
            fmt::format("{}: contact between \"{}\" and \"{}\" cannot be simulated yet; spheres and boxes among each "
                        "other, and all "
                        "shapes but cylinders on planes, can; give one of them \"collision\": \"none\"",
                        scene.bodies[b].where, scene.bodies[a].name, scene.bodies[b].name));
  return faults;
}

}  // namespace cradle
