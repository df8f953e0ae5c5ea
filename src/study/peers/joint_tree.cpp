#include "study/peers/joint_tree.h"

#include <algorithm>

#include "study/peers/peer_drives.h"

namespace cradle {
namespace {

struct Joint {
  const Constraint* constraint;
  TreeLink::Kind kind;
  Vec3 axisA;
  bool isUsed = false;
};

std::vector<Joint> jointsOf(const Constraints& constraints) {
  std::vector<Joint> joints;
  for (const Constraint& constraint : constraints)
    if (const auto* hinge = std::get_if<HingeConstraint>(&constraint.kind))
      joints.push_back({&constraint, TreeLink::Kind::hinge, hinge->axisA});
    else if (const auto* slider = std::get_if<SliderConstraint>(&constraint.kind))
      joints.push_back({&constraint, TreeLink::Kind::slider, slider->aFromB * slider->axisB()});
    else if (std::holds_alternative<WeldConstraint>(constraint.kind))
      joints.push_back({&constraint, TreeLink::Kind::weld, Vec3::UnitZ()});
    else if (std::holds_alternative<BallJointConstraint>(constraint.kind))
      joints.push_back({&constraint, TreeLink::Kind::ball, Vec3::UnitZ()});
  return joints;
}

Quat turnOf(int body, const VectorX& state) {
  return body == kFixed ? Quat::Identity() : orientation(state, body);
}

/// Hangs bodies on what is in the tree, breadth first.
class TreeGrowth {
 public:
  TreeGrowth(const Assembly& assembly, JointTree& tree)
      : mechanism_(assembly.mechanism),
        state_(assembly.state),
        joints_(jointsOf(assembly.mechanism.constraints)),
        isPlaced_(assembly.mechanism.bodies.size(), false),
        tree_(tree) {}

  void grow() {
    for (const DrivenBody& driven : mechanism_.driven) addFree(driven.body);
    hangOn(kFixed);
    spreadFrom(0);
    for (std::size_t body = 0; body < isPlaced_.size(); ++body) {
      if (isPlaced_[body]) continue;
      addFree(static_cast<int>(body));
      spreadFrom(tree_.links.size() - 1);
    }
  }

 private:
  void addFree(int body) {
    isPlaced_[static_cast<std::size_t>(body)] = true;
    tree_.links.push_back({TreeLink::Kind::free, body});
  }

  void spreadFrom(std::size_t first) {
    for (std::size_t i = first; i < tree_.links.size(); ++i) hangOn(tree_.links[i].body);
  }

  void hangOn(int parent) {
    for (Joint& joint : joints_) {
      const auto& [a, b, kind] = *joint.constraint;
      const bool fromA = a.body == parent;
      if (joint.isUsed || (!fromA && b.body != parent)) continue;
      joint.isUsed = true;
      hang(joint, fromA ? b : a, fromA ? a : b);
    }
  }

  void hang(const Joint& joint, const Attachment& child, const Attachment& parent) {
    if (child.body == kFixed || isPlaced_[static_cast<std::size_t>(child.body)]) {
      tree_.loops.push_back(*joint.constraint);
      return;
    }
    isPlaced_[static_cast<std::size_t>(child.body)] = true;
    const Vec3 axis =
        turnOf(child.body, state_).conjugate() * (turnOf(joint.constraint->anchorA.body, state_) * joint.axisA);
    double motorForce = 0;
    if (const JointMotor* motor = motorOf(*joint.constraint, mechanism_.motors))
      motorForce = (&child == &joint.constraint->anchorA ? 1 : -1) * motor->sign * motor->maxForce;
    tree_.links.push_back({joint.kind, child.body, parent.body, child.point, parent.point, axis, motorForce});
  }

  const Mechanism& mechanism_;
  const VectorX& state_;
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

std::string missingMotors(const JointTree& tree, const Assembly& assembly) {
  const std::vector<JointMotor>& motors = assembly.mechanism.motors;
  if (std::any_of(motors.begin(), motors.end(), [](const JointMotor& motor) { return motor.hasTarget; }))
    return "motors with a target velocity";
  for (const Constraint& loop : tree.loops)
    if (motorOf(loop, motors)) return "motors of joints that close a loop";
  return "";
}

LinkStart startOf(const TreeLink& link, const Assembly& assembly) {
  const Quat body = turnOf(link.body, assembly.state), parent = turnOf(link.parent, assembly.state);
  Vec3 spin = angularVelocity(assembly.state, link.body);
  const AttachmentMotion at = motionOf(Attachment{link.body, link.anchor}, assembly.state);
  Vec3 velocity = at.velocity;
  if (link.parent != kFixed) {
    const Vec3 spinOfParent = angularVelocity(assembly.state, link.parent);
    spin -= spinOfParent;
    velocity -= linearVelocity(assembly.state, link.parent) +
                spinOfParent.cross(at.position - centerOfMass(assembly.state, link.parent));
  }
  return {parent.conjugate() * body, body.conjugate() * spin, body.conjugate() * velocity};
}

}  // namespace cradle
