// Sweep and prune along x (D. Baraff, 1992) in cells across it: of a block of bodies, those at one x alone would be
// compared with each other all. Spheres of like sizes share a grid (hierarchical grid: C. Ericson, "Real-Time Collision
// Detection", 2005, 7.2), whose cells are so wide that a sphere overlaps others of its own cell and of the eight around
// it only.

#include "simulate/plan/near_spheres.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "core/interruption.h"

namespace cradle {
namespace {

constexpr double kSphereRounding = 1e-14;  // relative, of sums of three numbers
constexpr double kFarthestCell = 1e9;      // from the middle: spheres farther away share the outermost cells
constexpr int kWidestExponent = 1000;      // of a radius, 2^1000 m: what is larger is everywhere, in one cell

/// A sphere in a grid: its cell across, and what it takes of x.
struct CellEntry {
  std::int64_t row, column;
  double from, to;  // m
  std::size_t sphere;

  bool operator<(const CellEntry& other) const {
    return std::tie(row, column, from, sphere) < std::tie(other.row, other.column, other.from, other.sphere);
  }
};

/// Spheres of like sizes, sorted.
struct SizeGrid {
  double width = 0;  // m, of a cell: more than twice the radius of its spheres
  std::vector<CellEntry> entries;
};

double roundedRadius(const Reach& sphere) {
  return sphere.radius * (1 + kSphereRounding) + kSphereRounding * sphere.center.cwiseAbs().maxCoeff();
}

std::int64_t cellAt(double place, double width) {
  return static_cast<std::int64_t>(std::floor(std::clamp(place / width, -kFarthestCell, kFarthestCell)));
}

CellEntry entryOf(const std::vector<Reach>& spheres, std::size_t index, double width) {
  const Vec3& center = spheres[index].center;
  const double radius = roundedRadius(spheres[index]);
  return {cellAt(center.y(), width), cellAt(center.z(), width), center.x() - radius, center.x() + radius, index};
}

/// From the narrowest cells to the widest.
std::vector<SizeGrid> gridsOf(const std::vector<Reach>& spheres) {
  std::map<int, SizeGrid> bySize;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    int exponent = kWidestExponent;  // radius < 2^exponent
    if (const double radius = roundedRadius(spheres[i]); radius < std::ldexp(1.0, kWidestExponent))
      std::frexp(radius, &exponent);
    SizeGrid& grid = bySize[exponent];
    grid.width = exponent == kWidestExponent ? INFINITY : std::ldexp(2.0, exponent);
    grid.entries.push_back(entryOf(spheres, i, grid.width));
  }
  std::vector<SizeGrid> grids;
  for (auto& [exponent, grid] : bySize) {
    std::sort(grid.entries.begin(), grid.entries.end());
    grids.push_back(std::move(grid));
  }
  return grids;
}

/// Visits what a sphere overlaps of a grid of its own size or larger; in its own grid what comes after it. False if a
/// visit returned false.
bool visitNear(const CellEntry& own, const CellEntry& inGrid, const SizeGrid& grid, bool isOwnGrid,
               const std::function<bool(std::size_t, std::size_t)>& visit) {
  for (std::int64_t row = inGrid.row - !isOwnGrid; row <= inGrid.row + 1; ++row)
    for (std::int64_t column = inGrid.column - 1; column <= inGrid.column + 1; ++column) {
      const CellEntry first{row, column, own.from - grid.width, 0, 0};
      for (auto other = std::lower_bound(grid.entries.begin(), grid.entries.end(), first);
           other != grid.entries.end() && other->row == row && other->column == column && other->from <= own.to;
           ++other)
        if (other->to >= own.from && (!isOwnGrid || own < *other) && !visit(own.sphere, other->sphere)) return false;
    }
  return true;
}

}  // namespace

void forEachNearPair(const std::vector<Reach>& spheres, const std::function<bool(std::size_t, std::size_t)>& visit) {
  const std::vector<SizeGrid> grids = gridsOf(spheres);
  for (auto own = grids.begin(); own != grids.end(); ++own)
    for (const CellEntry& entry : own->entries) {
      throwIfInterrupted();
      for (auto other = own; other != grids.end(); ++other)
        if (!visitNear(entry, entryOf(spheres, entry.sphere, other->width), *other, own == other, visit)) return;
    }
}

}  // namespace cradle
