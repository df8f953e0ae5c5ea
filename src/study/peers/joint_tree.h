#pragma once

#include <string>
#include <vector>

#include "simulate/assembly.h"

namespace cradle {

/// How a moving body goes with the one before it in a tree of joints.
struct TreeLink {
  enum class Kind { free, ball, hinge, slider, weld };
  Kind kind = Kind::free;
  int body = 0, parent = kFixed;                            // moving bodies, or the world
  Vec3 anchor = Vec3::Zero(), parentAnchor = Vec3::Zero();  // m, of the joint: as attachments have their points
  Vec3 axis = Vec3::UnitZ();                                // of a hinge or slider: unit, in the frame of `body`
  double motorForce = 0;                                    // N or N m, of its motor, on `body` along or about the axis
};

/// The joints of a mechanism for engines in reduced coordinates. Bodies that no joint ties to the world or to a body
/// before them are free, and so are driven ones, which come first.
struct JointTree {
  std::vector<TreeLink> links;  // one a moving body, each after its parent
  Constraints loops;            // joints that close a loop
};
JointTree jointTreeOf(const Assembly& assembly);

/// The first kind of motors, in words, that is no constant force on a coordinate of the tree; empty if there is none.
std::string missingMotors(const JointTree& tree, const Assembly& assembly);

/// What relates a link to its parent at the start.
struct LinkStart {
  Quat parentFromBody;
  Vec3 relativeSpin;      // rad/s, of the body against its parent, in the body's frame
  Vec3 relativeVelocity;  // m/s, of the link's anchor against the parent there, in the body's frame
};
LinkStart startOf(const TreeLink& link, const Assembly& assembly);

}  // namespace cradle
