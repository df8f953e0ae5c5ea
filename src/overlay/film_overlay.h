#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "image/canvas.h"
#include "overlay/label_places.h"
#include "overlay/lens.h"
#include "overlay/overlay_choice.h"
#include "overlay/plot_panel.h"
#include "render/camera_path.h"
#include "render/framing.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// A film's trajectory as overlays need it.
struct FilmRecord {
  const Scene& scene;         // must outlive the overlay
  const View& view;           // for the constructor alone, like what follows but frameAt
  int width = 0, height = 0;  // pixels
  FrameSource frameAt;
  long frameCount = 0;
  std::vector<Event> events;                                              // in order of time
  std::function<std::vector<ContactWrench>(long frame)> contactsAt = {};  // for contacts alone
  std::optional<double> horizon = {};  // s: from there on the motion is one of many; none: not known, or never
};

/// Draws what was chosen on the finished pictures of a film. A picture depends on the film and the frame's number
/// alone, not on which frames are drawn before.
class FilmOverlay {
 public:
  /// Reads all frames once if the choice needs it (velocities, plot, of contacts only these), and later those that it
  /// has not drawn (trails, or a camera that follows): none at all in a film drawn in order. A plot goes to the corner
  /// where it hides the centres of mass of dynamic bodies the least often; it lies below the time where there is no
  /// room beside that.
  FilmOverlay(const FilmRecord& film, const OverlayChoice& choice);

  /// `image` is the picture of `frame`. O(bodies x length of their trails).
  void draw(const Frame& frame, Image& image);

  /// The panels that lie at the upper edge of pictures of that size.
  std::vector<PicturePart> upperPanels(int width, int height) const;

 private:
  struct LoadText {
    std::string text;
    double size;  // of the mark: the greatest are shown
    PicturePoint point;
    double opacity;
  };
  void readFilm(const FilmRecord& film);
  void addToPlot(const Frame& frame);
  void countHidden(const Frame& frame, const Lens& lens, std::array<long, 3>& hidden) const;
  void readTrail(long now);
  void drawTrails(const Frame& frame, const Lens& lens, Canvas& canvas);
  void drawVelocities(const Frame& frame, const Lens& lens, Canvas& canvas) const;
  void drawContacts(const Frame& frame, const Lens& lens, Canvas& canvas) const;
  void drawForces(const Frame& frame, const Lens& lens, Canvas& canvas, std::vector<LoadText>& texts) const;
  void drawImpacts(const Frame& frame, const Lens& lens, Canvas& canvas, std::vector<LoadText>& texts) const;
  static void drawLoadTexts(std::vector<LoadText> texts, Canvas& canvas);

  const Scene& scene_;
  const OverlayChoice choice_;
  const View view_;
  const FrameSource frameAt_;
  const std::function<std::vector<ContactWrench>(long frame)> contactsAt_;
  std::optional<double> horizon_;  // s
  FilmCamera camera_;
  std::vector<Event> impacts_;  // with an impulse, in order of time
  std::vector<int> movingBodies_;
  double arrowUnit_ = 1;        // m
  double greatestImpulse_ = 0;  // N s
  double greatestForce_ = 0;    // N, of a contact that lasts
  double greatestSpeed_ = 0;    // m/s
  int plottedBody_ = 0;
  double energyAtStart_ = 0;  // J
  PlotContent plot_;
  long trailStride_ = 1;           // frames from point to point of a trail
  std::deque<Frame> trailFrames_;  // with numbers that the stride divides, ascending
};

}  // namespace cradle
