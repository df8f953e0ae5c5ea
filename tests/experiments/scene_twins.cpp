// A body's image is congruent to it, as its shape has a mirror plane: with M the world's mirror and S the shape's,
// both x -> R x + t and its image M (R x + t) of the mirrored shape put the same surface there as x -> M R S x + ...,
// which is a rotation again.

#include "experiments/scene_twins.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kTurn = 37 * 3.14159265358979324 / 180;     // rad
constexpr double kScaledTimes = 10, kShrunkTimes = 1.0 / 8;  // lengths are their squares (Froude)
constexpr int kFewBodies = 4;  // that move, and no coarser accuracy than this: steps of contact are made for their size
constexpr double kFewBodiesAccuracy = 1e-4;
constexpr double kPrismMiddle = static_cast<double>(0.1f) / 2;  // m: the L prism stands on z = 0, 0.1 m high

Vec3 flipped(Vec3 v, int axis) {
  v[axis] = -v[axis];
  return v;
}

/// Mirror plane of a shape: x[axis] = middle.
struct ShapeMirror {
  int axis = 0;
  double middle = 0;

  Vec3 image(Vec3 point) const {
    point[axis] = 2 * middle - point[axis];
    return point;
  }
};

ShapeMirror mirrorOf(const SketchBody& body, int axis) {
  switch (body.shape) {
    case SketchShape::prismHull:
    case SketchShape::prism:
      return {2, kPrismMiddle * body.size.x()};
    case SketchShape::gear:
    case SketchShape::torus:
      return {1, 0};
    default:
      return {axis, 0};
  }
}

SceneTwin sameOrder(std::string name, const SceneSketch& sketch) {
  SceneTwin twin{std::move(name), sketch, std::vector<std::size_t>(sketch.bodies.size()), {}};
  std::iota(twin.bodies.begin(), twin.bodies.end(), 0U);
  return twin;
}

/// Of axial vectors: spins and hinges. Sliders have polar ones.
Vec3 axialImage(const Vec3& v, int axis) {
  return -flipped(v, axis);
}

Vec3 anchorImage(const SceneSketch& sketch, int body, const Vec3& point, int axis) {
  return body < 0 ? flipped(point, axis) : mirrorOf(sketch.bodies[static_cast<std::size_t>(body)], axis).image(point);
}

/// Times are `times` as long under the same gravity, and densities the same.
SceneTwin scaledBy(double times, std::string name, const SceneSketch& sketch) {
  const double lengths = times * times, masses = lengths * lengths * lengths;
  SceneTwin twin = sameOrder(std::move(name), sketch);
  twin.sketch.duration *= times, twin.sketch.framesPerSecond /= times;
  for (SketchBody& body : twin.sketch.bodies) {
    body.size *= lengths, body.worldFromBody.translation *= lengths, body.mass *= masses;
    body.linearVelocity *= lengths / times, body.angularVelocity /= times;
    if (!body.drive) continue;
    body.drive->amplitude *= lengths, body.drive->frequency /= times;
    for (KeyFrame& key : body.drive->keys) key.time *= times, key.pose.translation *= lengths;
  }
  for (SketchLink& link : twin.sketch.links) {
    link.anchorA *= lengths, link.anchorB *= lengths, link.length *= lengths;
    link.stiffness *= masses / (times * times), link.damping *= masses / times;
    const double unit = link.kind == SketchLinkKind::slider ? lengths : 1;  // of the coordinate: m or rad
    if (link.limits) link.limits->lower *= unit, link.limits->upper *= unit;
    if (!link.motor) continue;
    link.motor->force *= masses * lengths / unit;
    if (link.motor->targetVelocity) *link.motor->targetVelocity *= unit / times;
  }
  twin.back = [lengths](RigidTransform pose, std::size_t) {
    pose.translation /= lengths;
    return pose;
  };
  return twin;
}

}  // namespace

RigidTransform mirrorImage(const RigidTransform& worldFromBody, const SketchBody& body, int axis) {
  const ShapeMirror mirror = mirrorOf(body, axis);
  const auto reflection = [](int of) {
    Mat3 matrix = Mat3::Identity();
    matrix(of, of) = -1;
    return matrix;
  };
  // A rotation by (w, v) about v is, between two mirrors across the same axis, by (w, axial image of v): no rounding.
  Quat turn = worldFromBody.rotation;
  if (mirror.axis == axis)
    turn.vec() = axialImage(turn.vec(), axis);
  else
    turn = Quat(reflection(axis) * turn.toRotationMatrix() * reflection(mirror.axis)).normalized();
  const Vec3 middle = 2 * mirror.middle * Vec3::Unit(mirror.axis);
  return {turn, flipped(worldFromBody.translation, axis) - turn * middle};
}

SceneTwin mirroredTwin(const SceneSketch& sketch, int axis) {
  SceneTwin twin = sameOrder(axis == 0 ? "mirrored across x" : "mirrored across z", sketch);
  twin.sketch.gravity = flipped(sketch.gravity, axis);
  for (SketchBody& body : twin.sketch.bodies) {
    body.worldFromBody = mirrorImage(body.worldFromBody, body, axis);
    body.linearVelocity = flipped(body.linearVelocity, axis);
    body.angularVelocity = axialImage(body.angularVelocity, axis);
    if (!body.drive) continue;
    body.drive->amplitude = flipped(body.drive->amplitude, axis);
    for (KeyFrame& key : body.drive->keys) key.pose = mirrorImage(key.pose, body, axis);
  }
  for (SketchLink& link : twin.sketch.links) {
    const SketchBody& a = sketch.bodies[static_cast<std::size_t>(link.bodyA)];
    link.anchorA = anchorImage(sketch, link.bodyA, link.anchorA, axis);
    link.anchorB = anchorImage(sketch, link.bodyB, link.anchorB, axis);
    const int mirror = mirrorOf(a, axis).axis;
    link.axis = link.kind == SketchLinkKind::slider ? flipped(link.axis, mirror) : axialImage(link.axis, mirror);
  }
  twin.back = [bodies = sketch.bodies, axis](const RigidTransform& pose, std::size_t body) {
    return mirrorImage(pose, bodies[body], axis);
  };
  return twin;
}

SceneTwin renumberedTwin(const SceneSketch& sketch) {
  SceneTwin twin = sameOrder("renumbered", sketch);
  std::reverse(twin.sketch.bodies.begin(), twin.sketch.bodies.end());
  std::reverse(twin.bodies.begin(), twin.bodies.end());
  std::reverse(twin.sketch.links.begin(), twin.sketch.links.end());
  const auto number = [&](int body) {
    return body < 0 ? body : static_cast<int>(twin.bodies[static_cast<std::size_t>(body)]);
  };
  const auto turnOf = [&](int body) -> const Quat& {
    return twin.sketch.bodies[static_cast<std::size_t>(body)].worldFromBody.rotation;
  };
  for (SketchLink& link : twin.sketch.links) {
    link.bodyA = number(link.bodyA), link.bodyB = number(link.bodyB);
    if (link.bodyB < 0) continue;
    // The coordinate of B against A about the axis is that of A against B about the axis turned over.
    link.axis = -(turnOf(link.bodyB).conjugate() * (turnOf(link.bodyA) * link.axis));
    std::swap(link.bodyA, link.bodyB), std::swap(link.anchorA, link.anchorB);
  }
  twin.back = [](const RigidTransform& pose, std::size_t) { return pose; };
  return twin;
}

SceneTwin turnedTwin(const SceneSketch& sketch) {
  const RigidTransform turn{rotationAbout(Vec3::UnitY(), kTurn), Vec3::Zero()};
  SceneTwin twin = sameOrder("turned", sketch);
  twin.sketch.gravity = turn * sketch.gravity;
  for (SketchBody& body : twin.sketch.bodies) {
    body.worldFromBody = turn * body.worldFromBody;
    body.linearVelocity = turn * body.linearVelocity, body.angularVelocity = turn * body.angularVelocity;
    if (!body.drive) continue;
    body.drive->amplitude = turn.rotation * body.drive->amplitude;
    for (KeyFrame& key : body.drive->keys) key.pose = turn * key.pose;
  }
  for (SketchLink& link : twin.sketch.links)
    if (link.bodyB < 0) link.anchorB = turn * link.anchorB;
  twin.back = [back = turn.inverse()](const RigidTransform& pose, std::size_t) { return back * pose; };
  return twin;
}

SceneTwin scaledTwin(const SceneSketch& sketch) {
  SceneTwin twin = scaledBy(kScaledTimes, "scaled", sketch);
  twin.hasOtherSteps = true;
  return twin;
}

SceneTwin shrunkTwin(const SceneSketch& sketch) {
  SceneTwin twin = scaledBy(kShrunkTimes, "shrunk", sketch);
  twin.sketch.accuracy *= kShrunkTimes * kShrunkTimes;
  const auto moving = std::count_if(sketch.bodies.begin(), sketch.bodies.end(),
                                    [](const SketchBody& body) { return body.isDynamic(); });
  twin.hasOtherSteps = moving > kFewBodies || sketch.accuracy > kFewBodiesAccuracy;
  return twin;
}

}  // namespace cradle
