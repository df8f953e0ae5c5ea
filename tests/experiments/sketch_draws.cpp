#include "experiments/sketch_draws.h"

#include <algorithm>

#include "experiments/touching_places.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kRightAngle = 1.57079632679489662;  // rad
constexpr double kG = 9.81;                          // m/s^2

}  // namespace

SketchMaterial SketchDraws::material() {
  const double someRestitution = number(0, 1), someFriction = number(0, 1.5), part = number(0.5, 1);
  SketchMaterial material;
  material.restitution = one({0.0, 0.0, 0.3, 0.8, 1.0, someRestitution});
  material.staticFriction = one({0.0, 0.0, 0.1, 0.5, 1.0, 3.0, someFriction});
  material.dynamicFriction = material.staticFriction * (chance(0.7) ? 1 : part);
  return material;
}

Quat SketchDraws::orientation() {
  const int kind = upTo(6);
  const Quat any = random_.turn();
  const Quat yaw = rotationAbout(Vec3::UnitY(), one({0.0, 0.0, number(0, 6)}));
  if (kind < 1) return yaw;
  if (kind < 3) return yaw * rotationAbout(one({Vec3(1, 0, 0), Vec3(0, 0, 1)}), kRightAngle);
  if (kind < 4) return yaw * rotationAbout(one({Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(1, 0, 1)}), kRightAngle / 2);
  return any;
}

Quat SketchDraws::tilt(double most) {
  const double heading = number(0, 6), angle = number(0, most);
  return rotationAbout(one({Vec3(0, 0, 1), Vec3(std::cos(heading), 0, std::sin(heading))}), angle);
}

SketchBody SketchDraws::body(double scale) {
  SketchBody body;
  body.shape = one({SketchShape::sphere, SketchShape::box, SketchShape::box, SketchShape::cylinder,
                    SketchShape::cylinder, SketchShape::capsule, SketchShape::capsule, SketchShape::prismHull,
                    SketchShape::prism, chance(0.2) ? SketchShape::torus : SketchShape::sphere});
  const double a = scale * number(0.5, 1), b = scale * number(0.2, 2), c = scale * number(0.4, 2);
  body.size = Vec3(a, b, c);
  if (body.shape >= SketchShape::prismHull) body.size = Vec3::Constant(6 * a);
  if (body.shape == SketchShape::sphere) body.size = Vec3::Constant(a);
  body.mass = magnitude(-2, 2);
  body.worldFromBody.rotation = orientation();
  return body;
}

bool addTouching(SceneSketch& sketch, SketchDraws& draws, double scale, bool isCentered) {
  const bool hasWall = sketch.bodies.size() > 1 && sketch.bodies[1].shape == SketchShape::plane;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    SketchBody body = draws.body(scale);
    const Vec3 below = sketch.bodies.back().worldFromBody.translation;
    const double offset = isCentered ? 0 : draws.one({0.0, 0.3, 0.8}) * scale;
    body.worldFromBody.translation = below + Vec3(draws.number(-offset, offset), 0, draws.number(-offset, offset));
    if (hasWall) body.worldFromBody.translation.x() -= 3 * scale;
    sketch.bodies.push_back(body);
    const double gap = draws.gap() * sizeOf(body);
    bool touches = moveToTouch(sketch, -Vec3::UnitY(), gap);
    if (touches && hasWall && draws.chance(0.6)) {
      // Along the floor, up to the wall.
      const double sideGap = draws.gap() * sizeOf(body);
      SceneSketch beside = sketch;
      beside.bodies.erase(beside.bodies.begin());
      touches = moveToTouch(beside, Vec3::UnitX(), sideGap);
      sketch.bodies.back() = beside.bodies.back();
    }
    const std::optional<NearestPlace> nearest = nearestPlace(sketch);
    if (touches && nearest && nearest->separation >= -1e-12 * scale) return true;
    sketch.bodies.pop_back();
  }
  return false;
}

/// Slopes fall along x, by an angle alpha: with friction mu a sliding body gains g (sin alpha - mu cos alpha), and a
/// round one of moment of inertia j m r^2 rolls with g sin(alpha) / (1 + j) where mu >= tan(alpha) j / (1 + j), else
/// slides.
void drawThreshold(SceneSketch& sketch, SketchDraws& draws) {
  const double alpha = draws.number(0.05, 0.7), scale = draws.magnitude(-1.5, -0.7);
  const double beyond = draws.one({0.0, 1e-12, 1e-9, 1e-6, 1e-3, -1e-12, -1e-9, -1e-6, -1e-3});
  const Quat slope = rotationAbout(Vec3::UnitZ(), -alpha);
  const Vec3 down = slope * Vec3::UnitX(), normal = slope * Vec3::UnitY();
  SketchBody floor;
  floor.isStatic = true, floor.shape = SketchShape::plane, floor.worldFromBody.rotation = slope;
  SketchBody body;
  body.mass = draws.magnitude(-2, 2);
  const bool rolls = draws.chance(0.3);
  body.shape = rolls ? draws.one({SketchShape::sphere, SketchShape::cylinder})
                     : draws.one({SketchShape::box, SketchShape::cylinder});
  const double inertia = body.shape == SketchShape::sphere ? 0.4 : 0.5;
  const double radius = scale;
  body.size = Vec3(radius, (rolls ? 1.0 : 0.4) * radius, radius);
  double height = body.size.y() / 2;
  const double yaw = draws.one({0.0, 0.7});
  body.worldFromBody.rotation = slope * rotationAbout(Vec3::UnitY(), yaw);
  if (rolls) {
    height = radius;
    body.worldFromBody.rotation = slope * rotationAbout(Vec3::UnitX(), kRightAngle);
  }
  body.worldFromBody.translation = height * normal;

  const double limit = std::tan(alpha) * (rolls ? inertia / (1 + inertia) : 1);
  const double mu = limit * (1 + beyond);
  sketch.materials[0] = {draws.one({0.0, 0.5}), mu, mu};
  const double slide = kG * (std::sin(alpha) - mu * std::cos(alpha)), roll = kG * std::sin(alpha) / (1 + inertia);
  const double time = sketch.duration;
  double way = 0;
  if (rolls) {
    way = (beyond >= 0 ? roll : slide) * time * time / 2;
  } else {
    // At rest, down at a speed, or up until it stops there.
    const double speed = draws.one({0.0, 0.0, 0.3, -0.3});
    body.linearVelocity = speed * down;
    const double retarded = kG * (std::sin(alpha) + mu * std::cos(alpha)), stop = std::max(0.0, -speed) / retarded;
    const double left = std::max(0.0, time - stop);
    if (speed < 0) way = speed * std::min(time, stop) + retarded * std::pow(std::min(time, stop), 2) / 2;
    const double from = std::max(0.0, speed);
    const double end = slide < 0 ? std::min(left, from / -slide) : left;
    way += from * end + std::max(slide, from > 0 ? slide : 0.0) * end * end / 2;
  }
  sketch.bodies = {floor, body};
  sketch.displacements.push_back({1, way * down});
}

}  // namespace cradle
