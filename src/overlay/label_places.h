#pragma once

#include <vector>

#include "image/canvas.h"

namespace cradle {

/// A part of a picture (pixels).
struct PicturePart {
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// Where labels may be: in a part of a picture, below panels at its upper edge.
struct LabelRoom : PicturePart {
  std::vector<PicturePart> panels = {};
};

/// A rectangle with the name of something, and the place of that (pixels).
struct Label {
  PicturePoint place;
  double width = 0, height = 0;
  double left = 0, top = 0;
};

/// Moves labels up or down, from where they are, until none lies on another; false, and they are where they were, if
/// they do not fit into the height of the room. Small motions of labels and places move them by little, unless two that
/// are above each other change their order. O(labels^2).
bool stackLabels(const LabelRoom& room, double gap, std::vector<Label>& labels);

/// Puts labels in rows from the top of the room down, `gap` apart, in their order; returns the height of all rows.
double putInRows(const LabelRoom& room, double gap, std::vector<Label>& labels);

}  // namespace cradle
