#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "film/film_source.h"
#include "film/film_view.h"
#include "truth/pass_files.h"
#include "truth/passes.h"
#include "truth/truth_json.h"

namespace cradle {

/// A file that is to be written: its name in its folder, and what is in it.
struct FileBytes {
  std::string name, bytes;
};

/// A NumPy file of each pass, or an OpenEXR file with a layer of each.
enum class PassFormat { npy, exr };

/// Ground truth of a film: what its pixels show, as files.
class TruthFilm {
 public:
  /// `motion` is simulated, or beside this object, and must outlive it. Throws Error(limit) for more bodies than passes
  /// can tell apart.
  TruthFilm(FilmSource& motion, const View& view, int width, int height, const std::vector<Pass>& passes,
            PassFormat format = PassFormat::npy);

  /// What is seen in a frame, in the drawn world. Throws as finding its camera does. It goes when a frame that is not
  /// beside it is asked for by filesOf().
  FrameRays& raysOf(long frame);

  /// Of the passes that were asked for but rgb, and instances_NUMBER.json.
  std::vector<FileBytes> filesOf(long frame);

  /// camera.json and events.json, of the whole film.
  std::vector<FileBytes> filesOfFilm();

 private:
  bool has(Pass pass) const;
  std::vector<PassArray> passesOf(long frame, std::vector<std::uint16_t> segmentation);
  bool isThere(long frame) const { return frame >= 0 && frame < motion_.frameCount(); }
  const Camera& cameraAt(long frame);
  Pinhole inSceneWorld(long frame);

  FilmSource& motion_;
  int width_, height_;
  std::vector<Pass> passes_;
  PassFormat format_;
  SurfaceSource surfaces_;
  FilmCamera camera_;
  std::vector<Camera> cameras_;                        // of frames so far, in the drawn world
  std::map<long, std::unique_ptr<FrameRays>> nearby_;  // frames from one before the latest to one behind it
};

}  // namespace cradle
