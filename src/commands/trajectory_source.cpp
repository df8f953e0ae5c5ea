#include "commands/trajectory_source.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "commands/simulate_scene.h"
#include "core/error.h"
#include "core/output_path.h"
#include "scene/load_scene.h"
#include "simulate/assembly.h"
#include "simulate/run.h"
#include "simulate/simulate.h"

namespace cradle {
namespace {

/// Hands out the meshes that a trajectory holds, by the name that the scene loader gave them.
ModelSource modelsOf(const TrajectoryHeader& header) {
  return [&header](const MeshReference& reference) -> LoadedModel {
    const auto model = std::find_if(header.meshes.begin(), header.meshes.end(),
                                    [&](const Model& candidate) { return candidate.name == modelName(reference); });
    if (model == header.meshes.end())
      throw Error(ErrorKind::mesh, modelName(reference), "is not in the trajectory, though its scene names it");
    return {*model, {}};
  };
}

std::string temporaryPath() {
  std::error_code failed;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(failed);
  if (failed)
    throw Error(ErrorKind::output, "TMPDIR",
                "names no folder, and a scene is simulated into a file there: make it, or name another");
  return (folder / fmt::format("cradle-{}.sqlite", getpid())).string();
}

}  // namespace

Scene sceneOf(const TrajectoryHeader& header) {
  return parseScene(header.scene, header.scenePath, modelsOf(header)).scene;
}

TrajectorySource::TrajectorySource(const std::string& sceneOrTrajectory, bool quiet, const std::string& assetRoot)
    : quiet_(quiet) {
  if (isDatabaseFile(sceneOrTrajectory)) {
    open(sceneOrTrajectory);
    return;
  }
  scene_ = loadSceneAndWarn(sceneOrTrajectory, {.assetRoot = assetRoot});
  refuseUnsupported(scene_);
  frameCount_ = lastFrame(scene_) + 1;
}

TrajectorySource::~TrajectorySource() {
  reader_.reset();
  if (temporary_.empty()) return;
  std::error_code ignored;  // a temporary file that cannot be removed is no reason to fail
  std::filesystem::remove(temporary_, ignored);
  std::filesystem::remove(partPath(temporary_), ignored);
}

void TrajectorySource::open(const std::string& trajectory) {
  reader_.emplace(trajectory);
  scene_ = sceneOf(reader_->header());
  frameCount_ = reader_->frameCount();
}

void TrajectorySource::simulate() {
  if (reader_) return;
  temporary_ = temporaryPath();
  {
    Run run(scene_);
    TrajectoryWriter writer(temporary_, headerOf(scene_, run.plan()));
    simulateInto(writer, scene_, run, nullptr, quiet_);
  }
  open(temporary_);
}

void TrajectorySource::simulateBeside(std::function<void(const std::string&)> warn) {
  if (reader_) return;
  warn_ = std::move(warn);
  stream_.emplace(scene_);
}

Frame TrajectorySource::frameAt(long number) {
  if (reader_) return reader_->readFrame(number);
  while (waiting_.empty() || waiting_.back().number < number) waiting_.push_back(stream_->next(warn_));
  CRADLE_CHECK(number >= waiting_.front().number);
  return waiting_[static_cast<std::size_t>(number - waiting_.front().number)];
}

void TrajectorySource::forgetBefore(long number) {
  while (waiting_.size() > 1 && waiting_.front().number < number) waiting_.pop_front();
}

std::vector<Event> TrajectorySource::pushEvents() {
  if (reader_) return reader_->events();
  for (long number = 0; number < frameCount_ && stream_->pushEvents().size() < scene_.pushes.size(); ++number)
    frameAt(number);
  return stream_->pushEvents();
}

void TrajectorySource::finish() {
  if (!stream_) return;
  for (long number = waiting_.back().number + 1; number < frameCount_; ++number) {
    frameAt(number);
    forgetBefore(number);
  }
}

long TrajectorySource::pictureCount() const {
  return std::max(1L, frameCount_ - 1);
}

}  // namespace cradle
