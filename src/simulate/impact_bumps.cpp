#include "simulate/impact_bumps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/elementary.h"
#include "math/random_stream.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kMaxTilt = 1.4;  // rad: a normal stays on its side of the surface

/// m/s: as fast as bodies approach each other there.
double closingSpeedOf(const Contact& contact, const VectorX& state) {
  return -openingSpeed(contact, state);
}

int bodyOfImpact(const Scene& scene, int bodyA, int bodyB) {
  const auto isMoved = [&](int body) {
    return body >= 0 && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic;
  };
  const auto [first, second] = std::minmax(bodyA, bodyB);
  return isMoved(first) ? first : second;
}

}  // namespace

bool ImpactBumps::isFastEnough(const Contact& contact, double closingSpeed) const {
  const double fall = kMinFallRatio * smallestSize(contact, assembly_.radii);
  return closingSpeed > std::sqrt(2 * assembly_.mechanism.gravity.norm() * fall);
}

bool ImpactBumps::tilt(double time, const VectorX& state, std::span<ImpactContact> impacts) {
  if (!any()) return false;
  std::vector<char> isDone(impacts.size(), 0);
  bool isAny = false;
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    if (isDone[i]) continue;
    std::size_t fastest = i;
    const auto closing = [&](std::size_t k) { return closingSpeedOf(impacts[k].contact, state); };
    for (std::size_t k = i; k < impacts.size(); ++k) {
      if (impacts[k].contact.pair != impacts[i].contact.pair) continue;
      isDone[k] = 1;
      if (closing(k) > closing(fastest)) fastest = k;
    }
    if (!isFastEnough(impacts[fastest].contact, closing(fastest))) continue;
    const Quat turn = turnOf(time, impacts[fastest].contact);
    Contact turned = impacts[fastest].contact;
    turned.normal = turn * turned.normal;
    if (closingSpeedOf(turned, state) <= 0) continue;
    isAny = true;
    for (ImpactContact& impact : impacts)
      if (impact.contact.pair == turned.pair) impact.contact.normal = (turn * impact.contact.normal).normalized();
  }
  return isAny;
}

/// The turn by two angles about directions across the normal.
Quat ImpactBumps::turnOf(double time, const Contact& contact) {
  const std::pair<int, int> bodies = bodiesOf(assembly_, assembly_.geometry.pairs[contact.pair]);
  const int body = bodyOfImpact(scene_, bodies.first, bodies.second), number = numberOf(time, bodies);
  RandomStream random = RandomStream(seedOf(body, number))
                            .at("bumps")
                            .at(scene_.bodies[static_cast<std::size_t>(body)].name)
                            .at(static_cast<std::uint64_t>(number));
  const double deviation = scene_.bumps->deviation;
  const double first = deviation * normalQuantile(random.nextUniform());
  const double second = deviation * normalQuantile(random.nextUniform());
  const Vec3 across = contact.normal.unitOrthogonal();
  const Vec3 axis = first * across + second * contact.normal.cross(across);  // rad
  const double angle = axis.norm();
  if (angle == 0) return Quat::Identity();
  const double half = 0.5 * std::min(angle, kMaxTilt);
  const Vec3 part = sin(half) / angle * axis;
  return Quat(cos(half), part.x(), part.y(), part.z());
}

/// From 1 on, among those of its body.
int ImpactBumps::numberOf(double time, std::pair<int, int> bodies) {
  for (auto struck = struck_.rbegin(); struck != struck_.rend() && struck->time == time; ++struck)
    if (struck->bodies == bodies) return struck->impact;
  const int body = bodyOfImpact(scene_, bodies.first, bodies.second), number = ++counts_[body];
  struck_.push_back({time, bodies, body, number});
  return number;
}

/// The seed of the latest change, by its impact; of several the last in the scene.
std::uint64_t ImpactBumps::seedOf(int body, int impact) const {
  std::uint64_t seed = scene_.bumps->seed;
  int from = 0;
  for (const BumpChange& change : scene_.bumps->changes) {
    if (change.body != body || change.impact > impact || change.impact < from) continue;
    from = change.impact, seed = change.seed;
  }
  return seed;
}

void ImpactBumps::noteWithout(double time, const Contact& contact, double change, EventLog& log) {
  if (hasWarned_ || !any() || !isFastEnough(contact, change)) return;
  hasWarned_ = true;
  const auto [a, b] = bodiesOf(assembly_, assembly_.geometry.pairs[contact.pair]);
  log.warn(
      fmt::format("{}: impacts in a heap, where contact is solved once a step, have no bumps; the first is that of "
                  "\"{}\" and \"{}\" at {:.6g} s",
                  scene_.path, scene_.bodies[static_cast<std::size_t>(a)].name,
                  scene_.bodies[static_cast<std::size_t>(b)].name, time));
}

BumpCounts ImpactBumps::countsBy(double time) const {
  BumpCounts counts = counts_;
  for (auto struck = struck_.rbegin(); struck != struck_.rend() && struck->time > time + sameTime(time); ++struck)
    --counts[struck->body];
  return counts;
}

}  // namespace cradle
