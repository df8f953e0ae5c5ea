#pragma once

#include "render/demo_scenes.h"
#include "render/renderer.h"

namespace cradle {

/// A scene without bodies, with one matt material and the default light.
inline Scene emptyScene() {
  Scene scene;
  Material material;
  material.roughness = 1;
  scene.materials = {material};
  scene.lights = {Light{}};
  return scene;
}

inline Body& addBody(Scene& scene, const Shape& shape, const RigidTransform& place, Motion motion = Motion::dynamic) {
  Body body;
  body.shape = shape;
  body.worldFromBody = place;
  body.motion = motion;
  body.massProperties.mass = motion == Motion::dynamic ? 1 : 0;
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

inline Camera cameraAt(const Vec3& position, const Vec3& target, double verticalFieldOfView) {
  Camera camera;
  camera.position = position;
  camera.target = target;
  camera.verticalFieldOfView = verticalFieldOfView;
  return camera;
}

inline View viewOfStart(const Scene& scene, int width, int height) {
  Framing framing(scene, width, height);
  framing.add(startFrame(scene));
  return framing.view();
}

inline Image drawStart(const Scene& scene, int width, int height) {
  Renderer renderer(scene, viewOfStart(scene, width, height), width, height);
  return renderer.render(startFrame(scene));
}

}  // namespace cradle
