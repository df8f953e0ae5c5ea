#include "simulate/colliders.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/recognise_shape.h"

namespace cradle {
namespace {

struct Balls {
  std::vector<Vec3> points;
  double radius = 0;
};

Balls ballsOf(const Sphere& sphere) {
  return {{Vec3::Zero()}, sphere.radius};
}

Balls ballsOf(const Capsule& capsule) {
  const Vec3 end = capsule.length / 2 * Vec3::UnitY();
  return {{end, -end}, capsule.radius};
}

Balls ballsOf(const Box& box) {
  Balls corners;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    corners.points.push_back(signs.cwiseProduct(box.size) / 2);
  }
  return corners;
}

Balls ballsOf(const TriangleMesh& mesh, CollisionChoice choice) {
  const bool asPrimitive = choice == CollisionChoice::automatic || choice == CollisionChoice::sphere;
  const RecognisedShape recognised = asPrimitive ? recogniseShape(mesh) : RecognisedShape{};
  if (!recognised.primitive) return {mesh.vertices, 0};
  const PlacedPrimitive& placed = *recognised.primitive;
  Balls balls{mesh.vertices, 0};
  if (const auto* sphere = std::get_if<Sphere>(&placed.shape)) balls = ballsOf(*sphere);
  if (const auto* capsule = std::get_if<Capsule>(&placed.shape)) balls = ballsOf(*capsule);
  if (balls.radius > 0)
    for (Vec3& point : balls.points) point = placed.bodyFromShape * point;
  return balls;
}

Balls ballsOf(const Body& body, const Scene& scene) {
  if (const auto* sphere = std::get_if<Sphere>(&body.shape)) return ballsOf(*sphere);
  if (const auto* box = std::get_if<Box>(&body.shape)) return ballsOf(*box);
  if (const auto* capsule = std::get_if<Capsule>(&body.shape)) return ballsOf(*capsule);
  if (const auto* model = std::get_if<ModelShape>(&body.shape))
    return ballsOf(scene.models[static_cast<std::size_t>(model->model)].solid, body.collision);
  return {};
}

bool isPlane(const Body& body) {
  return std::holds_alternative<Plane>(body.shape);
}

}  // namespace

std::optional<BallsCollider> ballsColliderOf(const Body& body, const Scene& scene) {
  if (body.collision == CollisionChoice::none || isPlane(body)) return std::nullopt;
  Balls balls = ballsOf(body, scene);
  return BallsCollider{kFixed, std::move(balls.points), balls.radius, 0};
}

bool mayTouch(const Body& a, const Body& b) {
  return a.collision != CollisionChoice::none && b.collision != CollisionChoice::none &&
         (a.motion == Motion::dynamic || b.motion == Motion::dynamic);
}

std::vector<std::string> unsupportedContacts(const Scene& scene) {
  std::vector<std::string> faults;
  std::vector<bool> isBall, isCylinder;
  for (const Body& body : scene.bodies) {
    const auto collider = ballsColliderOf(body, scene);
    isBall.push_back(collider && collider->points.size() == 1);
    isCylinder.push_back(std::holds_alternative<Cylinder>(body.shape));
  }
  for (std::size_t a = 0; a < scene.bodies.size(); ++a)
    for (std::size_t b = a + 1; b < scene.bodies.size(); ++b) {
      if (!mayTouch(scene.bodies[a], scene.bodies[b])) continue;
      const bool onPlane = isPlane(scene.bodies[a]) || isPlane(scene.bodies[b]);
      if (onPlane ? !(isCylinder[a] || isCylinder[b]) : (isBall[a] && isBall[b])) continue;
      faults.push_back(fmt::format(
          "{}: contact between \"{}\" and \"{}\" cannot be simulated yet; spheres on spheres, and all shapes but "
          "cylinders on planes, can; give one of them \"collision\": \"none\"",
          scene.bodies[b].where, scene.bodies[a].name, scene.bodies[b].name));
    }
  return faults;
}

}  // namespace cradle
