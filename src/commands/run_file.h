#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scene/scene.h"
#include "simulate/world.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

/// The unfinished trajectory FILE.part of a run: begun, or gone on with from its checkpoint if it is of an ended run of
/// the same scene, with the same options and program.
class RunFile {
 public:
  /// Keeps a reference to `scene`; `world` is at its start, and only its plan is read. Throws as TrajectoryWriter does.
  RunFile(const std::string& output, const Scene& scene, const World& world, bool isStrict, bool isFresh);

  TrajectoryWriter& writer() { return *writer_; }

  /// Of all that the motion depends on, and of the program.
  std::string fingerprint() const;

  /// Says on stderr, if it goes on, from where; if it does not in spite of a checkpoint, why.
  void tellOfCheckpoint(const std::string& hint = "") const;

  /// Tells what there is up to the checkpoint, events before the frame of their instant. Returns the number of frames;
  /// 0 without a checkpoint. To be called once, before anything is written. Throws Error(interrupted), and what reading
  /// throws.
  long tellKept(const std::function<void(const Frame&)>& tellFrame, const std::function<void(const Event&)>& tellEvent);

  /// Of the checkpoint, for simulate(); empty without one.
  std::string record() const { return from_ ? from_->record : ""; }

 private:
  std::optional<Checkpoint> findCheckpoint();

  const std::string part_;
  const Scene& scene_;
  const TrajectoryHeader header_;
  const bool isStrict_;
  std::string refusal_;  // of what there is of an unfinished run; empty if nothing is refused
  std::optional<Checkpoint> from_;
  std::optional<TrajectoryReader> told_;
  std::optional<TrajectoryWriter> writer_;
};

}  // namespace cradle
