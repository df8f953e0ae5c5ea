#include "verify/truth_frame.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "core/error.h"
#include "verify/exr_reader.h"
#include "verify/npy_reader.h"
#include "verify/placed_solid.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExrKind = "passes";
constexpr std::array<const char*, 9> kTruthKinds = {
    "depth", "normal", "segmentation", "flow", "backwardFlow", "hidden", "objectCoordinates", "instances", kExrKind};
constexpr std::size_t kDigits = 6;  // of a frame's number in a file's name

/// The frame of a file; nothing if it is none of ground truth.
std::optional<long> frameOf(const std::string& name) {
  for (const char* kind : kTruthKinds) {
    const std::string before = kind + std::string("_");
    if (!name.starts_with(before) || name.size() < before.size() + kDigits) continue;
    const std::string digits = name.substr(before.size(), kDigits);
    if (digits.find_first_not_of("0123456789") != std::string::npos) continue;
    if (name == truthFileName(kind, std::stol(digits))) return std::stol(digits);
  }
  return std::nullopt;
}

bool isThere(const fs::path& path) {
  std::error_code missing;
  return fs::exists(path, missing);
}

template <class Number>
std::vector<Number> readPass(const VerifiedFilm& film, const char* kind, const TruthFrame& frame,
                             std::size_t channels) {
  const fs::path path = fs::path(film.folder) / frame.fileOf(kind);
  if (!isThere(path)) return {};
  if (frame.isExr)
    return readExr<Number>(path.string(), kind, channels, film.width(), film.height()).value_or(std::vector<Number>());
  std::vector<std::size_t> shape = {film.height(), film.width()};
  if (channels > 1) shape.push_back(channels);
  return readNpy<Number>(path.string(), shape);
}

std::vector<int> idsOf(const TruthFrame& frame, std::size_t width, std::size_t height) {
  if (!frame.segmentation.empty()) return {frame.segmentation.begin(), frame.segmentation.end()};
  std::vector<int> ids(width * height, kUnknownId);
  for (const InstanceRecord& record : frame.instances.annotations) {
    const auto mask = maskOf(record, width, height);
    if (!mask || record.id < 1 || record.id >= kFirstIdOfLinks) continue;  // told as faults of the annotation
    for (std::size_t pixel = 0; pixel < ids.size(); ++pixel)
      if ((*mask)[pixel]) ids[pixel] = static_cast<int>(record.id);
  }
  return ids;
}

}  // namespace

TruthCamera::TruthCamera(const CameraRecord& record)
    : position_(record.worldFromCameraOpenCv.topRightCorner<3, 1>()), focal_(record.intrinsics(0, 0)) {
  const Mat3 rotation = record.worldFromCameraOpenCv.topLeftCorner<3, 3>();
  pixelFromWorld_ = record.intrinsics * rotation.transpose();
  worldFromPixel_ = rotation * record.intrinsics.inverse();
}

VerifiedFilm::VerifiedFilm(std::string place, const Scene& ofScene, const TrajectoryReader& states,
                           CameraDocument document)
    : folder(std::move(place)), scene(ofScene), trajectory(states), cameras(std::move(document)) {
  for (const Model& model : scene.models) meshes.emplace_back(model.drawn);
}

std::vector<long> framesIn(const std::string& folder) {
  std::set<long> frames;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed))
    if (const auto frame = frameOf(entry->path().filename().string())) frames.insert(*frame);
  if (failed) throw Error(ErrorKind::usage, folder, "cannot be read: " + failed.message());
  return {frames.begin(), frames.end()};
}

std::string truthFileName(const std::string& kind, long frame) {
  return fmt::format("{}_{:06}{}", kind, frame, kind == "instances" ? ".json" : kind == kExrKind ? ".exr" : ".npy");
}

std::string TruthFrame::fileOf(const std::string& pass) const {
  return truthFileName(isExr ? kExrKind : pass, number);
}

TruthFrame readTruthFrame(const VerifiedFilm& film, long number) {
  TruthFrame frame;
  frame.number = number;
  frame.isExr = isThere(fs::path(film.folder) / truthFileName(kExrKind, number));
  frame.depth = readPass<float>(film, "depth", frame, 1);
  frame.normal = readPass<float>(film, "normal", frame, 3);
  frame.objectCoordinates = readPass<float>(film, "objectCoordinates", frame, 3);
  frame.flow = readPass<float>(film, "flow", frame, 2);
  frame.backwardFlow = readPass<float>(film, "backwardFlow", frame, 2);
  frame.segmentation = readPass<std::uint16_t>(film, "segmentation", frame, 1);
  frame.hidden = readPass<std::uint8_t>(film, "hidden", frame, 1);
  frame.instances = readInstances((fs::path(film.folder) / truthFileName("instances", number)).string());
  frame.ids = idsOf(frame, film.width(), film.height());
  frame.state = film.trajectory.readFrame(number);
  frame.worldFromBody = posesOf(film.scene, frame.state);
  return frame;
}

std::optional<std::vector<bool>> maskOf(const InstanceRecord& record, std::size_t width, std::size_t height) {
  std::vector<bool> mask(width * height, false);
  std::size_t place = 0;
  bool isInside = false;
  for (const long run : record.runs) {
    if (run < 0 || static_cast<std::size_t>(run) > mask.size() - place) return std::nullopt;
    for (const std::size_t end = place + static_cast<std::size_t>(run); place < end; ++place)
      if (isInside) mask[place % height * width + place / height] = true;
    isInside = !isInside;
  }
  return place == mask.size() ? std::optional(mask) : std::nullopt;
}

}  // namespace cradle
