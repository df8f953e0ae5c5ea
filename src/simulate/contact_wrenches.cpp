#include "simulate/contact_wrenches.h"

#include <algorithm>
#include <utility>

namespace cradle {

ContactLoad loadOf(const Contact& contact, const ColliderPair& pair, const Vec3& force, const Assembly& assembly) {
  const auto [a, b] = bodiesOf(assembly, pair);
  const Vec3 normalForce = contact.normal.dot(force) * contact.normal;
  return {a, b, contact.point, normalForce, force - normalForce};
}

/// The pair of a load, new if there is none yet. Loads mostly come in the order of pairs.
WrenchSum::Pair& WrenchSum::pairOf(const ContactLoad& load) {
  const std::pair bodies{load.bodyA, load.bodyB};
  const auto bodiesOfPair = [](const Pair& pair) { return std::pair{pair.bodyA, pair.bodyB}; };
  if (!pairs_.empty() && bodiesOfPair(pairs_.back()) == bodies) return pairs_.back();
  if (pairs_.empty() || bodiesOfPair(pairs_.back()) < bodies)
    return pairs_.emplace_back(Pair{load.bodyA, load.bodyB, load.point});
  const auto at = std::ranges::lower_bound(pairs_, bodies, {}, bodiesOfPair);
  if (bodiesOfPair(*at) == bodies) return *at;
  return *pairs_.insert(at, Pair{load.bodyA, load.bodyB, load.point});
}

void WrenchSum::add(const ContactLoad& load, double fraction) {
  Pair& pair = pairOf(load);
  const Vec3 normalForce = fraction * load.normalForce, force = normalForce + fraction * load.friction;
  const Vec3 point = load.point - pair.origin;
  const double weight = normalForce.norm();
  pair.force += force, pair.normalForce += normalForce;
  pair.torque += fraction * load.torque + point.cross(force);
  pair.weight += weight, pair.weighted += weight * point;
}

std::vector<ContactWrench> WrenchSum::wrenches(double factor) const {
  std::vector<ContactWrench> found;
  for (const Pair& pair : pairs_) {
    const Vec3 center = pair.weight > 0 ? Vec3(pair.weighted / pair.weight) : Vec3(Vec3::Zero());
    found.push_back({-1, pair.bodyA, pair.bodyB, factor * pair.force, factor * pair.normalForce,
                     factor * (pair.torque - center.cross(pair.force)), pair.origin + center});
  }
  return found;
}

}  // namespace cradle
