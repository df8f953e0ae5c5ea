#pragma once

#include <optional>

#include "math/types.h"
#include "scene/scene.h"

namespace cradle {

/// A camera as a pinhole, for pictures of `width` x `height` pixels. Pixel coordinates go right and down from the
/// picture's upper left corner, so that the first pixel's centre is at (0.5, 0.5). Coordinates of the camera are
/// OpenCV's: x to the right, y down, z along the view (m).
class Pinhole {
 public:
  Pinhole(const Camera& camera, int width, int height);

  const Vec3& position() const { return position_; }         // m, world
  const Mat3& worldFromCamera() const { return rotation_; }  // columns right, down, along the view
  int width() const { return width_; }
  int height() const { return height_; }

  /// [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], in pixels: pixels are square, and the principal point is the picture's
  /// middle.
  Mat3 intrinsics() const;

  /// What a pixel's ray goes through at a depth of 1: camera's coordinates.
  Vec3 rayAt(double x, double y) const { return {(x - middleX_) / focal_, (y - middleY_) / focal_, 1}; }

  Vec3 inCamera(const Vec3& worldPoint) const { return rotation_.transpose() * (worldPoint - position_); }
  Vec3 inWorld(const Vec3& cameraPoint) const { return rotation_ * cameraPoint + position_; }

  /// Pixel coordinates of a point, or a direction, in camera's coordinates; nothing unless it is in front.
  std::optional<Eigen::Vector2d> project(const Vec3& cameraPoint) const;

 private:
  Vec3 position_;
  Mat3 rotation_;
  double focal_, middleX_, middleY_;  // pixels
  int width_, height_;
};

}  // namespace cradle
