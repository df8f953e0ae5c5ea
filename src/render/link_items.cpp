// Springs, rods and ropes have no thickness in physics. Here they get one in proportion to the bodies that they hold.

#include "render/link_items.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "render/body_place.h"
#include "render/tube_curve.h"

namespace cradle {
namespace {

// Shares of the radius of a typical body, and of the whole view: links stay visible next to small and large bodies.
constexpr double kRodOfBody = 0.055, kRodOfView = 0.0022;
constexpr double kCoilOfBody = 0.45, kCoilOfView = 0.05, kCoilOfLength = 0.14;
constexpr double kWireOfCoil = 0.16;
constexpr double kPitchOfCoil = 0.85;  // distance of turns at rest
constexpr int kFewestTurns = 6;
constexpr double kStraightEnd = 0.07;  // of a spring's length
constexpr double kSlenderest = 0.3;    // a coil that is drawn out narrows so far and no farther
constexpr double kKnobOfRod = 1.8;     // radius of the sphere at the end of a rod
constexpr double kPlateOfKnob = 3.2, kPlateThickness = 0.9;
constexpr int kGroundHalvings = 40, kThirds = 50;  // to find where a rope lies on the ground

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Bodies that hang on joints alone, like the wheels of a cart, are parts of others.
std::vector<char> findParts(const Scene& scene) {
  std::vector<char> isPart(scene.bodies.size(), 0);
  const auto mark = [&isPart](const auto& links, char value) {
    for (const auto& link : links)
      for (const int body : {link.anchorA.body, link.anchorB.body})
        if (body != kWorld) isPart[static_cast<std::size_t>(body)] = value;
  };
  forEachKindOfJoint(scene, [&](const auto& joints) { mark(joints, 1); });
  mark(scene.springs, 0), mark(scene.rods, 0), mark(scene.ropes, 0);
  return isPart;
}

/// Median radius of the bodies that move, parts of others only if there is nothing else; m.
double typicalRadius(const Scene& scene, const Appearance& appearance) {
  const std::vector<char> isPart = findParts(scene);
  std::vector<double> wholes, all;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].motion != Motion::dynamic) continue;
    all.push_back(appearance.bodies[i].local.sizes().minCoeff() / 2);
    if (!isPart[i]) wholes.push_back(all.back());
  }
  return median(wholes.empty() ? all : wholes);
}

/// A unit vector across `direction` that turns with it from the start of the scene on, so that coils do not jump.
Vec3 sideOf(const Vec3& directionAtStart, const Vec3& direction) {
  Vec3::Index smallest;
  directionAtStart.cwiseAbs().minCoeff(&smallest);
  const Vec3 side = directionAtStart.cross(Vec3::Unit(smallest)).normalized();
  return rotationBetween(directionAtStart, direction) * side;
}

Vec3 directionBetween(const Vec3& a, const Vec3& b) {
  const Vec3 line = b - a;
  return line.norm() > 0 ? Vec3(line.normalized()) : Vec3(Vec3::UnitY());
}

/// Least height over the ground of a rope that hangs along `sag`.
double lowestHeight(const Ground& ground, const TubeItem& rope, const Vec3& sag) {
  TubeItem moved = rope;
  moved.sag = sag;
  const auto height = [&](double s) { return ground.normal.dot(tubePoint(moved, s) - ground.point); };
  double low = 0, high = 1;  // heights along a hanging rope are convex
  for (int i = 0; i < kThirds; ++i) {
    const double left = (2 * low + high) / 3, right = (low + 2 * high) / 3;
    if (height(left) < height(right))
      high = right;
    else
      low = left;
  }
  return std::min({height(0), height(1), height((low + high) / 2)});
}

/// A rope that would hang through the ground swings aside until it lies there: as long, and flat in the limit.
Vec3 laidOnGround(const Ground& ground, const TubeItem& rope) {
  const auto turned = [&rope](double angle) {
    return Vec3(std::cos(angle) * rope.sag + std::sin(angle) * rope.sag.norm() * rope.side);
  };
  double low = 0, high = std::numbers::pi / 2;
  if (lowestHeight(ground, rope, rope.sag) >= rope.wireRadius) return rope.sag;
  for (int i = 0; i < kGroundHalvings; ++i) {
    const double angle = (low + high) / 2;
    (lowestHeight(ground, rope, turned(angle)) < rope.wireRadius ? low : high) = angle;
  }
  return turned(high);
}

class LinkBuilder {
 public:
  LinkBuilder(const Scene& scene, const Appearance& appearance, const View& view,
              const std::vector<RigidTransform>& places, DrawList& list)
      : scene_(scene), appearance_(appearance), places_(places), start_(placeBodiesAtStart(scene)), list_(list) {
    body_ = typicalRadius(scene, appearance);
    size_ = view.size();
    rod_ = std::max(kRodOfBody * body_, kRodOfView * size_);
    coil_ = body_ > 0 ? std::min(kCoilOfBody * body_, kCoilOfView * size_) : kCoilOfView * size_;
  }

  void add(const Spring& spring);
  void add(const Rod& rod);
  void add(const Rope& rope);
  void add(const BallJoint& joint);
  void add(const Hinge& hinge);
  void add(const Slider& slider);
  void add(const Weld& weld);

 private:
  Vec3 now(const Anchor& anchor) const { return worldPoint(anchor, places_); }
  Vec3 atStart(const Anchor& anchor) const { return worldPoint(anchor, start_); }
  bool isInsideFixedBody(const Vec3& point) const;
  void addCylinder(const Vec3& a, const Vec3& b, double radius, const Surface& surface);
  void addEnd(const Anchor& anchor, const Anchor& other, double knob, bool plate);
  void addArm(const Anchor& anchor, double radius);

  const Scene& scene_;
  const Appearance& appearance_;
  const std::vector<RigidTransform>& places_;
  const std::vector<RigidTransform> start_;
  DrawList& list_;
  double body_ = 0, size_ = 1, rod_ = 0, coil_ = 0;  // m
};

bool LinkBuilder::isInsideFixedBody(const Vec3& point) const {
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    if (scene_.bodies[i].motion != Motion::fixed || appearance_.bodies[i].local.isEmpty()) continue;
    const Vec3 local = places_[i].inverse() * point;
    if (appearance_.bodies[i].local.exteriorDistance(local) <= rod_) return true;
  }
  return false;
}

void LinkBuilder::addCylinder(const Vec3& a, const Vec3& b, double radius, const Surface& surface) {
  list_.cylinders.push_back({(a + b) / 2, directionBetween(a, b), radius, (b - a).norm(), surface});
}

/// A knob where a link ends, and a plate behind it where that is the open world.
void LinkBuilder::addEnd(const Anchor& anchor, const Anchor& other, double knob, bool plate) {
  const Vec3 point = now(anchor);
  list_.spheres.push_back({point, knob, kSteel});
  if (anchor.body != kWorld || !plate || isInsideFixedBody(point)) return;
  // Ceilings are level and walls upright: the nearest axis of the world.
  const Vec3 direction = directionBetween(atStart(other), atStart(anchor));
  Vec3::Index along;
  direction.cwiseAbs().maxCoeff(&along);
  const Vec3 away = std::copysign(1.0, direction[along]) * Vec3::Unit(along);
  const double thickness = kPlateThickness * knob;
  const Vec3 near = point + 0.5 * knob * away;
  addCylinder(near, near + thickness * away, kPlateOfKnob * knob, kDarkSteel);
}

/// A link that ends outside its body hangs on a thin arm from the centre of mass.
void LinkBuilder::addArm(const Anchor& anchor, double radius) {
  if (anchor.body == kWorld) return;
  const std::size_t body = static_cast<std::size_t>(anchor.body);
  const Bounds& local = appearance_.bodies[body].local;
  if (local.isEmpty() || local.exteriorDistance(anchor.point) <= radius) return;
  addCylinder(places_[body] * scene_.bodies[body].massProperties.centerOfMass, now(anchor), radius, kSteel);
}

void LinkBuilder::add(const Spring& spring) {
  const Vec3 a = now(spring.anchorA), b = now(spring.anchorB);
  const Vec3 aStart = atStart(spring.anchorA), bStart = atStart(spring.anchorB);
  const double natural = std::max({spring.restLength, 0.5 * (bStart - aStart).norm(), 1e-3 * size_});
  const double widest = std::min(coil_, kCoilOfLength * natural);
  const int turns = std::clamp(static_cast<int>(natural / (kPitchOfCoil * widest)), kFewestTurns, kMaxCoilTurns);

  // The wire keeps its length and its volume: a coil narrows as it is drawn out, and at last its wire does.
  const double wire = std::hypot(2 * std::numbers::pi * turns * widest, natural);
  TubeItem tube{a, b, sideOf(directionBetween(aStart, bStart), directionBetween(a, b))};
  tube.turns = turns;
  tube.straightEnd = kStraightEnd;
  const double drawnWire = windCoil(wire, kSlenderest * widest, tube);
  tube.wireRadius = kWireOfCoil * widest * std::sqrt(std::min(wire / drawnWire, 1.0));
  tube.surface = kSteel;
  const Vec3 margin = Vec3::Constant(tube.coilRadius + tube.wireRadius);
  tube.bounds = Bounds(a.cwiseMin(b) - margin, a.cwiseMax(b) + margin);
  list_.tubes.push_back(tube);
  addEnd(spring.anchorA, spring.anchorB, 1.7 * tube.wireRadius, true);
  addEnd(spring.anchorB, spring.anchorA, 1.7 * tube.wireRadius, true);
  addArm(spring.anchorA, tube.wireRadius);
  addArm(spring.anchorB, tube.wireRadius);
}

void LinkBuilder::add(const Rod& rod) {
  addCylinder(now(rod.anchorA), now(rod.anchorB), rod_, kSteel);
  addEnd(rod.anchorA, rod.anchorB, kKnobOfRod * rod_, true);
  addEnd(rod.anchorB, rod.anchorA, kKnobOfRod * rod_, true);
  addArm(rod.anchorA, rod_);
  addArm(rod.anchorB, rod_);
}

void LinkBuilder::add(const Rope& rope) {
  const Vec3 a = now(rope.anchorA), b = now(rope.anchorB);
  const Vec3 down = scene_.gravity.norm() > 0 ? Vec3(scene_.gravity.normalized()) : Vec3(-Vec3::UnitY());
  TubeItem tube{a, b, Vec3::Zero()};
  Vec3 side = directionBetween(a, b).cross(down);
  if (side.norm() < 1e-6) side = directionBetween(a, b).unitOrthogonal();
  tube.side = side.normalized();
  tube.wireRadius = rod_;
  tube.surface = kHemp;
  hangRope(rope.maxLength, down, tube);
  if (appearance_.ground && tube.slack > 0) tube.sag = laidOnGround(*appearance_.ground, tube);
  const Vec3 margin = Vec3::Constant(tube.wireRadius);
  tube.bounds = Bounds(a.cwiseMin(b) - margin, a.cwiseMax(b) + margin);
  for (const Vec3& corner : ropeCorners(tube))
    tube.bounds.extend(Vec3(corner - margin)), tube.bounds.extend(Vec3(corner + margin));
  list_.tubes.push_back(tube);
  addEnd(rope.anchorA, rope.anchorB, 1.4 * rod_, true);
  addEnd(rope.anchorB, rope.anchorA, 1.4 * rod_, true);
  addArm(rope.anchorA, rod_);
  addArm(rope.anchorB, rod_);
}

void LinkBuilder::add(const BallJoint& joint) {
  list_.spheres.push_back({now(joint.anchorA), kBallJointOfRod * rod_, kDarkSteel});
  addArm(joint.anchorA, kPinOfRod * rod_);
  addArm(joint.anchorB, kPinOfRod * rod_);
}

void LinkBuilder::add(const Hinge& hinge) {
  const Vec3 axis = places_[static_cast<std::size_t>(hinge.anchorA.body)].rotation * hinge.axis;
  const Vec3 point = now(hinge.anchorA), half = kPinLengthOfRod / 2 * rod_ * axis;
  addCylinder(point - half, point + half, kPinOfRod * rod_, kDarkSteel);
  addArm(hinge.anchorA, kPinOfRod * rod_);
  addArm(hinge.anchorB, kPinOfRod * rod_);
}

/// A bar on B, and a sleeve of A around it.
void LinkBuilder::add(const Slider& slider) {
  const Vec3 axis = places_[static_cast<std::size_t>(slider.anchorA.body)].rotation * slider.axis;
  const Vec3 sleeve = now(slider.anchorA), middle = now(slider.anchorB);
  const double coordinate = axis.dot(sleeve - middle), halfSleeve = kSleeveLengthOfRod / 2 * rod_;
  const auto [from, to] = railEnds(slider, coordinate, coordinate, rod_);
  addCylinder(middle + from * axis, middle + to * axis, rod_, kSteel);
  addCylinder(sleeve - halfSleeve * axis, sleeve + halfSleeve * axis, kSleeveOfRod * rod_, kDarkSteel);
  const auto addStop = [&](double inner, double outwards) {  // a disc that the sleeve strikes
    addCylinder(middle + inner * axis, middle + (inner + outwards) * axis, kStopOfRod * rod_, kSteel);
  };
  if (slider.limits && std::isfinite(slider.limits->lower)) addStop(from, -kStopLengthOfRod * rod_);
  if (slider.limits && std::isfinite(slider.limits->upper)) addStop(to, kStopLengthOfRod * rod_);
  addArm(slider.anchorA, kSleeveOfRod * rod_);
  addArm(slider.anchorB, rod_);
}

void LinkBuilder::add(const Weld& weld) {
  list_.spheres.push_back({now(weld.anchorA), kBeadOfRod * rod_, kDarkSteel});
  addArm(weld.anchorA, kBeadOfRod * rod_);
  addArm(weld.anchorB, kBeadOfRod * rod_);
}

}  // namespace

std::pair<double, double> railEnds(const Slider& slider, double least, double most, double radius) {
  const double half = kRailLengthOfRod / 2 * radius, halfSleeve = kSleeveLengthOfRod / 2 * radius;
  const JointRange limits = slider.limits.value_or(JointRange{});
  return {std::min(std::isfinite(limits.lower) ? limits.lower - halfSleeve : -half, least - halfSleeve),
          std::max(std::isfinite(limits.upper) ? limits.upper + halfSleeve : half, most + halfSleeve)};
}

void appendLinks(const Scene& scene, const Appearance& appearance, const View& view,
                 const std::vector<RigidTransform>& worldFromBody, DrawList& list) {
  LinkBuilder builder(scene, appearance, view, worldFromBody, list);
  forEachKindOfLink(scene, [&](const auto& links) {
    const std::size_t spheres = list.spheres.size(), cylinders = list.cylinders.size(), tubes = list.tubes.size();
    for (const auto& link : links) builder.add(link);
    const auto mark = [](auto& items, std::size_t first) {
      for (std::size_t i = first; i < items.size(); ++i) items[i].link = LinkOf<decltype(links)>::kKind;
    };
    mark(list.spheres, spheres), mark(list.cylinders, cylinders), mark(list.tubes, tubes);
  });
}

}  // namespace cradle
