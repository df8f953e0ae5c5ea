#include "simulate/frame_stream.h"

#include <utility>

namespace cradle {

FrameStream::FrameStream(const Scene& scene)
    : FrameStream([&scene](const SimulationSink& sink) { simulate(scene, sink); }) {}

FrameStream::FrameStream(std::function<void(const SimulationSink&)> simulate)
    : thread_([this, told = std::move(simulate)] { run(told); }) {}

FrameStream::~FrameStream() {
  {
    const std::lock_guard lock(mutex_);
    isClosed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FrameStream::run(const std::function<void(const SimulationSink&)>& simulate) {
  try {
    const auto putPush = [this](const Event& event) {
      if (event.kind == EventKind::pushStart || event.kind == EventKind::pushMissed) put(event);
    };
    SimulationSink sink{[this](const Frame& frame) { put(frame); }, putPush,
                        [this](const std::string& warning) { put(warning); }};
    sink.reached = [this](double time) { put(time); };
    simulate(sink);
  } catch (const Closed&) {
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    changed_.notify_all();
  }
}

void FrameStream::put(Item item) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return isClosed_ || items_.size() < kFramesAhead; });
  if (isClosed_) throw Closed();
  items_.push_back(std::move(item));
  changed_.notify_all();
}

FrameStream::Item FrameStream::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !items_.empty() || failure_; });
  if (items_.empty()) std::rethrow_exception(failure_);
  Item item = std::move(items_.front());
  items_.pop_front();
  changed_.notify_all();
  return item;
}

Frame FrameStream::next(const std::function<void(const std::string&)>& warn,
                        const std::function<void(double time)>& reached) {
  for (;;) {
    Item item = take();
    if (auto* frame = std::get_if<Frame>(&item)) return std::move(*frame);
    if (const auto* push = std::get_if<Event>(&item))
      pushEvents_.push_back(*push);
    else if (const auto* time = std::get_if<double>(&item)) {
      if (reached) reached(*time);
    } else
      warn(std::get<std::string>(item));
  }
}

}  // namespace cradle
