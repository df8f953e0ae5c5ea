// A text as a scene: what is accepted is what simulations believe without another look.

#include <cmath>
#include <set>

#include "fuzz_target.h"
#include "mesh/primitives.h"
#include "scene/load_scene.h"

namespace cradle {
namespace {

/// Every mesh is a tetrahedron, except those that are not there.
LoadedModel tetrahedron(const MeshReference& reference) {
  if (reference.path.size() % 4 == 3) throw Error(ErrorKind::mesh, reference.path, "no such file");
  LoadedModel loaded;
  Model& model = loaded.model;
  model.name = modelName(reference);
  model.drawn.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (Vec3& vertex : model.drawn.vertices) vertex *= reference.scale;
  model.drawn.normals.assign(4, Vec3f::UnitY());
  model.drawn.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  model.drawn.materials = {{"", Vec3f(1, 0, 0), 0, 4}};
  model.solid = weld(model.drawn.vertices, model.drawn.triangles);
  return loaded;
}

void checkBody(const Body& body, const Scene& scene) {
  HOLDS(!body.name.empty() && body.material >= 0 && body.material < std::ssize(scene.materials));
  HOLDS(body.worldFromBody.translation.allFinite());
  HOLDS(std::abs(body.worldFromBody.rotation.norm() - 1) < 1e-12);
  HOLDS(body.linearVelocity.allFinite() && body.angularVelocity.allFinite());
  if (const auto* model = std::get_if<ModelShape>(&body.shape))
    HOLDS(model->model >= 0 && model->model < std::ssize(scene.models));
  if (body.motion == Motion::fixed) return;
  const MassProperties& properties = body.massProperties;
  HOLDS(std::isfinite(properties.mass) && properties.mass > 0 && properties.centerOfMass.allFinite());
  HOLDS(properties.inertiaTensor.allFinite() && (properties.inertiaTensor.diagonal().array() > 0).all());
}

void checkAnchors(const Anchor& a, const Anchor& b, const Scene& scene) {
  bool isAnyDynamic = false;
  for (const Anchor& anchor : {a, b}) {
    HOLDS(anchor.body >= kWorld && anchor.body < std::ssize(scene.bodies) && anchor.point.allFinite());
    isAnyDynamic = isAnyDynamic || (anchor.body != kWorld &&
                                    scene.bodies[static_cast<std::size_t>(anchor.body)].motion == Motion::dynamic);
  }
  HOLDS(isAnyDynamic && a.body != b.body);
}

void check(const Scene& scene) {
  HOLDS(std::isfinite(scene.duration) && scene.duration > 0 && scene.gravity.allFinite());
  HOLDS(scene.accuracy >= 1e-12 && scene.accuracy <= 1e-2 && !scene.lights.empty());
  std::set<std::string> names;
  for (const Body& body : scene.bodies) {
    checkBody(body, scene);
    HOLDS(names.insert(body.name).second);
  }
  for (const Spring& spring : scene.springs)
    HOLDS(spring.stiffness >= 0 && spring.damping >= 0 && spring.restLength >= 0 && std::isfinite(spring.restLength));
  forEachKindOfLink(scene, [&](const auto& links) {
    for (const auto& link : links) checkAnchors(link.anchorA, link.anchorB, scene);
  });
  for (const Rod& rod : scene.rods) HOLDS(rod.length > 0 && std::isfinite(rod.length));
  for (const Rope& rope : scene.ropes) HOLDS(rope.maxLength > 0 && std::isfinite(rope.maxLength));
  for (const Push& push : scene.pushes)
    HOLDS(push.body >= 0 && push.body < std::ssize(scene.bodies) && push.duration > 0 && push.force.allFinite());
}

}  // namespace
}  // namespace cradle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  acceptOrRefuse([&] { check(parseScene(textOf(data, size), "scene.json", tetrahedron).scene); });
  return 0;
}
