#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "mesh/primitives.h"
#include "render/draw_list.h"

namespace cradle {

/// Triangles, seen from both sides.
struct WorldTriangles {
  std::vector<Vec3> vertices;                        // m, world
  const std::vector<Triangle>* triangles = nullptr;  // kept by what made them
};

/// What a ray can meet of a body or a link, at one instant. What is round is met as what it is, not as it is drawn.
struct SeenSurface {
  int body = kWorld;                   // index into Scene::bodies; kWorld: a link
  std::optional<LinkKind> link = {};   // of a link
  RigidTransform worldFromShape = {};  // of all but triangles
  std::variant<Sphere, Cylinder, Capsule, Plane, WorldTriangles> shape;
};

/// Makes the surfaces of a scene's frames: bodies in the order of the scene, and links behind them, in the same order
/// in each frame. What only explains, as arrows, is left out. A plane other than the ground is the square as which it
/// is drawn.
class SurfaceSource {
 public:
  /// The scene must outlive this object, and this object its surfaces.
  SurfaceSource(const Scene& scene, const View& view);

  /// Seen from a point (m, world): from behind, planes are not there. O(vertices).
  std::vector<SeenSurface> at(const Frame& frame, const Vec3& viewpoint) const;

 private:
  void appendBody(std::size_t body, const RigidTransform& worldFromBody, const Vec3& viewpoint,
                  std::vector<SeenSurface>& surfaces) const;
  void appendLinks(const std::vector<RigidTransform>& places, std::vector<SeenSurface>& surfaces) const;
  SeenSurface tubeOf(const TubeItem& tube) const;

  const Scene& scene_;
  const View view_;
  const Appearance appearance_;
  std::vector<std::vector<Triangle>> coilTriangles_;  // by the number of turns
  std::vector<Triangle> ropeTriangles_;
};

}  // namespace cradle
