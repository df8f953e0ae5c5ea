#include "render/motor_arrows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "render/arrows.h"
#include "render/body_place.h"
#include "render/inside_body.h"

namespace cradle {
namespace {

constexpr double kLongestArc = std::numbers::pi;
constexpr double kArcOfWheel = 0.75;     // radius, of the body's smaller half-size across the axis ...
constexpr double kArcOfArm = 0.5;        // ... or of its greater one, whichever is more
constexpr double kHeadOfArc = 0.45;      // length of a head, of the radius of its arc
constexpr double kGap = 0.1;             // between arrow and body, of the longest arrow
constexpr double kArrowOfBody = 1.2;     // of a slider, of its body's size along the axis
constexpr double kMinShare = 0.05;       // of a motor's force: less is not drawn
constexpr double kSmallestArrow = 0.02;  // of the diagonal of a body
constexpr int kSamples = 9;              // of an arc: hidden are those of which most are inside of something
constexpr int kOutline = 16;             // points around the circle of an arc

/// What a motor moves, as arrows need it; the joint's anchor on that body is the origin.
struct MovedBody {
  int body, other;          // the smaller one of the joint's bodies that forces move, and the other one
  Vec3 anchor, axis;        // m and unit, in its frame
  double ahead, behind;     // m: how far it reaches along the axis and against it
  double radius, diagonal;  // m: of its arc; of its box
};

MovedBody moved(const Anchor& anchor, int other, const Vec3& axis, const std::vector<Bounds>& localBounds) {
  const Bounds& local = localBounds[static_cast<std::size_t>(anchor.body)];
  MovedBody found{anchor.body, other, anchor.point, axis, 0, 0, 0, local.diagonal().norm()};
  const Vec3 half = local.sizes() / 2;
  const double reach = half.cwiseProduct(axis.cwiseAbs()).sum(), middle = axis.dot(Vec3(local.center()) - anchor.point);
  found.ahead = std::max(0.0, middle + reach), found.behind = std::max(0.0, reach - middle);
  Vec3::Index along;
  axis.cwiseAbs().maxCoeff(&along);
  const auto [less, more] = std::minmax({half[(along + 1) % 3], half[(along + 2) % 3]});
  found.radius = std::max({kArcOfWheel * less, kArcOfArm * more, kSmallestArrow * found.diagonal});
  return found;
}

/// The axis of a joint in the frame of its body B, or the world.
Vec3 axisInB(const Scene& scene, const Anchor& a, const Anchor& b, const Vec3& axis) {
  const auto rotation = [&scene](int body) -> Quat {
    return body == kWorld ? Quat::Identity() : scene.bodies[static_cast<std::size_t>(body)].worldFromBody.rotation;
  };
  return rotation(b.body).conjugate() * (rotation(a.body) * axis);
}

template <class Joint>
MovedBody movedBy(const Scene& scene, const std::vector<Bounds>& localBounds, const Joint& joint) {
  const auto isMoved = [&scene](const Anchor& anchor) {
    return anchor.body != kWorld && scene.bodies[static_cast<std::size_t>(anchor.body)].motion == Motion::dynamic;
  };
  const auto ofB = [&] {
    const Vec3 axis = axisInB(scene, joint.anchorA, joint.anchorB, joint.axis);
    return moved(joint.anchorB, joint.anchorA.body, axis, localBounds);
  };
  if (!isMoved(joint.anchorA)) return ofB();
  const MovedBody a = moved(joint.anchorA, joint.anchorB.body, joint.axis, localBounds);
  if (!isMoved(joint.anchorB)) return a;
  const MovedBody b = ofB();
  return b.diagonal < a.diagonal ? b : a;
}

double longestArrow(const Hinge&, const MovedBody& body) {
  return kHeadOfArc * body.radius / kHeadLength;
}

double longestArrow(const Slider&, const MovedBody& body) {
  return std::max(kArrowOfBody * (body.ahead + body.behind), kSmallestArrow * body.diagonal);
}

template <class Visit>
void forEachMotor(const Scene& scene, const Visit& visit) {
  std::size_t index = 0;
  const auto visitAll = [&](const auto& joints) {
    for (const auto& joint : joints) {
      if (joint.motor && joint.motor->force != 0) visit(joint, index);
      ++index;
    }
  };
  visitAll(scene.hinges), visitAll(scene.sliders);
}

/// An arrow along `direction`, or an arc about it.
struct MotorArrow {
  bool turns;
  Vec3 start, direction;  // m and unit, world: tail of the arrow, or centre of the arc
  double extent, radius;  // m: length, and 0; or rad, and m: of an arc
};

/// What may hide the arrows of a motor, in the places of a frame.
class Cover {
 public:
  Cover(const Scene& scene, const std::vector<Bounds>& localBounds, const std::vector<RigidTransform>& worldFromBody,
        int other)
      : scene_(scene), localBounds_(localBounds), places_(worldFromBody) {
    if (other != kWorld) bodies_.push_back(static_cast<std::size_t>(other));
    for (std::size_t i = 0; other == kWorld && i < scene.bodies.size(); ++i)
      if (scene.bodies[i].motion == Motion::fixed) bodies_.push_back(i);
  }

  /// m: how far from most of `points` on along a unit direction the bodies end that they are in; 0 if in none.
  double beyond(const std::vector<Vec3>& points, const Vec3& direction) const {
    double farthest = 0;
    for (const std::size_t body : bodies_) {
      const auto inside =
          std::count_if(points.begin(), points.end(), [&](const Vec3& point) { return holds(body, point); });
      if (2 * inside <= std::ssize(points)) continue;
      const RigidTransform& place = places_[body];
      const Vec3 inward = place.rotation.conjugate() * direction;
      const double end = direction.dot(place * Vec3(localBounds_[body].center())) +
                         inward.cwiseAbs().dot(localBounds_[body].sizes() / 2);
      farthest = std::max(farthest, end - direction.dot(points.front()));
    }
    return farthest;
  }

 private:
  /// Of models the box counts: to look into each would take long.
  bool holds(std::size_t body, const Vec3& point) const {
    const Vec3 local = places_[body].rotation.conjugate() * (point - places_[body].translation);
    if (!localBounds_[body].contains(local)) return false;
    const Body& of = scene_.bodies[body];
    return std::holds_alternative<ModelShape>(of.shape) || isInside(scene_, of, local);
  }

  const Scene& scene_;
  const std::vector<Bounds>& localBounds_;
  const std::vector<RigidTransform>& places_;
  std::vector<std::size_t> bodies_;
};

/// Points of an arc, from its start to the tip, or around all of its circle.
std::vector<Vec3> pointsOf(const MotorArrow& arc, double angle, int count, double radius) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double at = angle * (static_cast<double>(i) / (count - 1) - 0.5);
    points.push_back(arc.start + radius * (rotationAbout(arc.direction, at) * middleOfArc(arc.direction)));
  }
  return points;
}

/// `share` of all of a motor's force, with its sign, acts on the body along `axis` (unit, world).
void append(const Hinge&, const MovedBody& body, const Vec3& anchor, const Vec3& axis, double share, double longest,
            const Cover& cover, std::vector<MotorArrow>& arrows) {
  const double gap = kGap * longest, head = kHeadLength * longest / body.radius;
  MotorArrow ahead{true, anchor + (body.ahead + gap) * axis, std::copysign(1.0, share) * axis,
                   head + std::abs(share) * (kLongestArc - head), body.radius};
  MotorArrow behind = ahead;
  behind.start = anchor - (body.behind + gap) * axis;
  const auto beyond = [&](const MotorArrow& arc, const Vec3& outwards) {
    return cover.beyond(pointsOf(arc, arc.extent, kSamples, arc.radius), outwards);
  };
  // One that can be seen is enough.
  const double before = beyond(ahead, axis), after = beyond(behind, -axis);
  if (before > 0 && after > 0) ahead.start += (before + gap) * axis, behind.start -= (after + gap) * axis;
  arrows.push_back(ahead), arrows.push_back(behind);
}

void append(const Slider&, const MovedBody& body, const Vec3& anchor, const Vec3& axis, double share, double longest,
            const Cover& cover, std::vector<MotorArrow>& arrows) {
  const Vec3 direction = std::copysign(1.0, share) * axis;
  const Vec3 tail = anchor + ((share > 0 ? body.ahead : body.behind) + kGap * longest) * direction;
  arrows.push_back({false, tail + cover.beyond({tail}, direction) * direction, direction,
                    (kHeadLength + std::abs(share) * (1 - kHeadLength)) * longest, 0});
}

std::vector<MotorArrow> arrowsAt(const Scene& scene, const std::vector<Bounds>& localBounds, double longest,
                                 const Frame& frame, const std::vector<RigidTransform>& worldFromBody) {
  std::vector<MotorArrow> arrows;
  if (frame.joints.empty()) return arrows;
  forEachMotor(scene, [&](const auto& joint, std::size_t index) {
    const double share = frame.joints.at(index).force / std::abs(joint.motor->force);
    if (std::abs(share) < kMinShare) return;
    const MovedBody body = movedBy(scene, localBounds, joint);
    const RigidTransform& place = worldFromBody.at(static_cast<std::size_t>(body.body));
    const double sign = body.body == joint.anchorA.body ? 1 : -1;  // on B it acts the other way
    append(joint, body, place * body.anchor, place.rotation * body.axis,
           sign * std::min(1.0, std::abs(share)) * std::copysign(1.0, share), longest,
           Cover(scene, localBounds, worldFromBody, body.other), arrows);
  });
  return arrows;
}

}  // namespace

double longestMotorArrow(const Scene& scene, const std::vector<Bounds>& localBounds) {
  std::vector<double> lengths;
  forEachMotor(scene, [&](const auto& joint, std::size_t) {
    lengths.push_back(longestArrow(joint, movedBy(scene, localBounds, joint)));
  });
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + std::ssize(lengths) / 2;
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

void appendMotorArrows(const Scene& scene, const Appearance& appearance, const Frame& frame,
                       const std::vector<RigidTransform>& worldFromBody, DrawList& list) {
  const ArrowLook& look = appearance.motorArrow;
  std::vector<Bounds> localBounds;
  for (const BodyAppearance& body : appearance.bodies) localBounds.push_back(body.local);
  for (const MotorArrow& arrow : arrowsAt(scene, localBounds, look.longest, frame, worldFromBody)) {
    if (arrow.turns)
      appendArc(appearance, look, arrow.start, arrow.direction, arrow.radius, arrow.extent, list);
    else
      appendArrow(appearance, look, arrow.start, arrow.start + arrow.extent * arrow.direction, list);
  }
}

std::vector<Vec3> outlineOfMotorArrows(const Scene& scene, const std::vector<Bounds>& localBounds, const Frame& frame,
                                       const std::vector<RigidTransform>& worldFromBody) {
  const double longest = longestMotorArrow(scene, localBounds), thick = kHeadRadius * longest;
  std::vector<Vec3> points;
  for (const MotorArrow& arrow : arrowsAt(scene, localBounds, longest, frame, worldFromBody)) {
    if (arrow.turns) {
      const std::vector<Vec3> around = pointsOf(arrow, 2 * std::numbers::pi, kOutline + 1,
                                                (arrow.radius + thick) / std::cos(std::numbers::pi / kOutline));
      points.insert(points.end(), around.begin(), around.end());
      continue;
    }
    const Vec3 aside = thick * middleOfArc(arrow.direction), across = arrow.direction.cross(aside);
    for (const Vec3& end : {arrow.start, Vec3(arrow.start + arrow.extent * arrow.direction)})
      for (const Vec3& off : {aside, Vec3(-aside), across, Vec3(-across)}) points.push_back(end + off);
  }
  return points;
}

}  // namespace cradle
