#include "impact/soft_sleep.h"

#include <algorithm>

namespace cradle {
namespace {

bool bothMove(const ManifoldLink& link) {
  return link.bodyB != kFixed;
}

/// Speed (m/s) at which a contact closes at its first point.
double closingSpeed(const PersistentManifold& manifold, const MovingPose& a, const MovingPose& b) {
  const Vec3 armA = a.rotation * manifold.onA[0].cast<double>(), armB = b.rotation * manifold.onB[0].cast<double>();
  const Vec3 relative =
      b.linearVelocity - a.linearVelocity + b.angularVelocity.cross(armB) - a.angularVelocity.cross(armA);
  return std::max(0.0, -manifold.normal.dot(relative));
}

}  // namespace

SoftSleep::SoftSleep(std::vector<double> masses, double stillTime)
    : masses_(std::move(masses)),
      stillTime_(stillTime),
      stillTimes_(masses_.size(), 0.0),
      isAsleep_(masses_.size(), 0),
      hasMovingNeighbor_(masses_.size(), 0),
      awake_(masses_.size()) {}

void SoftSleep::goOnFrom(const Record& record) {
  isAsleep_ = record.isAsleep, stillTimes_ = record.stillTimes;
  awake_ = static_cast<std::size_t>(std::ranges::count(isAsleep_, 0));
}

void SoftSleep::wakeTouched(const SoftContacts& contacts, const std::vector<MovingPose>& poses, double slow,
                            std::vector<int>& woken) {
  if (awake_ == masses_.size()) return;
  bool isListed = false;
  for (const ManifoldLink& link : contacts.active()) {
    if (!bothMove(link)) continue;
    const std::size_t a = static_cast<std::size_t>(link.bodyA), b = static_cast<std::size_t>(link.bodyB);
    if (isAsleep_[a] == isAsleep_[b]) continue;
    const std::size_t mover = isAsleep_[a] ? b : a, sleeper = isAsleep_[a] ? a : b;
    if (stillTimes_[mover] > 0) continue;
    if (!isListed) listNeighbors(contacts);
    isListed = true;
    const PersistentManifold& manifold = contacts.manifolds()[static_cast<std::size_t>(link.manifold)];
    const double momentum = masses_[mover] * closingSpeed(manifold, poses[a], poses[b]);
    wakeAround(static_cast<int>(sleeper), momentum / slow, woken);
  }
}

void SoftSleep::wake(int body, std::vector<int>& woken) {
  const std::size_t index = static_cast<std::size_t>(body);
  isAsleep_[index] = 0;
  stillTimes_[index] = stillTime_ / 2;  // not restless before it has moved
  ++awake_;
  woken.push_back(body);
}

void SoftSleep::wakeRestless(int body) {
  std::vector<int> woken;  // told to nobody
  wake(body, woken);
  stillTimes_[static_cast<std::size_t>(body)] = 0;
}

/// The body struck and those nearest to it, along contacts, until they have that mass (kg) together.
void SoftSleep::wakeAround(int struck, double leastMass, std::vector<int>& woken) {
  std::size_t next = woken.size();
  wake(struck, woken);
  double mass = masses_[static_cast<std::size_t>(struck)];
  for (; next < woken.size() && mass < leastMass; ++next) {
    const std::size_t body = static_cast<std::size_t>(woken[next]);
    for (std::size_t i = firstNeighbors_[body]; i < firstNeighbors_[body + 1]; ++i) {
      const std::size_t neighbor = static_cast<std::size_t>(neighbors_[i]);
      if (!isAsleep_[neighbor]) continue;
      wake(neighbors_[i], woken);
      mass += masses_[neighbor];
    }
  }
}

/// Counting sort of the contacts by their bodies.
void SoftSleep::listNeighbors(const SoftContacts& contacts) {
  firstNeighbors_.assign(masses_.size() + 2, 0);
  const auto forEach = [&](const auto& work) {
    contacts.forEachTouching([&](int a, int b) {
      work(static_cast<std::size_t>(a), b);
      work(static_cast<std::size_t>(b), a);
    });
  };
  forEach([&](std::size_t body, int) { ++firstNeighbors_[body + 2]; });
  for (std::size_t i = 2; i < firstNeighbors_.size(); ++i) firstNeighbors_[i] += firstNeighbors_[i - 1];
  neighbors_.resize(firstNeighbors_.back());
  forEach([&](std::size_t body, int other) { neighbors_[firstNeighbors_[body + 1]++] = other; });
}

void SoftSleep::letSleep(const SoftContacts& contacts, const std::vector<double>& speeds, double slow, double timeStep,
                         std::vector<int>& fallenAsleep) {
  bool someAreStill = false;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    if (isAsleep_[i]) continue;
    stillTimes_[i] = speeds[i] < slow ? stillTimes_[i] + timeStep : 0;
    someAreStill = someAreStill || stillTimes_[i] >= stillTime_;
  }
  if (!someAreStill) return;
  std::fill(hasMovingNeighbor_.begin(), hasMovingNeighbor_.end(), 0);
  const auto isMovingFast = [&](std::size_t body) { return !isAsleep_[body] && stillTimes_[body] < stillTime_; };
  for (const ManifoldLink& link : contacts.active()) {
    if (!bothMove(link)) continue;
    const std::size_t a = static_cast<std::size_t>(link.bodyA), b = static_cast<std::size_t>(link.bodyB);
    if (isMovingFast(a)) hasMovingNeighbor_[b] = 1;
    if (isMovingFast(b)) hasMovingNeighbor_[a] = 1;
  }
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    if (isAsleep_[i] || isMovingFast(i) || hasMovingNeighbor_[i]) continue;
    isAsleep_[i] = 1;
    --awake_;
    fallenAsleep.push_back(static_cast<int>(i));
  }
}

}  // namespace cradle
