#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "scene/scene.h"
#include "simulate/simulate.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// A simulation in a thread of its own. It is kFramesAhead frames ahead of who takes them at most, and then waits.
class FrameStream {
 public:
  static constexpr std::size_t kFramesAhead = 16;  // a slow frame does not stop the drawing at once

  /// Begins. `scene` must outlive this object.
  explicit FrameStream(const Scene& scene);

  /// The same of anything that tells a sink the frames of a run, its events and warnings.
  explicit FrameStream(std::function<void(const SimulationSink&)> simulate);

  /// Ends the simulation, with the frame under way at the latest.
  ~FrameStream();
  FrameStream(const FrameStream&) = delete;
  FrameStream& operator=(const FrameStream&) = delete;

  /// Waits for the next frame; `warn` is told what the user should know of it, and `reached`, which may be none, the
  /// simulated time (s) inside a frame that takes long. Throws what the simulation throws. Not to be called again after
  /// the last frame, or after an error.
  Frame next(const std::function<void(const std::string&)>& warn, const std::function<void(double time)>& reached = {});

  /// Of pushes that began or missed their bodies, up to the latest frame.
  const std::vector<Event>& pushEvents() const { return pushEvents_; }

 private:
  using Item = std::variant<Frame, Event, double, std::string>;  // the last two: s, warning
  struct Closed {};
  void run(const std::function<void(const SimulationSink&)>& simulate);
  void put(Item item);
  Item take();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::exception_ptr failure_;  // behind the items
  bool isClosed_ = false;
  std::vector<Event> pushEvents_;  // taken
  std::thread thread_;
};

}  // namespace cradle
