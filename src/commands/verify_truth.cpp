#include "commands/verify_truth.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "commands/frame_folder.h"
#include "commands/trajectory_source.h"
#include "core/console.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/printable.h"
#include "core/progress.h"
#include "trajectory/trajectory_file.h"
#include "verify/check_cameras.h"
#include "verify/check_instances.h"
#include "verify/check_motion.h"
#include "verify/check_surfaces.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

/// The trajectory that a folder keeps or names, if it still is the one that was drawn.
TrajectoryReader trajectoryOf(const std::string& folder) {
  const fs::path origin = fs::path(folder) / kOriginFile;
  std::error_code missing;
  if (!fs::exists(origin, missing))
    throw Error(ErrorKind::usage, folder,
                "has no truth.json, which says what it was drawn from; fill it with `cradle render --passes`");
  const auto [named, stateHash] = readOrigin(origin.string());
  TrajectoryReader trajectory((fs::path(folder) / named).string());
  const std::string hash = trajectory.hashOfFrames();
  if (hash == stateHash) return trajectory;
  throw Error(ErrorKind::usage, trajectory.path(),
              fmt::format("is not the trajectory that {} was drawn from: its states have the hash {}, those drawn {}",
                          folder, hash, stateHash));
}

/// What can be indexed without looking again.
void requireWholeCameras(const VerifiedFilm& film, const std::vector<long>& frames) {
  constexpr long kLargestSide = 16384;  // pixels, of any picture
  const std::string path = (fs::path(film.folder) / kCameraFile).string();
  const auto& [width, height, cameras] = film.cameras;
  if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide)
    throw Error(ErrorKind::usage, path,
                fmt::format("says {} x {} pixels; allowed are 1 to {}", width, height, kLargestSide));
  if (std::ssize(cameras) != film.trajectory.frameCount())
    throw Error(
        ErrorKind::different, path,
        fmt::format("has {} cameras; the trajectory has {} frames", cameras.size(), film.trajectory.frameCount()));
  if (frames.empty())
    throw Error(ErrorKind::usage, film.folder, "has no ground truth; fill it with `cradle render --passes`");
  if (frames.back() >= film.trajectory.frameCount())
    throw Error(ErrorKind::different, film.folder,
                fmt::format("has files of frame {}; the trajectory has {} frames", frames.back(),
                            film.trajectory.frameCount()));
}

void checkFrames(const VerifiedFilm& film, const std::vector<long>& frames, bool quiet, Findings& findings) {
  Progress progress("Checking", "frames", std::ssize(frames), quiet);
  std::optional<TruthFrame> frame;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    throwIfInterrupted();
    if (!frame) frame = readTruthFrame(film, frames[i]);
    std::optional<TruthFrame> next;
    if (i + 1 < frames.size()) next = readTruthFrame(film, frames[i + 1]);
    const bool isNeighbour = next && next->number == frame->number + 1;
    checkSurfaces(film, *frame, findings);
    checkMotion(film, *frame, isNeighbour ? &*next : nullptr, findings);
    checkInstances(film, *frame, findings);
    frame = std::move(next);
    progress.update(static_cast<long>(i) + 1);
  }
}

void printFindings(const Findings& findings, std::size_t frames) {
  show("{} frames\n", frames);
  for (std::size_t i = 0; i < kAspects; ++i) {
    const Aspect aspect = static_cast<Aspect>(i);
    const Tally& tally = findings.of(aspect);
    if (tally.values == 0) continue;
    show("{:18} {:10} values, worst off by {:.2g} {}, {:.2g} allowed{}\n", nameOf(aspect), tally.values,
         tally.deviation, unitOf(aspect), tally.tolerance, tally.holds() ? "" : ": WRONG");
  }
}

[[noreturn]] void refuseFindings(const std::string& folder, const Findings& findings) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < kAspects; ++i) {
    const Aspect aspect = static_cast<Aspect>(i);
    const Tally& tally = findings.of(aspect);
    if (!tally.fault) continue;
    lines.push_back(printableLine(fmt::format("{}/{}", folder, describe(*tally.fault, tally, aspect))));
  }
  throw Error::ofLines(ErrorKind::different, fmt::format("{}", fmt::join(lines, "\n")));
}

}  // namespace

void verifyTruth(const std::string& folder, bool asJson, bool quiet) {
  const std::vector<long> frames = framesIn(folder);
  const TrajectoryReader trajectory = trajectoryOf(folder);
  const Scene scene = sceneOf(trajectory);
  const VerifiedFilm film(folder, scene, trajectory, readCameras((fs::path(folder) / kCameraFile).string()));
  requireWholeCameras(film, frames);
  Findings findings;
  checkCameras(film, findings);
  checkEvents(film, readEvents((fs::path(folder) / kEventsFile).string()), findings);
  checkFrames(film, frames, quiet, findings);
  if (asJson)
    showText(stdout, findingsJson(findings, std::ssize(frames)));
  else
    printFindings(findings, frames.size());
  if (!findings.hold()) refuseFindings(folder, findings);
}

}  // namespace cradle
