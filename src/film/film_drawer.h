#pragma once

#include <optional>
#include <string>

#include "film/film_source.h"
#include "film/film_view.h"
#include "image/image.h"
#include "overlay/film_overlay.h"
#include "render/renderer.h"

namespace cradle {

/// How the pictures of a film are drawn.
struct PictureOrder {
  PictureSize size;
  std::string shaders = {};                    // folder; empty: those that are built in
  std::optional<OverlayChoice> overlays = {};  // fits the scene
};

/// What draws the frames of a film: whatever is wrong with its shaders, and with its camera as far as its way is known,
/// shows before a picture is made.
class FilmDrawer {
 public:
  /// `motion` must outlive this object. Without a `view`, that of the film. Throws what Renderer throws, and reading.
  FilmDrawer(FilmSource& motion, const PictureOrder& order, const std::optional<View>& view = {});

  /// The picture of a frame. Of a motion that is being simulated, frames before are not to be asked for again.
  Image draw(long number);

 private:
  FilmSource& motion_;
  View view_;
  FilmCamera camera_;
  Renderer renderer_;
  std::optional<FilmOverlay> overlay_;
};

}  // namespace cradle
