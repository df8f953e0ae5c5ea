#pragma once

#include <array>
#include <limits>
#include <vector>

#include "render/shown_push.h"
#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// What a whole film looks at: one camera, or one for each frame; and a box around all that it shows (ground apart).
struct View {
  Camera camera;                       // at the start
  Bounds bounds;                       // m, world
  std::vector<ShownPush> pushes = {};  // drawn as arrows
  double longestArrow = 0;             // m, of the push with the greatest force
  std::vector<Camera> cameras = {};    // of all frames; none if the camera stands still

  const Camera& cameraAt(long frame) const {
    return cameras.empty() ? camera : cameras.at(static_cast<std::size_t>(frame));
  }

  /// m, from the tail to the point that is pushed; 0 for a push without a force.
  double arrowLength(const ShownPush& push) const;
};

/// Finds the view of a film from its frames, one by one. Unless the scene names a camera, all that moves stays in the
/// picture, seen from slightly above and aside; fixed bodies too, unless they are much larger than what moves.
class Framing {
 public:
  /// The scene must outlive this object. Sizes in pixels.
  Framing(const Scene& scene, int width, int height, std::vector<ShownPush> pushes = {});

  /// O(bodies).
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
    double radius = 0;  // > 0: a ball around the local origin
    RigidTransform worldFromLocal;
    double support(const Vec3& direction) const;
  };

  static Reach emptyReach();
  static Reach reachOf(const Candidate& candidate, const Solid& solid);
  void includeMoving(const Solid& solid);
  std::vector<Solid> solidsOf(const std::vector<RigidTransform>& places, Motion motion) const;
  bool movesAlongZ() const;
  bool seesGround(const Candidate& candidate) const;
  const Candidate& bestCandidate() const;
  void includeArrows(View& view, std::vector<Solid>& shown) const;
  Camera automaticCamera(const std::vector<Solid>& others) const;

  struct ArrowPlace {
    std::size_t push;  // index into pushes_
    Vec3 tip;          // m, world
  };

  const Scene& scene_;
  const std::vector<ShownPush> pushes_;
  std::vector<ArrowPlace> arrowPlaces_;  // in all frames
  double tanHalfX_, tanHalfY_;
  std::vector<Bounds> localBounds_;  // of every body
  std::vector<Candidate> candidates_;
  Bounds movingBounds_;
  long places_ = 0;  // of bodies that move, over all frames
  Vec3 placeSum_ = Vec3::Zero(), placeSquareSum_ = Vec3::Zero();
};

}  // namespace cradle
