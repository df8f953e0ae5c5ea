// Inelastic collapse: S. McNamara, W. R. Young, "Inelastic collapse and clumping in a one-dimensional granular medium",
// Physics of Fluids A 4(3), 1992. In a round of impacts the speeds of the contacts change by a fixed matrix; where its
// eigenvalues are real, the round repeats for ever. For a sphere of mass m between a fixed floor and a mass M these are
// the roots of x^2 - ((1 + e)^2 M / (m + M) - 2 e) x + e^2: real if (1 + e)^2 M / (m + M) >= 4 e. Speeds shrink by the
// larger root a round, gaps about as fast as by the smaller one. All impulses together end all closing: without
// friction they are those of one impact without rebound, whenever in the sequence that comes.

#include "simulate/events/impact_sequence.h"

#include <algorithm>
#include <limits>

#include "simulate/events/event_tolerances.h"

namespace cradle {
namespace {

constexpr std::size_t kCollapseImpacts = 200;   // enough to tell intervals that shrink for ever from a few short ones
constexpr std::size_t kImpactsOfAContact = 20;  // the same, for each contact
constexpr std::size_t kMaxSequenceImpacts = 100000;  // a row of 40 spheres takes a thousand

constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace

ImpactSequence::ImpactSequence(std::vector<Contact> contacts, const std::optional<std::size_t>& closingPair,
                               const std::vector<double>& radii, const SequenceLimits& limits, const VectorX& state)
    : contacts_(std::move(contacts)),
      radii_(radii),
      limits_(limits),
      gapErrors_(limits.gapErrors),
      offsets_(limits.gapOffsets),
      speeds_(contacts_.size()),
      leftSpeeds_(contacts_.size(), 0.0),
      lastImpacts_(contacts_.size(), 0),
      displacements_(VectorX::Zero(bodyCount(state) * kVelocitySize)) {
  offsets_.resize(contacts_.size(), 0.0);
  for (std::size_t i = 0; i < contacts_.size(); ++i) gaps_.push_back(contacts_[i].separation - offsets_[i]);
  findSpeeds(state);
  if (closingPair) closeGapOf(*closingPair);
}

/// The event's time is rounded. All gaps are advanced to the instant at which the nearest closing contact of the pair
/// has none. None goes back, for a contact that touched before may be closed farther than rounding.
void ImpactSequence::closeGapOf(std::size_t pair) {
  std::size_t nearest = contacts_.size();
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (contacts_[i].pair == pair && closes(i) && (nearest == contacts_.size() || gaps_[i] < gaps_[nearest]))
      nearest = i;
  if (nearest == contacts_.size()) return;
  const double most = limits_.touchTolerance / fastestClosing_;
  const double time = std::clamp(gaps_[nearest] / -speeds_[nearest], 0.0, most);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    gaps_[i] += time * speeds_[i];
    offsets_[i] -= time * speeds_[i];
  }
  closeGap(nearest);
}

void ImpactSequence::findSpeeds(const VectorX& state) {
  fastestClosing_ = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    speeds_[i] = openingSpeed(contacts_[i], state);
    fastestClosing_ = std::max(fastestClosing_, -speeds_[i]);
  }
}

bool ImpactSequence::closes(std::size_t contact) const {
  return speeds_[contact] < leftSpeeds_[contact] - limits_.stillSpeed;
}

void ImpactSequence::closeGap(std::size_t contact) {
  offsets_[contact] += gaps_[contact];
  gaps_[contact] = 0;
}

bool ImpactSequence::isWithinRounding(std::size_t contact) const {
  const double least = limits_.leastRounding;
  const bool isKnown = gapErrors_[contact] < least && std::abs(offsets_[contact]) <= least;
  return gaps_[contact] <= EventTolerances::kHiddenGapRatio * (isKnown ? least : limits_.gapRounding);
}

bool ImpactSequence::next(const VectorX& state) {
  findSpeeds(state);
  isCollapse_ = hasCollapsed();
  if (isCollapse_) {
    members_.clear();
    const std::size_t first = times_.size() - std::max(kCollapseImpacts, kImpactsOfAContact * contacts_.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      if (lastImpacts_[i] > first) members_.push_back(i);
    collapses_ = times_.size();
    return true;
  }
  if (times_.size() > kMaxSequenceImpacts) return false;
  double time = timeToNextImpact();
  if (time == kNever) return false;
  if (time > 0 && !mayAdvance(state, time)) {
    if (!closeWithinRounding()) return false;
    time = 0;
  }
  advance(state, time);
  findMembers();
  return true;
}

/// Whether a gap is known so well, however small, that the instant is known at which it closes. Forces, which would
/// change that, close it by a t^2 / 2 in the time t = s / -s' in which its speed does.
bool ImpactSequence::closesLater(std::size_t contact) const {
  const double gap = gaps_[contact], time = gap / -speeds_[contact];
  const double error = gapErrors_[contact] + limits_.acceleration * time * time / 2;
  return gap > EventTolerances::kKnownGapRatio * error && gapErrors_[contact] < limits_.leastRounding &&
         time > limits_.shortestTime;
}

/// At the end of a sequence, closes gaps that rounding would hide from the search for the next event, and whose instant
/// is not known. True if there is one.
bool ImpactSequence::closeWithinRounding() {
  bool isAnyClosed = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!closes(i) || !isWithinRounding(i) || closesLater(i)) continue;
    closeGap(i);
    isAnyClosed = true;
  }
  return isAnyClosed;
}

bool ImpactSequence::hasCollapsed() const {
  const std::size_t count = std::max(kCollapseImpacts, kImpactsOfAContact * contacts_.size());
  return times_.size() >= collapses_ + count &&
         elapsed_ - times_[times_.size() - count] <= EventTolerances::kCollapseRatio * elapsed_;
}

/// s; infinite if nothing closes.
double ImpactSequence::timeToNextImpact() const {
  double time = kNever;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (closes(i)) time = std::min(time, gaps_[i] <= gapErrors_[i] ? 0 : gaps_[i] / -speeds_[i]);
  return time;
}

bool ImpactSequence::mayAdvance(const VectorX& state, double time) const {
  if (!(elapsed_ + time <= limits_.duration)) return false;
  const Eigen::Index velocities = poseComponents(state);
  for (std::size_t body = 0; body < radii_.size(); ++body) {
    const Eigen::Index at = static_cast<Eigen::Index>(body) * kVelocitySize;
    const Eigen::Vector<double, kVelocitySize> way =
        displacements_.segment<kVelocitySize>(at) + time * state.segment<kVelocitySize>(velocities + at);
    if (way.head<3>().norm() + radii_[body] * way.tail<3>().norm() > limits_.reach / 2) return false;
  }
  return true;
}

void ImpactSequence::advance(const VectorX& state, double time) {
  if (time == 0) return;
  elapsed_ += time;
  displacements_ += time * state.segment(poseComponents(state), displacements_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const bool staysClosed = gaps_[i] <= gapErrors_[i] && speeds_[i] > 0 && speeds_[i] <= limits_.openingSpeed;
    if (!staysClosed) gaps_[i] += time * speeds_[i];
    gapErrors_[i] += EventTolerances::kGapGrowthError * fastestClosing_ * time;
  }
}

/// The members of the next impact. A contact that opens is none, however small its gap. Corners of a face that lands
/// flat touch at one instant, to rounding; all others have an instant each, at every accuracy.
void ImpactSequence::findMembers() {
  members_.clear();
  const auto isClosed = [this](std::size_t i) { return gaps_[i] <= gapErrors_[i]; };
  const auto isOfClosingPair = [&](std::size_t i) {
    for (std::size_t other = 0; other < contacts_.size(); ++other)
      if (contacts_[other].pair == contacts_[i].pair && isClosed(other) && closes(other)) return true;
    return false;
  };
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (speeds_[i] > EventTolerances::kTakesNoPartRatio * fastestClosing_) continue;
    if (isClosed(i) || (isWithinRounding(i) && isOfClosingPair(i))) members_.push_back(i);
  }
}

void ImpactSequence::finishImpact(const VectorX& state) {
  times_.push_back(elapsed_);
  for (const std::size_t i : members_) {
    closeGap(i);
    gapErrors_[i] = 0;
    leftSpeeds_[i] = std::min(0.0, openingSpeed(contacts_[i], state));
    lastImpacts_[i] = times_.size();
  }
}

bool ImpactSequence::moveBodies(VectorX& state) const {
  if (elapsed_ == 0) return false;
  for (std::size_t body = 0; body < radii_.size(); ++body) {
    const auto index = static_cast<Eigen::Index>(body);
    centerOfMass(state, index) += displacements_.segment<3>(index * kVelocitySize);
    turnBody(state, index, displacements_.segment<3>(index * kVelocitySize + 3));
  }
  return true;
}

}  // namespace cradle
