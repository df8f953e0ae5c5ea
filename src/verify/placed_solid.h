#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Where each body's frame is in a frame of a trajectory, in the order of the scene.
std::vector<RigidTransform> posesOf(const Scene& scene, const Frame& frame);

/// The depths between which a ray first meets a solid, for all that rounding may do to them.
struct DepthRange {
  double least = 0, most = 0;  // m, along the view
  bool isSure = false;         // else rounding decides whether the ray misses

  double middle() const { return least + (most - least) / 2; }
};

/// A ray of a picture in the world.
struct PictureRay {
  Vec3 origin;     // m: of the camera
  Vec3 direction;  // that has a depth of 1
};

/// A body whose surface has a closed form, at one instant: a convex solid, which a ray is in for one piece of its
/// length. Boxes are slabs (T. L. Kay, J. T. Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986), and what is round
/// has quadratics about the point of the ray nearest to its middle. (Pictures' rays have roots about the camera, and
/// the triangles of boxes.)
class PlacedSolid {
 public:
  using Form = std::variant<Sphere, Box, Cylinder, Capsule, Plane>;

  /// Of one body, seen from a point (m, world).
  PlacedSolid(int body, const Form& form, const RigidTransform& worldFromBody, const Vec3& viewpoint);

  int body() const { return body_; }

  /// Nothing if the ray misses, though the solid were larger by rounding. A camera inside sees the far side, but of a
  /// plane nothing. O(1).
  std::optional<DepthRange> meet(const PictureRay& ray) const;

  /// How far a unit vector is from the surface's normal where a ray meets it, on the side of the camera, and how far it
  /// may be for what is not known of the place.
  struct NormalDeviation {
    double deviation = 0, tolerance = 0;
    Vec3 expected = Vec3::Zero();
  };
  NormalDeviation compareNormal(const PictureRay& ray, const DepthRange& depths, const Vec3& normal) const;

 private:
  PictureRay inBody(const PictureRay& ray) const;

  int body_;
  Form form_;
  RigidTransform worldFromBody_;
  Mat3 bodyFromWorld_;  // turns directions
  double reach_;        // m, of the sphere around it; infinite for a plane
  double rounding_;     // m, by which its surface may be off for the numbers of its place and the camera's
};

/// The bodies of a scene with closed forms: all but meshes, and planes that are not the ground, which are drawn as
/// squares. From behind, the ground is not there.
std::vector<PlacedSolid> solidsOf(const Scene& scene, const std::vector<RigidTransform>& worldFromBody,
                                  const Vec3& viewpoint);

/// Whether these solids are all that a scene shows.
bool hasSolidsAlone(const Scene& scene);

}  // namespace cradle
