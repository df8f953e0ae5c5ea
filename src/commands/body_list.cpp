#include "commands/body_list.h"

#include <fmt/format.h>

#include "core/printable.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxLines = 30;

std::string sizesText(const Vec3& size) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} m", size.x(), size.y(), size.z());
}

/// `sizes` are those of the scene's models.
ShapeFacts factsOf(const Shape& shape, const std::vector<Vec3>& sizes) {
  struct {
    const std::vector<Vec3>& sizes;
    ShapeFacts operator()(const Sphere& sphere) const { return {"sphere", Vec3::Constant(2 * sphere.radius)}; }
    ShapeFacts operator()(const Box& box) const { return {"box", box.size}; }
    ShapeFacts operator()(const Cylinder& cylinder) const {
      return {"cylinder", Vec3(2 * cylinder.radius, cylinder.length, 2 * cylinder.radius)};
    }
    ShapeFacts operator()(const Capsule& capsule) const {
      return {"capsule", Vec3(2 * capsule.radius, capsule.length + 2 * capsule.radius, 2 * capsule.radius)};
    }
    ShapeFacts operator()(const Plane&) const { return {"plane", std::nullopt}; }
    ShapeFacts operator()(const ModelShape& model) const {
      return {"mesh", sizes[static_cast<std::size_t>(model.model)]};
    }
  } facts{sizes};
  return std::visit(facts, shape);
}

std::string textOf(const Body& body, const ShapeFacts& shape) {
  std::string text = shape.kind;
  if (std::holds_alternative<Sphere>(body.shape))
    text += fmt::format(", {:.4g} m", shape.size->x());
  else if (shape.size)
    text += ", " + sizesText(*shape.size);
  const bool isDynamic = body.motion == Motion::dynamic;
  return text +
         (isDynamic ? fmt::format(", {:.4g} kg", body.massProperties.mass) : fmt::format(", {}", nameOf(body.motion)));
}

}  // namespace

const char* nameOf(Motion motion) {
  return motion == Motion::fixed ? "static" : motion == Motion::driven ? "driven" : "dynamic";
}

std::vector<ShapeFacts> shapesOf(const Scene& scene) {
  std::vector<Vec3> sizes;
  for (const Model& model : scene.models) {
    Bounds bounds;
    for (const Vec3& vertex : model.solid.vertices) bounds.extend(vertex);
    sizes.emplace_back(bounds.sizes());
  }
  std::vector<ShapeFacts> shapes;
  for (const Body& body : scene.bodies) shapes.push_back(factsOf(body.shape, sizes));
  return shapes;
}

std::vector<std::string> describeBodies(const Scene& scene) {
  std::vector<std::string> lines;
  const std::vector<ShapeFacts> shapes = shapesOf(scene);
  const std::size_t count = scene.bodies.size();
  std::string text = count > 0 ? textOf(scene.bodies[0], shapes[0]) : "", nextText;
  for (std::size_t i = 0, next = 1; i < count; i = next++) {
    if (lines.size() == kMaxLines) {
      lines.push_back(fmt::format("and {} bodies more", count - i));
      break;
    }
    for (; next < count && (nextText = textOf(scene.bodies[next], shapes[next])) == text; ++next) {
    }
    const std::string others = next - i > 1 ? fmt::format(" and {} more, each", next - i - 1) : "";
    lines.push_back(fmt::format("{}{}: {}", printableLine(scene.bodies[i].name), others, text));
    text = nextText;
  }
  return lines;
}

}  // namespace cradle
