#pragma once

#include <vector>

namespace cradle {

/// Columns and rows of pixels, first included, last not; rows from the bottom, as OpenGL counts.
struct PixelRectangle {
  int left = 0, bottom = 0, right = 0, top = 0;
  int width() const { return right - left; }
  int height() const { return top - bottom; }
  bool isEmpty() const { return width() <= 0 || height() <= 0; }
};

/// The least rectangle that holds both; an empty one holds nothing.
PixelRectangle joined(const PixelRectangle& a, const PixelRectangle& b);

/// What both hold; empty if that is nothing.
PixelRectangle common(const PixelRectangle& a, const PixelRectangle& b);

/// Rectangles in groups in which no two have an edge or a corner in common, each in the first group that it fits into.
std::vector<std::vector<PixelRectangle>> groupsApart(const std::vector<PixelRectangle>& rectangles);

}  // namespace cradle
