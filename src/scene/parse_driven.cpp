#include "scene/parse_driven.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/elementary.h"
#include "scene/parse_pose.h"

namespace cradle {
namespace {

constexpr Range kFrequencies{0, 1e9};                  // 1/s
constexpr Range kAmplitudes{-1e9, 1e9};                // m
constexpr Range kPhases{-1e9, 1e9};                    // rad
constexpr std::size_t kMaxKeyFrames = 100000;          // some 100 MB while the way through them is found
constexpr double kMaxTurnDegrees = 170;                // from a key frame to the next: half a turn goes either way
constexpr double kSamePlace = 1e-9, kSameTurn = 1e-6;  // m a m of coordinates; rad: of the ends of a way that repeats

KeyFrame parseKeyFrame(const Field& field, const RigidTransform& usual, FaultList& faults) {
  KeyFrame key;
  ObjectReader reader(field, faults);
  reader.require("time");
  key.time = reader.number("time", kKeyTimes, "s", 0);
  key.pose = parsePlace(reader, usual);
  reader.rejectUnknownKeys();
  return key;
}

void checkOrder(const KeyFrame& before, const KeyFrame& key, const Field& field, FaultList& faults) {
  if (!(key.time > before.time))
    addFault(faults, field,
             fmt::format("time is {} s, and {} s in the key frame before; times must ascend", key.time, before.time));
  const double speed = (key.pose.translation - before.pose.translation).norm() / (key.time - before.time);
  if (key.time > before.time && speed > kSpeeds.most)
    addFault(faults, field,
             fmt::format("the body would come here from the key frame before with {:.3g} m/s; allowed are {:g}", speed,
                         kSpeeds.most));
  const double halfCosine = std::abs(before.pose.rotation.dot(key.pose.rotation));
  if (halfCosine < cos(kMaxTurnDegrees / 2 * kRadiansPerDegree))
    addFault(
        faults, field,
        fmt::format("the body turns by more than {} degrees from the key frame before, and half a turn goes either "
                    "way; give a key frame in between",
                    kMaxTurnDegrees));
}

/// The largest angle that the orientation of a key frame without faults gives, degrees; 0 if it gives none.
double largestAngle(const Field& keyFrame, FaultList& faults) {
  const auto orientation = ObjectReader(keyFrame, faults).find("orientation");
  if (!orientation) return 0;
  ObjectReader reader(*orientation, faults);
  const Vec3 angles = reader.vector("eulerDegrees", kAnyNumber, "", Vec3::Zero());
  return std::max(angles.cwiseAbs().maxCoeff(), std::abs(reader.number("angleDegrees", kAnyNumber, "", 0)));
}

/// Of a key frame at `field` that is turned as the one before, though its angle is a whole turn or more.
void warnOfWholeTurns(const KeyFrame& before, const KeyFrame& key, const Field& field, FaultList& faults) {
  const double turn = 2 * (key.pose.rotation * before.pose.rotation.conjugate()).vec().norm();  // of a small one
  if (turn > kSameTurn || largestAngle(field, faults) < 360) return;
  addWarning(faults, field,
             "the body is turned as in the key frame before, and does not turn: orientations count no whole turns; "
             "give key frames in between");
}

void checkEndsMeet(const KeyFrame& first, const KeyFrame& last, const Field& repeat, FaultList& faults) {
  const double way = (last.pose.translation - first.pose.translation).norm();
  const double turn = 2 * (last.pose.rotation * first.pose.rotation.conjugate()).vec().norm();  // of a small one
  if (way <= kSamePlace * (1 + first.pose.translation.norm()) && turn <= kSameTurn) return;
  addFault(faults, repeat,
           fmt::format("the last key frame is {:.3g} m and {:.3g} degrees from the first; what repeats must end where "
                       "it began",
                       way, turn / kRadiansPerDegree));
}

std::optional<PrescribedMotion> parseKeyFrames(ObjectReader& reader, const Field& field, const RigidTransform& usual) {
  FaultList& faults = reader.faults();
  const std::size_t faultsBefore = faults.count();
  const std::vector<Field> items = readItems(field, faults);
  const bool repeats = reader.boolean("repeat", false);
  if (faults.count() != faultsBefore) return std::nullopt;
  if (items.size() < 2 || items.size() > kMaxKeyFrames) {
    addFault(faults, field,
             fmt::format("found {} key frame{}; allowed are 2..{}; a body that keeps its place is \"static\"",
                         items.size(), items.size() == 1 ? "" : "s", kMaxKeyFrames));
    return std::nullopt;
  }
  std::vector<KeyFrame> keys;
  for (std::size_t i = 0; i < items.size(); ++i) {
    keys.push_back(parseKeyFrame(items[i], usual, faults));
    if (i == 0 || faults.count() != faultsBefore) continue;
    checkOrder(keys[i - 1], keys[i], items[i], faults);
    warnOfWholeTurns(keys[i - 1], keys[i], items[i], faults);
  }
  if (repeats) checkEndsMeet(keys.front(), keys.back(), *reader.find("repeat"), faults);
  if (faults.count() != faultsBefore) return std::nullopt;
  return KeyFramePath(keys, repeats);
}

OscillatingMotion parseOscillation(const Field& field, const RigidTransform& middle, FaultList& faults) {
  OscillatingMotion motion;
  ObjectReader reader(field, faults);
  motion.middle = middle;
  motion.direction = reader.direction("direction", motion.direction);
  reader.require("amplitude"), reader.require("frequency");
  motion.amplitude = reader.number("amplitude", kAmplitudes, "m", 0);
  motion.frequency = reader.number("frequency", kFrequencies, "Hz", 0);
  motion.phase = reader.number("phase", kPhases, "rad", 0);
  const double speed = 2 * std::numbers::pi * std::abs(motion.amplitude) * motion.frequency;
  if (speed > kSpeeds.most)
    addFault(faults, field,
             fmt::format("the body would move with up to {:.3g} m/s, 2 pi x amplitude x frequency; allowed are {:g}",
                         speed, kSpeeds.most));
  reader.rejectUnknownKeys();
  return motion;
}

bool isMotion(const std::string& word) {
  return word == "dynamic" || word == "static";
}

/// The key that says how a body is led is there, but not that it is.
void rejectUnled(ObjectReader& reader, const char* key, const Field& field) {
  const std::string what = fmt::format("{} is for driven bodies; give this one \"motion\": \"driven\" too", key);
  const auto motion = reader.find("motion");
  if (!motion)
    reader.addMissing({"motion"}, what);
  else if (const auto* word = std::get_if<std::string>(&motion->value->content); word && isMotion(*word))
    addFault(reader.faults(), field, what);  // a word that is none is a fault already
}

}  // namespace

void parseDriven(ObjectReader& reader, BodyDraft& draft) {
  Body& body = draft.body;
  FaultList& faults = reader.faults();
  const auto keyFrames = reader.find("keyFrames"), oscillation = reader.find("oscillation");
  const auto repeat = reader.find("repeat");
  if (body.motion != Motion::driven) {
    for (const char* key : {"keyFrames", "oscillation", "repeat"})
      if (const auto field = reader.find(key)) return rejectUnled(reader, key, *field);
    return;
  }
  const char* velocityKey = "linearVelocity";
  for (const char* key : {"angularVelocity", "angularVelocityBody"})
    if (!reader.find(velocityKey)) velocityKey = key;
  const bool hasVelocity = reader.find(velocityKey).has_value();
  if (int(keyFrames.has_value()) + int(oscillation.has_value()) + int(hasVelocity) != 1) {
    reader.addMissing(
        {"keyFrames", "oscillation", "linearVelocity", "angularVelocity", "angularVelocityBody"},
        fmt::format(
            "found {} for the way of the driven body; allowed is one of \"keyFrames\", \"oscillation\", and velocities "
            "(\"linearVelocity\", \"angularVelocity\" or \"angularVelocityBody\")",
            reader.keysFound({"keyFrames", "oscillation", velocityKey})));
    return;
  }
  if (repeat && !keyFrames) addFault(faults, *repeat, "repeat is for keyFrames; leave it out");
  if (keyFrames)
    body.prescribed = parseKeyFrames(reader, *keyFrames, body.worldFromBody);
  else if (oscillation)
    body.prescribed = parseOscillation(*oscillation, body.worldFromBody, faults);
  else
    body.prescribed = SteadyMotion{body.worldFromBody, body.linearVelocity, body.angularVelocity};
  if (!body.prescribed) return;
  const PoseMotion start = motionAt(*body.prescribed, 0);
  body.worldFromBody = start.pose;
  body.linearVelocity = start.velocity, body.angularVelocity = start.angularVelocity;
}

}  // namespace cradle
