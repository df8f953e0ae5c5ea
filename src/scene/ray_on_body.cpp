#include "scene/ray_on_body.h"

namespace cradle {
namespace {

std::optional<double> castRay(const Ray& ray, const Plane& plane) {
  const double height = plane.normal.dot(ray.origin), approach = plane.normal.dot(ray.direction);
  return height >= 0 && approach < 0 ? std::optional(-height / approach) : std::nullopt;
}

}  // namespace

std::optional<double> castRay(const Ray& ray, const Body& body, const Scene& scene) {
  return std::visit(
      [&](const auto& shape) -> std::optional<double> {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, ModelShape>)
          return castRay(ray, scene.models[static_cast<std::size_t>(shape.model)].solid);
        else
          return castRay(ray, shape);
      },
      body.shape);
}

}  // namespace cradle
