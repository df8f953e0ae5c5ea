#include "render/upright.h"

#include "math/rotation.h"

namespace cradle {

Quat uprightFromWorld(const Scene& scene) {
  const Vec3 up = upOf(scene);
  return up == Vec3::UnitY() ? Quat::Identity() : rotationBetween(up, Vec3::UnitY());
}

Scene turned(const Quat& turn, Scene scene) {
  scene.gravity = turn * scene.gravity;
  for (Body& body : scene.bodies) {
    body.worldFromBody = RigidTransform{turn, Vec3::Zero()} * body.worldFromBody;
    body.linearVelocity = turn * body.linearVelocity;
    body.angularVelocity = turn * body.angularVelocity;
    body.prescribed.reset();
  }
  forEachKindOfLink(scene, [&turn](auto& links) {
    for (auto& link : links)
      for (Anchor* anchor : {&link.anchorA, &link.anchorB})
        if (anchor->body == kWorld) anchor->point = turn * anchor->point;
  });
  for (Push& push : scene.pushes) {
    push.force = turn * push.force;
    if (push.torque) push.torque = turn * *push.torque;
    if (auto* ray = std::get_if<Push::Ray>(&push.target)) *ray = {turn * ray->origin, turn * ray->direction};
  }
  if (scene.camera) {
    scene.camera->position = turn * scene.camera->position;
    scene.camera->target = turn * scene.camera->target;
    scene.camera->up = turn * scene.camera->up;
  }
  for (CameraMotion::Key& key : scene.cameraMotion.keys) {
    key.position = turn * key.position;
    key.target = turn * key.target;
  }
  for (Light& light : scene.lights) light.direction = turn * light.direction;
  return scene;
}

Frame turned(const Quat& turn, Frame frame) {
  for (BodyState& state : frame.states) {
    state.position = turn * state.position;
    state.orientation = turn * state.orientation;
    state.linearVelocity = turn * state.linearVelocity;
    state.angularVelocity = turn * state.angularVelocity;
  }
  return frame;
}

Event turned(const Quat& turn, Event event) {
  event.point = turn * event.point;
  event.normal = turn * event.normal;
  return event;
}

ContactWrench turned(const Quat& uprightFromWorld, ContactWrench wrench) {
  for (Vec3* vector : {&wrench.force, &wrench.normalForce, &wrench.torque, &wrench.point})
    *vector = uprightFromWorld * *vector;
  return wrench;
}

}  // namespace cradle
