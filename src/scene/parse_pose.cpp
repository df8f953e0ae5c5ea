#include "scene/parse_pose.h"

#include <fmt/format.h>

#include <cmath>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kLengthTolerance = 1e-6;  // of a quaternion: six digits are enough to write one down

std::optional<Quat> readQuaternion(ObjectReader& reader) {
  FaultList& faults = reader.faults();
  const std::size_t faultsBefore = faults.count();
  Eigen::Vector4d parts = Eigen::Vector4d::Zero();  // w, x, y, z
  Eigen::Index i = 0;
  for (const char* key : {"w", "x", "y", "z"}) {
    reader.require(key);
    parts[i++] = reader.number(key, kAnyNumber, "", 0);
  }
  if (faults.count() != faultsBefore) return std::nullopt;
  const double length = parts.stableNorm();
  if (length == 0) {
    addFault(faults, reader.field(), "the quaternion is zero; its length must be 1");
    return std::nullopt;
  }
  if (std::abs(length - 1) > kLengthTolerance) {
    const Eigen::Vector4d unit = parts / length;
    addFault(
        faults, reader.field(),
        fmt::format("the quaternion has length {}; allowed is 1 within 1e-6; its direction is w {}, x {}, y {}, z {}",
                    length, unit[0], unit[1], unit[2], unit[3]));
    return std::nullopt;
  }
  return Quat(parts[0], parts[1], parts[2], parts[3]).normalized();
}

std::optional<Quat> readAxisAngle(ObjectReader& reader) {
  const auto axis = reader.require("axis");
  reader.require("angleDegrees");
  const Vec3 direction = axis ? readDirection(*axis, reader.faults()).value_or(Vec3::UnitX()) : Vec3::UnitX();
  const double angle = reader.number("angleDegrees", kAngles, "degrees", 0);
  return rotationAbout(direction, angle * kRadiansPerDegree);
}

bool isEulerOrder(const std::string& order) {
  if (order.size() != 3 || order.find_first_not_of("xyz") != order.npos) return false;
  return order[0] != order[1] && order[1] != order[2];
}

std::optional<Quat> readEulerAngles(ObjectReader& reader) {
  FaultList& faults = reader.faults();
  reader.require("eulerDegrees");
  const Vec3 degrees = reader.vector("eulerDegrees", kAngles, "degrees", Vec3::Zero());
  const std::string order = reader.text("order", "zyx");
  if (!isEulerOrder(order)) {
    addFault(
        faults, reader.find("order").value_or(reader.field()),
        fmt::format("order is {}; allowed are three letters of x, y, z, neighbours different, as in \"zyx\" or \"zxz\"",
                    inQuotes(order)));
    return std::nullopt;
  }
  const Vec3 angles = degrees * kRadiansPerDegree;
  return rotationFromEuler({angles.x(), angles.y(), angles.z()}, order);
}

// The three ways to write an orientation, told apart by their keys.
Quat parseOrientation(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  int forms = 0;
  const auto isGiven = [&reader](const std::vector<const char*>& keys) {
    bool isAny = false;
    for (const char* key : keys) isAny = reader.find(key).has_value() || isAny;
    return isAny;
  };
  const bool isQuaternion = isGiven({"w", "x", "y", "z"});
  const bool isAxisAngle = isGiven({"axis", "angleDegrees"});
  const bool isEuler = isGiven({"eulerDegrees", "order"});
  forms = int(isQuaternion) + int(isAxisAngle) + int(isEuler);
  std::optional<Quat> rotation;
  if (forms == 1) {
    rotation = isQuaternion ? readQuaternion(reader) : isAxisAngle ? readAxisAngle(reader) : readEulerAngles(reader);
  } else {
    const std::string what = fmt::format(
        "the orientation is given in {} forms; allowed is one of: w, x, y, z; axis and angleDegrees; eulerDegrees and "
        "order",
        forms);
    if (forms == 0)
      reader.addMissing({"w", "x", "y", "z", "axis", "angleDegrees", "eulerDegrees", "order"}, what);
    else
      addFault(faults, field, what);
  }
  reader.rejectUnknownKeys();
  return rotation.value_or(Quat::Identity());
}

}  // namespace

RigidTransform parsePlace(ObjectReader& reader, const RigidTransform& usual) {
  RigidTransform place{usual.rotation, reader.vector("position", kCoordinates, "m", usual.translation)};
  if (const auto field = reader.find("orientation")) place.rotation = parseOrientation(*field, reader.faults());
  return place;
}

void parsePose(ObjectReader& reader, BodyDraft& draft) {
  Body& body = draft.body;
  body.worldFromBody = parsePlace(reader, {});
  body.linearVelocity = reader.vector("linearVelocity", kSpeeds, "m/s", Vec3::Zero());
  const auto inWorld = reader.find("angularVelocity"), inBody = reader.find("angularVelocityBody");
  if (inWorld && inBody) {
    addFault(reader.faults(), *inBody,
             "both angularVelocity and angularVelocityBody are given; allowed is one of them");
  }
  body.angularVelocity = reader.vector("angularVelocity", kAngularSpeeds, "rad/s", Vec3::Zero());
  const Vec3 bodyVelocity = reader.vector("angularVelocityBody", kAngularSpeeds, "rad/s", Vec3::Zero());
  if (inBody) body.angularVelocity = body.worldFromBody.rotation * bodyVelocity;
}

}  // namespace cradle
