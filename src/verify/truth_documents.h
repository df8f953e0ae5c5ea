#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "math/types.h"
#include "verify/findings.h"

// The JSON files of a folder of ground truth as plain data, and what verification says as JSON. All readers throw
// Error(usage) if a file is missing, no JSON, or lacks what they read, with its name.

namespace cradle {

/// `truth.json`: what the folder was drawn from.
struct TruthOrigin {
  std::string trajectory;  // a path, from the folder on or absolute
  std::string stateHash;
};

struct CameraRecord {
  long frame = 0;
  double time = 0;  // s
  Mat3 intrinsics;  // K, pixels
  Eigen::Matrix4d worldFromCamera, worldFromCameraOpenCv;
};

/// `camera.json`.
struct CameraDocument {
  long width = 0, height = 0;  // pixels
  std::vector<CameraRecord> frames;
};

/// An event of `events.json`; bodies by their names, nothing for the world.
struct EventRecord {
  double time = 0;  // s
  std::string kind;
  std::optional<std::string> bodyA, bodyB;
  Vec3 point, normal;
  double impulse = 0;
};

/// Left, top, width, height, in pixels.
using BoxOfPixels = std::array<long, 4>;

struct BoxRecord {
  Vec3 center, size;
  Quat orientation;
};

/// An annotation of `instances_NUMBER.json`; SI units.
struct InstanceRecord {
  long id = 0, imageId = 0, categoryId = 0, isCrowd = 0;
  std::string category, name, motion;
  BoxOfPixels box, wholeBox;
  long area = 0, wholeArea = 0;  // pixels
  std::array<long, 2> maskSize;  // pixels: height, width
  std::vector<long> runs;        // pixels, column by column
  double visibleFraction = 0;
  std::optional<BoxRecord> boxInSpace;
  Eigen::Matrix4d worldFromBody;
  Vec3 position, linearVelocity, angularVelocity;
  Quat orientation;
  double mass = 0, staticFriction = 0, dynamicFriction = 0, restitution = 0;
};

struct CategoryRecord {
  long id = 0;
  std::string name;
};

/// `instances_NUMBER.json`.
struct InstanceDocument {
  long imageId = 0, width = 0, height = 0;
  double time = 0;  // s
  std::string pictureName;
  std::vector<CategoryRecord> categories;
  std::vector<InstanceRecord> annotations;
};

TruthOrigin readOrigin(const std::string& path);
CameraDocument readCameras(const std::string& path);
std::vector<EventRecord> readEvents(const std::string& path);
InstanceDocument readInstances(const std::string& path);

/// {"frames", "holds", "checks": [{"check", "values", "faults", "worst", "allowed", "unit", "fault"}]}.
std::string findingsJson(const Findings& findings, long frames);

}  // namespace cradle
