#include "experiments/scene_sketch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/experiment.h"

namespace cradle {
namespace {

std::string modelText(const char* file, double scale) {
  return fmt::format(R"("shape": {{"mesh": "{}/assets/{}", "scale": {}}})", CRADLE_SOURCE_DIR, file, scale);
}

std::string shapeText(const SketchBody& body) {
  const Vec3& size = body.size;
  switch (body.shape) {
    case SketchShape::sphere:
      return fmt::format(R"("shape": {{"sphere": {{"radius": {}}}}})", size.x());
    case SketchShape::box:
      return fmt::format(R"("shape": {{"box": {{"size": {}}}}})", vectorText(size));
    case SketchShape::cylinder:
      return fmt::format(R"("shape": {{"cylinder": {{"radius": {}, "length": {}}}}})", size.x(), size.y());
    case SketchShape::capsule:
      return fmt::format(R"("shape": {{"capsule": {{"radius": {}, "length": {}}}}})", size.x(), size.y());
    case SketchShape::prismHull:
      return modelText("l_prism.3ds", size.x()) + R"(, "collision": "hull")";
    case SketchShape::prism:
      return modelText("l_prism.3ds", size.x());
    case SketchShape::gear:
      return modelText("gear.3ds", size.x());
    case SketchShape::torus:
      return modelText("torus.3ds", size.x());
    case SketchShape::plane:
      break;
  }
  return R"("shape": {"plane": {}})";
}

std::string poseText(const RigidTransform& pose) {
  const Quat& q = pose.rotation;
  return fmt::format(R"("position": {}, "orientation": {{"w": {}, "x": {}, "y": {}, "z": {}}})",
                     vectorText(pose.translation), q.w(), q.x(), q.y(), q.z());
}

std::string driveText(const SketchBody& body) {
  const SketchDrive& drive = *body.drive;
  if (drive.keys.empty() && drive.frequency > 0)
    return fmt::format(R"(, "oscillation": {{"direction": {}, "amplitude": {}, "frequency": {}, "phase": {}}})",
                       vectorText(drive.amplitude.normalized()), drive.amplitude.norm(), drive.frequency, drive.phase);
  if (drive.keys.empty()) return "";
  std::vector<std::string> keys;
  for (const KeyFrame& key : drive.keys)
    keys.push_back(fmt::format(R"({{"time": {}, {}}})", key.time, poseText(key.pose)));
  return fmt::format(R"(, "keyFrames": [{}])", fmt::join(keys, ", "));
}

std::string bodyText(const SketchBody& body, std::size_t index) {
  std::string text = fmt::format(R"({{"name": "b{}", {}, "material": "m{}", {})", index, shapeText(body), body.material,
                                 poseText(body.worldFromBody));
  if (!body.collides) text += R"(, "collision": "none")";
  if (body.isStatic) return text + R"(, "motion": "static"})";
  const bool isSteady = body.drive && body.drive->keys.empty() && body.drive->frequency == 0;
  text += body.drive ? R"(, "motion": "driven")" + driveText(body) : fmt::format(R"(, "mass": {})", body.mass);
  if (!body.linearVelocity.isZero(0) || isSteady) text += R"(, "linearVelocity": )" + vectorText(body.linearVelocity);
  if (!body.angularVelocity.isZero(0)) text += R"(, "angularVelocity": )" + vectorText(body.angularVelocity);
  return text + "}";
}

/// Axis, stops and motor of a hinge or slider.
std::string coordinateText(const SketchLink& link) {
  const bool turns = link.kind == SketchLinkKind::hinge;
  std::string text = R"(, "axis": )" + vectorText(link.axis);
  if (link.limits)
    text += fmt::format(R"(, "limits": {{"lower": {}, "upper": {}, "restitution": {}}})", link.limits->lower,
                        link.limits->upper, link.limits->restitution);
  if (link.motor && link.motor->targetVelocity)
    text += fmt::format(R"(, "motor": {{"targetVelocity": {}, "{}": {}}})", *link.motor->targetVelocity,
                        turns ? "maxTorque" : "maxForce", link.motor->force);
  else if (link.motor)
    text += fmt::format(R"(, "motor": {{"{}": {}}})", turns ? "torque" : "force", link.motor->force);
  return text;
}

std::string linkText(const SketchLink& link) {
  std::string text = fmt::format(R"({{"bodyA": "b{}", "anchorA": {}, "anchorB": {})", link.bodyA,
                                 vectorText(link.anchorA), vectorText(link.anchorB));
  if (link.bodyB >= 0) text += fmt::format(R"(, "bodyB": "b{}")", link.bodyB);
  switch (link.kind) {
    case SketchLinkKind::spring:
      text += fmt::format(R"(, "stiffness": {}, "damping": {}, "restLength": {})", link.stiffness, link.damping,
                          link.length);
      break;
    case SketchLinkKind::rod:
      text += fmt::format(R"(, "length": {})", link.length);
      break;
    case SketchLinkKind::rope:
      text += fmt::format(R"(, "maxLength": {}, "restitution": {})", link.length, link.restitution);
      break;
    case SketchLinkKind::hinge:
    case SketchLinkKind::slider:
      text += coordinateText(link);
      break;
    case SketchLinkKind::ballJoint:
    case SketchLinkKind::weld:
      break;
  }
  return text + "}";
}

}  // namespace

std::string textOf(const SceneSketch& sketch) {
  std::vector<std::string> materials, bodies;
  for (std::size_t i = 0; i < sketch.materials.size(); ++i) {
    const SketchMaterial& material = sketch.materials[i];
    materials.push_back(fmt::format(R"("m{}": {{"restitution": {}, "staticFriction": {}, "dynamicFriction": {}}})", i,
                                    material.restitution, material.staticFriction, material.dynamicFriction));
  }
  for (std::size_t i = 0; i < sketch.bodies.size(); ++i) bodies.push_back(bodyText(sketch.bodies[i], i));
  std::string lists;
  for (const auto& [kind, name] : {std::pair{SketchLinkKind::spring, "springs"},
                                   {SketchLinkKind::rod, "rods"},
                                   {SketchLinkKind::rope, "ropes"},
                                   {SketchLinkKind::ballJoint, "ballJoints"},
                                   {SketchLinkKind::hinge, "hinges"},
                                   {SketchLinkKind::slider, "sliders"},
                                   {SketchLinkKind::weld, "welds"}}) {
    std::vector<std::string> links;
    for (const SketchLink& link : sketch.links)
      if (link.kind == kind) links.push_back(linkText(link));
    if (!links.empty()) lists += fmt::format(",\n \"{}\": [{}]", name, fmt::join(links, ",\n  "));
  }
  return fmt::format(R"({{"schema": "cradle-scene/1", "name": "{}", "duration": {}, "accuracy": {},
 "output": {{"framesPerSecond": {}}}, "gravity": {},
 "materials": {{{}}},
 "bodies": [{}]{}}}
)",
                     sketch.name, sketch.duration, sketch.accuracy, sketch.framesPerSecond, vectorText(sketch.gravity),
                     fmt::join(materials, ",\n  "), fmt::join(bodies, ",\n  "), lists);
}

double sizeOf(const SketchBody& body) {
  const Vec3& size = body.size;
  switch (body.shape) {
    case SketchShape::box:
      return size.norm() / 2;
    case SketchShape::cylinder:
      return std::hypot(size.x(), size.y() / 2);
    case SketchShape::capsule:
      return size.x() + size.y() / 2;
    case SketchShape::prismHull:
    case SketchShape::prism:
      return 0.2 * size.x();
    case SketchShape::gear:
      return 0.15 * size.x();
    case SketchShape::torus:
      return 0.165 * size.x();
    case SketchShape::sphere:
    case SketchShape::plane:
      break;
  }
  return size.x();
}

double smallestSizeOf(const SceneSketch& sketch) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const SketchBody& body : sketch.bodies)
    if (body.isDynamic()) smallest = std::min(smallest, sizeOf(body));
  return smallest;
}

RigidTransform startPoseOf(const SketchBody& body) {
  RigidTransform pose = body.worldFromBody;
  if (body.drive && body.drive->keys.empty()) pose.translation += std::sin(body.drive->phase) * body.drive->amplitude;
  return pose;
}

Vec3 anchorInWorld(const SceneSketch& sketch, int body, const Vec3& point) {
  return body < 0 ? point : Vec3(startPoseOf(sketch.bodies[static_cast<std::size_t>(body)]) * point);
}

Vec3 anchorInBody(const SceneSketch& sketch, int body, const Vec3& point) {
  return body < 0 ? point : Vec3(startPoseOf(sketch.bodies[static_cast<std::size_t>(body)]).inverse() * point);
}

}  // namespace cradle
