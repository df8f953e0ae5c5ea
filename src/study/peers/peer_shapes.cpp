#include "study/peers/peer_shapes.h"

#include <algorithm>

#include "simulate/colliders.h"
#include "simulate/welded_bodies.h"

namespace cradle {

RecognisedShape recogniseModel(const Body& body, const Scene& scene) {
  const auto* model = std::get_if<ModelShape>(&body.shape);
  if (!model) return {};
  RecognisedShape found = recogniseShape(scene.models[static_cast<std::size_t>(model->model)].solid);
  if (body.collision == CollisionChoice::hull || body.collision == CollisionChoice::mesh) found.primitive.reset();
  return found;
}

std::optional<PeerShape> peerShapeOf(const Body& body, const Scene& scene) {
  if (body.collision == CollisionChoice::none) return std::nullopt;
  return std::visit(
      [&](const auto& shape) -> std::optional<PeerShape> {
        if constexpr (!std::is_same_v<std::decay_t<decltype(shape)>, ModelShape>) return PeerShape{shape, {}};
        const RecognisedShape found = recogniseModel(body, scene);
        if (!found.primitive) return std::nullopt;
        return std::visit(
            [&](const auto& primitive) {
              return PeerShape{primitive, found.primitive->bodyFromShape};
            },
            found.primitive->shape);
      },
      body.shape);
}

std::string missingInEveryPeer(const Scene& scene) {
  if (!scene.pushes.empty()) return "pushes";
  const auto anyOf = [&](auto has) {
    return std::ranges::any_of(scene.hinges, has) || std::ranges::any_of(scene.sliders, has);
  };
  if (anyOf([](const auto& joint) { return joint.limits.has_value(); })) return "limits of joints";
  return "";
}

std::string meshThatTouches(const Scene& scene) {
  for (const Body& body : scene.bodies)
    if (body.collision != CollisionChoice::none && !peerShapeOf(body, scene))
      return "the mesh of \"" + body.name + "\", which is no primitive";
  return "";
}

std::set<std::pair<int, int>> joinedBodies(const Scene& scene) {
  std::set<std::pair<int, int>> joined = pairsKeptFromTouching(scene);
  const WeldedBodies welded(scene);
  for (int a = 0; a < std::ssize(scene.bodies); ++a)
    for (int b = a + 1; b < std::ssize(scene.bodies); ++b)
      if (welded.areOne(a, b)) joined.emplace(a, b);
  return joined;
}

}  // namespace cradle
