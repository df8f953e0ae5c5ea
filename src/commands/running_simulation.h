#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// A simulation in a thread of its own, into a trajectory file that can be read meanwhile: what is not yet drawn waits
/// on the disk, so that memory is bounded and nobody waits for who is slower.
class RunningSimulation {
 public:
  /// Starts it. Throws as TrajectoryWriter does.
  RunningSimulation(Scene scene, const std::string& path);
  /// Ends it, after the frame under way at the latest.
  ~RunningSimulation();
  RunningSimulation(const RunningSimulation&) = delete;
  RunningSimulation& operator=(const RunningSimulation&) = delete;

  /// Waits until more than `frames` frames can be read, or until the end, and says how many there are. Throws as
  /// throwIfFailed() does.
  long waitForMore(long frames);

  /// Throws what has ended the simulation before its time, if anything has.
  void throwIfFailed();

  /// Whether it has come to its end, and all frames are in the file.
  bool isFinished();

  /// Of the file; knows new frames when it is told to read them.
  TrajectoryReader& reader() { return reader_; }

  /// Warnings since the last call.
  std::vector<std::string> takeWarnings();

 private:
  struct Unwanted {};  // thrown through the simulation by its own sink
  void run();
  void simulateIntoFile();
  void publish();

  const Scene scene_;
  TrajectoryWriter writer_;  // of the thread, while that runs
  TrajectoryReader reader_;  // opened before the file gets its name
  std::atomic<bool> isUnwanted_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  long readable_ = 0;  // frames; like what follows, under the mutex
  bool hasEnded_ = false;
  std::exception_ptr failure_;
  std::vector<std::string> warnings_;
  std::thread thread_;
};

}  // namespace cradle
