#include "commands/trajectory_source.h"

#include <fmt/format.h>

#include <algorithm>

#include "commands/simulate_scene.h"
#include "commands/warnings.h"
#include "core/error.h"
#include "core/progress.h"
#include "render/upright.h"
#include "scene/load_scene.h"
#include "simulate/assembly.h"
#include "simulate/simulate.h"
#include "simulate/world.h"

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

std::string stateHashOf(const std::string& path) {
  if (!isTrajectoryFile(path)) return "";
  try {
    return TrajectoryReader(path).stateHash();
  } catch (const Error&) {
    return "";
  }
}

TrajectorySource::TrajectorySource(const std::string& sceneOrTrajectory, bool quiet, const SceneOptions& options)
    : quiet_(quiet) {
  if (isDatabaseFile(sceneOrTrajectory)) {
    open(TrajectoryReader(sceneOrTrajectory));
    return;
  }
  setScene(loadSceneAndWarn(sceneOrTrajectory, options));
  refuseUnsupported(scene_);
  frameCount_ = lastFrame(scene_) + 1;
}

TrajectorySource::TrajectorySource(TrajectoryReader trajectory, bool quiet) : quiet_(quiet) {
  open(std::move(trajectory));
}

void TrajectorySource::open(TrajectoryReader trajectory) {
  reader_.emplace(std::move(trajectory));
  setScene(sceneOf(*reader_));
  frameCount_ = reader_->frameCount();
}

void TrajectorySource::setScene(Scene scene) {
  scene_ = std::move(scene);
  if (upOf(scene_) == Vec3::UnitY()) return;
  const Quat turn = uprightFromWorld(scene_);
  upright_ = {turn, turned(turn, scene_)};
}

Frame TrajectorySource::drawnFrameAt(long number) {
  return upright_ ? turned(upright_->fromWorld, frameAt(number)) : frameAt(number);
}

std::vector<Event> TrajectorySource::drawn(std::vector<Event> events) const {
  if (!upright_) return events;
  for (Event& event : events) event = turned(upright_->fromWorld, event);
  return events;
}

std::vector<Event> TrajectorySource::drawnPushEvents() {
  return drawn(pushEvents());
}

std::vector<Event> TrajectorySource::drawnEvents() const {
  return drawn(reader_->events());
}

std::vector<ContactWrench> TrajectorySource::drawnContactsAt(long number) const {
  std::vector<ContactWrench> contacts = reader_->contactsAt(number);
  if (upright_)
    for (ContactWrench& wrench : contacts) wrench = turned(upright_->fromWorld, wrench);
  return contacts;
}

/// Calls simulateInto(writer, world).
template <class Simulate>
void TrajectorySource::simulateBy(const Simulate& simulateInto) {
  if (reader_) return;
  World world(scene_);
  TrajectoryWriter writer(headerOf(scene_, world.plan()));
  simulateInto(writer, world);
  open(TrajectoryReader(writer));
}

void TrajectorySource::keepAt(const std::string& path) {
  if (!reader_) kept_.emplace(path, scene_, quiet_);
}

/// As simulate(), into the file that is kept.
void TrajectorySource::simulateKept() {
  Progress progress("Simulating", "frames", frameCount_, quiet_);
  SimulationSink sink{[&](const Frame& frame) { progress.update(frame.number + 1); }, [](const Event&) {},
                      [&](const std::string& warning) {
                        progress.endLine();
                        cradle::warn(warning);
                      }};
  sink.reached = [&](double time) { progress.showTime(time); };
  kept_->run(sink, [&](long frames) { progress.skipTo(frames); });
  progress.endLine();
  open(TrajectoryReader(kept_->part()));
}

void TrajectorySource::simulate() {
  if (kept_) return simulateKept();
  simulateBy([this](TrajectoryWriter& writer, World& world) { simulateInto(writer, scene_, world, quiet_); });
}

void TrajectorySource::simulateUntilItFails() {
  simulateBy([this](TrajectoryWriter& writer, World& world) {
    const std::optional<std::string> failure = cradle::simulateUntilItFails(writer, scene_, world, quiet_);
    if (failure) warn(fmt::format("{}; the frames up to then are taken", *failure));
  });
}

void TrajectorySource::simulateBeside(std::function<void(const std::string&)> warn,
                                      std::function<void(double time)> reached) {
  if (reader_) return;
  warn_ = std::move(warn);
  reached_ = std::move(reached);
  if (kept_)
    stream_.emplace([this](const SimulationSink& sink) { kept_->run(sink); });
  else
    stream_.emplace(scene_);
}

Frame TrajectorySource::frameAt(long number) {
  if (reader_) return reader_->readFrame(number);
  while (waiting_.empty() || waiting_.back().number < number) waiting_.push_back(stream_->next(warn_, reached_));
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
