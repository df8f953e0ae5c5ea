#include "film/film_source.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "render/upright.h"
#include "scene/load_scene.h"

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

TextureSource texturesOf(const TrajectoryHeader& header) {
  return [&header](const std::string& path) {
    const auto texture = std::find_if(header.textures.begin(), header.textures.end(),
                                      [&](const SharedTexture& candidate) { return candidate->name == path; });
    if (texture == header.textures.end())
      throw Error(ErrorKind::mesh, path, "is not in the trajectory, though its scene names it");
    return *texture;
  };
}

Scene parsedScene(const TrajectoryReader& trajectory) {
  const TrajectoryHeader& header = trajectory.header();
  try {
    return parseScene(header.scene, header.scenePath, modelsOf(header), texturesOf(header)).scene;
  } catch (const Error& error) {
    const std::string faults = error.what();
    throw Error(ErrorKind::usage, trajectory.path(),
                "holds a scene that cannot be read: " + faults.substr(0, faults.find('\n')));
  }
}

/// Name of the model that a body has; empty if it has another shape.
std::string modelOf(const Body& body, const Scene& scene) {
  const auto* shape = std::get_if<ModelShape>(&body.shape);
  return shape == nullptr ? "" : scene.models[static_cast<std::size_t>(shape->model)].name;
}

std::string modelOf(const BodyRecord& body, const TrajectoryHeader& header) {
  return body.mesh < 0 ? "" : header.meshes[static_cast<std::size_t>(body.mesh)].name;
}

/// Anyone can write both.
void requireSameBodies(const Scene& scene, const TrajectoryReader& trajectory) {
  const TrajectoryHeader& header = trajectory.header();
  const auto fits = [&](const Body& body, const BodyRecord& record) {
    return body.name == record.name && (body.motion == Motion::dynamic) == record.isDynamic &&
           (body.motion == Motion::driven) == record.isDriven && modelOf(body, scene) == modelOf(record, header);
  };
  if (std::equal(scene.bodies.begin(), scene.bodies.end(), header.bodies.begin(), header.bodies.end(), fits)) return;
  throw Error(ErrorKind::usage, trajectory.path(),
              "is damaged: its bodies are not those of its scene; make it again with `cradle simulate`");
}

}  // namespace

Scene sceneOf(const TrajectoryReader& trajectory) {
  Scene scene = parsedScene(trajectory);
  requireSameBodies(scene, trajectory);
  return scene;
}

FilmSource::FilmSource(std::shared_ptr<const TrajectoryReader> trajectory) {
  setTrajectory(std::move(trajectory));
}

void FilmSource::setTrajectory(std::shared_ptr<const TrajectoryReader> trajectory) {
  reader_ = std::move(trajectory);
  setScene(sceneOf(*reader_));
  frameCount_ = reader_->frameCount();
}

void FilmSource::setScene(Scene scene) {
  scene_ = std::move(scene);
  frameCount_ = lastFrame(scene_) + 1;
  if (upOf(scene_) == Vec3::UnitY()) return;
  const Quat turn = uprightFromWorld(scene_);
  upright_ = {turn, turned(turn, scene_)};
}

Frame FilmSource::frameAt(long number) {
  return reader_->readFrame(number);
}

std::vector<Event> FilmSource::pushEvents() {
  return reader_->events();
}

Frame FilmSource::drawnFrameAt(long number) {
  return upright_ ? turned(upright_->fromWorld, frameAt(number)) : frameAt(number);
}

std::vector<Event> FilmSource::drawn(std::vector<Event> events) const {
  if (!upright_) return events;
  for (Event& event : events) event = turned(upright_->fromWorld, event);
  return events;
}

std::vector<Event> FilmSource::drawnPushEvents() {
  return drawn(pushEvents());
}

std::vector<Event> FilmSource::drawnEvents() const {
  return drawn(reader_->events());
}

std::vector<ContactWrench> FilmSource::drawnContactsAt(long number) const {
  std::vector<ContactWrench> contacts = reader_->contactsAt(number);
  if (upright_)
    for (ContactWrench& wrench : contacts) wrench = turned(upright_->fromWorld, wrench);
  return contacts;
}

long FilmSource::pictureCount() const {
  return std::max(1L, frameCount_ - 1);
}

}  // namespace cradle
