// A pair alone: the closed form. More: reflections (generalized_reflections.h), with a small state of the balls that
// take part. Balls that a plane carries slide on it under the part of gravity that the planes leave:
// a = g + N^T f with 0 <= f perp N a >= 0, N the normals of the planes that they touch.

#include "simulate/balls/ball_impact.h"

#include <algorithm>
#include <cmath>

#include "impact/generalized_reflections.h"
#include "impact/linear_complementarity.h"

namespace cradle {
namespace {

constexpr double kRestPart = 1e-7;       // of sqrt(g r): slower is no bounce but rounding
constexpr double kRestRounding = 1e-13;  // of the ball's speed, likewise
constexpr double kLoadedPart = 1e-9;     // of g: what presses less is rounding
constexpr std::array<int, 3> kInFlight = {-1, -1, -1};

}  // namespace

void BallImpact::begin() {
  balls_.clear(), contacts_.clear(), impulses_.clear();
  for (int ball = 0; ball < world_.ballCount(); ++ball) {
    balls_.push_back(ball);
    found_.clear();
    flights_.appendTouching(ball, 0, found_);
    for (const BallContact& contact : found_)
      if (contact.other < ball) keepContact(contact);
  }
  moveHere(0);
  findSupports();
  for (std::size_t i = 0; i < balls_.size(); ++i) flights_.strike(balls_[i], 0, motions_[i], supports_[i]);
}

void BallImpact::resolve(int ball, int other, double time) {
  findTouching(ball, other, time);
  moveHere(time);
  const double kinetic = kineticEnergy();
  const VectorX speeds = openingSpeeds();
  if (contacts_.size() == 1) {
    reflectAlone(0);
  } else if (!reflectAll()) {
    // What closes by rounding alone is no contact of the impact, but would come again.
    const auto isStruck = [&](const BallContact& contact) {
      return (contact.ball == ball && contact.other == other) || (contact.ball == other && contact.other == ball);
    };
    reflectAlone(
        static_cast<std::size_t>(std::find_if(contacts_.begin(), contacts_.end(), isStruck) - contacts_.begin()));
  }
  energyTaken_ = -0.5 * Eigen::Map<const VectorX>(impulses_.data(), speeds.size()).dot(speeds + openingSpeeds());
  findSupports();
  energyLost_ = kinetic - kineticEnergy() - energyTaken_;
  for (std::size_t i = 0; i < balls_.size(); ++i) flights_.strike(balls_[i], time, motions_[i], supports_[i]);
}

/// J: of the centres' motion.
double BallImpact::kineticEnergy() const {
  double energy = 0;
  for (std::size_t i = 0; i < balls_.size(); ++i)
    energy += 0.5 / inverseMassOf(balls_[i]) * motions_[i].velocity.squaredNorm();
  return energy;
}

/// m/s: of the contacts.
VectorX BallImpact::openingSpeeds() const {
  VectorX speeds(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    speeds[static_cast<Eigen::Index>(i)] = contacts_[i].normal.dot(relativeVelocity(contacts_[i]));
  return speeds;
}

/// The contact itself, however its gap was rounded, and what hangs together with it.
void BallImpact::findTouching(int ball, int other, double time) {
  balls_ = {ball};
  contacts_.clear(), impulses_.clear();
  if (other >= 0) balls_.push_back(other);
  keepContact(flights_.contactOf(ball, other, time));
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    found_.clear();
    flights_.appendTouching(balls_[i], time, found_);
    for (const BallContact& contact : found_) {
      const auto known = std::find(balls_.begin(), balls_.end(), contact.other);
      if (known < balls_.begin() + static_cast<std::ptrdiff_t>(i)) continue;  // found from there
      if (contact.other >= 0 && known == balls_.end()) balls_.push_back(contact.other);
      if (!(contact.ball == ball && contact.other == other) && !(contact.ball == other && contact.other == ball))
        keepContact(contact);
    }
  }
  std::sort(balls_.begin(), balls_.end());
  std::sort(contacts_.begin(), contacts_.end(), [](const BallContact& a, const BallContact& b) {
    return std::pair(a.ball, a.other) < std::pair(b.ball, b.other);
  });
}

/// Of two balls the one with the smaller index comes first.
void BallImpact::keepContact(const BallContact& contact) {
  contacts_.push_back(contact);
  BallContact& kept = contacts_.back();
  if (kept.other < 0 || kept.ball < kept.other) return;
  std::swap(kept.ball, kept.other);
  kept.normal = -kept.normal;
}

void BallImpact::moveHere(double time) {
  motions_.clear();
  for (const int ball : balls_) motions_.push_back(flights_.motionAt(ball, time));
  impulses_.assign(contacts_.size(), 0.0);
}

std::size_t BallImpact::indexOf(int ball) const {
  return static_cast<std::size_t>(std::lower_bound(balls_.begin(), balls_.end(), ball) - balls_.begin());
}

Vec3 BallImpact::relativeVelocity(const BallContact& contact) const {
  const Vec3 own = motions_[indexOf(contact.ball)].velocity;
  return contact.other < 0 ? Vec3(-own) : Vec3(motions_[indexOf(contact.other)].velocity - own);
}

void BallImpact::reflectAlone(std::size_t index) {
  const BallContact& contact = contacts_[index];
  const double opening = contact.normal.dot(relativeVelocity(contact));
  if (opening >= 0) return;
  const double impulse = -2 * opening / (inverseMassOf(contact.ball) + inverseMassOf(contact.other));
  motions_[indexOf(contact.ball)].velocity -= impulse * inverseMassOf(contact.ball) * contact.normal;
  if (contact.other >= 0)
    motions_[indexOf(contact.other)].velocity += impulse * inverseMassOf(contact.other) * contact.normal;
  impulses_[index] = impulse;
}

/// False if nothing closes but by rounding.
bool BallImpact::reflectAll() {
  std::vector<RigidBody> bodies(balls_.size());
  VectorX state = VectorX::Zero(stateSize(std::ssize(balls_)));
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    const auto body = static_cast<Eigen::Index>(i);
    bodies[i].inverseMass = inverseMassOf(balls_[i]);
    bodies[i].mass = 1 / bodies[i].inverseMass;
    bodies[i].inverseInertia.setZero();  // no impulse has a lever
    centerOfMass(state, body) = motions_[i].position;
    linearVelocity(state, body) = motions_[i].velocity;
    setOrientation(state, body, Quat::Identity());
  }
  std::vector<ImpactContact> impacts;
  for (const BallContact& contact : contacts_) {
    const int other = contact.other < 0 ? kFixed : static_cast<int>(indexOf(contact.other));
    const Contact here{0, static_cast<int>(indexOf(contact.ball)), other, contact.point, contact.normal, contact.gap};
    impacts.push_back({here, {1, 0, 0}, 0, Vec3::Zero()});
  }
  resolveReflections(impacts, ImpulseResponse(bodies), state);
  for (std::size_t i = 0; i < balls_.size(); ++i)
    motions_[i].velocity = linearVelocity(state, static_cast<Eigen::Index>(i));
  for (std::size_t i = 0; i < impacts.size(); ++i) impulses_[i] = contacts_[i].normal.dot(impacts[i].impulse);
  return std::any_of(impulses_.begin(), impulses_.end(), [](double impulse) { return impulse > 0; });
}

/// Nothing could be told from rest: the ball neither bounces nor leaves, as far as this contact is concerned.
bool BallImpact::isSlow(const BallContact& contact, double speed) const {
  const double gravity = world_.gravity.norm(), radius = world_.radii[static_cast<std::size_t>(contact.ball)];
  const double rounding = kRestRounding * motions_[indexOf(contact.ball)].velocity.norm();
  return std::abs(speed) <= std::max(kRestPart * std::sqrt(gravity * radius), rounding);
}

/// Which planes carry the balls from here on.
void BallImpact::findSupports() {
  supports_.assign(balls_.size(), kInFlight);
  for (UniformMotion& motion : motions_) motion.acceleration = world_.gravity;
  if (world_.gravity.isZero(0)) return;
  std::vector<int> planes;
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    planes.clear();
    for (const BallContact& contact : contacts_)
      if (contact.ball == balls_[i] && contact.other < 0 && ~contact.other < world_.planeCount() &&
          isSlow(contact, contact.normal.dot(motions_[i].velocity)))
        planes.push_back(~contact.other);
    if (!planes.empty()) carry(i, planes);
  }
}

void BallImpact::carry(std::size_t index, const std::vector<int>& planes) {
  MatrixX normals(static_cast<Eigen::Index>(planes.size()), 3);
  for (std::size_t i = 0; i < planes.size(); ++i)
    normals.row(static_cast<Eigen::Index>(i)) = world_.planes[static_cast<std::size_t>(planes[i])].normal.transpose();
  const VectorX forces = solveLinearComplementarity(normals * normals.transpose(), normals * world_.gravity);
  UniformMotion& motion = motions_[index];
  motion.acceleration += normals.transpose() * forces;
  const VectorX rates = normals * motion.acceleration;
  std::size_t count = 0;
  for (std::size_t i = 0; i < planes.size() && count < 3; ++i) {
    if (std::abs(rates[static_cast<Eigen::Index>(i)]) > kLoadedPart * world_.gravity.norm()) continue;
    supports_[index][count++] = planes[i];
    const Vec3& normal = world_.planes[static_cast<std::size_t>(planes[i])].normal;
    motion.velocity -= normal.dot(motion.velocity) * normal;
  }
}

std::optional<BallContact> BallImpact::lastingContact() const {
  for (const BallContact& contact : contacts_) {
    const bool isPlane = contact.other < 0 && ~contact.other < world_.planeCount();
    const Vec3 velocity = relativeVelocity(contact);
    const double opening = contact.normal.dot(velocity);
    if (isPlane || !isSlow(contact, opening)) continue;
    Vec3 acceleration = -motions_[indexOf(contact.ball)].acceleration;
    if (contact.other >= 0) acceleration += motions_[indexOf(contact.other)].acceleration;
    // Balls that slide past each other also part because they are round.
    double curving = 0;
    if (contact.other >= 0)
      curving =
          (velocity - opening * contact.normal).squaredNorm() / (world_.radii[static_cast<std::size_t>(contact.ball)] +
                                                                 world_.radii[static_cast<std::size_t>(contact.other)]);
    if (contact.normal.dot(acceleration) + curving < -kLoadedPart * world_.gravity.norm()) return contact;
  }
  return std::nullopt;
}

}  // namespace cradle
