#include "commands/body_list.h"

#include <fmt/format.h>

#include "core/printable.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxLines = 30;

std::string sizesText(const Vec3& size) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} m", size.x(), size.y(), size.z());
}

std::string sizesText(const Model& model) {
  Bounds bounds;
  for (const Vec3& vertex : model.solid.vertices) bounds.extend(vertex);
  return sizesText(bounds.sizes());
}

/// `models` are the sizes of the scene's.
std::string textOf(const Body& body, const std::vector<std::string>& models) {
  const std::string mass = body.motion == Motion::fixed    ? "static"
                           : body.motion == Motion::driven ? "driven"
                                                           : fmt::format("{:.4g} kg", body.massProperties.mass);
  const std::string shape = std::visit(
      [&](const auto& shape) -> std::string {
        using Kind = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Kind, Sphere>) {
          return fmt::format("sphere, {:.4g} m", 2 * shape.radius);
        } else if constexpr (std::is_same_v<Kind, Box>) {
          return "box, " + sizesText(shape.size);
        } else if constexpr (std::is_same_v<Kind, Cylinder>) {
          return "cylinder, " + sizesText({2 * shape.radius, shape.length, 2 * shape.radius});
        } else if constexpr (std::is_same_v<Kind, Capsule>) {
          return "capsule, " + sizesText({2 * shape.radius, shape.length + 2 * shape.radius, 2 * shape.radius});
        } else if constexpr (std::is_same_v<Kind, Plane>) {
          return "plane";
        } else {
          return "mesh, " + models[static_cast<std::size_t>(shape.model)];
        }
      },
      body.shape);
  return shape + ", " + mass;
}

}  // namespace

std::vector<std::string> describeBodies(const Scene& scene) {
  std::vector<std::string> models, lines;
  for (const Model& model : scene.models) models.push_back(sizesText(model));
  const std::size_t count = scene.bodies.size();
  std::string text = count > 0 ? textOf(scene.bodies[0], models) : "", nextText;
  for (std::size_t i = 0, next = 1; i < count; i = next++) {
    if (lines.size() == kMaxLines) {
      lines.push_back(fmt::format("and {} bodies more", count - i));
      break;
    }
    for (; next < count && (nextText = textOf(scene.bodies[next], models)) == text; ++next) {
    }
    const std::string others = next - i > 1 ? fmt::format(" and {} more, each", next - i - 1) : "";
    lines.push_back(fmt::format("{}{}: {}", printableLine(scene.bodies[i].name), others, text));
    text = nextText;
  }
  return lines;
}

}  // namespace cradle
