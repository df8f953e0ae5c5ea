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

RigidTransform Copies::move(int number) const {
  if (!ring) {
    const int iz = number % count[2], iy = number / count[2] % count[1], ix = number / (count[1] * count[2]);
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
