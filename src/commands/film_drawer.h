#pragma once

#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands/film_view.h"
#include "commands/frame_folder.h"
#include "commands/pictures.h"
#include "commands/trajectory_source.h"
#include "core/interruption.h"
#include "core/progress.h"
#include "image/image.h"
#include "overlay/film_overlay.h"
#include "render/renderer.h"

namespace cradle {

/// What the command line says of pictures. Whatever is wrong with it shows before anything is simulated.
struct PictureOrder {
  /// Throws Error(usage), Error(limit) where there is too little memory to draw, or Error(scene) where words do not fit
  /// into pictures of that size.
  PictureOrder(const PictureOptions& options, const Scene& scene);

  PictureSize size;
  std::string shaders;
  std::optional<OverlayChoice> overlays;
};

/// What draws the frames of a film: whatever is wrong with its shaders, and with its camera as far as its way is known,
/// shows before a picture is made.
class FilmDrawer {
 public:
  /// `trajectory` must outlive this object. Without a `view`, that of the film.
  FilmDrawer(TrajectorySource& trajectory, const PictureOrder& order, const std::optional<View>& view = {});

  /// The picture of a frame. Frames before are not to be asked for again.
  Image draw(long number);

 private:
  TrajectorySource& source_;
  View view_;
  FilmCamera camera_;
  Renderer renderer_;
  std::optional<FilmOverlay> overlay_;
};

/// All frames of a range.
std::vector<long> framesIn(const FrameRange& range);

/// Draws frames in ascending order, and hands on what draw(frame) gives, to take(frame, drawn), in a thread beside the
/// drawing of the next one.
template <class Draw, class Take>
void drawFrames(const std::vector<long>& frames, Progress& progress, const Draw& draw, const Take& take) {
  std::future<void> taken;
  long done = 0;
  for (const long frame : frames) {
    throwIfInterrupted();
    auto drawn = draw(frame);
    if (taken.valid()) taken.get();
    taken = std::async(std::launch::async, [&take, frame, drawn = std::move(drawn)] { take(frame, drawn); });
    progress.update(++done);
  }
  if (taken.valid()) taken.get();
}

}  // namespace cradle
