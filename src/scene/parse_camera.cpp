#include "scene/parse_camera.h"

#include <fmt/format.h>

#include <cmath>

#include "math/rotation.h"
#include "scene/parse_pose.h"

namespace cradle {
namespace {

constexpr Range kFieldsOfView{0, 180, true};  // degrees
constexpr double kShortestPeriod = 1e-9;      // s

/// One or two faults of a camera whose target is a point: as much as the text alone says.
void checkView(const Camera& camera, const Field& field, FaultList& faults) {
  if (camera.position == camera.target)
    addFault(faults, field, "the camera's position is its target; they must differ, or there is no way to look");
  else if (looksAlongUp(camera))
    addFault(faults, field,
             fmt::format("the camera looks along its up vector [{}, {}, {}]; allowed is any other direction; give "
                         "\"up\" the direction that is up in the picture, as [0, 0, -1] for a view from above",
                         camera.up.x(), camera.up.y(), camera.up.z()));
}

CameraMotion::Key parseKey(const Field& field, const SceneDraft& draft, FaultList& faults) {
  const Camera& camera = *draft.scene.camera;
  const bool looksAtBody = draft.scene.cameraMotion.targetBody != kWorld;
  ObjectReader reader(field, faults);
  reader.require("time");
  CameraMotion::Key key;
  key.time = reader.number("time", kKeyTimes, "s", 0);
  key.position = reader.vector("position", kCoordinates, "m", camera.position);
  key.target = reader.vector("target", kCoordinates, "m", camera.target);
  if (const auto target = reader.find("target"); target && looksAtBody)
    addFault(faults, *target, "a key frame has a target though the camera's target is a body; allowed is one of them");
  key.verticalFieldOfView = kRadiansPerDegree * reader.number("verticalFieldOfViewDegrees", kFieldsOfView, "degrees",
                                                              camera.verticalFieldOfView / kRadiansPerDegree);
  reader.rejectUnknownKeys();
  if (!looksAtBody) checkView({"", key.position, key.target, key.verticalFieldOfView, camera.up}, field, faults);
  return key;
}

void parseKeys(const Field& field, SceneDraft& draft, FaultList& faults) {
  std::vector<CameraMotion::Key>& keys = draft.scene.cameraMotion.keys;
  const std::size_t faultsBefore = faults.count();
  const auto items = readItems(field, faults);
  for (const Field& item : items) {
    keys.push_back(parseKey(item, draft, faults));
    if (keys.size() < 2 || keys.back().time > keys[keys.size() - 2].time || faults.count() > faultsBefore) continue;
    addFault(faults, item,
             fmt::format("time is {}, which is not after that of the key frame before, {}; allowed are ascending times",
                         keys.back().time, keys[keys.size() - 2].time));
  }
  if (items.size() < 2 && faults.count() == faultsBefore)
    addFault(faults, field, fmt::format("found {} key frames; allowed are two or more", items.size()));
}

CameraMotion::Follow parseFollow(const Field& field, const SceneDraft& draft, FaultList& faults) {
  ObjectReader reader(field, faults);
  CameraMotion::Follow follow;
  const auto name = reader.require("body");
  follow.body = (name ? findNamed(*name, draft.bodyIndex, "body", faults) : std::nullopt).value_or(kWorld);
  follow.lag = reader.number("lag", kInstants, "s", follow.lag);
  reader.rejectUnknownKeys();
  return follow;
}

/// A point, or a body that stays in the middle of the picture.
void parseTarget(const Field& field, SceneDraft& draft, FaultList& faults) {
  if (std::holds_alternative<std::string>(field.value->content))
    draft.scene.cameraMotion.targetBody = findNamed(field, draft.bodyIndex, "body", faults).value_or(kWorld);
  else if (std::holds_alternative<JsonValue::Array>(field.value->content))
    draft.scene.camera->target = readVector(field, kCoordinates, "m", faults).value_or(Vec3::UnitY());
  else
    addFault(
        faults, field,
        fmt::format("target is {}; allowed are three numbers (m), or the name of a body", described(*field.value)));
}

std::optional<double> parseOrbit(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  const auto period = reader.require("period");
  const auto seconds = period ? readNumber(*period, kPeriods, "s", faults) : std::nullopt;
  if (seconds && std::abs(*seconds) < kShortestPeriod)
    addFault(
        faults, *period,
        fmt::format("period is {}; allowed is any other number (s), of {:g} at least; negative turns clockwise, seen "
                    "from above",
                    *seconds, kShortestPeriod));
  reader.rejectUnknownKeys();
  return seconds;
}

void parseMotion(ObjectReader& reader, SceneDraft& draft) {
  FaultList& faults = reader.faults();
  CameraMotion& motion = draft.scene.cameraMotion;
  const auto target = reader.find("target"), keys = reader.find("keyFrames");
  if (target) parseTarget(*target, draft, faults);
  if (const auto field = reader.find("follow")) motion.follow = parseFollow(*field, draft, faults);
  if (motion.follow && !target && !keys) motion.targetBody = motion.follow->body;
  if (const auto field = reader.find("orbit")) motion.orbitPeriod = parseOrbit(*field, faults);
  if (keys) parseKeys(*keys, draft, faults);
}

}  // namespace

void parseCamera(ObjectReader& root, SceneDraft& draft) {
  const auto field = root.find("camera");
  if (!field) return;
  FaultList& faults = root.faults();
  const std::size_t faultsBefore = faults.count();
  Camera& camera = draft.scene.camera.emplace();
  camera.where = faults.where(field->place(), field->pointer);
  ObjectReader reader(*field, faults);
  const Quat worldFromUpright = rotationBetween(Vec3::UnitY(), upOf(draft.scene));
  camera.target = worldFromUpright * camera.target;
  camera.position = reader.vector("position", kCoordinates, "m", worldFromUpright * camera.position);
  camera.up = reader.direction("up", upOf(draft.scene));
  camera.verticalFieldOfView =
      kRadiansPerDegree * reader.number("verticalFieldOfViewDegrees", kFieldsOfView, "degrees", 40);
  parseMotion(reader, draft);
  reader.rejectUnknownKeys();
  const CameraMotion& motion = draft.scene.cameraMotion;
  if (faults.count() == faultsBefore && motion.keys.empty() && motion.targetBody == kWorld)
    checkView(camera, *field, faults);
}

}  // namespace cradle
