#include "render/tile_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cradle {
namespace {

constexpr int kTile = 8;             // pixels
constexpr double kMargin = 2;        // pixels: samples lie beside the centres, and rounding
constexpr long kRectangleCost = 10;  // tiles: what drawing one more rectangle costs
constexpr int kMaxRectangles = 256;  // before they are merged: the merging is quadratic

using Point = Eigen::Vector2d;

double turn(const Point& a, const Point& b, const Point& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Corners of the convex hull, around it (A. M. Andrew's monotone chain, 1979).
std::vector<Point> hullOf(std::vector<Point> points) {
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  if (points.size() < 3) return points;
  std::vector<Point> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Point& point : points) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull.empty() ? std::vector<Point>{points.front()} : hull;
}

/// Grows [low, high] to the x of the part of an edge whose y is within [bottom, top].
void includeEdge(const Point& a, const Point& b, double bottom, double top, double& low, double& high) {
  const auto include = [&](double x) { low = std::min(low, x), high = std::max(high, x); };
  for (const Point* end : {&a, &b})
    if (end->y() >= bottom && end->y() <= top) include(end->x());
  for (const double y : {bottom, top})
    if ((a.y() < y) != (b.y() < y)) include(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
}

int clampedTile(double pixel, int tiles) {
  return static_cast<int>(std::clamp(std::floor(pixel / kTile), -1.0, static_cast<double>(tiles)));
}

/// In tiles, last included.
struct TileRectangle {
  int left, bottom, right, top;
  long area() const { return static_cast<long>(right - left + 1) * (top - bottom + 1); }
};

TileRectangle around(const TileRectangle& a, const TileRectangle& b) {
  return {std::min(a.left, b.left), std::min(a.bottom, b.bottom), std::max(a.right, b.right), std::max(a.top, b.top)};
}

/// What is saved by drawing one rectangle around both.
long saving(const TileRectangle& a, const TileRectangle& b) {
  return a.area() + b.area() + kRectangleCost - around(a, b).area();
}

/// Appends a run of a row, or lengthens a rectangle that ends in the row below where that costs less.
void appendRun(const TileRectangle& run, std::vector<TileRectangle>& found) {
  TileRectangle* best = nullptr;
  for (TileRectangle& other : found)
    if (other.top + 1 == run.bottom && saving(other, run) > (best ? saving(*best, run) : 0)) best = &other;
  if (best != nullptr)
    *best = around(*best, run);
  else
    found.push_back(run);
}

/// Merges the two that save most, while any do.
void merge(std::vector<TileRectangle>& found) {
  while (found.size() > 1) {
    long best = 0;
    std::size_t first = 0, second = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = i + 1; k < found.size(); ++k)
        if (const long gain = saving(found[i], found[k]); gain > best) best = gain, first = i, second = k;
    if (best == 0) return;
    found[first] = around(found[first], found[second]);
    found.erase(found.begin() + static_cast<std::ptrdiff_t>(second));
  }
}

}  // namespace

long TileSpans::count() const {
  long tiles = 0;
  for (const auto& [first, last] : rows) tiles += std::max(last - first + 1, 0);
  return tiles;
}

TileMask::TileMask(int width, int height)
    : width_(width),
      height_(height),
      columns_((width + kTile - 1) / kTile),
      rows_((height + kTile - 1) / kTile),
      isSet_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {}

TileSpans TileMask::spansOf(std::vector<Point> polygon) const {
  const std::vector<Point> hull = hullOf(std::move(polygon));
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Point& corner : hull) lowest = std::min(lowest, corner.y()), highest = std::max(highest, corner.y());
  TileSpans spans{std::max(clampedTile(lowest - kMargin, rows_), 0), {}};
  const int lastRow = std::min(clampedTile(highest + kMargin, rows_), rows_ - 1);
  for (int row = spans.firstRow; row <= lastRow; ++row) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const double bottom = kTile * row - kMargin, top = kTile * (row + 1) + kMargin;
    for (std::size_t i = 0; i < hull.size(); ++i)
      includeEdge(hull[i], hull[(i + 1) % hull.size()], bottom, top, low, high);
    if (low > high)
      spans.rows.emplace_back(0, -1);
    else
      spans.rows.emplace_back(std::max(clampedTile(low - kMargin, columns_), 0),
                              std::min(clampedTile(high + kMargin, columns_), columns_ - 1));
  }
  return spans;
}

TileSpans TileMask::spansInside(std::vector<Point> polygon) const {
  const std::vector<Point> hull = hullOf(std::move(polygon));
  TileSpans spans{0, {}};
  for (int row = 0; row < rows_; ++row) {
    double left = -std::numeric_limits<double>::infinity(), right = -left;
    for (const double y : {kTile * row - kMargin, kTile * (row + 1) + kMargin}) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t i = 0; i < hull.size(); ++i) includeEdge(hull[i], hull[(i + 1) % hull.size()], y, y, low, high);
      left = std::max(left, low), right = std::min(right, high);
    }
    if (left < right)
      spans.rows.emplace_back(std::max(clampedTile(left + kMargin, columns_) + 1, 0),
                              clampedTile(right - kMargin, columns_) - 1);
    else
      spans.rows.emplace_back(0, -1);
  }
  return spans;
}

void TileMask::add(const TileSpans& spans, const TileMask* except) {
  for (std::size_t i = 0; i < spans.rows.size(); ++i) {
    const std::ptrdiff_t first = (static_cast<std::ptrdiff_t>(i) + spans.firstRow) * columns_;
    char* const row = isSet_.data() + first;
    for (int column = spans.rows[i].first; column <= spans.rows[i].second; ++column) {
      if (except && except->isSet_[static_cast<std::size_t>(first + column)]) continue;
      count_ += !row[column];
      row[column] = 1;
    }
  }
}

void TileMask::addAll() {
  std::fill(isSet_.begin(), isSet_.end(), char{1});
  count_ = static_cast<long>(isSet_.size());
}

double TileMask::coverage() const {
  return static_cast<double>(count_) / static_cast<double>(isSet_.size());
}

std::vector<PixelRectangle> TileMask::rectangles() const {
  std::vector<TileRectangle> found;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const char* const tiles = isSet_.data() + static_cast<std::ptrdiff_t>(row) * columns_;
      if (!tiles[column]) continue;
      const int first = column;
      while (column + 1 < columns_ && tiles[column + 1]) ++column;
      appendRun({first, row, column, row}, found);
    }
  if (found.size() > kMaxRectangles) found = {{0, 0, columns_ - 1, rows_ - 1}};
  merge(found);
  std::vector<PixelRectangle> rectangles;
  for (const TileRectangle& tiles : found)
    rectangles.push_back({kTile * tiles.left, kTile * tiles.bottom, std::min(kTile * (tiles.right + 1), width_),
                          std::min(kTile * (tiles.top + 1), height_)});
  return rectangles;
}

TileSpans commonTiles(const TileSpans& a, const TileSpans& b) {
  const int first = std::max(a.firstRow, b.firstRow);
  const int end = std::min(a.firstRow + static_cast<int>(a.rows.size()), b.firstRow + static_cast<int>(b.rows.size()));
  TileSpans common{first, {}};
  for (int row = first; row < end; ++row) {
    const auto& inA = a.rows[static_cast<std::size_t>(row - a.firstRow)];
    const auto& inB = b.rows[static_cast<std::size_t>(row - b.firstRow)];
    common.rows.emplace_back(std::max(inA.first, inB.first), std::min(inA.second, inB.second));
  }
  return common;
}

}  // namespace cradle
