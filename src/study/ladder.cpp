#include "study/ladder.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr double kLimitOfUnstable = 2;            // step x omega to start from if a method has no limit of its own
constexpr double kStepWithoutSprings = 1.0 / 30;  // s
constexpr long kMaxSteps = 3000000;
constexpr int kFinestTenths = 12;
constexpr double kResolved = 1e-3;  // an error at which a method follows the motion
constexpr int kRungsWithoutGain = 3;

long firstStepCount(const StudyMethod& method, const StudyScene& scene) {
  const double frequency = scene.fastestFrequency();
  const double limit = method.stabilityLimit > 0 ? method.stabilityLimit : kLimitOfUnstable;
  const double step = frequency > 0 ? limit / frequency : kStepWithoutSprings;
  return std::clamp(static_cast<long>(scene.duration() / step), 1L, kMaxSteps);
}

}  // namespace

Ladder::Ladder(const StudyMethod& method, const StudyScene& scene)
    : kind_(method.setting), duration_(scene.duration()), steps_(firstStepCount(method, scene)) {}

double Ladder::setting() const {
  return kind_ == SettingKind::timeStep ? duration_ / static_cast<double>(steps_)
                                        : std::stod("1e-" + std::to_string(tenths_));
}

bool Ladder::descend(double cpuSeconds, double cpuLimit) {
  if (2 * cpuSeconds > cpuLimit) return false;
  steps_ *= 2;
  ++tenths_;
  return kind_ == SettingKind::timeStep ? steps_ <= kMaxSteps : tenths_ <= kFinestTenths;
}

bool GainWatch::goesOn(double error, double floor) {
  if (error <= floor) return false;
  rungsWithoutGain_ = error < least_ ? 0 : rungsWithoutGain_ + 1;
  least_ = std::min(least_, error);
  return least_ > kResolved || rungsWithoutGain_ < kRungsWithoutGain;
}

}  // namespace cradle
