#include "commands/glb_joints.h"

#include "mesh/primitives.h"
#include "render/link_items.h"

namespace cradle {
namespace {

constexpr int kFacets = 24;

}  // namespace

GlbJoints::GlbJoints(const Scene& scene, const std::vector<int>& nodes, double radius, GlbFile& file, GlbMeshes& meshes)
    : scene_(scene), nodes_(nodes), radius_(radius), file_(file) {
  const bool hasBars = !scene.hinges.empty() || !scene.sliders.empty(),
             hasBalls = !scene.ballJoints.empty() || !scene.welds.empty();
  if (!hasBars && !hasBalls) return;
  bar_ = meshes.add("joint", tessellate(Cylinder{1, 1}, kFacets), "joint", kDarkSteel);
  if (!scene.sliders.empty()) rail_ = meshes.add("rail", tessellate(Cylinder{1, 1}, kFacets), "rail", kSteel);
  if (hasBalls) ball_ = meshes.add("ball", tessellate(Sphere{1}, kFacets), "joint", kDarkSteel);
}

/// A node in the frame of a body, or the world.
void GlbJoints::add(const JointPart& part) {
  RigidTransform parentFromPart = part.bodyFromPart;
  int parent = GlbFile::kNoParent;
  if (part.body != kWorld) {
    const Body& holder = scene_.bodies[static_cast<std::size_t>(part.body)];
    parent = nodes_[static_cast<std::size_t>(part.body)];
    if (parent == GlbFile::kNoParent)
      parentFromPart = holder.worldFromBody * part.bodyFromPart;
    else if (holder.motion != Motion::fixed)
      parentFromPart.translation -= holder.massProperties.centerOfMass;
  }
  const int node = file_.addNode(part.name, parentFromPart, parent);
  file_.setScale(node, part.scale);
  file_.setMesh(node, part.kind == JointPartKind::ball ? ball_ : part.kind == JointPartKind::rail ? rail_ : bar_);
}

void GlbJoints::add() {
  for (const JointPart& part : jointParts(scene_, radius_)) add(part);
}

void GlbJoints::addRails() {
  for (const JointPart& part : railParts(scene_, reach_, radius_)) add(part);
}

}  // namespace cradle
