#include "simulate/welded_bodies.h"

namespace cradle {

WeldedBodies::WeldedBodies(const Scene& scene) : scene_(scene), sets_(scene.bodies.size() + 1) {
  for (const Weld& weld : scene.welds) sets_.join(placeOf(weld.anchorA.body), placeOf(weld.anchorB.body));
  sets_.flatten();
}

/// The place of a body, or of the world, in the disjoint sets.
int WeldedBodies::placeOf(int body) const {
  const bool isFixed = body == kWorld || scene_.bodies[static_cast<std::size_t>(body)].motion == Motion::fixed;
  return isFixed ? static_cast<int>(scene_.bodies.size()) : body;
}

}  // namespace cradle
