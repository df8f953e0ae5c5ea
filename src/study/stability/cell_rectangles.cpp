// Cells are rectangles of their own, since gnuplot's images need axes with equal steps; neighbours of one colour in a
// row are one rectangle, or files would have megabytes.

#include "study/stability/cell_rectangles.h"

#include <fmt/format.h>

#include <cstdlib>

#include "core/error.h"

namespace cradle {
namespace {

constexpr int kColorLevels = 64;  // of cells that are numbers
constexpr double kOverlap = 0.3;  // of the next cell, that a rectangle reaches into it: no gaps show between them

double between(const Axis& axis, double a, double b) {
  return axis.quantity.isLogarithmic ? std::sqrt(a * b) : (a + b) / 2;
}

/// The value as far from a as that is from b, on the other side.
double mirrored(const Axis& axis, double a, double b) {
  return axis.quantity.isLogarithmic ? a * a / b : 2 * a - b;
}

long colorNumber(const std::string& color) {
  return std::strtol(color.c_str() + 1, nullptr, 16);
}

}  // namespace

bool hasCells(const StabilityMap& map) {
  return std::any_of(map.panels.begin(), map.panels.end(), [](const MapPanel& panel) { return !panel.cells.empty(); });
}

std::vector<double> edgesOf(const Axis& axis) {
  const std::vector<double>& values = axis.values;
  CRADLE_CHECK(values.size() >= 2);
  std::vector<double> edges;
  for (std::size_t i = 1; i < values.size(); ++i) edges.push_back(between(axis, values[i - 1], values[i]));
  edges.insert(edges.begin(), mirrored(axis, values.front(), edges.front()));
  edges.push_back(mirrored(axis, values.back(), edges.back()));
  return edges;
}

ColorScale::ColorScale(const StabilityMap& map) : isLogarithmic_(map.cell.isLogarithmic) {
  for (const MapPanel& panel : map.panels)
    for (const double cell : panel.cells)
      if (!isLogarithmic_ || cell > 0) range_.include(cell);
}

double ColorScale::levelOf(double number) const {
  if (!(range_.first < range_.last)) return range_.first;
  const double inside = std::clamp(number, range_.first, range_.last);
  const double part = (scaled(inside) - scaled(range_.first)) / (scaled(range_.last) - scaled(range_.first));
  const double level = std::round(part * kColorLevels) / kColorLevels;
  const double value = scaled(range_.first) + level * (scaled(range_.last) - scaled(range_.first));
  return isLogarithmic_ ? std::pow(10, value) : value;
}

double ColorScale::scaled(double number) const {
  return isLogarithmic_ ? std::log10(number) : number;
}

std::string cellRectangles(const StabilityMap& map, const MapPanel& panel, const ColorScale& scale) {
  const std::vector<double> xs = edgesOf(map.x), ys = edgesOf(map.y);
  const std::size_t columns = map.x.values.size(), rows = map.y.values.size();
  CRADLE_CHECK(panel.cells.size() == columns * rows);
  const auto colorOf = [&](std::size_t row, std::size_t column) {
    const double cell = panel.cells[row * columns + column];
    if (std::isnan(cell) || map.outcomes.empty()) return std::isnan(cell) ? cell : scale.levelOf(cell);
    return static_cast<double>(colorNumber(map.outcomes.at(static_cast<std::size_t>(cell)).color));
  };
  const auto beyond = [](const std::vector<double>& edges, std::size_t end, bool isOverdrawn) {
    return isOverdrawn ? edges[end] + kOverlap * (edges[end + 1] - edges[end]) : edges[end];
  };
  std::string text;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t first = 0, end = 0; first < columns; first = end) {
      const double color = colorOf(row, first);
      for (end = first + 1; end < columns && colorOf(row, end) == color;) ++end;
      if (std::isnan(color)) continue;
      bool isBelowCells = row + 1 < rows;
      for (std::size_t i = first; i < end && isBelowCells; ++i) isBelowCells = !std::isnan(colorOf(row + 1, i));
      const bool isBeforeCell = end < columns && !std::isnan(colorOf(row, end));
      text += fmt::format("{} {} {} {} {}\n", xs[first], beyond(xs, end, isBeforeCell), ys[row],
                          beyond(ys, row + 1, isBelowCells), color);
    }
  }
  return text;
}

}  // namespace cradle
