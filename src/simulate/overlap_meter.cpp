#include "simulate/overlap_meter.h"

#include <algorithm>

namespace cradle {

const std::vector<Contact>& OverlapMeter::overlapsOf(const VectorX& state) {
  broadPhase_.update(state, std::vector<double>(assembly_.mechanism.bodies.size(), 0.0), 0, geometry_);
  findContacts(geometry_, state, 0, overlaps_);
  return overlaps_;
}

std::pair<int, int> OverlapMeter::bodiesOf(const Contact& contact) const {
  return cradle::bodiesOf(assembly_, geometry_.pairs[contact.pair]);
}

double OverlapMeter::halfExtent(const Contact& contact) const {
  const ColliderPair& pair = geometry_.pairs[contact.pair];
  double least = INFINITY;
  const auto consider = [&](const Collider& collider) {
    if (collider.body != kFixed) least = std::min(least, collider.bounds.sizes().minCoeff() / 2);
  };
  consider(geometry_.colliders[pair.a]);
  if (!pair.againstPlane) consider(geometry_.colliders[pair.b]);
  return least;
}

VectorX stateOf(const Assembly& assembly, const Frame& frame) {
  VectorX state = assembly.state;
  for (std::size_t i = 0; i < frame.states.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    centerOfMass(state, body) = frame.states[i].position;
    setOrientation(state, body, frame.states[i].orientation);
  }
  return state;
}

}  // namespace cradle
