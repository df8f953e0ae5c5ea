#include "sampling/metropolis_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/elementary.h"

namespace cradle {
namespace {

constexpr double kMinStep = 1e-4, kMaxStep = 1e-1;                                // of the range of a number in (0, 1)
constexpr double kAllAnewShare = 0.1, kOneAnewShare = 0.3, kOneMovedShare = 0.3;  // of the steps; else all are moved
constexpr double kBumpsShare = 0.5;  // of those that do not draw all anew, where there are bumps

/// Around the ends: what leaves (0, 1) on one side comes in on the other.
double moved(double number, double by) {
  const double sum = number + by;
  return std::clamp(sum - std::floor(sum), std::numeric_limits<double>::epsilon(),
                    1 - std::numeric_limits<double>::epsilon());
}

void drawAnew(std::vector<double>& numbers, RandomStream& random) {
  for (double& number : numbers) number = random.nextUniform();
}

void move(std::vector<double>& numbers, double step, RandomStream& random) {
  for (double& number : numbers) number = moved(number, step * (2 * random.nextUniform() - 1));
}

int sumOf(const ImpactCounts& impacts) {
  int sum = 0;
  for (const auto& [body, count] : impacts) sum += count;
  return sum;
}

/// Adds the numbers that are not there yet.
void addNeeded(const std::vector<double>& needed, std::vector<double>& numbers) {
  for (std::size_t i = numbers.size(); i < needed.size(); ++i) numbers.push_back(needed[i]);
}

/// Of deviations from the mean.
double covariance(const std::vector<double>& deviations, std::size_t lag) {
  double sum = 0;
  for (std::size_t i = lag; i < deviations.size(); ++i) sum += deviations[i] * deviations[i - lag];
  return sum / static_cast<double>(deviations.size());
}

}  // namespace

MetropolisChain::MetropolisChain(std::vector<std::string> places, bool hasBumps, Evaluate evaluate,
                                 const RandomStream& stream, ChainState start)
    : places_(std::move(places)),
      hasBumps_(hasBumps),
      evaluate_(std::move(evaluate)),
      stream_(stream),
      state_(std::move(start)) {}

UniformSource MetropolisChain::sourceOf(UniformNumbers& numbers) const {
  const RandomStream prior = stream_.at("prior");
  return [&numbers, prior](const std::string& pointer, std::size_t index) {
    std::vector<double>& ofPlace = numbers[pointer];
    while (ofPlace.size() <= index) ofPlace.push_back(prior.at(pointer).at(ofPlace.size()).nextUniform());
    return ofPlace[index];
  };
}

MetropolisChain::Proposal MetropolisChain::proposal(RandomStream& random) const {
  Proposal next{state_.numbers, state_.bumpChanges, "", 0};
  const double kind = random.nextUniform();
  const double step = kMinStep * exp(log(kMaxStep / kMinStep) * random.nextUniform());
  const double place = random.nextUniform();
  if (kind < kAllAnewShare) {
    for (auto& [pointer, ofPlace] : next.numbers) drawAnew(ofPlace, random);
    if (next.numbers.contains(kBumpSeedPlace)) next.bumpChanges.clear();  // else their seed is given, and not drawn
    return next;
  }
  if (hasBumps_ && (places_.empty() || random.nextUniform() < kBumpsShare)) {
    changeBumps(random, next);
    return next;
  }
  const double count = static_cast<double>(places_.size());
  const std::string& one = places_[std::min(static_cast<std::size_t>(place * count), places_.size() - 1)];
  // A number that nothing needed yet is one of the prior, whatever is done to it.
  const auto ofOne = next.numbers.find(one);
  if (kind < kAllAnewShare + kOneAnewShare) {
    if (ofOne != next.numbers.end()) drawAnew(ofOne->second, random);
  } else if (kind < kAllAnewShare + kOneAnewShare + kOneMovedShare) {
    if (ofOne != next.numbers.end()) move(ofOne->second, step, random);
  } else {
    for (auto& [pointer, ofPlace] : next.numbers)
      if (pointer != kBumpSeedPlace) move(ofPlace, step, random);
  }
  return next;
}

/// Draws the bumps of a body anew from one of the impacts of the state's motion on.
void MetropolisChain::changeBumps(RandomStream& random, Proposal& next) const {
  const int all = sumOf(state_.impacts);
  int number = static_cast<int>(random.nextUniform() * all);  // from 0 on, over all bodies
  const auto seed = static_cast<std::uint64_t>(kBumpSeeds * random.nextUniform());
  for (const auto& [body, count] : state_.impacts) {
    if (number < count) {
      next.changedBody = body, next.changedFrom = number + 1;
      break;
    }
    number -= count;
  }
  if (next.changedFrom == 0) return;
  std::erase_if(next.bumpChanges, [&](const NamedBumpChange& change) {
    return change.body == next.changedBody && change.impact >= next.changedFrom;
  });
  next.bumpChanges.push_back({next.changedBody, next.changedFrom, seed});
}

/// Log of how much likelier the step back is to be proposed than the step there. From one motion to another, and back,
/// leads the same impact, of as many as the one and the other have.
double MetropolisChain::logProposalRatio(const Proposal& next, const ImpactCounts& impacts) const {
  if (next.changedFrom == 0) return 0;
  const auto there = impacts.find(next.changedBody);
  if (there == impacts.end() || there->second < next.changedFrom) return -std::numeric_limits<double>::infinity();
  return log(double(sumOf(state_.impacts)) / sumOf(impacts));
}

bool MetropolisChain::step(long number) {
  RandomStream random = stream_.at("step").at(static_cast<std::uint64_t>(number));
  Proposal next = proposal(random);
  ChainOutcome outcome = evaluate_(sourceOf(next.numbers), next.bumpChanges);
  // Not below: from a state that cannot be, too, but to one that can.
  const bool isAccepted = outcome.logLikelihood > -std::numeric_limits<double>::infinity() &&
                          log(random.nextUniform()) <=
                              outcome.logLikelihood - state_.logLikelihood + logProposalRatio(next, outcome.impacts);
  if (isAccepted)
    state_ = {std::move(next.numbers), outcome.logLikelihood, std::move(next.bumpChanges), std::move(outcome.impacts)};
  else
    for (auto& [place, ofPlace] : next.numbers) addNeeded(ofPlace, state_.numbers[place]);
  return isAccepted;
}

double autocorrelationTime(const std::vector<double>& series) {
  const auto [least, most] = std::minmax_element(series.begin(), series.end());
  const double count = static_cast<double>(series.size());
  if (series.empty() || *least == *most) return std::max(count, 1.0);
  double mean = 0;
  for (const double value : series) mean += value / count;
  std::vector<double> deviations;
  for (const double value : series) deviations.push_back(value - mean);
  const double variance = covariance(deviations, 0);
  double time = -1;
  for (std::size_t lag = 0; lag + 1 < series.size(); lag += 2) {
    const double pair = covariance(deviations, lag) + covariance(deviations, lag + 1);
    if (pair <= 0) break;
    time += 2 * pair / variance;
  }
  return std::max(time, 1.0);
}

}  // namespace cradle
