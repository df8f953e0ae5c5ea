#include "study/growth_meter.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr double kSteadyGrowth = 100;  // times 1 + t: phases that drift apart grow like time alone
constexpr double kFirstGrowth = 10;    // times the disturbance: from there on, growth is measured

}  // namespace

void GrowthMeter::take(double time, double difference) {
  largest_ = std::max(largest_, difference);
  isFast_ = isFast_ || difference > kSteadyGrowth * disturbance_ * (1 + time);
  if (meaninglessFrom_) return;
  const Point now{time, difference};
  if (first_.difference == 0 && difference > kFirstGrowth * disturbance_) first_ = last_ = now;
  if (first_.difference > 0 && difference > last_.difference) last_ = now;
  if (difference > kSecondDigit) meaninglessFrom_ = time;
}

std::optional<Divergence> GrowthMeter::divergence() const {
  if (!isFast_) return std::nullopt;
  const double seconds = last_.time - first_.time;
  const double rate = seconds > 0 ? std::log(last_.difference / first_.difference) / seconds : HUGE_VAL;
  return Divergence{rate, meaninglessFrom_};
}

}  // namespace cradle
