#pragma once

#include <array>
#include <optional>

#include "scene/read_fields.h"

namespace cradle {

constexpr double kMaxBodies = 1e6;

/// Where the copies of an entry of the scene file are: along the world's axes, or in a ring. Copy 0 is what the entry
/// says.
struct Copies {
  struct Ring {
    int count = 1;
    Vec3 center = Vec3::Zero();  // m, world
    Vec3 axis = Vec3::UnitY();   // unit, world
  };

  std::array<int, 3> count{1, 1, 1};
  Vec3 spacing = Vec3::Ones();  // m
  std::optional<Ring> ring;     // in place of those
  bool areAsked = false;        // by the entry; their names have numbers then

  /// How many there are: copy (ix, iy, iz) has the number (ix*ny + iy)*nz + iz.
  double total() const;
  std::array<int, 3> placeOf(int number) const;  // (ix, iy, iz)

  /// What takes copy 0 to copy `number`, in the world.
  RigidTransform move(int number) const;

  /// The number of the copy that is as far from copy `from` as copy `number` of `others` is from their first: as many
  /// places along each axis, or around the ring of as many. Nothing if there is none.
  std::optional<int> numberBeside(int from, const Copies& others, int number) const;
};

/// The key `copies` of a body or a link; one copy if there is none.
Copies parseCopies(ObjectReader& reader);

}  // namespace cradle
