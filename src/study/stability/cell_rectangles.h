#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "study/stability/stability_map.h"

namespace cradle {

struct Range {
  double first = std::numeric_limits<double>::infinity(), last = -std::numeric_limits<double>::infinity();

  /// Numbers that are not finite are left out.
  void include(double value) {
    if (!std::isfinite(value)) return;
    first = std::min(first, value);
    last = std::max(last, value);
  }
};

bool hasCells(const StabilityMap& map);

/// Borders of the cells along an axis: one more than values, of which there must be two at the least.
std::vector<double> edgesOf(const Axis& axis);

/// Colours of cells that are numbers, in equal steps of the number or of its logarithm.
class ColorScale {
 public:
  explicit ColorScale(const StabilityMap& map);

  /// Of all numbers that have a colour.
  const Range& range() const { return range_; }

  /// The number that stands for all of its step; those beyond the scale belong to its ends.
  double levelOf(double number) const;

 private:
  double scaled(double number) const;

  bool isLogarithmic_;
  Range range_;
};

/// The cells of a panel as lines "left right bottom top colour" for gnuplot: the colour is a number of the scale, or of
/// an outcome's colour as red, green and blue.
std::string cellRectangles(const StabilityMap& map, const MapPanel& panel, const ColorScale& scale);

}  // namespace cradle
