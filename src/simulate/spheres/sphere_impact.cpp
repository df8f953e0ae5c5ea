// A pair alone: the closed form. More: reflections (generalized_reflections.h), with a small state of the spheres that
// take part. Spheres that a plane carries slide on it under the part of gravity that the planes leave:
// a = g + N^T f with 0 <= f perp N a >= 0, N the normals of the planes that they touch.

#include "simulate/spheres/sphere_impact.h"

#include <algorithm>
#include <cmath>

#include "impact/generalized_reflections.h"
#include "impact/linear_complementarity.h"

namespace cradle {
namespace {

constexpr std::array<int, 3> kInFlight = {-1, -1, -1};

}  // namespace

void SphereImpact::begin() {
  spheres_.clear(), contacts_.clear(), impulses_.clear();
  for (int sphere = 0; sphere < world_.sphereCount(); ++sphere) {
    spheres_.push_back(sphere);
    found_.clear();
    flights_.appendTouching(sphere, 0, found_);
    for (const SphereContact& contact : found_)
      if (contact.other < sphere) keepContact(contact);
  }
  moveHere(0);
  findSupports();
  for (std::size_t i = 0; i < spheres_.size(); ++i) flights_.strike(spheres_[i], 0, motions_[i], supports_[i]);
}

void SphereImpact::resolve(int sphere, int other, double time) {
  findTouching(sphere, other, time);
  moveHere(time);
  const double kinetic = kineticEnergy();
  const VectorX speeds = openingSpeeds();
  if (contacts_.size() == 1) {
    reflectAlone(0);
  } else if (!reflectAll()) {
    // What closes by rounding alone is no contact of the impact, but would come again.
    const auto isStruck = [&](const SphereContact& contact) {
      return (contact.sphere == sphere && contact.other == other) ||
             (contact.sphere == other && contact.other == sphere);
    };
    reflectAlone(
        static_cast<std::size_t>(std::find_if(contacts_.begin(), contacts_.end(), isStruck) - contacts_.begin()));
  }
  energyTaken_ = -0.5 * Eigen::Map<const VectorX>(impulses_.data(), speeds.size()).dot(speeds + openingSpeeds());
  findSupports();
  energyLost_ = kinetic - kineticEnergy() - energyTaken_;
  for (std::size_t i = 0; i < spheres_.size(); ++i) flights_.strike(spheres_[i], time, motions_[i], supports_[i]);
}

/// J: of the centres' motion.
double SphereImpact::kineticEnergy() const {
  double energy = 0;
  for (std::size_t i = 0; i < spheres_.size(); ++i)
    energy += 0.5 / inverseMassOf(spheres_[i]) * motions_[i].velocity.squaredNorm();
  return energy;
}

/// m/s: of the contacts.
VectorX SphereImpact::openingSpeeds() const {
  VectorX speeds(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    speeds[static_cast<Eigen::Index>(i)] = contacts_[i].normal.dot(relativeVelocity(contacts_[i]));
  return speeds;
}

/// The contact itself, however its gap was rounded, and what hangs together with it.
void SphereImpact::findTouching(int sphere, int other, double time) {
  spheres_ = {sphere};
  contacts_.clear(), impulses_.clear();
  if (other >= 0) spheres_.push_back(other);
  keepContact(flights_.contactOf(sphere, other, time));
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    found_.clear();
    flights_.appendTouching(spheres_[i], time, found_);
    for (const SphereContact& contact : found_) {
      const auto known = std::find(spheres_.begin(), spheres_.end(), contact.other);
      if (known < spheres_.begin() + static_cast<std::ptrdiff_t>(i)) continue;  // found from there
      if (contact.other >= 0 && known == spheres_.end()) spheres_.push_back(contact.other);
      if (!(contact.sphere == sphere && contact.other == other) &&
          !(contact.sphere == other && contact.other == sphere))
        keepContact(contact);
    }
  }
  std::sort(spheres_.begin(), spheres_.end());
  std::sort(contacts_.begin(), contacts_.end(), [](const SphereContact& a, const SphereContact& b) {
    return std::pair(a.sphere, a.other) < std::pair(b.sphere, b.other);
  });
}

/// Of two spheres the one with the smaller index comes first.
void SphereImpact::keepContact(const SphereContact& contact) {
  contacts_.push_back(contact);
  SphereContact& kept = contacts_.back();
  if (kept.other < 0 || kept.sphere < kept.other) return;
  std::swap(kept.sphere, kept.other);
  kept.normal = -kept.normal;
}

void SphereImpact::moveHere(double time) {
  motions_.clear();
  for (const int sphere : spheres_) motions_.push_back(flights_.motionAt(sphere, time));
  impulses_.assign(contacts_.size(), 0.0);
}

std::size_t SphereImpact::indexOf(int sphere) const {
  return static_cast<std::size_t>(std::lower_bound(spheres_.begin(), spheres_.end(), sphere) - spheres_.begin());
}

Vec3 SphereImpact::relativeVelocity(const SphereContact& contact) const {
  const Vec3 own = motions_[indexOf(contact.sphere)].velocity;
  return contact.other < 0 ? Vec3(-own) : Vec3(motions_[indexOf(contact.other)].velocity - own);
}

void SphereImpact::reflectAlone(std::size_t index) {
  const SphereContact& contact = contacts_[index];
  const double opening = contact.normal.dot(relativeVelocity(contact));
  if (opening >= 0) return;
  const double impulse = -2 * opening / (inverseMassOf(contact.sphere) + inverseMassOf(contact.other));
  motions_[indexOf(contact.sphere)].velocity -= impulse * inverseMassOf(contact.sphere) * contact.normal;
  if (contact.other >= 0)
    motions_[indexOf(contact.other)].velocity += impulse * inverseMassOf(contact.other) * contact.normal;
  impulses_[index] = impulse;
}

/// False if nothing closes but by rounding.
bool SphereImpact::reflectAll() {
  std::vector<RigidBody> bodies(spheres_.size());
  VectorX state = VectorX::Zero(stateSize(std::ssize(spheres_)));
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    const auto body = static_cast<Eigen::Index>(i);
    bodies[i].inverseMass = inverseMassOf(spheres_[i]);
    bodies[i].mass = 1 / bodies[i].inverseMass;
    bodies[i].inverseInertia.setZero();  // no impulse has a moment arm
    centerOfMass(state, body) = motions_[i].position;
    linearVelocity(state, body) = motions_[i].velocity;
    setOrientation(state, body, Quat::Identity());
  }
  std::vector<ImpactContact> impacts;
  for (const SphereContact& contact : contacts_) {
    const int other = contact.other < 0 ? kFixed : static_cast<int>(indexOf(contact.other));
    const Contact here{0, static_cast<int>(indexOf(contact.sphere)), other, contact.point, contact.normal, contact.gap};
    impacts.push_back({here, {1, 0, 0}, 0, Vec3::Zero()});
  }
  resolveReflections(impacts, ImpulseResponse(bodies), state);
  for (std::size_t i = 0; i < spheres_.size(); ++i)
    motions_[i].velocity = linearVelocity(state, static_cast<Eigen::Index>(i));
  for (std::size_t i = 0; i < impacts.size(); ++i) impulses_[i] = contacts_[i].normal.dot(impacts[i].impulse);
  return std::any_of(impulses_.begin(), impulses_.end(), [](double impulse) { return impulse > 0; });
}

/// Nothing could be told from rest: the sphere neither bounces nor leaves, as far as this contact is concerned.
bool SphereImpact::isSlow(const SphereContact& contact, double speed) const {
  const double radius = world_.radii[static_cast<std::size_t>(contact.sphere)];
  return std::abs(speed) <= tolerances().maxRestSpeed(radius, motions_[indexOf(contact.sphere)].velocity.norm());
}

/// Which planes carry the spheres from here on.
void SphereImpact::findSupports() {
  supports_.assign(spheres_.size(), kInFlight);
  for (UniformMotion& motion : motions_) motion.acceleration = world_.gravity;
  if (world_.gravity.isZero(0)) return;
  std::vector<int> planes;
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    planes.clear();
    for (const SphereContact& contact : contacts_)
      if (contact.sphere == spheres_[i] && contact.other < 0 && ~contact.other < world_.planeCount() &&
          isSlow(contact, contact.normal.dot(motions_[i].velocity)))
        planes.push_back(~contact.other);
    if (!planes.empty()) carry(i, planes);
  }
}

void SphereImpact::carry(std::size_t index, const std::vector<int>& planes) {
  MatrixX normals(static_cast<Eigen::Index>(planes.size()), 3);
  for (std::size_t i = 0; i < planes.size(); ++i)
    normals.row(static_cast<Eigen::Index>(i)) = world_.planes[static_cast<std::size_t>(planes[i])].normal.transpose();
  const VectorX forces = solveLinearComplementarity(normals * normals.transpose(), normals * world_.gravity);
  UniformMotion& motion = motions_[index];
  motion.acceleration += normals.transpose() * forces;
  const VectorX rates = normals * motion.acceleration;
  std::size_t count = 0;
  for (std::size_t i = 0; i < planes.size() && count < 3; ++i) {
    if (std::abs(rates[static_cast<Eigen::Index>(i)]) > tolerances().minLoadedAcceleration()) continue;
    supports_[index][count++] = planes[i];
    const Vec3& normal = world_.planes[static_cast<std::size_t>(planes[i])].normal;
    motion.velocity -= normal.dot(motion.velocity) * normal;
  }
}

std::optional<SphereContact> SphereImpact::lastingContact() const {
  for (const SphereContact& contact : contacts_) {
    const bool isPlane = contact.other < 0 && ~contact.other < world_.planeCount();
    const Vec3 velocity = relativeVelocity(contact);
    const double opening = contact.normal.dot(velocity);
    if (isPlane || !isSlow(contact, opening)) continue;
    Vec3 acceleration = -motions_[indexOf(contact.sphere)].acceleration;
    if (contact.other >= 0) acceleration += motions_[indexOf(contact.other)].acceleration;
    // Spheres that slide past each other also part because they are round.
    double curving = 0;
    if (contact.other >= 0)
      curving = (velocity - opening * contact.normal).squaredNorm() /
                (world_.radii[static_cast<std::size_t>(contact.sphere)] +
                 world_.radii[static_cast<std::size_t>(contact.other)]);
    if (contact.normal.dot(acceleration) + curving < -tolerances().minLoadedAcceleration()) return contact;
  }
  return std::nullopt;
}

}  // namespace cradle
