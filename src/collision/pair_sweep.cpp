#include "collision/pair_sweep.h"

#include <algorithm>

namespace cradle {

bool PairSweep::update(const VectorX& state, const std::vector<double>& motions, double margin,
                       ContactGeometry& geometry) {
  const std::size_t n = geometry.colliders.size();
  const auto tight = [&](std::size_t i) {
    const Collider& c = geometry.colliders[i];
    Bounds bounds;
    if (c.body == kFixed) {
      for (const Vec3& p : c.points) bounds.extend(p);
    } else if (c.isBall()) {
      bounds.extend(Vec3(centerOfMass(state, c.body)));
    } else {
      const RigidTransform pose = poseOf(state, c.body);
      const Mat3 r = pose.rotation.toRotationMatrix();
      for (const Vec3& p : c.points) bounds.extend(Vec3(r * p + pose.translation));
    }
    const double grow = c.radius + margin / 2 + (c.body == kFixed ? 0 : motions[static_cast<std::size_t>(c.body)]);
    bounds.min().array() -= grow, bounds.max().array() += grow;
    return bounds;
  };
  bool covered = fat_.size() == n;
  for (std::size_t i = 0; covered && i < n; ++i) {
    if (geometry.colliders[i].body == kFixed) continue;
    covered = fat_[i].contains(tight(i));
  }
  if (covered) return false;
  fat_.resize(n);
  order_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    fat_[i] = tight(i);
    const double skin = geometry.colliders[i].body == kFixed ? 0 : 0.005 + motions[static_cast<std::size_t>(geometry.colliders[i].body)];
    fat_[i].min().array() -= skin, fat_[i].max().array() += skin;
    order_.emplace_back(fat_[i].min().x(), static_cast<int>(i));
  }
  std::sort(order_.begin(), order_.end());
  geometry.pairs.clear();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t p = 0; p < geometry.planes.size(); ++p)
      if (geometry.colliders[i].body != kFixed) geometry.pairs.push_back({i, p, true, law});
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = static_cast<std::size_t>(order_[i].second);
    for (std::size_t j = i + 1; j < n && order_[j].first <= fat_[a].max().x(); ++j) {
      const std::size_t b = static_cast<std::size_t>(order_[j].second);
      if (geometry.colliders[a].body == kFixed && geometry.colliders[b].body == kFixed) continue;
      if (fat_[a].intersects(fat_[b])) geometry.pairs.push_back({std::min(a, b), std::max(a, b), false, law});
    }
  }
  std::sort(geometry.pairs.begin(), geometry.pairs.end(), [](const ColliderPair& l, const ColliderPair& r) {
    return std::tuple(!l.againstPlane, l.a, l.b) < std::tuple(!r.againstPlane, r.a, r.b);
  });
  return true;
}

}  // namespace cradle
