#include "experiments/random_sketch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/scene_twins.h"
#include "experiments/sketch_draws.h"
#include "experiments/squeezed_balls.h"
#include "experiments/touching_places.h"

namespace cradle {
namespace {

SceneSketch emptySketch(SketchFamily family, unsigned number, SketchDraws& draws) {
  constexpr std::array kAccuracies{1e-3, 1e-4, 1e-6, 1e-8};
  SceneSketch sketch;
  sketch.name = fmt::format("{} {}", kSketchFamilyNames[static_cast<std::size_t>(family)], number);
  sketch.accuracy = kAccuracies[number % kAccuracies.size()];
  sketch.duration = draws.one({0.025, 0.05, 0.1, 0.2, 0.3});
  sketch.materials.push_back(draws.material());
  return sketch;
}

/// A floor, level or not, with or without a wall; a fixed box; a fixed model.
void addGround(SceneSketch& sketch, SketchDraws& draws) {
  SketchBody ground;
  ground.isStatic = true, ground.shape = SketchShape::plane;
  const double kind = draws.number(0, 1);
  if (kind > 0.45 && kind < 0.6) ground.worldFromBody.rotation = draws.tilt(0.8);
  if (kind > 0.75 && kind < 0.85) {
    ground.shape = SketchShape::box, ground.size = Vec3(0.3, 0.1, 0.2);
    if (draws.chance(0.5)) ground.worldFromBody.rotation = draws.tilt(0.5);
  }
  if (kind > 0.85) {
    ground.shape = draws.one({SketchShape::prism, SketchShape::prism, SketchShape::gear});
    ground.size = Vec3::Constant(draws.number(0.5, 2));
    if (draws.chance(0.5)) ground.worldFromBody.rotation = draws.orientation();
  }
  sketch.bodies.push_back(ground);
  if (kind < 0.6 || kind > 0.75) return;
  ground.worldFromBody.rotation = rotationBetween(Vec3::UnitY(), Vec3(-1, draws.one({0.0, 0.0, 0.3}), 0));
  sketch.bodies.push_back(ground);  // a wall, beside the floor
}

void addVelocities(SceneSketch& sketch, SketchDraws& draws) {
  const int kind = draws.upTo(5);
  for (SketchBody& body : sketch.bodies) {
    if (body.isStatic || kind < 2) continue;
    const Vec3 velocity = draws.vector(1), spin = draws.vector(8);
    if (kind == 2) body.linearVelocity = Vec3(velocity.x(), 0, velocity.z());
    if (kind >= 3) body.linearVelocity = velocity;
    if (kind == 4) body.angularVelocity = spin;
  }
}

/// A spring, rod or rope from a body to another or to the world above.
void addLink(SceneSketch& sketch, SketchDraws& draws) {
  std::vector<int> moving;
  for (std::size_t i = 0; i < sketch.bodies.size(); ++i)
    if (!sketch.bodies[i].isStatic) moving.push_back(static_cast<int>(i));
  SketchLink link;
  link.bodyA = moving[static_cast<std::size_t>(draws.upTo(static_cast<int>(moving.size())))];
  const int other = moving[static_cast<std::size_t>(draws.upTo(static_cast<int>(moving.size())))];
  const bool isToOther = draws.chance(0.5);
  const SketchBody& body = sketch.bodies[static_cast<std::size_t>(link.bodyA)];
  const double size = sizeOf(body);
  const Vec3 above = Vec3(0, 2 * size, 0) + draws.vector(2 * size);
  if (draws.chance(0.6)) link.anchorA = draws.vector(0.3 * size);
  link.anchorB = body.worldFromBody.translation + above;
  if (isToOther && other != link.bodyA) link.bodyB = other, link.anchorB = draws.vector(0.2 * size);
  const double distance =
      (anchorInWorld(sketch, link.bodyA, link.anchorA) - anchorInWorld(sketch, link.bodyB, link.anchorB)).norm();
  if (distance < 0.3 * size) return;
  link.kind = draws.one({SketchLinkKind::spring, SketchLinkKind::rod, SketchLinkKind::rope});
  link.length = distance;
  if (link.kind == SketchLinkKind::spring) link.length *= draws.one({1.0, 0.8, 1.1});
  if (link.kind == SketchLinkKind::rope) link.length *= draws.one({1.0, 1.0, 1.001, 1.1});
  link.stiffness = body.mass * 9.81 / size * draws.magnitude(0, 3),
  link.damping = draws.one({0.0, 0.0, 1.0}) * body.mass;
  link.restitution = draws.one({0.0, 0.0, 0.5, 1.0});
  sketch.links.push_back(link);
}

SceneSketch drawTouch(unsigned number, SketchDraws& draws) {
  SceneSketch sketch = emptySketch(SketchFamily::touch, number, draws);
  addGround(sketch, draws);
  const int count = 1 + draws.upTo(3);
  const double scale = draws.magnitude(-1.5, -0.7);
  for (int i = 0; i < count; ++i) addTouching(sketch, draws, scale, draws.chance(0.4));
  addVelocities(sketch, draws);
  if (draws.chance(0.3) && !sketch.bodies.back().isStatic) addLink(sketch, draws);
  return sketch;
}

/// Pins the last body where it is nearest to another, to the world or to that other one.
void pinLast(SceneSketch& sketch, SketchDraws& draws) {
  const std::optional<NearestPlace> nearest = nearestPlace(sketch);
  if (!nearest) return;
  SketchLink link;
  link.kind = draws.chance(0.5) ? SketchLinkKind::hinge : SketchLinkKind::ballJoint;
  link.bodyA = static_cast<int>(sketch.bodies.size()) - 1;
  const bool isToOther = draws.chance(0.3) && !sketch.bodies[static_cast<std::size_t>(nearest->other)].isStatic;
  if (isToOther) link.bodyB = nearest->other;
  link.anchorA = anchorInBody(sketch, link.bodyA, nearest->point);
  link.anchorB = anchorInBody(sketch, link.bodyB, nearest->point);
  const Vec3 direction = draws.direction(), across = nearest->normal.cross(direction).normalized();
  const Vec3 axis = draws.one({across, across, direction, nearest->normal});
  link.axis = sketch.bodies.back().worldFromBody.rotation.conjugate() * axis;
  sketch.links.push_back(link);
}

SceneSketch drawPinned(unsigned number, SketchDraws& draws) {
  SceneSketch sketch = emptySketch(SketchFamily::pinned, number, draws);
  addGround(sketch, draws);
  const int count = 1 + draws.upTo(2);
  const double scale = draws.magnitude(-1.5, -0.7);
  for (int i = 0; i < count; ++i)
    if (addTouching(sketch, draws, scale, draws.chance(0.2)) && (i == 0 || draws.chance(0.5))) pinLast(sketch, draws);
  if (draws.chance(0.5)) addVelocities(sketch, draws);
  return sketch;
}

/// Balls of which each impact is known.
SceneSketch drawSqueezedBalls(SceneSketch sketch, SketchDraws& draws) {
  const double scale = draws.magnitude(-1.5, -0.7), ratio = draws.magnitude(0.5, 4),
               size = scale * draws.number(0.5, 2);
  const double restitution = draws.one({0.05, 0.1, 0.3, 0.5, draws.number(0, 1)});
  const double friction = draws.one({0.0, 0.0, 0.5});
  SqueezedBalls balls{{0.1, 0.1 * ratio}, {}, {}, restitution, 9.81};
  for (double& gap : balls.gaps) gap = scale * draws.one({1e-4, 1e-3, 1e-2, 0.1});
  balls.velocities = {draws.one({0.0, -1.0, 0.3}), -draws.magnitude(-1, 0.5)};
  sketch.materials[0] = {restitution, friction, friction};
  SketchBody lower, upper;
  lower.size = Vec3::Constant(scale), upper.size = Vec3::Constant(size);
  lower.mass = balls.masses[0], upper.mass = balls.masses[1];
  lower.worldFromBody.translation = Vec3(0, scale + balls.gaps[0], 0);
  upper.worldFromBody.translation = Vec3(0, 2 * scale + size + balls.gaps[0] + balls.gaps[1], 0);
  lower.linearVelocity.y() = balls.velocities[0], upper.linearVelocity.y() = balls.velocities[1];
  sketch.bodies.push_back(lower), sketch.bodies.push_back(upper);
  if (const auto ways = waysOf(balls, sketch.duration))
    for (const int ball : {0, 1})
      sketch.displacements.push_back({ball + 1, Vec3(0, (*ways)[static_cast<std::size_t>(ball)], 0)});
  return sketch;
}

SceneSketch drawSqueezed(unsigned number, SketchDraws& draws) {
  SceneSketch sketch = emptySketch(SketchFamily::squeezed, number, draws);
  sketch.materials[0].restitution = draws.one({0.0, 0.05, 0.1, 0.3, 0.5, 0.8, draws.number(0, 1)});
  SketchBody floor;
  floor.isStatic = true, floor.shape = SketchShape::plane;
  sketch.bodies.push_back(floor);
  if (draws.chance(0.3)) return drawSqueezedBalls(sketch, draws);
  const int layers = 2 + (draws.chance(0.3) ? 1 : 0);
  const double scale = draws.magnitude(-1.5, -0.7), ratio = draws.magnitude(0.5, layers == 2 ? 4 : 2);
  const bool isCentered = draws.chance(0.5);
  double mass = 0.1;
  for (int i = 0; i < layers; ++i) {
    if (!addTouching(sketch, draws, i == 0 ? scale : scale * draws.number(1, 2), isCentered)) continue;
    sketch.bodies.back().mass = mass;
    mass *= ratio;
  }
  if (draws.chance(0.6)) sketch.bodies.back().linearVelocity = Vec3(0, -draws.magnitude(-1, 0.5), 0);
  return sketch;
}

/// Its image in the mirror x = 0.
SketchBody imageOf(SketchBody body) {
  body.worldFromBody = mirrorImage(body.worldFromBody, body, 0);
  body.linearVelocity.x() *= -1;
  body.angularVelocity.y() *= -1, body.angularVelocity.z() *= -1;
  return body;
}

/// A body and its image, `gap` apart if they are to touch, on what is there already.
bool addPair(SceneSketch& sketch, SketchDraws& draws, double scale) {
  SketchBody body = draws.body(scale);
  body.worldFromBody.translation = Vec3(0, 0, draws.chance(0.5) ? 0 : draws.number(-scale, scale) / 4);
  SceneSketch beside = sketch;
  SketchBody mirror;
  mirror.isStatic = true, mirror.shape = SketchShape::plane;
  mirror.worldFromBody.rotation = rotationBetween(Vec3::UnitY(), Vec3::UnitX());
  const double gap = draws.one({0.5 * draws.gap() * sizeOf(body), scale * draws.number(0, 1)});
  beside.bodies = {mirror, body};
  if (!moveToTouch(beside, -Vec3::UnitX(), gap)) return false;
  sketch.bodies.push_back(beside.bodies.back());
  const double floorGap = draws.gap() * sizeOf(body);
  const bool touches = moveToTouch(sketch, -Vec3::UnitY(), floorGap);
  const std::optional<NearestPlace> nearest = nearestPlace(sketch);
  if (!touches || !nearest || nearest->separation < -1e-12 * scale) {
    sketch.bodies.pop_back();
    return false;
  }
  SketchBody& added = sketch.bodies.back();
  if (draws.chance(0.4)) added.linearVelocity = draws.vector(0.5);
  const int index = static_cast<int>(sketch.bodies.size()) - 1;
  sketch.images.push_back(index + 1), sketch.images.push_back(index);
  sketch.bodies.push_back(imageOf(sketch.bodies.back()));
  return true;
}

/// A body in the mirror's plane, on what is there already.
void addMiddle(SceneSketch& sketch, SketchDraws& draws, double scale) {
  SketchBody body;
  do body = draws.body(scale);
  while (body.shape > SketchShape::capsule);
  body.worldFromBody.rotation =
      rotationAbout(Vec3::UnitX(), draws.one({0.0, 0.0, 1.5707963267948966, draws.number(0, 3)}));
  body.worldFromBody.translation = Vec3(0, 0, draws.one({0.0, draws.number(-scale, scale) / 4}));
  sketch.bodies.push_back(body);
  const double gap = draws.gap() * sizeOf(body);
  const bool touches = moveToTouch(sketch, -Vec3::UnitY(), gap);
  const std::optional<NearestPlace> nearest = nearestPlace(sketch);
  if (!touches || !nearest || nearest->separation < -1e-12 * scale) {
    sketch.bodies.pop_back();
    return;
  }
  const Vec3 velocity = draws.vector(1);
  if (draws.chance(0.6)) sketch.bodies.back().linearVelocity = Vec3(0, -std::abs(velocity.y()), velocity.z());
  if (draws.chance(0.2)) sketch.bodies.back().angularVelocity = Vec3(8 * velocity.x(), 0, 0);
  sketch.images.push_back(static_cast<int>(sketch.images.size()));
}

SceneSketch drawSymmetric(unsigned number, SketchDraws& draws) {
  SceneSketch sketch = emptySketch(SketchFamily::symmetric, number, draws);
  SketchBody floor;
  floor.isStatic = true, floor.shape = SketchShape::plane;
  sketch.bodies.push_back(floor), sketch.images.push_back(0);
  const double scale = draws.magnitude(-1.5, -0.7);
  if (draws.chance(0.3)) addMiddle(sketch, draws, scale);
  const int pairs = 1 + draws.upTo(2);
  for (int i = 0; i < pairs; ++i)
    for (int trial = 0; trial < kMaxTrials; ++trial)
      if (addPair(sketch, draws, scale)) break;
  if (draws.chance(0.8)) addMiddle(sketch, draws, scale * draws.number(0.7, 2));
  return sketch;
}

SceneSketch drawSketch(SketchFamily family, unsigned number, SketchDraws& draws) {
  switch (family) {
    case SketchFamily::touch:
      return drawTouch(number, draws);
    case SketchFamily::pinned:
      return drawPinned(number, draws);
    case SketchFamily::squeezed:
      return drawSqueezed(number, draws);
    case SketchFamily::symmetric:
      return drawSymmetric(number, draws);
    case SketchFamily::threshold:
    case SketchFamily::led:
      break;
  }
  SceneSketch sketch = emptySketch(family, number, draws);
  family == SketchFamily::led ? drawLed(sketch, draws) : drawThreshold(sketch, draws);
  return sketch;
}

}  // namespace

SceneSketch randomSketch(SketchFamily family, unsigned number) {
  constexpr unsigned kSeeds = 1U << 24;  // of each family
  SketchDraws draws((static_cast<unsigned>(family) + 1) * kSeeds + number);
  return drawSketch(family, number, draws);
}

}  // namespace cradle
