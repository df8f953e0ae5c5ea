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

TrajectorySource::TrajectorySource(const std::string& sceneOrTrajectory, bool quiet) {
  std::string trajectory = sceneOrTrajectory;
  try {
    if (!isTrajectoryFile(sceneOrTrajectory)) {
      const std::string name = fmt::format("cradle-{}.sqlite", getpid());
      trajectory = temporary_ = (std::filesystem::temp_directory_path() / name).string();
      simulateToTemporary(loadSceneAndWarn(sceneOrTrajectory, {}), quiet);
    }
    reader_.emplace(trajectory);
    scene_ = parseScene(reader_->header().scene, reader_->header().scenePath, modelsOf(reader_->header())).scene;
  } catch (...) {
    removeTemporary();
    throw;
  }
}

void TrajectorySource::simulateToTemporary(const Scene& scene, bool quiet) const {
  refuseUnsupported(scene);
  TrajectoryWriter writer(temporary_, headerOf(scene));
  simulateInto(writer, scene, quiet);
}

TrajectorySource::~TrajectorySource() {
  reader_.reset();
  removeTemporary();
}

void TrajectorySource::removeTemporary() const {
  if (temporary_.empty()) return;
  std::error_code ignored;  // a temporary file that cannot be removed is no reason to fail
  std::filesystem::remove(temporary_, ignored);
  std::filesystem::remove(partPath(temporary_), ignored);
}

long TrajectorySource::pictureCount() const {
  return std::max(1L, reader_->frameCount() - 1);
}

}  // namespace cradle
