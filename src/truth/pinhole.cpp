#include "truth/pinhole.h"

#include <cmath>

#include "render/camera.h"

namespace cradle {

Pinhole::Pinhole(const Camera& camera, int width, int height)
    : position_(camera.position),
      rotation_(cameraAxes(camera)),
      focal_(height / (2 * std::tan(camera.verticalFieldOfView / 2))),
      middleX_(width / 2.0),
      middleY_(height / 2.0),
      width_(width),
      height_(height) {
  rotation_.rightCols<2>() *= -1;  // from up and back
}

Mat3 Pinhole::intrinsics() const {
  Mat3 matrix = Mat3::Identity();
  matrix(0, 0) = matrix(1, 1) = focal_;
  matrix(0, 2) = middleX_;
  matrix(1, 2) = middleY_;
  return matrix;
}

std::optional<Eigen::Vector2d> Pinhole::project(const Vec3& cameraPoint) const {
  if (!(cameraPoint.z() > 0)) return std::nullopt;
  return Eigen::Vector2d(middleX_ + focal_ * cameraPoint.x() / cameraPoint.z(),
                         middleY_ + focal_ * cameraPoint.y() / cameraPoint.z());
}

}  // namespace cradle
