#include "film/joint_parts.h"

#include <algorithm>

#include "math/rotation.h"
#include "render/body_place.h"
#include "render/link_items.h"

namespace cradle {
namespace {

constexpr double kLinkOfBody = 0.055, kLinkOfScene = 0.002;  // of a typical body's radius, of the scene's diagonal

JointPart bar(const std::string& name, int body, const Vec3& from, const Vec3& to, double radius,
              JointPartKind kind = JointPartKind::bar) {
  const double length = (to - from).norm();
  const Quat turn = length > 0 ? rotationBetween(Vec3::UnitY(), to - from) : Quat::Identity();
  return {kind, name, body, {turn, (from + to) / 2}, Vec3(radius, length, radius)};
}

JointPart ball(const std::string& name, const Anchor& anchor, double radius) {
  return {JointPartKind::ball, name, anchor.body, {Quat::Identity(), anchor.point}, Vec3::Constant(radius)};
}

template <class Joint>
void addArms(const Scene& scene, const Joint& joint, double radius, std::vector<JointPart>& parts) {
  for (const Anchor* anchor : {&joint.anchorA, &joint.anchorB}) {
    if (anchor->body == kWorld) continue;
    const Body& body = scene.bodies[static_cast<std::size_t>(anchor->body)];
    const Bounds local = localBounds(scene, body);
    if (local.isEmpty() || local.exteriorDistance(anchor->point) <= radius) continue;
    parts.push_back(bar(joint.name + " arm of " + body.name, anchor->body, body.massProperties.centerOfMass,
                        anchor->point, radius));
  }
}

}  // namespace

double linkRadius(const Scene& scene, const Bounds& bounds) {
  std::vector<double> radii;
  for (const Body& body : scene.bodies)
    if (body.motion == Motion::dynamic) radii.push_back(localBounds(scene, body).sizes().minCoeff() / 2);
  const auto middle = radii.begin() + std::ssize(radii) / 2;
  std::nth_element(radii.begin(), middle, radii.end());
  return std::max(radii.empty() ? 0 : kLinkOfBody * *middle, kLinkOfScene * bounds.diagonal().norm());
}

std::vector<JointPart> jointParts(const Scene& scene, double radius) {
  std::vector<JointPart> parts;
  for (const BallJoint& joint : scene.ballJoints) {
    parts.push_back(ball(joint.name, joint.anchorA, kBallJointOfRod * radius));
    addArms(scene, joint, kPinOfRod * radius, parts);
  }
  for (const Hinge& hinge : scene.hinges) {
    const Vec3 half = kPinLengthOfRod / 2 * radius * hinge.axis, &middle = hinge.anchorA.point;
    parts.push_back(bar(hinge.name, hinge.anchorA.body, middle - half, middle + half, kPinOfRod * radius));
    addArms(scene, hinge, kPinOfRod * radius, parts);
  }
  for (const Slider& slider : scene.sliders) {
    const Vec3 half = kSleeveLengthOfRod / 2 * radius * slider.axis, &middle = slider.anchorA.point;
    parts.push_back(bar(slider.name, slider.anchorA.body, middle - half, middle + half, kSleeveOfRod * radius));
    addArms(scene, slider, kSleeveOfRod * radius, parts);
  }
  for (const Weld& weld : scene.welds) {
    parts.push_back(ball(weld.name, weld.anchorA, kBeadOfRod * radius));
    addArms(scene, weld, kBeadOfRod * radius, parts);
  }
  return parts;
}

void include(const Frame& frame, const Scene& scene, SliderReach& reach) {
  reach.resize(scene.sliders.size());
  if (frame.joints.empty()) return;
  for (std::size_t i = 0; i < reach.size(); ++i) {
    const double coordinate = frame.joints.at(scene.hinges.size() + i).coordinate;
    reach[i] = {std::min(reach[i].first, coordinate), std::max(reach[i].second, coordinate)};
  }
}

std::vector<JointPart> railParts(const Scene& scene, const SliderReach& reach, double radius) {
  const auto rotation = [&scene](const Anchor& anchor) -> Quat {
    if (anchor.body == kWorld) return Quat::Identity();
    return scene.bodies[static_cast<std::size_t>(anchor.body)].worldFromBody.rotation;
  };
  std::vector<JointPart> rails;
  for (std::size_t i = 0; i < reach.size(); ++i) {
    const Slider& slider = scene.sliders[i];
    const Vec3 axis = rotation(slider.anchorB).conjugate() * (rotation(slider.anchorA) * slider.axis);
    const auto [from, to] = railEnds(slider, reach[i].first, reach[i].second, radius);
    rails.push_back(bar(slider.name + " rail", slider.anchorB.body, slider.anchorB.point + from * axis,
                        slider.anchorB.point + to * axis, radius, JointPartKind::rail));
  }
  return rails;
}

}  // namespace cradle
