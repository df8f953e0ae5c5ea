#include "commands/trajectory_source.h"

#include <fmt/format.h>

#include <memory>

#include "commands/simulate_scene.h"
#include "commands/warnings.h"
#include "core/error.h"
#include "core/progress.h"
#include "simulate/assembly.h"
#include "simulate/simulate.h"
#include "simulate/world.h"

namespace cradle {

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
    setTrajectory(std::make_shared<const TrajectoryReader>(sceneOrTrajectory));
    return;
  }
  setScene(loadSceneAndWarn(sceneOrTrajectory, options));
  refuseUnsupported(scene());
}

/// Calls simulateInto(writer, world).
template <class Simulate>
void TrajectorySource::simulateBy(const Simulate& simulateInto) {
  if (isWhole()) return;
  World world(scene());
  TrajectoryWriter writer(headerOf(scene(), world.plan()));
  simulateInto(writer, world);
  setTrajectory(std::make_shared<const TrajectoryReader>(writer));
}

void TrajectorySource::keepAt(const std::string& path) {
  if (!isWhole()) kept_.emplace(path, scene(), quiet_);
}

/// As simulate(), into the file that is kept.
void TrajectorySource::simulateKept() {
  Progress progress("Simulating", "frames", frameCount(), quiet_);
  SimulationSink sink{[&](const Frame& frame) { progress.update(frame.number + 1); }, [](const Event&) {},
                      [&](const std::string& warning) {
                        progress.endLine();
                        cradle::warn(warning);
                      }};
  sink.reached = [&](double time) { progress.showTime(time); };
  kept_->run(sink, [&](long frames) { progress.skipTo(frames); });
  progress.endLine();
  setTrajectory(std::make_shared<const TrajectoryReader>(kept_->part()));
}

void TrajectorySource::simulate() {
  if (kept_) return simulateKept();
  simulateBy([this](TrajectoryWriter& writer, World& world) { simulateInto(writer, scene(), world, quiet_); });
}

void TrajectorySource::simulateUntilItFails() {
  simulateBy([this](TrajectoryWriter& writer, World& world) {
    const std::optional<std::string> failure = cradle::simulateUntilItFails(writer, scene(), world, quiet_);
    if (failure) warn(fmt::format("{}; the frames up to then are taken", *failure));
  });
}

void TrajectorySource::simulateBeside(std::function<void(const std::string&)> warn,
                                      std::function<void(double time)> reached) {
  if (isWhole()) return;
  warn_ = std::move(warn);
  reached_ = std::move(reached);
  if (kept_)
    stream_.emplace([this](const SimulationSink& sink) { kept_->run(sink); });
  else
    stream_.emplace(scene());
}

Frame TrajectorySource::frameAt(long number) {
  if (isWhole()) return FilmSource::frameAt(number);
  while (waiting_.empty() || waiting_.back().number < number) waiting_.push_back(stream_->next(warn_, reached_));
  CRADLE_CHECK(number >= waiting_.front().number);
  return waiting_[static_cast<std::size_t>(number - waiting_.front().number)];
}

void TrajectorySource::forgetBefore(long number) {
  while (waiting_.size() > 1 && waiting_.front().number < number) waiting_.pop_front();
}

std::vector<Event> TrajectorySource::pushEvents() {
  if (isWhole()) return FilmSource::pushEvents();
  for (long number = 0; number < frameCount() && stream_->pushEvents().size() < scene().pushes.size(); ++number)
    frameAt(number);
  return stream_->pushEvents();
}

void TrajectorySource::finish() {
  if (!stream_) return;
  for (long number = waiting_.back().number + 1; number < frameCount(); ++number) {
    frameAt(number);
    forgetBefore(number);
  }
}

}  // namespace cradle
