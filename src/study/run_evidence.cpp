#include "study/run_evidence.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr double kMinImpulse = 1e-6;  // of the hardest: what barely touches may do so in one run alone

}  // namespace

void RunEvidence::add(const Event& event) {
  if (event.kind != EventKind::impact || event.bodyB < 0) return;
  Touch& touch = touches_.try_emplace(std::minmax(event.bodyA, event.bodyB), Touch{event.time, 0}).first->second;
  touch.impulse = std::max(touch.impulse, event.impulse);
  hardest_ = std::max(hardest_, event.impulse);
}

void RunEvidence::add(const Frame& frame) {
  const EnergyBalance& energy = frame.energy;
  const double constant = energy.kinetic + energy.potential + energy.dissipated - energy.work;
  if (isFirst_) startConstant_ = constant;
  isFirst_ = false;
  energyChange_ = std::max(energyChange_, std::abs(constant - startConstant_));
  largestKinetic_ = std::max(largestKinetic_, energy.kinetic);
  const std::optional<Overlap> worst = overlaps_.worstOf(frame);
  if (worst && (!overlap_ || worst->depth * overlap_->allowed > overlap_->depth * worst->allowed)) overlap_ = worst;
}

std::optional<TouchDifference> RunEvidence::difference(const RunEvidence& first, const RunEvidence& second,
                                                       double time) {
  const double least = kMinImpulse * std::max(first.hardest_, second.hardest_);
  std::optional<TouchDifference> found;
  const auto consider = [&](const RunEvidence& one, const RunEvidence& other, bool isInFirst) {
    for (const auto& [pair, touch] : one.touches_)
      if (touch.time < time && touch.impulse > least && !other.touches_.contains(pair) &&
          (!found || touch.time < found->time))
        found = {touch.time, pair.first, pair.second, isInFirst};
  };
  consider(first, second, true);
  consider(second, first, false);
  return found;
}

}  // namespace cradle
