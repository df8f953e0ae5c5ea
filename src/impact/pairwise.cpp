#include "impact/pairwise.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace cradle {
namespace {

// Of the fastest closing speed: 1e4 unit roundoffs, for sums over many impulses.
constexpr double kPairClosedRatio = 1e-12;
constexpr long kMaxImpulsesPerPair = 10000;    // a row of n spheres needs n, a box on its corners tens
constexpr double kPairEnergyRounding = 1e-12;  // of the work of the impulse: 1e4 unit roundoffs

double closingSpeed(const Contact& contact, const VectorX& state) {
  return -contact.normal.dot(relativeVelocity(contact, state));
}

/// Impulse that slides: friction at its limit against the sliding, the normal velocity reversed by `restitution`.
Vec3 slidingImpulse(const Contact& contact, const Mat3& inverseMass, const Vec3& velocity, double friction,
                    double restitution) {
  const Vec3 sliding = velocity - contact.normal.dot(velocity) * contact.normal;
  Vec3 direction = contact.normal - friction * sliding.stableNormalized();
  double response = contact.normal.dot(inverseMass * direction);
  if (response <= 0) {  // friction that jams: no impulse along this direction separates the pair
    direction = contact.normal;
    response = contact.normal.dot(inverseMass * direction);
  }
  return -(1 + restitution) * contact.normal.dot(velocity) / response * direction;
}

}  // namespace

Vec3 pairImpulse(const ImpactContact& impact, const ImpulseResponse& response, const VectorX& state) {
  const Contact& contact = impact.contact;
  const ContactMaterial& material = impact.material;
  const Vec3 velocity = relativeVelocity(contact, state);
  const double closing = -contact.normal.dot(velocity);
  if (closing <= 0) return Vec3::Zero();
  const Mat3 inverseMass = response.delassusAt(contact, state);
  const double restitution = closing > impact.restSpeed ? material.restitution : 0;
  const Vec3 frictionless = slidingImpulse(contact, inverseMass, velocity, 0, restitution);
  if (material.staticFriction == 0) return frictionless;

  // Does friction hold the point still?
  const Vec3 wanted = restitution * closing * contact.normal - velocity;
  Vec3 impulse = inverseMass.lu().solve(wanted);
  const double normal = contact.normal.dot(impulse);
  const double tangential = (impulse - normal * contact.normal).norm();
  if (!(normal > 0 && tangential <= material.staticFriction * normal))
    impulse = slidingImpulse(contact, inverseMass, velocity, material.dynamicFriction, restitution);

  const double gained = impulse.dot(velocity + 0.5 * (inverseMass * impulse));
  const bool addsEnergy = gained > kPairEnergyRounding * std::abs(impulse.dot(velocity));
  return addsEnergy ? frictionless : impulse;
}

void resolvePairwise(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state) {
  double fastest = 0;
  const long most = kMaxImpulsesPerPair * static_cast<long>(impacts.size());
  for (long count = 0; count < most; ++count) {
    const auto next = std::max_element(impacts.begin(), impacts.end(), [&](const auto& left, const auto& right) {
      return closingSpeed(left.contact, state) < closingSpeed(right.contact, state);
    });
    if (next == impacts.end()) return;
    const double closing = closingSpeed(next->contact, state);
    fastest = std::max(fastest, closing);
    if (closing <= kPairClosedRatio * fastest) return;
    const Vec3 impulse = pairImpulse(*next, response, state);
    response.apply(next->contact, impulse, state);
    next->impulse += impulse;
  }
  throw Error(ErrorKind::unstable, "",
              "an impact among " + std::to_string(impacts.size()) +
                  " contacts does not come to an end when resolved pair by pair");
}

}  // namespace cradle
