// Scenes of linkages and driven bodies. Lengths are about `scale` (m), speeds sqrt(g scale), forces weights.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/experiment.h"
#include "experiments/sketch_draws.h"
#include "experiments/touching_places.h"
#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kPi = std::numbers::pi;

int lastOf(const SceneSketch& sketch) {
  return static_cast<int>(sketch.bodies.size()) - 1;
}

SketchBody& bodyOf(SceneSketch& sketch, int body) {
  return sketch.bodies[static_cast<std::size_t>(body)];
}

/// Moves a body along some way; without `mayFall` on the level or straight up, as there is a floor.
void drive(SketchBody& body, SketchDraws& draws, double scale, double duration, bool mayFall) {
  const auto way = [&](double reach) {
    Vec3 v = draws.vector(reach);
    if (!mayFall) v.y() = draws.one({0.0, std::abs(v.y())});
    return v;
  };
  const double speed = std::sqrt(kGravity * scale);
  SketchDrive drive;
  switch (draws.upTo(3)) {
    case 0: {
      const double amplitude = scale * draws.one({0.1, 0.5, 1.0}), part = draws.one({0.2, 0.6, 1.0, 3.0});
      Vec3 direction = draws.one({Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, 1, 0), draws.direction()});
      if (!mayFall) direction = Vec3(direction.x() + direction.y(), 0, direction.z()).normalized();
      drive.amplitude = amplitude * direction;
      drive.frequency = std::sqrt(part * kGravity / amplitude) / (2 * kPi);
      drive.phase = draws.one({0.0, kPi / 2, draws.number(0, 6)});
      break;
    }
    case 1: {
      KeyFrame key{duration * draws.one({0.0, 0.2}), body.worldFromBody};
      drive.keys.push_back(key);
      const int more = 1 + draws.upTo(3);
      const bool turns = draws.chance(0.5), waits = draws.chance(0.2);
      for (int i = 0; i < more; ++i) {
        const Vec3 by = way(scale), axis = draws.direction();
        key.time += duration * draws.number(0.2, 0.6);
        if (!waits || i > 0) key.pose.translation += mayFall ? by : Vec3(by.x(), 0, by.z());
        if (turns && mayFall) key.pose.rotation = rotationAbout(axis, draws.number(-0.8, 0.8)) * key.pose.rotation;
        drive.keys.push_back(key);
      }
      break;
    }
    default:
      body.linearVelocity = way(draws.one({0.0, 0.3, 1.0}) * speed);
      if (draws.chance(0.5)) body.angularVelocity = Vec3(0, draws.number(-1, 1) * speed / scale, 0);
  }
  body.drive = drive;
}

void addFloor(SceneSketch& sketch, SketchDraws& draws) {
  SketchBody floor;
  floor.isStatic = true, floor.shape = SketchShape::plane;
  if (draws.chance(0.2)) floor.worldFromBody.rotation = draws.tilt(0.4);
  sketch.bodies.push_back(floor);
}

/// A link of two bodies, or a body and the world, at a point (world), with an axis (world) if it has one.
SketchLink linkAt(const SceneSketch& sketch, SketchLinkKind kind, int a, int b, const Vec3& point, const Vec3& axis) {
  SketchLink link;
  link.kind = kind, link.bodyA = a, link.bodyB = b;
  link.anchorA = anchorInBody(sketch, a, point), link.anchorB = anchorInBody(sketch, b, point);
  link.axis = sketch.bodies[static_cast<std::size_t>(a)].worldFromBody.rotation.conjugate() * axis;
  return link;
}

/// Stops and a motor of a hinge or slider of bodies of that size (m) and weight (N).
void addStops(SketchLink& link, SketchDraws& draws, double size) {
  const double unit = link.kind == SketchLinkKind::slider ? size : 1;
  const double lower = draws.one({0.0, 0.1, draws.number(0, 1)});
  const double upper = lower == 0 ? draws.number(0.1, 1) : draws.one({0.0, 0.1, draws.number(0, 1)});
  link.limits = JointRange{-unit * lower, unit * upper, draws.one({0.0, 0.0, 0.5, 1.0, draws.number(0, 1)})};
}

void addMotor(SketchLink& link, SketchDraws& draws, double size, double weight) {
  const bool turns = link.kind == SketchLinkKind::hinge;
  const double strength = weight * (turns ? size : 1), speed = std::sqrt(kGravity * size) / (turns ? size : 1);
  JointDrive motor;
  const double target = speed * draws.one({0.0, 0.3, -0.3, draws.number(-2, 2)});
  const double sign = draws.one({1.0, -1.0});
  motor.force = sign * strength * draws.magnitude(-1.5, 1);
  if (draws.chance(0.7)) motor.targetVelocity = target, motor.force = strength * draws.magnitude(-1.5, 2);
  link.motor = motor;
}

/// A joint of any kind, with what may be on it.
SketchLink someJoint(const SceneSketch& sketch, SketchDraws& draws, int a, int b, const Vec3& point) {
  const Vec3 axis = draws.one({Vec3(0, 0, 1), Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 1, 0), draws.direction()});
  const auto kind =
      draws.one({SketchLinkKind::hinge, SketchLinkKind::hinge, SketchLinkKind::hinge, SketchLinkKind::slider,
                 SketchLinkKind::slider, SketchLinkKind::ballJoint, SketchLinkKind::weld});
  SketchLink link = linkAt(sketch, kind, a, b, point, axis);
  const SketchBody& body = sketch.bodies[static_cast<std::size_t>(a)];
  const double size = sizeOf(body), weight = kGravity * body.mass;
  if (kind != SketchLinkKind::hinge && kind != SketchLinkKind::slider) return link;
  if (draws.chance(0.5)) addStops(link, draws, size);
  if (draws.chance(0.6)) addMotor(link, draws, size, weight);
  return link;
}

/// Bodies in a row from a point on, each joined to the one before, the first to `root` (-1: the world).
void addChain(SceneSketch& sketch, SketchDraws& draws, double scale, int root, Vec3 point, int count) {
  const Vec3 along = draws.one({Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, -1, 1).normalized()});
  for (int i = 0; i < count; ++i) {
    const double length = scale * draws.number(0.5, 1.5);
    SketchBody bar;
    bar.shape = draws.one({SketchShape::box, SketchShape::box, SketchShape::capsule, SketchShape::sphere});
    bar.size = bar.shape == SketchShape::box ? Vec3(0.7, 0.4, 0.2) : Vec3(0.15, 0.3, 0);
    if (bar.shape == SketchShape::sphere) bar.size = Vec3::Constant(0.3);
    bar.size *= length, bar.mass = draws.magnitude(-1.5, 1.5), bar.collides = draws.chance(0.7);
    bar.worldFromBody = {draws.orientation(), point + length / 2 * along};
    sketch.bodies.push_back(bar);
    const int added = lastOf(sketch);
    const bool isTurnedOver = draws.chance(0.3) && root >= 0 && bodyOf(sketch, root).isDynamic();
    sketch.links.push_back(isTurnedOver ? someJoint(sketch, draws, root, added, point)
                                        : someJoint(sketch, draws, added, root, point));
    point += length * along, root = added;
  }
}

/// A hand, far from all else, that nothing touches.
int addHand(SceneSketch& sketch, SketchDraws& draws, double scale, const Vec3& place, bool mayFall) {
  SketchBody hand;
  hand.size = Vec3::Constant(0.2 * scale), hand.collides = false, hand.worldFromBody.translation = place;
  drive(hand, draws, scale, sketch.duration, mayFall);
  sketch.bodies.push_back(hand);
  return lastOf(sketch);
}

void addVelocity(SketchBody& body, SketchDraws& draws, double scale) {
  const Vec3 velocity = draws.vector(std::sqrt(kGravity * scale)), spin = draws.vector(std::sqrt(kGravity / scale));
  if (draws.chance(0.4)) body.linearVelocity = velocity;
  if (draws.chance(0.2)) body.angularVelocity = spin;
}

/// A table that moves, and bodies on it.
void drawCarried(SceneSketch& sketch, SketchDraws& draws, double scale) {
  SketchBody table;
  table.shape = draws.one({SketchShape::box, SketchShape::box, SketchShape::cylinder});
  table.size = scale * (table.shape == SketchShape::box ? Vec3(10, 0.5, 10) : Vec3(5, 0.5, 0));
  drive(table, draws, scale, sketch.duration, true);
  sketch.bodies.push_back(table);
  const int count = 1 + draws.upTo(2);
  for (int i = 0; i < count; ++i)
    if (addTouching(sketch, draws, scale, draws.chance(0.4))) addVelocity(sketch.bodies.back(), draws, scale);
  if (!draws.chance(0.3) || sketch.bodies.size() < 2) return;
  const Vec3 point = sketch.bodies[1].worldFromBody.translation;
  sketch.links.push_back(someJoint(sketch, draws, 1, 0, point));
}

/// A hand that tows a body over a floor, by any link.
void drawTowed(SceneSketch& sketch, SketchDraws& draws, double scale) {
  addFloor(sketch, draws);
  sketch.bodies[0].worldFromBody.rotation.setIdentity();  // a rigid joint may press nothing into a slope
  if (!addTouching(sketch, draws, scale, true)) return;
  const int body = lastOf(sketch);
  const Vec3 middle = bodyOf(sketch, body).worldFromBody.translation;
  const Vec3 offset = draws.one({Vec3(2, 0, 0), Vec3(1.5, 1, 0), Vec3(0, 2, 0), Vec3(1, 1.5, 0.5)});
  const int hand = addHand(sketch, draws, scale, middle + scale * offset, false);
  const Vec3 handPlace = anchorInWorld(sketch, hand, Vec3::Zero());
  SketchLink link = someJoint(sketch, draws, body, hand, handPlace);
  if (draws.chance(0.6)) {
    const Vec3 anchor = draws.one({Vec3(0, 0, 0), draws.vector(0.3 * scale)});
    link = SketchLink{};
    link.kind = draws.one({SketchLinkKind::rope, SketchLinkKind::rope, SketchLinkKind::rod, SketchLinkKind::spring});
    link.bodyA = body, link.bodyB = hand, link.anchorA = anchor;
    link.length = (anchorInWorld(sketch, body, anchor) - handPlace).norm();
    if (link.kind != SketchLinkKind::rod) link.length *= draws.one({1.0, 1.0, 1.1});
    link.stiffness = kGravity * bodyOf(sketch, body).mass / scale * draws.magnitude(0, 2);
    link.restitution = draws.one({0.0, 0.0, 0.5, 1.0});
  }
  sketch.links.push_back(link);
}

/// A wall that comes along the floor and strikes what stands there.
void drawStruck(SceneSketch& sketch, SketchDraws& draws, double scale) {
  addFloor(sketch, draws);
  const int count = 1 + draws.upTo(2);
  for (int i = 0; i < count; ++i) addTouching(sketch, draws, scale, draws.chance(0.4));
  SketchBody wall;
  wall.shape = draws.one({SketchShape::box, SketchShape::sphere, SketchShape::capsule});
  wall.size = scale * (wall.shape == SketchShape::box ? Vec3(0.5, 2, 4) : Vec3(0.7, 1, 0));
  wall.worldFromBody.translation = Vec3(0, scale * draws.number(0.3, 1.2), 0);
  sketch.bodies.push_back(wall);
  SceneSketch beside = sketch;
  beside.bodies.erase(beside.bodies.begin());
  const double gap = draws.one({draws.gap(), draws.number(0, 0.5)}) * scale;
  if (moveToTouch(beside, Vec3::UnitX(), gap)) sketch.bodies.back() = beside.bodies.back();
  SketchBody& moved = sketch.bodies.back();
  if (draws.chance(0.5)) {
    moved.linearVelocity = Vec3(std::sqrt(kGravity * scale) * draws.number(0.1, 2), 0, 0);
    moved.drive = SketchDrive{};
    return;
  }
  SketchDrive drive;
  drive.amplitude = Vec3(-0.3 * scale, 0, 0),
  drive.frequency = std::sqrt(kGravity / scale) / (2 * kPi) * draws.number(0.5, 3);
  drive.phase = kPi;
  moved.drive = drive;
}

/// A linkage that hangs from the world or a hand, or flies; over a floor or not, with bodies in its way or not.
void drawLinkage(SceneSketch& sketch, SketchDraws& draws, double scale) {
  const int count = 1 + draws.upTo(4);
  const bool hasFloor = draws.chance(0.4);
  if (hasFloor) addFloor(sketch, draws);
  const Vec3 point(0, scale * (1 + 1.6 * count), 0);
  const int root = draws.one({-1, -1, -2, -3});
  int first = -1;
  if (root == -2) first = addHand(sketch, draws, scale, point, !hasFloor);
  if (root == -3) {
    SketchBody body;
    body.shape = SketchShape::box, body.size = scale * Vec3(0.5, 0.3, 0.4), body.mass = draws.magnitude(-1, 1);
    body.worldFromBody.translation = point - scale * Vec3(0.4, 0, 0);
    sketch.bodies.push_back(body), first = lastOf(sketch);
    addVelocity(sketch.bodies.back(), draws, scale);
  }
  const Vec3 start = first >= 0 && root == -2 ? anchorInWorld(sketch, first, Vec3::Zero()) : point;
  addChain(sketch, draws, scale, first, start, count);
  if (!draws.chance(0.3)) return;
  SketchBody ball;
  ball.size = Vec3::Constant(0.3 * scale), ball.mass = draws.magnitude(-1, 1);
  ball.worldFromBody.translation = point + scale * Vec3(0.7, 2, 0);
  sketch.bodies.push_back(ball);
}

/// A car whose wheels motors turn, on a floor or on a table that moves.
void drawCar(SceneSketch& sketch, SketchDraws& draws, double scale) {
  RigidTransform ground;
  addFloor(sketch, draws);
  if (draws.chance(0.3)) {
    SketchBody& table = sketch.bodies.back();
    table = SketchBody{};
    table.shape = SketchShape::box, table.size = scale * Vec3(40, 1, 40);
    table.worldFromBody.translation = Vec3(0, -scale / 2, 0);
    drive(table, draws, scale, sketch.duration, true);
    ground.translation = startPoseOf(table).translation - table.worldFromBody.translation;
  } else {
    ground.rotation = sketch.bodies.back().worldFromBody.rotation;
  }
  const double radius = 0.4 * scale;
  SketchBody chassis;
  chassis.shape = SketchShape::box, chassis.size = scale * Vec3(2.4, 0.3, 0.8), chassis.mass = draws.magnitude(-1, 1);
  chassis.worldFromBody = {ground.rotation, ground * Vec3(0, radius + draws.one({0.0, 0.3}) * scale, 0)};
  sketch.bodies.push_back(chassis);
  const int car = lastOf(sketch), wheels = draws.one({4, 4, 3});
  const bool isRound = draws.chance(0.5);
  const double mass = draws.magnitude(-1, 1);
  SketchLink sample;
  sample.kind = SketchLinkKind::hinge;
  addMotor(sample, draws, radius, kGravity * (chassis.mass + wheels * mass) / 4);
  for (int i = 0; i < wheels; ++i) {
    const double x = i < 2 ? 0.8 : -0.8, z = wheels == 3 && i == 2 ? 0 : i % 2 ? 0.7 : -0.7;
    SketchBody wheel;
    wheel.shape = isRound ? SketchShape::sphere : SketchShape::cylinder, wheel.mass = mass;
    wheel.size = isRound ? Vec3::Constant(radius) : Vec3(radius, 0.2 * scale, 0);
    wheel.worldFromBody = {ground.rotation * rotationAbout(Vec3::UnitX(), kPi / 2),
                           ground * Vec3(scale * x, radius, scale * z)};
    sketch.bodies.push_back(wheel);
    SketchLink axle = linkAt(sketch, SketchLinkKind::hinge, lastOf(sketch), car, wheel.worldFromBody.translation,
                             ground.rotation * Vec3::UnitZ());
    if (i < 2 || draws.chance(0.5)) axle.motor = sample.motor;
    sketch.links.push_back(axle);
  }
}

/// A plate on a slider that is pressed onto bodies on a floor.
void drawPressed(SceneSketch& sketch, SketchDraws& draws, double scale) {
  addFloor(sketch, draws);
  const int count = 1 + draws.upTo(2);
  for (int i = 0; i < count; ++i) addTouching(sketch, draws, scale, draws.chance(0.4));
  SketchBody plate;
  plate.shape = SketchShape::box, plate.size = scale * Vec3(4, 0.3, 4), plate.mass = draws.magnitude(-1, 1);
  sketch.bodies.push_back(plate);
  const double gap = draws.one({draws.gap(), 0.1, 0.3}) * scale;
  if (!moveToTouch(sketch, -Vec3::UnitY(), gap)) return;
  SketchLink guide = linkAt(sketch, SketchLinkKind::slider, lastOf(sketch), -1,
                            sketch.bodies.back().worldFromBody.translation, Vec3::UnitY());
  if (draws.chance(0.7)) addMotor(guide, draws, scale, kGravity * plate.mass);
  if (draws.chance(0.5)) addStops(guide, draws, scale);
  sketch.links.push_back(guide);
}

/// A crank that a motor turns, its rod, and a piston on a slider, or a rocker.
void drawCrank(SceneSketch& sketch, SketchDraws& draws, double scale) {
  const double crank = 0.4 * scale, angle = draws.number(0.2, 3);
  const Vec3 pin(crank * std::cos(angle), crank * std::sin(angle), 0);
  const bool hasRocker = draws.chance(0.5);
  const Vec3 end = hasRocker ? Vec3(1.2 * scale, scale, 0) : Vec3(1.5 * scale, draws.one({0.0, 0.2 * scale}), 0);
  const Vec3 foot(1.2 * scale, 0, 0);
  const auto addBar = [&](const Vec3& from, const Vec3& to) {
    SketchBody bar;
    const double length = (to - from).norm();
    bar.shape = SketchShape::box, bar.size = Vec3(length, 0.1 * scale, 0.1 * scale), bar.collides = false;
    bar.mass = draws.magnitude(-1, 1);
    bar.worldFromBody = {rotationBetween(Vec3::UnitX(), (to - from) / length), (from + to) / 2};
    sketch.bodies.push_back(bar);
    return lastOf(sketch);
  };
  const int first = addBar(Vec3::Zero(), pin), rod = addBar(pin, end);
  const int last = hasRocker ? addBar(foot, end) : addBar(end, end + Vec3(0.3 * scale, 0, 0));
  SketchLink axle = linkAt(sketch, SketchLinkKind::hinge, first, -1, Vec3::Zero(), Vec3::UnitZ());
  addMotor(axle, draws, scale, kGravity * (bodyOf(sketch, first).mass + bodyOf(sketch, rod).mass));
  SketchLink guide = linkAt(sketch, hasRocker ? SketchLinkKind::hinge : SketchLinkKind::slider, last, -1,
                            hasRocker ? foot : end, hasRocker ? Vec3::UnitZ() : Vec3::UnitX());
  if (draws.chance(0.3)) addStops(guide, draws, scale);
  sketch.links = {axle, linkAt(sketch, SketchLinkKind::hinge, rod, first, pin, Vec3::UnitZ()),
                  linkAt(sketch, SketchLinkKind::ballJoint, rod, last, end, Vec3::UnitZ()), guide};
}

}  // namespace

void drawLed(SceneSketch& sketch, SketchDraws& draws) {
  sketch.duration = draws.one({0.2, 0.5, 1.0});
  sketch.framesPerSecond = draws.one({60.0, 240.0});
  const double scale = draws.magnitude(-1.5, 0);
  switch (draws.upTo(8)) {
    case 0:
    case 1:
      return drawCarried(sketch, draws, scale);
    case 2:
      return drawTowed(sketch, draws, scale);
    case 3:
      return drawStruck(sketch, draws, scale);
    case 4:
      return drawCar(sketch, draws, scale);
    case 5:
      return drawPressed(sketch, draws, scale);
    case 6:
      return drawCrank(sketch, draws, scale);
    default:
      return drawLinkage(sketch, draws, scale);
  }
}

}  // namespace cradle
