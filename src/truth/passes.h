#pragma once

#include <cstdint>
#include <vector>

#include "truth/picture_rays.h"

namespace cradle {

/// What can be said of each pixel beside its colour.
enum class Pass { rgb, depth, normal, segmentation, flow, backwardFlow, objectCoordinates };

/// The name of a pass on the command line and of its files.
const char* nameOf(Pass pass);

/// Passes named with commas, or "all". Throws Error(usage).
std::vector<Pass> parsePasses(const std::string& text);

/// Segmentation of links: this and the number of their LinkKind. Bodies have their index + 1, and the sky 0.
constexpr int kFirstLinkId = 60000;

/// One frame of a film as rays see it.
class FrameRays {
 public:
  /// Of a frame with its bodies' places. O(vertices).
  FrameRays(const SurfaceSource& source, const Frame& frame, std::vector<RigidTransform> worldFromBody,
            const Pinhole& pinhole);
  FrameRays(const FrameRays&) = delete;
  FrameRays& operator=(const FrameRays&) = delete;

  const Pinhole& pinhole() const { return pinhole_; }
  const std::vector<RigidTransform>& worldFromBody() const { return worldFromBody_; }
  const std::vector<SeenSurface>& surfaces() const { return surfaces_; }
  PictureRays& rays() { return rays_; }
  const PictureRays& rays() const { return rays_; }

  /// What pixels show, row by row from above, and what each body covers. Found once.
  const std::vector<SeenPoint>& seen();
  const std::vector<WholeExtent>& wholes();

 private:
  void findSeen();

  const Pinhole pinhole_;
  const std::vector<RigidTransform> worldFromBody_;
  const std::vector<SeenSurface> surfaces_;
  PictureRays rays_;
  std::vector<SeenPoint> seen_;
  std::vector<WholeExtent> wholes_;
};

// Passes of a frame: arrays, row by row from above.

/// m, along the view; infinite for the sky.
std::vector<float> depthPass(FrameRays& frame);

/// Three a pixel: unit, of the surface, towards the camera, turned from the world by `outFromWorld`; NaN for the sky.
std::vector<float> normalPass(FrameRays& frame, const Quat& outFromWorld);

/// kFirstLinkId says of what. Needs fewer bodies than that.
std::vector<std::uint16_t> segmentationPass(FrameRays& frame);

/// Three a pixel: m, in the frame of the body that is seen; NaN for links and the sky.
std::vector<float> objectCoordinatesPass(FrameRays& frame);

/// Where what is seen at the centres of a frame's pixels is in another one.
struct Flow {
  std::vector<float>
      shift;  // two a pixel: from that centre, right and down; NaN where it is not in front of the camera
  std::vector<std::uint8_t> isHidden;  // 1 where it is not seen: something is before it, or it is beside the picture
};

/// The sky moves by the camera's turning alone. `isHidden` is found only if asked for.
Flow flowPass(FrameRays& frame, FrameRays& other, bool findsHidden);

}  // namespace cradle
