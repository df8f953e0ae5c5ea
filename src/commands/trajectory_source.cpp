#include "commands/trajectory_source.h"

#include <algorithm>

#include "commands/simulate_scene.h"
#include "core/error.h"
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

}  // namespace

Scene sceneOf(const TrajectoryHeader& header) {
  return parseScene(header.scene, header.scenePath, modelsOf(header)).scene;
}

TrajectorySource::TrajectorySource(const std::string& sceneOrTrajectory, bool quiet, const std::string& assetRoot)
    : quiet_(quiet) {
  if (isDatabaseFile(sceneOrTrajectory)) {
    open(TrajectoryReader(sceneOrTrajectory));
    return;
  }
  scene_ = loadSceneAndWarn(sceneOrTrajectory, {.assetRoot = assetRoot});
  refuseUnsupported(scene_);
  frameCount_ = lastFrame(scene_) + 1;
}

void TrajectorySource::open(TrajectoryReader trajectory) {
  reader_.emplace(std::move(trajectory));
  scene_ = sceneOf(reader_->header());
  frameCount_ = reader_->frameCount();
}

void TrajectorySource::simulate() {
  if (reader_) return;
  Run run(scene_);
  TrajectoryWriter writer(headerOf(scene_, run.plan()));
  simulateInto(writer, scene_, run, nullptr, quiet_);
  open(TrajectoryReader(writer));
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
