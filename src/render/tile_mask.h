#pragma once

#include <utility>
#include <vector>

#include "math/types.h"
#include "render/pixel_rectangle.h"

namespace cradle {

/// Tiles of 8 x 8 pixels that a convex polygon meets, with a pixel around it: in row `firstRow` + i from tile first to
/// tile last, both included; none where last < first.
struct TileSpans {
  int firstRow = 0;
  std::vector<std::pair<int, int>> rows;
  long count() const;
};

/// A part of a picture, in tiles that OpenGL's groups of pixels do not straddle: derivatives inside it are the same
/// whether its surroundings are drawn or not.
class TileMask {
 public:
  /// Empty; sizes in pixels.
  TileMask(int width, int height);

  /// `polygon` is convex, in pixels from the lower left corner, at least one point in any order. O(points log points).
  TileSpans spansOf(std::vector<Eigen::Vector2d> polygon) const;
  /// Those that lie wholly in it, with a pixel around each.
  TileSpans spansInside(std::vector<Eigen::Vector2d> polygon) const;
  /// But for tiles of `except`, a mask of the same size.
  void add(const TileSpans& spans, const TileMask* except = nullptr);
  void addAll();

  bool isEmpty() const { return count_ == 0; }
  /// Share of the picture's tiles.
  double coverage() const;

  /// Few rectangles that cover the tiles, and some beside them where one rectangle costs less than two.
  std::vector<PixelRectangle> rectangles() const;

 private:
  int width_, height_, columns_, rows_;
  std::vector<char> isSet_;  // by row, then column
  long count_ = 0;
};

/// What two polygons' tiles have in common.
TileSpans commonTiles(const TileSpans& a, const TileSpans& b);

}  // namespace cradle
