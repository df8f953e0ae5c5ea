#include "scene/parse_driven.h"

#include <fmt/format.h>

#include <cmath>

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
  for (const Field& item : items) {
    keys.push_back(parseKeyFrame(item, usual, faults));
    if (keys.size() > 1) checkOrder(keys[keys.size() - 2], keys.back(), item, faults);
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
  reader.rejectUnknownKeys();
  return motion;
}

/// The first key of several that is there.
std::optional<Field> firstOf(ObjectReader& reader, const std::vector<const char*>& keys) {
  std::optional<Field> first;
  for (const char* key : keys)
    if (const auto field = reader.find(key); field && !first) first = field;
  return first;
}

}  // namespace

void parseDriven(ObjectReader& reader, BodyDraft& draft) {
  Body& body = draft.body;
  FaultList& faults = reader.faults();
  const auto keyFrames = reader.find("keyFrames"), oscillation = reader.find("oscillation");
  const auto repeat = reader.find("repeat");
  if (body.motion != Motion::driven) {
    if (const auto field = firstOf(reader, {"keyFrames", "oscillation", "repeat"}))
      addFault(faults, *field, "only a driven body is led; give it \"motion\": \"driven\" too");
    return;
  }
  const auto velocity = firstOf(reader, {"linearVelocity", "angularVelocity", "angularVelocityBody"});
  if (int(keyFrames.has_value()) + int(oscillation.has_value()) + int(velocity.has_value()) != 1) {
    addFault(faults, draft.field,
             "a driven body moves as one of these says: \"keyFrames\", \"oscillation\", or \"linearVelocity\" and "
             "\"angularVelocity\"; give one of them");
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
