#include "commands/running_simulation.h"

#include <utility>

#include "core/output_path.h"
#include "simulate/simulate.h"

namespace cradle {

RunningSimulation::RunningSimulation(Scene scene, const std::string& path)
    : scene_(std::move(scene)), writer_(path, headerOf(scene_)), reader_(partPath(path)), thread_([this] { run(); }) {}

RunningSimulation::~RunningSimulation() {
  isUnwanted_ = true;
  thread_.join();
}

void RunningSimulation::run() {
  std::exception_ptr failure;
  try {
    simulateIntoFile();
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  failure_ = failure;
  hasEnded_ = true;
  readable_ = writer_.readableFrames();
  changed_.notify_all();
}

void RunningSimulation::simulateIntoFile() {
  const SimulationSink sink{[&](const Frame& frame) {
                              if (isUnwanted_) throw Unwanted();
                              writer_.append(frame);
                              publish();
                            },
                            [&](const Event& event) { writer_.append(event); },
                            [&](const std::string& warning) {
                              const std::lock_guard lock(mutex_);
                              warnings_.push_back(warning);
                            }};
  writer_.finish(simulate(scene_, sink));
}

void RunningSimulation::publish() {
  const std::lock_guard lock(mutex_);
  if (readable_ == writer_.readableFrames()) return;
  readable_ = writer_.readableFrames();
  changed_.notify_all();
}

long RunningSimulation::waitForMore(long frames) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return hasEnded_ || readable_ > frames; });
  if (failure_) std::rethrow_exception(failure_);
  return readable_;
}

void RunningSimulation::throwIfFailed() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

bool RunningSimulation::isFinished() {
  const std::lock_guard lock(mutex_);
  return hasEnded_ && !failure_;
}

std::vector<std::string> RunningSimulation::takeWarnings() {
  const std::lock_guard lock(mutex_);
  return std::exchange(warnings_, {});
}

}  // namespace cradle
