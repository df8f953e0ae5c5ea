// Labels keep their column: one that is moved sideways would stand at what belongs to another. In a column, the label
// of what is lower in the picture is lower. Of things that are as high, the label of the right one is lower: lines from
// there to labels above it pass none of the labels, which reach to the right.

#include "overlay/label_places.h"

#include <algorithm>
#include <numeric>

namespace cradle {
namespace {

constexpr double kSlope = 0.5;  // how far to the right counts as much as down: things in a row keep their order

/// Indices of labels, the lowest in a stack first.
std::vector<std::size_t> orderOf(const std::vector<Label>& labels) {
  std::vector<std::size_t> order(labels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto depth = [&](std::size_t i) { return labels[i].place.y + kSlope * labels[i].place.x; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth(a) > depth(b); });
  return order;
}

/// 1 where a label is above or below a part of the picture, and 0 where it is farther aside than it is high: labels
/// that come together make way for each other before they meet.
double nearness(const Label& label, double left, double right) {
  const double aside = std::max(label.left, left) - std::min(label.left + label.width, right);
  return std::clamp(1 - aside / label.height, 0.0, 1.0);
}

double nearness(const Label& label, const Label& other) {
  return nearness(label, other.left, other.left + other.width);
}

/// The highest that a label may be.
double ceilingOf(const Label& label, const LabelRoom& room, double gap) {
  double ceiling = room.top;
  for (const PicturePart& panel : room.panels) {
    const double fall = panel.bottom + gap - room.top;
    ceiling = std::max(ceiling, room.top + nearness(label, panel.left, panel.right) * fall);
  }
  return ceiling;
}

}  // namespace

bool stackLabels(const LabelRoom& room, double gap, std::vector<Label>& labels) {
  const std::vector<Label> wanted = labels;
  const std::vector<std::size_t> order = orderOf(labels);
  // Each upwards, over those below it.
  for (std::size_t k = 0; k < order.size(); ++k) {
    Label& label = labels[order[k]];
    const double start = label.top;
    for (std::size_t i = 0; i < k; ++i) {
      const Label& below = labels[order[i]];
      const double rise = start - (below.top - gap - label.height);
      if (rise > 0) label.top = std::min(label.top, start - nearness(label, below) * rise);
    }
  }
  // What does not fit below the upper edge comes down again, and what is below it with it.
  for (std::size_t k = order.size(); k-- > 0;) {
    Label& label = labels[order[k]];
    const double start = std::max(label.top, ceilingOf(label, room, gap));
    label.top = start;
    for (std::size_t i = k + 1; i < order.size(); ++i) {
      const Label& above = labels[order[i]];
      const double fall = above.top + above.height + gap - start;
      if (fall > 0) label.top = std::max(label.top, start + nearness(label, above) * fall);
    }
  }
  const bool isInRoom = std::all_of(labels.begin(), labels.end(),
                                    [&](const Label& label) { return label.top + label.height <= room.bottom; });
  if (!isInRoom) labels = wanted;
  return isInRoom;
}

double putInRows(const LabelRoom& room, double gap, std::vector<Label>& labels) {
  double left = room.left, top = room.top, rowHeight = 0;
  for (Label& label : labels) {
    if (left > room.left && left + label.width > room.right) {
      top += rowHeight + gap;
      left = room.left, rowHeight = 0;
    }
    label.left = left, label.top = top;
    left += label.width + gap;
    rowHeight = std::max(rowHeight, label.height);
  }
  return top + rowHeight - room.top;
}

}  // namespace cradle
