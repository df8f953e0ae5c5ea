#pragma once

#include <array>
#include <vector>

#include "math/types.h"

namespace cradle {

/// Place of a cell along the three axes, from the grid's origin.
using Cell = std::array<long, 3>;

/// Spheres by the cell of a uniform grid that their centres are in, so that a sphere meets only spheres of its own cell
/// and of the 26 around it. Cells that are `counts` apart along an axis share one list: space is unbounded and memory
/// is not. A few spheres share one cell without end.
class SphereCells {
 public:
  SphereCells() = default;

  /// A grid for spheres at `centers` (m) of at most that radius, with about one sphere in a cell of it now; `fixed`
  /// things are to be added.
  SphereCells(const std::vector<Vec3>& centers, double largestRadius, std::size_t fixed);

  /// Whether cells end at all, and their size (m) if they do.
  bool isBounded() const { return size_ > 0; }
  double size() const { return size_; }

  const Cell& cellOf(int sphere) const { return cells_[static_cast<std::size_t>(sphere)]; }

  /// Lower side of a cell, or of the next one for `cell + 1`, along an axis (m, world).
  double sideOf(long cell, int axis) const { return origin_[axis] + static_cast<double>(cell) * size_; }

  /// Moves a sphere to the next cell along an axis; `step` is 1 or -1. O(1).
  void move(int sphere, int axis, int step);

  /// Calls visit(other) for the spheres, itself included, that a sphere may meet before it leaves its cell or they
  /// theirs.
  template <class Visit>
  void visitNear(int sphere, const Visit& visit) const;

  /// The same for those in cells that became near when the sphere last moved along `axis` by `step`.
  template <class Visit>
  void visitAhead(int sphere, int axis, int step, const Visit& visit) const;

  /// Something fixed that spheres with their centres in `bounds` (m) may touch.
  void addFixed(int fixed, const Bounds& bounds);

  /// The fixed things that a sphere may touch before it leaves its cell.
  const std::vector<int>& fixedNear(int sphere) const { return fixed_[listOf(cellOf(sphere))]; }

 private:
  std::size_t wrapped(long place, std::size_t axis) const {
    return static_cast<std::size_t>(place & (counts_[axis] - 1));
  }
  /// Where the lists of the cells along z begin.
  std::size_t rowOf(long x, long y) const {
    return (wrapped(x, 0) * static_cast<std::size_t>(counts_[1]) + wrapped(y, 1)) *
           static_cast<std::size_t>(counts_[2]);
  }
  std::size_t listOf(const Cell& cell) const { return rowOf(cell[0], cell[1]) + wrapped(cell[2], 2); }
  Cell cellAt(const Vec3& center) const;
  void insert(int sphere);
  template <class Visit>
  void visitList(std::size_t list, const Visit& visit) const;

  double size_ = 0;                         // m; 0: one cell without end
  Vec3 origin_ = Vec3::Zero();              // m
  Cell counts_ = {1, 1, 1};                 // powers of two
  std::vector<Cell> cells_;                 // by sphere
  std::vector<int> first_, next_, before_;  // first sphere by list; its neighbours by sphere; or kNoSphere
  std::vector<std::vector<int>> fixed_;     // by list
};

template <class Visit>
void SphereCells::visitList(std::size_t list, const Visit& visit) const {
  for (int sphere = first_[list]; sphere >= 0; sphere = next_[static_cast<std::size_t>(sphere)]) visit(sphere);
}

template <class Visit>
void SphereCells::visitNear(int sphere, const Visit& visit) const {
  const Cell& cell = cellOf(sphere);
  if (!isBounded()) return visitList(0, visit);
  for (long x = cell[0] - 1; x <= cell[0] + 1; ++x)
    for (long y = cell[1] - 1; y <= cell[1] + 1; ++y) {
      const std::size_t row = rowOf(x, y);
      for (long z = cell[2] - 1; z <= cell[2] + 1; ++z) visitList(row + wrapped(z, 2), visit);
    }
}

template <class Visit>
void SphereCells::visitAhead(int sphere, int axis, int step, const Visit& visit) const {
  const Cell& cell = cellOf(sphere);
  Cell from = {cell[0] - 1, cell[1] - 1, cell[2] - 1}, to = {cell[0] + 1, cell[1] + 1, cell[2] + 1};
  const auto along = static_cast<std::size_t>(axis);
  from[along] = to[along] = cell[along] + step;
  for (long x = from[0]; x <= to[0]; ++x)
    for (long y = from[1]; y <= to[1]; ++y)
      for (long z = from[2]; z <= to[2]; ++z) visitList(rowOf(x, y) + wrapped(z, 2), visit);
}

}  // namespace cradle
