#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "commands/film_view.h"
#include "commands/trajectory_source.h"
#include "truth/passes.h"
#include "truth/truth_json.h"

namespace cradle {

/// A file that is to be written: its name in its folder, and what is in it.
struct FileBytes {
  std::string name, bytes;
};

/// Ground truth of a film: what its pixels show, as files.
class TruthFilm {
 public:
  /// `source` is simulated, and must outlive this object. Throws Error(limit) for more bodies than segmentations can
  /// tell apart, and what finding the cameras throws. O(frames x bodies).
  TruthFilm(TrajectorySource& source, const View& view, int width, int height, const std::vector<Pass>& passes);

  /// Of the passes that were asked for but rgb, and instances_NUMBER.json.
  std::vector<FileBytes> filesOf(long frame);

  /// camera.json and events.json, of the whole film.
  std::vector<FileBytes> filesOfFilm() const;

 private:
  bool has(Pass pass) const;
  bool isThere(long frame) const { return frame >= 0 && frame < source_.frameCount(); }
  FrameRays& raysOf(long frame);
  Pinhole inSceneWorld(long frame) const;

  TrajectorySource& source_;
  int width_, height_;
  std::vector<Pass> passes_;
  SurfaceSource surfaces_;
  std::vector<Camera> cameras_;                        // of all frames, in the drawn world
  std::map<long, std::unique_ptr<FrameRays>> nearby_;  // frames from one before the latest to one behind it
};

}  // namespace cradle
