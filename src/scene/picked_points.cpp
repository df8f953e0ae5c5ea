#include "scene/picked_points.h"

#include <fmt/format.h>

#include <limits>

#include "math/elementary.h"
#include "scene/camera_axes.h"
#include "scene/ray_on_body.h"

namespace cradle {
namespace {

constexpr int kMaxFrame = 2147483647;
constexpr Range kPixels{0, 16384};  // as many as pictures have

/// The camera of the first frame, which is that of all frames if it stands still.
Camera cameraAtStart(const Scene& scene) {
  Camera camera = *scene.camera;
  const CameraMotion& motion = scene.cameraMotion;
  if (!motion.keys.empty()) {
    const CameraMotion::Key& key = motion.keys.front();
    camera.position = key.position, camera.target = key.target, camera.verticalFieldOfView = key.verticalFieldOfView;
  }
  if (motion.targetBody != kWorld) {
    const Body& body = scene.bodies[static_cast<std::size_t>(motion.targetBody)];
    const bool isDynamic = body.motion == Motion::dynamic;
    camera.target = body.worldFromBody * (isDynamic ? body.massProperties.centerOfMass : Vec3(Vec3::Zero()));
  }
  return camera;
}

/// Why the camera of a frame is not known when the scene is read; empty if it is.
std::string whyUnknown(const Scene& scene, int frame) {
  if (!scene.camera)
    return "the scene names no camera, and the one that is chosen follows from the whole motion; give it one";
  const CameraMotion& motion = scene.cameraMotion;
  if (!motion.isNone() && frame != 0) return "the camera moves; give frame 0, the start of the scene";
  if (!motion.keys.empty() && motion.keys.front().time < 0)
    return "the camera's first key frame is before the start of the scene; begin its key frames at 0 s";
  return "";
}

std::optional<double> castAtStart(const Ray& ray, const Body& body, const Scene& scene) {
  const RigidTransform bodyFromWorld = body.worldFromBody.inverse();
  return castRay({bodyFromWorld * ray.origin, bodyFromWorld.rotation * ray.direction}, body, scene);
}

}  // namespace

std::optional<PixelPick> parsePick(const Field& field, FaultList& faults) {
  const std::size_t faultsBefore = faults.count();
  ObjectReader reader(field, faults);
  PixelPick pick{field, reader.integer("frame", 0, kMaxFrame, 0)};
  if (const auto pixel = reader.require("pixel")) {
    const std::vector<Field> numbers = readItems(*pixel, 2, faults);
    if (numbers.size() == 2) {
      pick.column = readNumber(numbers[0], kPixels, "pixels", faults).value_or(0);
      pick.row = readNumber(numbers[1], kPixels, "pixels", faults).value_or(0);
    }
  }
  reader.rejectUnknownKeys();
  return faults.count() == faultsBefore ? std::optional(pick) : std::nullopt;
}

std::optional<Ray> rayOf(const PixelPick& pick, const Scene& scene, FaultList& faults) {
  if (const std::string why = whyUnknown(scene, pick.frame); !why.empty()) {
    addFault(faults, pick.field, "it is not known what the pixel shows: " + why);
    return std::nullopt;
  }
  const Output& output = scene.output;
  if (pick.column >= output.width || pick.row >= output.height) {
    addFault(faults, pick.field,
             fmt::format("pixel [{}, {}] is outside of the picture; allowed are columns below {} and rows below {}",
                         pick.column, pick.row, output.width, output.height));
    return std::nullopt;
  }
  const Camera camera = cameraAtStart(scene);
  const SinCos half = sinCos(camera.verticalFieldOfView / 2);
  const double perPixel = 2 * half.sin / half.cos / output.height;  // at a depth of 1
  const Vec3 inCamera((pick.column + 0.5 - output.width / 2.0) * perPixel,
                      (output.height / 2.0 - pick.row - 0.5) * perPixel, -1);
  return Ray{camera.position, (cameraAxes(camera) * inCamera).normalized()};
}

std::optional<Anchor> firstMet(const Ray& ray, const Scene& scene) {
  double nearest = std::numeric_limits<double>::infinity();
  int met = kWorld;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const std::optional<double> distance = castAtStart(ray, scene.bodies[i], scene);
    if (distance && *distance < nearest) nearest = *distance, met = static_cast<int>(i);
  }
  if (met == kWorld) return std::nullopt;
  const Body& body = scene.bodies[static_cast<std::size_t>(met)];
  return Anchor{met, body.worldFromBody.inverse() * Vec3(ray.origin + nearest * ray.direction)};
}

std::optional<Vec3> pickedPoint(const PixelPick& pick, int body, const Scene& scene, FaultList& faults) {
  const std::optional<Ray> ray = rayOf(pick, scene, faults);
  if (!ray) return std::nullopt;
  const Body& asked = scene.bodies[static_cast<std::size_t>(body)];
  const std::optional<double> distance = castAtStart(*ray, asked, scene);
  if (distance) return asked.worldFromBody.inverse() * Vec3(ray->origin + *distance * ray->direction);
  const std::optional<Anchor> met = firstMet(*ray, scene);
  addFault(faults, pick.field,
           fmt::format("body {} is not at pixel [{}, {}]; the ray there meets {}", inQuotes(asked.name), pick.column,
                       pick.row,
                       met ? "body " + inQuotes(scene.bodies[static_cast<std::size_t>(met->body)].name) : "nothing"));
  return std::nullopt;
}

}  // namespace cradle
