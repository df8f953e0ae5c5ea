#include "commands/trajectory_source.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "commands/simulate_scene.h"
#include "core/error.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "scene/load_scene.h"
#include "simulate/assembly.h"

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

/// The scene of a trajectory, with the meshes that it holds.
Scene sceneOf(const TrajectoryReader& reader) {
  const TrajectoryHeader& header = reader.header();
  return parseScene(header.scene, header.scenePath, modelsOf(header)).scene;
}

}  // namespace

TrajectorySource::TrajectorySource(const std::string& sceneOrTrajectory, bool quiet) : quiet_(quiet) {
  if (!isTrajectoryFile(sceneOrTrajectory)) {
    scene_ = loadSceneAndWarn(sceneOrTrajectory, {});
    refuseUnsupported(scene_);
    frameCount_ = lastFrame(scene_) + 1;
    return;
  }
  ownReader_ = std::make_unique<TrajectoryReader>(sceneOrTrajectory);
  scene_ = sceneOf(*ownReader_);
  frameCount_ = ownReader_->frameCount();
}

TrajectorySource::~TrajectorySource() {
  simulation_.reset();
  if (temporary_.empty()) return;
  std::error_code ignored;  // a temporary file that cannot be removed is no reason to fail
  std::filesystem::remove(temporary_, ignored);
  std::filesystem::remove(partPath(temporary_), ignored);
}

void TrajectorySource::start() {
  if (ownReader_) return;
  temporary_ = (std::filesystem::temp_directory_path() / fmt::format("cradle-{}.sqlite", getpid())).string();
  simulation_ = std::make_unique<RunningSimulation>(std::move(scene_), temporary_);
  scene_ = sceneOf(simulation_->reader());
}

long TrajectorySource::pictureCount() const {
  return std::max(1L, frameCount_ - 1);
}

Frame TrajectorySource::frame(long number) const {
  if (simulation_) simulation_->throwIfFailed();
  while (number >= reader().frameCount()) {
    CRADLE_CHECK(simulation_ && number < frameCount_);
    simulation_->waitForMore(reader().frameCount());
    simulation_->reader().readNewFrames();
  }
  return reader().readFrame(number);
}

void TrajectorySource::waitForEnd() const {
  if (!simulation_) return;
  Progress progress("Simulating", "frames", frameCount_, quiet_);
  for (long done = 0; !simulation_->isFinished();) {
    done = simulation_->waitForMore(done);
    printWarnings(takeWarnings(), progress);
    progress.update(done);
  }
  simulation_->reader().readNewFrames();
}

std::vector<std::string> TrajectorySource::takeWarnings() const {
  return simulation_ ? simulation_->takeWarnings() : std::vector<std::string>();
}

}  // namespace cradle
