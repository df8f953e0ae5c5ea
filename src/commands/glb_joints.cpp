#include "commands/glb_joints.h"

#include <algorithm>

#include "math/rotation.h"
#include "mesh/primitives.h"
#include "render/body_place.h"
#include "render/link_items.h"

namespace cradle {
namespace {

constexpr int kFacets = 24;

}  // namespace

GlbJoints::GlbJoints(const Scene& scene, const std::vector<int>& nodes, double radius, GlbFile& file, GlbMeshes& meshes)
    : scene_(scene),
      nodes_(nodes),
      radius_(radius),
      file_(file),
      meshes_(meshes),
      least_(scene.sliders.size(), 0.0),
      most_(scene.sliders.size(), 0.0) {
  const bool hasBars = !scene.hinges.empty() || !scene.sliders.empty(),
             hasBalls = !scene.ballJoints.empty() || !scene.welds.empty();
  if (!hasBars && !hasBalls) return;
  darkCylinder_ = meshes_.add("joint", tessellate(Cylinder{1, 1}, kFacets), "joint", kDarkSteel);
  if (!scene.sliders.empty()) cylinder_ = meshes_.add("rail", tessellate(Cylinder{1, 1}, kFacets), "rail", kSteel);
  if (hasBalls) ball_ = meshes_.add("ball", tessellate(Sphere{1}, kFacets), "joint", kDarkSteel);
}

/// A node in the frame of a body, or the world.
int GlbJoints::addPart(const std::string& name, int body, const RigidTransform& bodyFromPart, const Vec3& scale) {
  RigidTransform parentFromPart = bodyFromPart;
  int parent = GlbFile::kNoParent;
  if (body != kWorld) {
    const Body& holder = scene_.bodies[static_cast<std::size_t>(body)];
    parent = nodes_[static_cast<std::size_t>(body)];
    if (parent == GlbFile::kNoParent)
      parentFromPart = holder.worldFromBody * bodyFromPart;
    else if (holder.motion != Motion::fixed)
      parentFromPart.translation -= holder.massProperties.centerOfMass;
  }
  const int node = file_.addNode(name, parentFromPart, parent);
  file_.setScale(node, scale);
  return node;
}

void GlbJoints::addBar(const std::string& name, int body, const Vec3& from, const Vec3& to, double radius,
                       bool isDark) {
  const double length = (to - from).norm();
  const Quat turn = length > 0 ? rotationBetween(Vec3::UnitY(), to - from) : Quat::Identity();
  const int node = addPart(name, body, {turn, (from + to) / 2}, Vec3(radius, length, radius));
  file_.setMesh(node, isDark ? darkCylinder_ : cylinder_);
}

void GlbJoints::addBall(const Anchor& anchor, const std::string& name, double radius) {
  file_.setMesh(addPart(name, anchor.body, {Quat::Identity(), anchor.point}, Vec3::Constant(radius)), ball_);
}

void GlbJoints::addArms(const Anchor& a, const Anchor& b, const std::string& name, double radius) {
  for (const Anchor* anchor : {&a, &b}) {
    if (anchor->body == kWorld) continue;
    const Body& body = scene_.bodies[static_cast<std::size_t>(anchor->body)];
    const Bounds local = localBounds(scene_, body);
    if (local.isEmpty() || local.exteriorDistance(anchor->point) <= radius) continue;
    addBar(name + " arm of " + body.name, anchor->body, body.massProperties.centerOfMass, anchor->point, radius);
  }
}

void GlbJoints::add() {
  for (const BallJoint& joint : scene_.ballJoints) {
    addBall(joint.anchorA, joint.name, kBallJointOfRod * radius_);
    addArms(joint.anchorA, joint.anchorB, joint.name, kPinOfRod * radius_);
  }
  for (const Hinge& hinge : scene_.hinges) {
    const Vec3 half = kPinLengthOfRod / 2 * radius_ * hinge.axis, &middle = hinge.anchorA.point;
    addBar(hinge.name, hinge.anchorA.body, middle - half, middle + half, kPinOfRod * radius_);
    addArms(hinge.anchorA, hinge.anchorB, hinge.name, kPinOfRod * radius_);
  }
  for (const Slider& slider : scene_.sliders) {
    const Vec3 half = kSleeveLengthOfRod / 2 * radius_ * slider.axis, &middle = slider.anchorA.point;
    addBar(slider.name, slider.anchorA.body, middle - half, middle + half, kSleeveOfRod * radius_);
    addArms(slider.anchorA, slider.anchorB, slider.name, kSleeveOfRod * radius_);
  }
  for (const Weld& weld : scene_.welds) {
    addBall(weld.anchorA, weld.name, kBeadOfRod * radius_);
    addArms(weld.anchorA, weld.anchorB, weld.name, kBeadOfRod * radius_);
  }
}

void GlbJoints::follow(const Frame& frame) {
  for (std::size_t i = 0; i < least_.size() && !frame.joints.empty(); ++i) {
    const double coordinate = frame.joints.at(scene_.hinges.size() + i).coordinate;
    least_[i] = std::min(least_[i], coordinate), most_[i] = std::max(most_[i], coordinate);
  }
}

void GlbJoints::addRails() {
  for (std::size_t i = 0; i < least_.size(); ++i) {
    const Slider& slider = scene_.sliders[i];
    const auto rotation = [this](const Anchor& anchor) -> Quat {
      if (anchor.body == kWorld) return Quat::Identity();
      return scene_.bodies[static_cast<std::size_t>(anchor.body)].worldFromBody.rotation;
    };
    const Vec3 axis = rotation(slider.anchorB).conjugate() * (rotation(slider.anchorA) * slider.axis);
    const auto [from, to] = railEnds(slider, least_[i], most_[i], radius_);
    addBar(slider.name + " rail", slider.anchorB.body, slider.anchorB.point + from * axis,
           slider.anchorB.point + to * axis, radius_, false);
  }
}

}  // namespace cradle
