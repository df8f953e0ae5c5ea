#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory_file.h"
#include "verify/drawn_surface.h"
#include "verify/findings.h"
#include "verify/truth_documents.h"

namespace cradle {

constexpr int kUnknownId = -1;          // in place of a pixel's id
constexpr int kFirstIdOfLinks = 60000;  // and the number of their LinkKind; bodies have their index + 1, the sky 0

/// A camera as camera.json has it.
class TruthCamera {
 public:
  explicit TruthCamera(const CameraRecord& record);

  const Vec3& position() const { return position_; }  // m, world
  double focal() const { return focal_; }             // pixels

  /// World direction, of depth 1, through pixel coordinates (x, y).
  Vec3 rayAt(double x, double y) const { return worldFromPixel_ * Vec3(x, y, 1); }

  /// Pixel coordinates times depth, and depth (m), of a point of the world; of a direction, of what is far away in it.
  Vec3 seen(const Vec3& point) const { return pixelFromWorld_ * (point - position_); }
  Vec3 seenDirection(const Vec3& direction) const { return pixelFromWorld_ * direction; }

 private:
  Vec3 position_;
  Mat3 worldFromPixel_, pixelFromWorld_;
  double focal_;
};

/// What a folder of ground truth is checked against. Scene and trajectory must outlive it.
struct VerifiedFilm {
  VerifiedFilm(std::string folder, const Scene& scene, const TrajectoryReader& trajectory, CameraDocument cameras);

  std::string folder;
  const Scene& scene;
  const TrajectoryReader& trajectory;
  CameraDocument cameras;
  std::vector<DrawnSurface> meshes;  // of each of the scene's models

  std::size_t width() const { return static_cast<std::size_t>(cameras.width); }    // pixels
  std::size_t height() const { return static_cast<std::size_t>(cameras.height); }  // pixels
  bool hasFrame(long frame) const { return frame >= 0 && frame < trajectory.frameCount(); }
};

/// What the folder says of one frame, and where its bodies are by the trajectory. Passes are empty that are not there.
struct TruthFrame {
  long number = 0;
  std::vector<float> depth, normal, objectCoordinates, flow, backwardFlow;
  std::vector<std::uint16_t> segmentation;
  std::vector<std::uint8_t> hidden;
  InstanceDocument instances;
  std::vector<int> ids;  // of `segmentation`, else those of the instances' bodies and kUnknownId
  Frame state;
  std::vector<RigidTransform> worldFromBody;
  bool isExr = false;  // passes are layers of one file

  /// The name of the file that has a pass.
  std::string fileOf(const std::string& pass) const;
};

/// The frames that a folder has any file of but pictures, ascending. Throws Error(usage) if it cannot be read.
std::vector<long> framesIn(const std::string& folder);

/// KIND_000012.npy, of a kind of file; of "passes" .exr, of "instances" .json.
std::string truthFileName(const std::string& kind, long frame);

/// Reads the files of a frame that are there, of passes the .exr or else .npy; instances_NUMBER.json has to be. Throws
/// Error(usage) for what is damaged.
TruthFrame readTruthFrame(const VerifiedFilm& film, long frame);

/// The mask of an annotation, row by row from above; nothing if its runs are none of a picture of this size.
std::optional<std::vector<bool>> maskOf(const InstanceRecord& record, std::size_t width, std::size_t height);

}  // namespace cradle
