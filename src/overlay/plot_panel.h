#pragma once

#include <string>
#include <vector>

#include "image/canvas.h"

namespace cradle {

/// A number over time, one value a frame.
struct PlotCurve {
  std::string name;
  std::vector<double> values;
  Ink ink;
};

/// Where a plot lies in a picture; the upper left corner is that of the time.
enum class PlotCorner { upperRight, lowerRight, lowerLeft };

/// What a plot shows; all curves have as many values as there are times.
struct PlotContent {
  std::string title;          // with the unit
  std::vector<double> times;  // s, ascending, at least one
  std::vector<PlotCurve> curves;
  PlotCorner corner = PlotCorner::upperRight;
  double upperEdge = 0;  // pixels: no part of the plot lies above
};

/// The rectangle of a plot's curves in a picture, and what its sides stand for.
struct PlotArea {
  double left = 0, top = 0, right = 0, bottom = 0;                        // pixels
  double firstTime = 0, lastTime = 1, lowestValue = 0, highestValue = 1;  // at those sides

  PicturePoint at(double time, double value) const;
};

/// The upper left and the lower right end of a plot and what belongs to it (pixels), below `upperEdge`.
std::pair<PicturePoint, PicturePoint> plotPanelAt(PlotCorner corner, double upperEdge, int width, int height);

/// Where the curves of `content` lie in a picture: the same in all frames of a film.
PlotArea plotAreaOf(const PlotContent& content, int width, int height);

/// Draws the plot with its curves up to the time with index `now`, and a dot on each there.
void drawPlot(Canvas& canvas, const PlotContent& content, std::size_t now);

/// About `wanted` round numbers (1, 2 or 5 times a power of ten apart), ascending, from `low` to `high`; at most
/// twice as many and one, and none where the range is not above the rounding of its ends.
std::vector<double> roundNumbers(double low, double high, int wanted);

}  // namespace cradle
