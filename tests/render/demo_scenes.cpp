#include "render/demo_scenes.h"

#include <cmath>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kPi = 3.14159265358979323846;

Material makeMaterial(const std::string& name, const Vec3f& color, double metallic, double roughness) {
  Material material;
  material.name = name;
  material.baseColor = color;
  material.metallic = metallic;
  material.roughness = roughness;
  return material;
}

Body& addBody(Scene& scene, const std::string& name, const Shape& shape, int material, Motion motion,
              const RigidTransform& place) {
  Body body;
  body.name = name;
  body.shape = shape;
  body.material = material;
  body.motion = motion;
  body.worldFromBody = place;
  if (motion == Motion::dynamic) {
    body.massProperties.mass = 1;
    body.massProperties.inertiaTensor = Mat3::Identity();
  }
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

void addBar(Scene& scene, const Vec3& a, const Vec3& b, double radius) {
  const RigidTransform place{rotationBetween(Vec3::UnitY(), b - a), (a + b) / 2};
  addBody(scene, "bar", Cylinder{radius, (b - a).norm()}, 2, Motion::fixed, place);
}

void addCradleFrame(Scene& scene, double halfWidth, double halfDepth, double height) {
  const double radius = 0.006;
  for (const double z : {-halfDepth, halfDepth}) {
    addBar(scene, {-halfWidth, 0, z}, {-halfWidth, height, z}, radius);
    addBar(scene, {halfWidth, 0, z}, {halfWidth, height, z}, radius);
    addBar(scene, {-halfWidth, height, z}, {halfWidth, height, z}, radius);
    for (const double x : {-halfWidth, halfWidth})
      addBody(scene, "corner", Sphere{1.3 * radius}, 2, Motion::fixed, {Quat::Identity(), {x, height, z}});
  }
  for (const double x : {-halfWidth, halfWidth}) addBar(scene, {x, height, -halfDepth}, {x, height, halfDepth}, radius);
}

}  // namespace

Scene makeCradleScene() {
  Scene scene;
  scene.materials = {
      makeMaterial("", {0.69f, 0.69f, 0.69f}, 0, 0.5),      makeMaterial("steel", {0.90f, 0.91f, 0.92f}, 1, 0.08),
      makeMaterial("frame", {0.80f, 0.81f, 0.83f}, 1, 0.3), makeMaterial("brass", {0.95f, 0.80f, 0.45f}, 1, 0.12),
      makeMaterial("red", {0.80f, 0.10f, 0.09f}, 0, 0.3),   makeMaterial("green", {0.13f, 0.65f, 0.33f}, 0, 0.45),
      makeMaterial("blue", {0.12f, 0.42f, 0.80f}, 0, 0.25)};
  scene.materials[0].baseColor.reset();
  scene.lights = {Light{}};
  addBody(scene, "ground", Plane{}, 0, Motion::fixed, {});
  const double radius = 0.025, height = 0.24, length = 0.16, depth = 0.06;
  addCradleFrame(scene, 0.15, depth, height);
  for (int i = 0; i < 5; ++i) {
    const double x = 2 * radius * (i - 2), angle = i == 0 ? -40 * kPi / 180 : 0;
    const Vec3 center = Vec3(x, height, 0) + length * Vec3(std::sin(angle), -std::cos(angle), 0);
    const int body = static_cast<int>(scene.bodies.size());
    addBody(scene, "ball", Sphere{radius}, i == 2 ? 3 : 1, Motion::dynamic,
            {rotationAbout(Vec3::UnitZ(), angle), center});
    for (const double z : {-depth, depth})
      scene.rods.push_back({"", "", {body, {0, radius, 0}}, {kWorld, {x, height, z}}, 0});
  }
  addBody(scene, "red", Sphere{0.026}, 4, Motion::dynamic, {Quat::Identity(), {-0.11, 0.026, 0.15}});
  addBody(scene, "green", Sphere{0.016}, 5, Motion::dynamic, {Quat::Identity(), {0.03, 0.016, 0.18}});
  addBody(scene, "blue", Sphere{0.022}, 6, Motion::dynamic, {Quat::Identity(), {0.11, 0.022, 0.13}});
  addBody(scene, "box", Box{{0.04, 0.04, 0.04}}, 0, Motion::dynamic,
          {rotationAbout(Vec3::UnitY(), 0.5), {0.0, 0.02, -0.13}});
  return scene;
}

Scene makeSpringScene() {
  Scene scene;
  scene.materials = {makeMaterial("", {0.85f, 0.45f, 0.12f}, 0, 0.4)};
  scene.lights = {Light{}};
  addBody(scene, "box", Box{{0.4, 0.3, 0.25}}, 0, Motion::dynamic, {rotationAbout({0.3, 1, 0.2}, 0.7), {0, 0, 0}});
  scene.springs.push_back({"", "", {0, {0.2, 0.15, 0.125}}, {kWorld, {0.1, 1.4, 0}}, 100, 0, 0.9});
  return scene;
}

Frame startFrame(const Scene& scene) {
  Frame frame;
  for (const Body& body : scene.bodies) {
    if (body.motion == Motion::fixed) continue;
    BodyState state;
    state.position = body.worldFromBody * body.massProperties.centerOfMass;
    state.orientation = body.worldFromBody.rotation;
    frame.states.push_back(state);
  }
  return frame;
}

}  // namespace cradle
