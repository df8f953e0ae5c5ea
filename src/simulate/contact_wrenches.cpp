#include "simulate/contact_wrenches.h"

#include <algorithm>
#include <utility>

namespace cradle {

ContactLoad loadOf(const Contact& contact, const ColliderPair& pair, const Vec3& force, const Assembly& assembly) {
  const auto [a, b] = bodiesOf(assembly, pair);
  const double pressure = contact.normal.dot(force);
  const Vec3 normalForce = pressure * contact.normal;
  return {a, b, contact.point, pressure, normalForce, force - normalForce};
}

void WrenchSum::add(const ContactLoad& load, double fraction) {
  if (pairs_.empty() || pairs_.back().bodies() != std::pair(load.bodyA, load.bodyB))
    pairs_.push_back({load.bodyA, load.bodyB, load.point});
  Pair& pair = pairs_.back();
  const Vec3 normalForce = fraction * load.normalForce, force = normalForce + fraction * load.friction;
  const Vec3 point = load.point - pair.origin;
  const double weight = fraction * load.pressure;
  pair.force += force, pair.normalForce += normalForce;
  pair.torque += fraction * load.torque + point.cross(force);
  pair.weight += weight, pair.weighted += weight * point;
}

void WrenchSum::Pair::add(const Pair& other) {
  const Vec3 shift = other.origin - origin;
  force += other.force, normalForce += other.normalForce;
  torque += other.torque + shift.cross(other.force);
  weight += other.weight, weighted += other.weighted + other.weight * shift;
}

std::vector<ContactWrench> WrenchSum::wrenches() {
  std::ranges::stable_sort(pairs_, {}, &Pair::bodies);
  std::vector<ContactWrench> found;
  for (std::size_t i = 0; i < pairs_.size();) {
    Pair& pair = pairs_[i];
    for (++i; i < pairs_.size() && pairs_[i].bodies() == pair.bodies(); ++i) pair.add(pairs_[i]);
    const Vec3 center = pair.weight > 0 ? Vec3(pair.weighted / pair.weight) : Vec3(Vec3::Zero());
    found.push_back({-1, pair.bodyA, pair.bodyB, pair.force, pair.normalForce,
                     Vec3(pair.torque - center.cross(pair.force)), Vec3(pair.origin + center)});
  }
  return found;
}

}  // namespace cradle
