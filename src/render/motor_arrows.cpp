#include "render/motor_arrows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/arrows.h"

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

/// What a motor moves, as arrows need it; the joint's anchor on that body is the origin.
struct MovedBody {
  int body;                 // the smaller one of the joint's bodies that forces move
  Vec3 anchor, axis;        // m and unit, in its frame
  double ahead, behind;     // m: how far it reaches along the axis and against it
  double radius, diagonal;  // m: of its arc; of its box
};

MovedBody moved(const Anchor& anchor, const Vec3& axis, const Appearance& appearance) {
  const Bounds& local = appearance.bodies[static_cast<std::size_t>(anchor.body)].local;
  MovedBody found{anchor.body, anchor.point, axis, 0, 0, 0, local.diagonal().norm()};
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
MovedBody movedBy(const Scene& scene, const Appearance& appearance, const Joint& joint) {
  const auto isMoved = [&scene](const Anchor& anchor) {
    return anchor.body != kWorld && scene.bodies[static_cast<std::size_t>(anchor.body)].motion == Motion::dynamic;
  };
  const auto ofB = [&] {
    return moved(joint.anchorB, axisInB(scene, joint.anchorA, joint.anchorB, joint.axis), appearance);
  };
  if (!isMoved(joint.anchorA)) return ofB();
  const MovedBody a = moved(joint.anchorA, joint.axis, appearance);
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

/// `share` of all of a motor's force, with its sign, acts on the body along `axis` (unit, world).
void append(const Appearance& appearance, const ArrowLook& look, const Hinge&, const MovedBody& body,
            const Vec3& anchor, const Vec3& axis, double share, DrawList& list) {
  const double gap = kGap * look.longest, head = kHeadLength * look.longest / body.radius;
  const double angle = head + std::abs(share) * (kLongestArc - head);
  for (const double at : {body.ahead + gap, -body.behind - gap})
    appendArc(appearance, look, anchor + at * axis, std::copysign(1.0, share) * axis, body.radius, angle, list);
}

void append(const Appearance& appearance, const ArrowLook& look, const Slider&, const MovedBody& body,
            const Vec3& anchor, const Vec3& axis, double share, DrawList& list) {
  const Vec3 direction = std::copysign(1.0, share) * axis;
  const Vec3 tail = anchor + ((share > 0 ? body.ahead : body.behind) + kGap * look.longest) * direction;
  const double length = (kHeadLength + std::abs(share) * (1 - kHeadLength)) * look.longest;
  appendArrow(appearance, look, tail, tail + length * direction, list);
}

}  // namespace

double longestMotorArrow(const Scene& scene, const Appearance& appearance) {
  std::vector<double> lengths;
  forEachMotor(scene, [&](const auto& joint, std::size_t) {
    lengths.push_back(longestArrow(joint, movedBy(scene, appearance, joint)));
  });
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + std::ssize(lengths) / 2;
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

void appendMotorArrows(const Scene& scene, const Appearance& appearance, const Frame& frame,
                       const std::vector<RigidTransform>& worldFromBody, DrawList& list) {
  if (frame.joints.empty()) return;
  forEachMotor(scene, [&](const auto& joint, std::size_t index) {
    const double share = frame.joints.at(index).force / std::abs(joint.motor->force);
    if (std::abs(share) < kMinShare) return;
    const MovedBody body = movedBy(scene, appearance, joint);
    const RigidTransform& place = worldFromBody.at(static_cast<std::size_t>(body.body));
    const double sign = body.body == joint.anchorA.body ? 1 : -1;  // on B it acts the other way
    append(appearance, appearance.motorArrow, joint, body, place * body.anchor, place.rotation * body.axis,
           sign * std::min(1.0, std::abs(share)) * std::copysign(1.0, share), list);
  });
}

}  // namespace cradle
