#pragma once

#include <functional>
#include <optional>

#include "collision/collider.h"

namespace cradle {

/// A face of a polytope above which another body stays, with all of its points inside the face's outline: what touches
/// are then its corners, or the spheres around its points, on the face as on a plane.
struct FaceBelow {
  bool isOfA = false;                                // of a pair: else B's
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();  // unit, m; in its body's frame
};

/// The face of `lower` below all of `upper`. `motionAlong` tells how far (m) the upper body can go along a face with a
/// normal (world), as seen from the lower one.
std::optional<FaceBelow> faceBelow(const Collider& upper, const RigidTransform& worldFromUpper, const Collider& lower,
                                   const RigidTransform& worldFromLower,
                                   const std::function<double(const Vec3& normal)>& motionAlong);

/// Height (m) of a point of the upper body over the face.
double heightOver(const FaceBelow& face, const RigidTransform& worldFromLower, const Vec3& corner);

}  // namespace cradle
