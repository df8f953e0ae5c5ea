#pragma once

#include <optional>

#include "collision/collider.h"

namespace cradle {

/// A face of one polytope above which another one stays, with all of its points inside the face's outline: what touches
/// are then corners on the face, as on a plane.
struct FaceBelow {
  bool isOfA = false;                                // of a pair: else B's
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();  // unit, m; in its body's frame
};

/// The face of `lower` below all of `upper`, as long as no point of it moves by more than `motion` (m) as seen from the
/// lower one.
std::optional<FaceBelow> faceBelow(const Collider& upper, const RigidTransform& worldFromUpper, const Collider& lower,
                                   const RigidTransform& worldFromLower, double motion);

/// Height (m) of a corner of the upper body over the face.
double heightOver(const FaceBelow& face, const RigidTransform& worldFromLower, const Vec3& corner);

}  // namespace cradle
