#include "simulate/plan/reach.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

namespace cradle {
namespace {

constexpr double kReachRounding = 1e-6;  // of the radius: a motion may go exactly to its bound

/// Two anchors that stay within `length` (m, or infinity) of each other.
struct Tether {
  Anchor a, b;
  double length;
};

std::vector<Tether> limitsOf(const Scene& scene) {
  std::vector<Tether> limits;
  for (const Rod& rod : scene.rods) limits.push_back({rod.anchorA, rod.anchorB, rod.length});
  for (const Rope& rope : scene.ropes) limits.push_back({rope.anchorA, rope.anchorB, rope.maxLength});
  for (const BallJoint& joint : scene.ballJoints) limits.push_back({joint.anchorA, joint.anchorB, 0});
  for (const Hinge& hinge : scene.hinges) limits.push_back({hinge.anchorA, hinge.anchorB, 0});
  for (const Slider& slider : scene.sliders)
    limits.push_back({slider.anchorA, slider.anchorB, std::numeric_limits<double>::infinity()});
  for (const Weld& weld : scene.welds) limits.push_back({weld.anchorA, weld.anchorB, 0});
  return limits;
}

bool isFixed(const Anchor& anchor, const Scene& scene) {
  return anchor.body == kWorld || scene.bodies[static_cast<std::size_t>(anchor.body)].motion == Motion::fixed;
}

/// Whether forces move it.
bool isMoved(const Anchor& anchor, const Scene& scene) {
  return anchor.body != kWorld && scene.bodies[static_cast<std::size_t>(anchor.body)].motion == Motion::dynamic;
}

const Body& bodyOf(const Anchor& anchor, const Scene& scene) {
  return scene.bodies[static_cast<std::size_t>(anchor.body)];
}

/// m: length of the moment arm r of an anchor, from its body's centre of mass.
double momentArmOf(const Anchor& anchor, const Scene& scene) {
  return (anchor.point - bodyOf(anchor, scene).massProperties.centerOfMass).norm();
}

Vec3 worldPoint(const Anchor& anchor, const Scene& scene) {
  return anchor.body == kWorld ? anchor.point : bodyOf(anchor, scene).worldFromBody * anchor.point;
}

/// The reach of an anchor.
Reach reachOfAnchor(const Anchor& anchor, const Scene& scene, const std::vector<Reach>& reaches) {
  if (isFixed(anchor, scene)) return {worldPoint(anchor, scene), 0};
  const Reach& body = reaches[static_cast<std::size_t>(anchor.body)];
  return {body.center, body.radius + momentArmOf(anchor, scene)};
}

/// Narrows the reach of the body at `end` by a link to `other`. True if that helped.
bool narrow(const Anchor& end, const Anchor& other, double length, const Scene& scene, std::vector<Reach>& reaches) {
  if (!isMoved(end, scene)) return false;
  const Reach from = reachOfAnchor(other, scene, reaches);
  const double radius = (from.radius + length + momentArmOf(end, scene)) * (1 + kReachRounding);
  Reach& reach = reaches[static_cast<std::size_t>(end.body)];
  if (!(radius < reach.radius)) return false;
  reach = {from.center, radius};
  return true;
}

/// m: the largest distance d of a spring's end from its fixed anchor. With the energy E at the start, the stiffness k,
/// the rest length L0, and the moment arm r of the end, the spring's energy is at most E + m g x fall: k (d - L0)^2 / 2
/// <= E + m g (d + r - start), as the body's centre of mass is at most d + r below the anchor.
double farthestOnSpring(const Spring& spring, const Anchor& end, const Anchor& fixed, double energy,
                        const Scene& scene) {
  if (spring.stiffness == 0) return std::numeric_limits<double>::infinity();
  const Body& body = bodyOf(end, scene);
  const double gravity = scene.gravity.norm();
  const Vec3 down = gravity > 0 ? Vec3(scene.gravity / gravity) : Vec3(Vec3::Zero());
  const Vec3 start = body.worldFromBody * body.massProperties.centerOfMass - worldPoint(fixed, scene);
  const double weight =
      body.massProperties.mass * gravity / spring.stiffness;  // m: by which its weight stretches the spring
  const double half = spring.restLength + weight;  // d^2 - 2 half d + L0^2 - 2 (E / k + weight (r - start)) <= 0
  const double rest = spring.restLength * spring.restLength -
                      2 * (energy / spring.stiffness + weight * (momentArmOf(end, scene) - down.dot(start)));
  return half + std::sqrt(std::max(0.0, half * half - rest));
}

double kineticEnergyOf(const Body& body) {
  const Vec3 angularVelocity = body.worldFromBody.rotation.conjugate() * body.angularVelocity;
  return 0.5 * body.massProperties.mass * body.linearVelocity.squaredNorm() +
         0.5 * angularVelocity.dot(body.massProperties.inertiaTensor * angularVelocity);
}

/// Whether something pushes a body, by body.
std::vector<char> pushedOf(const Scene& scene) {
  std::vector<char> isPushed(scene.bodies.size(), 0);
  for (const Push& push : scene.pushes) isPushed[static_cast<std::size_t>(push.body)] = 1;
  return isPushed;
}

/// A body on springs, as long as it is not known to be moved by anything else.
struct SpringBody {
  bool isAlone = true;
  double energy = 0;  // J, at the start
};

double energyOf(const Spring& spring, const Scene& scene) {
  const double extension =
      (worldPoint(spring.anchorA, scene) - worldPoint(spring.anchorB, scene)).norm() - spring.restLength;
  return 0.5 * spring.stiffness * extension * extension;
}

/// Calls visit(end, other) for both ends of a link.
template <class Visit>
void forBothEnds(const Anchor& a, const Anchor& b, const Visit& visit) {
  visit(a, b), visit(b, a);
}

/// Narrows the reaches of bodies on springs that all end at fixed points, and that nothing else moves.
void narrowBySprings(const Scene& scene, const std::vector<char>& touches, const std::vector<Tether>& limits,
                     std::vector<Reach>& reaches) {
  std::vector<SpringBody> bodies(scene.bodies.size());
  const std::vector<char> isPushed = pushedOf(scene);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    bodies[i] = {!touches[i] && !isPushed[i], kineticEnergyOf(scene.bodies[i])};
  const auto bodyAt = [&](const Anchor& end) -> SpringBody& { return bodies[static_cast<std::size_t>(end.body)]; };
  const auto requireFixed = [&](const Anchor& end, const Anchor& other) {
    if (end.body != kWorld && !isFixed(other, scene)) bodyAt(end).isAlone = false;
  };
  for (const Tether& limit : limits) forBothEnds(limit.a, limit.b, requireFixed);
  for (const Spring& spring : scene.springs) {
    forBothEnds(spring.anchorA, spring.anchorB, requireFixed);
    const auto addEnergy = [&](const Anchor& end, const Anchor& other) {
      if (end.body != kWorld && isFixed(other, scene)) bodyAt(end).energy += energyOf(spring, scene);
    };
    forBothEnds(spring.anchorA, spring.anchorB, addEnergy);
  }
  for (const Spring& spring : scene.springs)
    forBothEnds(spring.anchorA, spring.anchorB, [&](const Anchor& end, const Anchor& other) {
      if (!isMoved(end, scene) || !isFixed(other, scene) || !bodyAt(end).isAlone) return;
      narrow(end, other, farthestOnSpring(spring, end, other, bodyAt(end).energy, scene), scene, reaches);
    });
}

/// Narrows the reaches of bodies along chains of limits, which are lengths of ways: each from the nearest fixed point
/// (E. W. Dijkstra, 1959).
void narrowByLimits(const Scene& scene, const std::vector<Tether>& limits, std::vector<Reach>& reaches) {
  std::vector<std::vector<Tether>> limitsFrom(scene.bodies.size());  // by the body of their anchor b
  using Way = std::pair<double, int>;                                // m; body
  std::priority_queue<Way, std::vector<Way>, std::greater<>> next;
  const auto narrowEnd = [&](const Anchor& end, const Anchor& other, double length) {
    if (narrow(end, other, length, scene, reaches))
      next.emplace(reaches[static_cast<std::size_t>(end.body)].radius, end.body);
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].motion != Motion::fixed && std::isfinite(reaches[i].radius))
      next.emplace(reaches[i].radius, static_cast<int>(i));
  for (const Tether& limit : limits)
    forBothEnds(limit.a, limit.b, [&](const Anchor& end, const Anchor& other) {
      if (isFixed(other, scene)) return narrowEnd(end, other, limit.length);
      limitsFrom[static_cast<std::size_t>(other.body)].push_back({end, other, limit.length});
    });
  while (!next.empty()) {
    const auto [radius, body] = next.top();
    next.pop();
    if (radius > reaches[static_cast<std::size_t>(body)].radius) continue;
    for (const Tether& limit : limitsFrom[static_cast<std::size_t>(body)]) narrowEnd(limit.a, limit.b, limit.length);
  }
}

/// Narrows the reaches of free bodies: a parabola stays within half its chord plus g T^2 / 8 of the middle of its
/// chord.
void narrowByFlight(const Scene& scene, const std::vector<char>& isAttached, std::vector<Reach>& reaches) {
  const std::vector<char> isPushed = pushedOf(scene);
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    if (isAttached[body] || isPushed[body]) continue;
    const Body& flying = scene.bodies[body];
    const Vec3 way = flying.linearVelocity * scene.duration + 0.5 * scene.duration * scene.duration * scene.gravity;
    const double sag = scene.gravity.norm() * scene.duration * scene.duration / 8;
    const Vec3 start = flying.worldFromBody * flying.massProperties.centerOfMass;
    const double radius = (way.norm() / 2 + sag) * (1 + kReachRounding);
    if (radius < reaches[body].radius) reaches[body] = {start + way / 2, radius};
  }
}

/// Where a body is that no force moves.
Reach placesOf(const Body& body, double duration) {
  if (!body.prescribed) return {body.worldFromBody.translation, 0};
  const MotionBall ball = ballOf(*body.prescribed, duration);
  return {ball.center, ball.radius * (1 + kReachRounding)};
}

}  // namespace

std::vector<Reach> reachOf(const Scene& scene, const std::vector<char>& touches) {
  std::vector<Reach> reaches(scene.bodies.size());
  std::vector<char> isAttached = touches;
  const auto attach = [&](const Anchor& anchor) {
    if (anchor.body != kWorld) isAttached[static_cast<std::size_t>(anchor.body)] = 1;
  };
  const std::vector<Tether> limits = limitsOf(scene);
  for (const Tether& limit : limits) attach(limit.a), attach(limit.b);
  for (const Spring& spring : scene.springs) attach(spring.anchorA), attach(spring.anchorB);
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    if (scene.bodies[body].motion == Motion::dynamic) continue;
    reaches[body] = placesOf(scene.bodies[body], scene.duration);
    isAttached[body] = 1;
  }

  narrowBySprings(scene, touches, limits, reaches);
  narrowByLimits(scene, limits, reaches);
  narrowByFlight(scene, isAttached, reaches);
  return reaches;
}

}  // namespace cradle
