#include "render/camera.h"

#include <cmath>

namespace cradle {
namespace {

// A point infinitely far has depth 1, and rounding must not put it behind the far plane.
constexpr double kFarMargin = 1e-6;

Eigen::Vector2d halfExtents(const Camera& camera, int width, int height) {
  const double vertical = std::tan(camera.verticalFieldOfView / 2);
  return {vertical * width / height, vertical};
}

}  // namespace

Eigen::Matrix4f clipFromWorld(const Camera& camera, const Vec3& origin, int width, int height, double nearPlane) {
  const Mat3 axes = cameraAxes(camera);
  Eigen::Matrix4d viewFromWorld = Eigen::Matrix4d::Identity();
  viewFromWorld.topLeftCorner<3, 3>() = axes.transpose();
  viewFromWorld.topRightCorner<3, 1>() = axes.transpose() * (origin - camera.position);

  const Eigen::Vector2d half = halfExtents(camera, width, height);
  Eigen::Matrix4d clipFromView = Eigen::Matrix4d::Zero();
  clipFromView(0, 0) = 1 / half.x();
  clipFromView(1, 1) = 1 / half.y();
  clipFromView(2, 2) = kFarMargin - 1;
  clipFromView(2, 3) = (kFarMargin - 2) * nearPlane;
  clipFromView(3, 2) = -1;
  return (clipFromView * viewFromWorld).cast<float>();
}

Eigen::Vector2d projectToPixel(const Camera& camera, const Vec3& point, int width, int height) {
  const Vec3 view = cameraAxes(camera).transpose() * (point - camera.position);
  const Eigen::Vector2d half = halfExtents(camera, width, height);
  const double x = view.x() / (-view.z() * half.x()), y = view.y() / (-view.z() * half.y());
  return {width * (1 + x) / 2, height * (1 - y) / 2};
}

}  // namespace cradle
