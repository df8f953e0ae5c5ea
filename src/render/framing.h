#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "render/shown_push.h"
#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// What a film looks at, as far as it is known before its first picture: sizes that stay the same follow from it.
struct View {
  Camera camera;                       // at the start
  Bounds bounds;                       // m, world: around what is shown (ground apart)
  std::vector<ShownPush> pushes = {};  // drawn as arrows
  double longestArrow = 0;             // m, of the push with the greatest force
  std::vector<Camera> keys = {};       // where else the camera is going to be, as far as the scene says so
  double seen = 0;                     // m: height of the picture where `bounds` is; 0 if these are of the whole film

  /// What thin things and patterns are measured by; m.
  double size() const;

  /// m, from the tail to the point that is pushed; 0 for a push without a force.
  double arrowLength(const ShownPush& push) const;

  /// m, of the arc that shows a torque: round its body, and as large as an arrow's head needs.
  double arcRadius(const ShownPush& push) const;
};

/// Finds the view of a film. Where the scene names a camera, that and the first frame decide. Else all frames do: all
/// that moves stays in the picture, seen from slightly above and aside; fixed bodies too, unless they are much larger
/// than what moves.
class Framing {
 public:
  /// The scene must outlive this object. Sizes in pixels.
  Framing(const Scene& scene, int width, int height, std::vector<ShownPush> pushes = {});

  /// To be called for the first frame, and, unless the scene names a camera, for all others. O(bodies).
  void add(const Frame& frame);

  View view() const;

 private:
  /// How far things reach towards the sides of a picture seen with given axes.
  struct Reach {
    double right, left, top, bottom;
    void include(const Reach& other);
  };
  struct Candidate {
    Mat3 axes;                     // right, up, back
    std::array<Vec3, 4> outwards;  // right, left, top, bottom: not normalised
    Reach moving;
  };
  /// A convex thing in the world, for which farthest points are known.
  struct Solid {
    Bounds local;
    double radius = 0;  // > 0: a sphere around the local origin
    RigidTransform worldFromLocal;
    double support(const Vec3& direction) const;
  };

  static Reach emptyReach();
  static Reach reachOf(const Candidate& candidate, const Solid& solid);
  void includeMoving(const Solid& solid);
  void includeMotorArrows(const Frame& frame, const std::vector<RigidTransform>& places);
  std::vector<Solid> solidsOf(const std::vector<RigidTransform>& places, bool areMoving) const;
  bool movesAlongZ() const;
  bool seesGround(const Candidate& candidate) const;
  const Candidate& bestCandidate() const;
  void includeArrows(View& view, std::vector<Solid>& shown) const;
  Camera automaticCamera(const std::vector<Solid>& others) const;
  void lookFromScene(View& view) const;

  struct ArrowPlace {
    std::size_t push;  // index into pushes_
    Vec3 point;        // m, world: what is pushed
  };

  const Scene& scene_;
  const std::vector<ShownPush> pushes_;
  std::vector<ArrowPlace> arrowPlaces_;  // in all frames
  double tanHalfX_, tanHalfY_;
  std::vector<Bounds> localBounds_;  // of every body
  std::vector<Candidate> candidates_;
  std::optional<Camera> start_;  // that the scene names, in the first frame
  Bounds movingBounds_, motorArrowBounds_;
  long places_ = 0;  // of bodies that move, over all frames
  Vec3 placeSum_ = Vec3::Zero(), placeSquareSum_ = Vec3::Zero();
};

}  // namespace cradle
