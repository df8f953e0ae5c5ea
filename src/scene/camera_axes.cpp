#include "scene/camera_axes.h"

namespace cradle {

Mat3 cameraAxes(const Vec3& position, const Vec3& target, const Vec3& up) {
  const Vec3 towards = target - position;
  const Vec3 back = towards.norm() > 0 ? Vec3(-towards.normalized()) : Vec3(Vec3::UnitZ());
  Vec3 right = up.cross(back);
  if (right.norm() < 1e-9) right = Vec3::UnitX();
  right.normalize();
  Mat3 axes;
  axes << right, back.cross(right), back;
  return axes;
}

Mat3 cameraAxes(const Camera& camera) {
  return cameraAxes(camera.position, camera.target, camera.up);
}

}  // namespace cradle
