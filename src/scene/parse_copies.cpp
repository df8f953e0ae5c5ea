#include "scene/parse_copies.h"

#include <numbers>

#include "math/rotation.h"

namespace cradle {
namespace {

Copies::Ring parseRing(const Field& field, FaultList& faults) {
  Copies::Ring ring;
  ObjectReader reader(field, faults);
  reader.require("count");
  ring.count = reader.integer("count", 1, static_cast<int>(kMaxBodies), 1);
  ring.center = reader.vector("center", kCoordinates, "m", ring.center);
  ring.axis = reader.direction("axis", ring.axis);
  reader.rejectUnknownKeys();
  return ring;
}

}  // namespace

double Copies::total() const {
  return ring ? ring->count : double(count[0]) * double(count[1]) * double(count[2]);
}

std::array<int, 3> Copies::placeOf(int number) const {
  return {number / (count[1] * count[2]), number / count[2] % count[1], number % count[2]};
}

std::optional<int> Copies::numberBeside(int from, const Copies& others, int number) const {
  if (ring.has_value() != others.ring.has_value()) return std::nullopt;
  if (ring) return ring->count == others.ring->count ? std::optional((from + number) % ring->count) : std::nullopt;
  const std::array<int, 3> start = placeOf(from), step = others.placeOf(number);
  int beside = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int place = start[axis] + step[axis];
    if (place >= count[axis]) return std::nullopt;
    beside = beside * count[axis] + place;
  }
  return beside;
}

RigidTransform Copies::move(int number) const {
  if (!ring) {
    const auto [ix, iy, iz] = placeOf(number);
    return {Quat::Identity(), spacing.cwiseProduct(Vec3(ix, iy, iz))};
  }
  const Quat turn = rotationAbout(ring->axis, 2 * std::numbers::pi * number / ring->count);
  return {turn, ring->center - turn * ring->center};
}

Copies parseCopies(ObjectReader& owner) {
  Copies copies;
  const auto field = owner.find("copies");
  if (!field) return copies;
  copies.areAsked = true;
  FaultList& faults = owner.faults();
  ObjectReader reader(*field, faults);
  const auto count = reader.find("count"), spacing = reader.find("spacing"), ring = reader.find("ring");
  if (count) {
    const std::vector<Field> items = readItems(*count, 3, faults);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Range counts{1, kMaxBodies, false, true};
      copies.count[i] = static_cast<int>(readNumber(items[i], counts, "", faults).value_or(1));
    }
  }
  copies.spacing = reader.vector("spacing", kCoordinates, "m", copies.spacing);
  if (ring) copies.ring = parseRing(*ring, faults);
  if (ring && (count || spacing))
    addFault(faults, *ring, "copies are in a ring, or along the axes by count and spacing; allowed is one of them");
  reader.rejectUnknownKeys();
  return copies;
}

}  // namespace cradle
