#include "render/same_items.h"

#include "render/instances.h"

namespace cradle {
namespace {

template <typename Item>
bool haveSameNumbers(const Item& a, const Item& b, const Stage& stage) {
  Instance first = instanceOf(a, stage), second = instanceOf(b, stage);
  for (const std::size_t number : kNearBallNumbers) first[number] = second[number] = 0;
  return first == second;
}

}  // namespace

bool isSame(const MeshItem& a, const MeshItem& b, const Stage& stage) {
  return a.mesh == b.mesh && a.firstTriangle == b.firstTriangle && a.triangleCount == b.triangleCount &&
         haveSameNumbers(a, b, stage);
}

bool isSame(const SphereItem& a, const SphereItem& b, const Stage& stage) {
  return outlineLevel(a, stage) == outlineLevel(b, stage) && haveSameNumbers(a, b, stage);
}

bool isSame(const CylinderItem& a, const CylinderItem& b, const Stage& stage) {
  return outlineLevel(a, stage) == outlineLevel(b, stage) && haveSameNumbers(a, b, stage);
}

bool isSame(const TubeItem& a, const TubeItem& b, const Stage& stage) {
  return haveSameNumbers(a, b, stage);
}

bool isSame(const NeighbourItem& a, const NeighbourItem& b, const Stage& stage) {
  return numbersOf(a, stage) == numbersOf(b, stage);
}

bool isSame(const ContactItem& a, const ContactItem& b, const Stage& stage) {
  const auto first = darkenedSquare(a, stage), second = darkenedSquare(b, stage);
  if (!first || !second) return !first && !second;
  return instanceOf(a, *first, stage) == instanceOf(b, *second, stage);
}

}  // namespace cradle
