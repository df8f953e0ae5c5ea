#include "verify/check_cameras.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

namespace cradle {
namespace {

const std::string kCameraFile = "camera.json";
// Numbers of a file have all their digits. A dozen operations of 1.1e-16 each are between those of two programs, and
// the length of the view divides those of positions.
constexpr double kCameraRounding = 1e-13;

template <class Matrix>
std::string textOf(const Matrix& matrix) {
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      text += fmt::format("{}{:.9g}", text.empty() ? "" : " ", matrix(row, column));
  return "[" + text + "]";
}

/// Adds what one frame's camera is found to be, and what it should be.
class CameraComparison {
 public:
  CameraComparison(long frame, Findings& findings) : frame_(frame), findings_(findings) {}

  template <class Numbers>
  void add(const char* what, const Numbers& found, const Numbers& expected, double tolerance) const {
    findings_.add(Aspect::camera, (found - expected).norm(), tolerance, [&] {
      return Fault{{kCameraFile}, fmt::format("{} {} of frame {}", what, textOf(found), frame_), textOf(expected)};
    });
  }

  void addNumber(const char* what, double found, double expected, double tolerance) const {
    using One = Eigen::Matrix<double, 1, 1>;
    add(what, One(found), One(expected), tolerance);
  }

 private:
  long frame_;
  Findings& findings_;
};

/// The camera that a scene names, as it is at a time (s); nothing if it moves in other ways than around its target.
std::optional<Camera> namedCamera(const Scene& scene, double time) {
  const CameraMotion& motion = scene.cameraMotion;
  if (!scene.camera || !motion.keys.empty() || motion.follow || motion.targetBody != kWorld) return std::nullopt;
  Camera camera = *scene.camera;
  if (!motion.orbitPeriod) return camera;
  const Eigen::AngleAxisd turn(2 * std::numbers::pi * time / *motion.orbitPeriod, camera.up.normalized());
  camera.position = camera.target + turn * (camera.position - camera.target);
  return camera;
}

void checkForm(const CameraRecord& record, const CameraDocument& document, const CameraComparison& comparison) {
  const Mat3 rotation = record.worldFromCameraOpenCv.topLeftCorner<3, 3>();
  const Vec3 middle(static_cast<double>(document.width) / 2, static_cast<double>(document.height) / 2, 1);
  const double focal = record.intrinsics(0, 0);
  Mat3 intrinsics = Vec3(focal, focal, 1).asDiagonal();
  intrinsics.col(2) = middle;
  comparison.add("K", record.intrinsics, intrinsics, 0);
  comparison.add("rotation times its transpose", Mat3(rotation * rotation.transpose()), Mat3(Mat3::Identity()),
                 kCameraRounding);
  comparison.addNumber("determinant of the rotation", rotation.determinant(), 1.0, kCameraRounding);
  const Eigen::Matrix4d openCv = record.worldFromCamera * Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
  comparison.add("worldFromCameraOpenCV", record.worldFromCameraOpenCv, openCv, 0);
  comparison.add("last row of worldFromCamera", Eigen::RowVector4d(record.worldFromCamera.row(3)),
                 Eigen::RowVector4d(0, 0, 0, 1), 0);
}

void checkNamed(const CameraRecord& record, const CameraDocument& document, const Camera& camera,
                const CameraComparison& comparison) {
  const Vec3 view = camera.target - camera.position, forward = view.normalized();
  const Vec3 right = forward.cross(camera.up).normalized();
  Mat3 rotation;
  rotation << right, forward.cross(right), forward;
  const double size = camera.position.norm() + camera.target.norm();
  const double focal = static_cast<double>(document.height) / 2 / std::tan(camera.verticalFieldOfView / 2);
  comparison.add("position", Vec3(record.worldFromCameraOpenCv.topRightCorner<3, 1>()), camera.position,
                 kCameraRounding * size);
  comparison.add("rotation", Mat3(record.worldFromCameraOpenCv.topLeftCorner<3, 3>()), rotation,
                 kCameraRounding * (1 + size / view.norm()) / forward.cross(camera.up).norm());
  comparison.addNumber("focal length", record.intrinsics(0, 0), focal, kCameraRounding * focal);
}

/// Against the camera that the trajectory has for a picture of this size.
void checkKept(const CameraRecord& record, const CameraDocument& document, const CameraPose& kept,
               const CameraComparison& comparison) {
  const double focal = static_cast<double>(document.height) / 2 / std::tan(kept.verticalFieldOfView / 2);
  comparison.add("position", Vec3(record.worldFromCamera.topRightCorner<3, 1>()), kept.position,
                 kCameraRounding * (1 + kept.position.norm()));
  comparison.add("rotation", Mat3(record.worldFromCamera.topLeftCorner<3, 3>()),
                 Mat3(kept.orientation.toRotationMatrix()), kCameraRounding);
  comparison.addNumber("focal length", record.intrinsics(0, 0), focal, kCameraRounding * focal);
}

}  // namespace

void checkCameras(const VerifiedFilm& film, Findings& findings) {
  const CameraComparison whole(0, findings);
  whole.addNumber("number of cameras, the first", static_cast<double>(film.cameras.frames.size()),
                  static_cast<double>(film.trajectory.frameCount()), 0);
  std::map<long, CameraPose> kept;  // a chosen camera depends on the picture's size
  const Output& output = film.scene.output;
  if (film.scene.camera || (film.cameras.width == output.width && film.cameras.height == output.height))
    for (const CameraPose& camera : film.trajectory.cameras()) kept[camera.frame] = camera;
  for (std::size_t i = 0; i < film.cameras.frames.size(); ++i) {
    const CameraRecord& record = film.cameras.frames[i];
    const long frame = static_cast<long>(i);
    const CameraComparison comparison(frame, findings);
    comparison.addNumber("frame", static_cast<double>(record.frame), static_cast<double>(frame), 0);
    if (film.hasFrame(frame)) comparison.addNumber("time", record.time, film.trajectory.frameTimes()[i], 0);
    checkForm(record, film.cameras, comparison);
    if (const auto camera = namedCamera(film.scene, record.time)) checkNamed(record, film.cameras, *camera, comparison);
    if (kept.contains(frame)) checkKept(record, film.cameras, kept[frame], comparison);
  }
}

}  // namespace cradle
