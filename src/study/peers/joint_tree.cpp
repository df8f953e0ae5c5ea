#include "study/peers/joint_tree.h"

namespace cradle {
namespace {

/// A joint of either kind.
struct Joint {
  Attachment a, b;
  TreeLink::Kind kind;
  Vec3 axisA;
  std::size_t index;  // among those of its kind
  bool isUsed = false;
};

std::vector<Joint> jointsOf(const Constraints& constraints) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < constraints.ballJoints.size(); ++i)
    joints.push_back(
        {constraints.ballJoints[i].anchorA, constraints.ballJoints[i].anchorB, TreeLink::Kind::ball, Vec3::UnitZ(), i});
  for (std::size_t i = 0; i < constraints.hinges.size(); ++i)
    joints.push_back({constraints.hinges[i].anchorA, constraints.hinges[i].anchorB, TreeLink::Kind::hinge,
                      constraints.hinges[i].axisA, i});
  return joints;
}

Quat turnOf(int body, const VectorX& state) {
  return body == kFixed ? Quat::Identity() : orientation(state, body);
}

/// Hangs bodies on what is in the tree, breadth first.
class TreeGrowth {
 public:
  TreeGrowth(const Assembly& assembly, JointTree& tree)
      : state_(assembly.state),
        constraints_(assembly.mechanism.constraints),
        joints_(jointsOf(constraints_)),
        isPlaced_(assembly.mechanism.bodies.size(), false),
        tree_(tree) {}

  void grow() {
    hangOn(kFixed);
    spreadFrom(0);
    for (std::size_t body = 0; body < isPlaced_.size(); ++body) {
      if (isPlaced_[body]) continue;
      isPlaced_[body] = true;
      tree_.links.push_back({TreeLink::Kind::free, static_cast<int>(body)});
      spreadFrom(tree_.links.size() - 1);
    }
  }

 private:
  void spreadFrom(std::size_t first) {
    for (std::size_t i = first; i < tree_.links.size(); ++i) hangOn(tree_.links[i].body);
  }

  void hangOn(int parent) {
    for (Joint& joint : joints_) {
      const bool fromA = joint.a.body == parent;
      if (joint.isUsed || (!fromA && joint.b.body != parent)) continue;
      joint.isUsed = true;
      hang(joint, fromA ? joint.b : joint.a, fromA ? joint.a : joint.b);
    }
  }

  void hang(const Joint& joint, const Attachment& child, const Attachment& parent) {
    if (child.body == kFixed || isPlaced_[static_cast<std::size_t>(child.body)]) {
      if (joint.kind == TreeLink::Kind::ball) tree_.loopBallJoints.push_back(constraints_.ballJoints[joint.index]);
      if (joint.kind == TreeLink::Kind::hinge) tree_.loopHinges.push_back(constraints_.hinges[joint.index]);
      return;
    }
    isPlaced_[static_cast<std::size_t>(child.body)] = true;
    const Vec3 axis = turnOf(child.body, state_).conjugate() * (turnOf(joint.a.body, state_) * joint.axisA);
    tree_.links.push_back({joint.kind, child.body, parent.body, child.point, parent.point, axis});
  }

  const VectorX& state_;
  const Constraints& constraints_;
  std::vector<Joint> joints_;
  std::vector<bool> isPlaced_;
  JointTree& tree_;
};

}  // namespace

JointTree jointTreeOf(const Assembly& assembly) {
  JointTree tree;
  TreeGrowth(assembly, tree).grow();
  return tree;
}

LinkStart startOf(const TreeLink& link, const Assembly& assembly) {
  const Quat body = turnOf(link.body, assembly.state), parent = turnOf(link.parent, assembly.state);
  Vec3 spin = angularVelocity(assembly.state, link.body);
  if (link.parent != kFixed) spin -= angularVelocity(assembly.state, link.parent);
  return {parent.conjugate() * body, body.conjugate() * spin};
}

}  // namespace cradle
