#include "sampling/metropolis_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "scene/json_document.h"

namespace cradle {
namespace {

// Autoregressive: x' = a x + sqrt(1 - a^2) z has autocorrelations a^k, whose time is (1 + a) / (1 - a). The estimate
// from n numbers scatters by some sqrt(time / n) of itself, 1 % here; 0.1 is ten times that.
TEST(AutocorrelationTime, OfAnAutoregressiveSeriesIsThatOfItsClosedForm) {
  for (const double a : {0.0, 0.5, 0.9}) {
    RandomStream random(5);
    std::vector<double> series = {0};
    for (int i = 0; i < 200'000; ++i)
      series.push_back(a * series.back() + std::sqrt(1 - a * a) * normalQuantile(random.nextUniform()));
    EXPECT_NEAR(autocorrelationTime(series) * (1 - a) / (1 + a), 1, 0.1) << a;
  }
}

TEST(AutocorrelationTime, OfWhatNeverChangesIsItsLength) {
  EXPECT_EQ(autocorrelationTime(std::vector<double>(100, 3.0)), 100);
  EXPECT_EQ(autocorrelationTime({}), 1);
}

// Three and four choices, the second with a draw inside of one of its values, which is needed only now and then.
const char* const kChoices = R"({"a": {"draw": {"choice": [0, 1, 2]}},
  "b": {"draw": {"choice": [0, 1, {"draw": {"uniform": [2, 3]}}, 4]}}})";

struct Choice {
  int a = 0;
  double b = 0;
};

Choice choiceOf(const JsonValue& document, const UniformSource& uniform) {
  const JsonValue made = drawn(document, uniform).document;
  const auto numberAt = [&](const char* key) { return std::get<double>(memberOf(made, key)->content); };
  return {static_cast<int>(numberAt("a")), numberAt("b")};
}

// What is likely varies by e^4.6 = 100; one of the twelve cannot be. Between 2 and 3 it is constant, so that this
// choice is like the others.
double logLikelihoodOf(const Choice& choice) {
  const int b = std::min(static_cast<int>(choice.b), 3);
  if (choice.a == 1 && b == 1) return -std::numeric_limits<double>::infinity();
  return 2.3 * ((choice.a + 2 * b) % 3);
}

MetropolisChain::Evaluate evaluationOf(const JsonValue& document) {
  return [&document](const UniformSource& uniform, const std::vector<NamedBumpChange>&) {
    return ChainOutcome{logLikelihoodOf(choiceOf(document, uniform))};
  };
}

int cellOf(const Choice& choice) {
  return 4 * choice.a + std::min(static_cast<int>(choice.b), 3);
}

struct ChainOfChoices {
  std::vector<std::vector<double>> inCell = std::vector<std::vector<double>>(12);  // 0 or 1 at each step
  std::vector<double> inside;                                                      // values drawn between 2 and 3
};

ChainOfChoices runChoices(int steps) {
  FaultList faults("test", ErrorKind::scene);
  const JsonValue document = readJson(kChoices, faults);
  MetropolisChain chain(drawPlaces(document), false, evaluationOf(document), RandomStream(7),
                        {{{"/a", {0.5}}, {"/b", {0.3}}}, -std::numeric_limits<double>::infinity()});
  ChainOfChoices result;
  for (int i = 1; i <= steps; ++i) {
    chain.step(i);
    const Choice choice = choiceOf(document, [&](const std::string& pointer, std::size_t index) {
      return chain.state().numbers.at(pointer).at(index);
    });
    for (int cell = 0; cell < 12; ++cell)
      result.inCell[static_cast<std::size_t>(cell)].push_back(cellOf(choice) == cell);
    if (choice.b > 2 && choice.b < 3) result.inside.push_back(choice.b - 2);
  }
  return result;
}

// Expected is the enumeration of all twelve, whose prior is equal. A share p of n steps with an autocorrelation time t
// scatters by sqrt(p (1 - p) t / n); five of that are exceeded once in 10^5.
TEST(MetropolisChains, OverChoicesHaveTheSharesOfTheirEnumeration) {
  constexpr int kSteps = 40'000;
  const ChainOfChoices chain = runChoices(kSteps);
  std::array<double, 12> weights{};
  double sum = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 4; ++b)
      sum += weights[static_cast<std::size_t>(4 * a + b)] = std::exp(logLikelihoodOf({a, b + 0.0}));
  for (std::size_t cell = 0; cell < 12; ++cell) {
    const std::vector<double>& steps = chain.inCell[cell];
    const double share = std::accumulate(steps.begin(), steps.end(), 0.0) / kSteps;
    const double expected = weights[cell] / sum;
    const double deviation = std::sqrt(expected * (1 - expected) * autocorrelationTime(steps) / kSteps);
    EXPECT_NEAR(share, expected, 5 * deviation) << cell;
    EXPECT_LT(deviation, 0.02) << cell;
  }
}

// A draw that is needed only where another one chooses it is uniform there: mean 1/2, variance 1/12.
TEST(MetropolisChains, KeepTheDistributionOfDrawsThatAreNeededNowAndThen) {
  const std::vector<double> inside = runChoices(40'000).inside;
  const double count = static_cast<double>(inside.size());
  ASSERT_GT(count, 1000);
  double mean = 0, variance = 0;
  for (const double value : inside) mean += value / count;
  for (const double value : inside) variance += (value - mean) * (value - mean) / count;
  const double time = autocorrelationTime(inside);
  EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(time / 12 / count));
  EXPECT_NEAR(variance, 1.0 / 12, 5 * std::sqrt(time / 180 / count));  // Var[(x - 1/2)^2] = 1/80 - 1/144 = 1/180
}

TEST(MetropolisChains, StepsAreFunctionsOfTheirStateAndNumber) {
  FaultList faults("test", ErrorKind::scene);
  const JsonValue document = readJson(kChoices, faults);
  const MetropolisChain::Evaluate evaluate = evaluationOf(document);
  MetropolisChain whole(drawPlaces(document), false, evaluate, RandomStream(3), {{{"/a", {0.1}}, {"/b", {0.6}}}, 0});
  for (int i = 1; i <= 50; ++i) whole.step(i);
  MetropolisChain first(drawPlaces(document), false, evaluate, RandomStream(3), {{{"/a", {0.1}}, {"/b", {0.6}}}, 0});
  for (int i = 1; i <= 20; ++i) first.step(i);
  MetropolisChain second(drawPlaces(document), false, evaluate, RandomStream(3), first.state());
  for (int i = 21; i <= 50; ++i) second.step(i);
  EXPECT_EQ(second.state().numbers, whole.state().numbers);
  EXPECT_EQ(second.state().logLikelihood, whole.state().logLikelihood);
}

// A walk whose length depends on its bumps: each of the impacts 1, 2, ... adds a bit, that of its seed and number, and
// the walk ends after impact 2 if the first bit is 0, else after impact 4. A sum of three or more bits is three times
// as likely as others. By enumeration: half of the walks are short and have 2 bits, whose first is 0; the others have
// 4, of which the first is 1, so that P(sum >= 3) of these is P(of 3 bits >= 2) = 1/2. Of all walks 1/4 are weighed by
// 3, 3/4 by 1: 3/4 : 3/4. A chain whose proposals are not weighed by the numbers of impacts comes to another share.
TEST(MetropolisChains, OverBumpsHaveTheSharesOfTheirEnumeration) {
  const auto bitOf = [](std::uint64_t seed, int impact) {
    return RandomStream(seed).at(static_cast<std::uint64_t>(impact)).nextUniform() < 0.5 ? 0 : 1;
  };
  const auto seedOf = [](std::uint64_t seed, const std::vector<NamedBumpChange>& changes, int impact) {
    int from = 0;
    for (const NamedBumpChange& change : changes)
      if (change.impact <= impact && change.impact >= from) from = change.impact, seed = change.seed;
    return seed;
  };
  const auto outcomeOf = [&](const UniformSource& uniform, const std::vector<NamedBumpChange>& changes) {
    const auto seed = static_cast<std::uint64_t>(0x1p52 * uniform(kBumpSeedPlace, 0));
    int sum = bitOf(seedOf(seed, changes, 1), 1);
    const int count = sum == 0 ? 2 : 4;
    for (int impact = 2; impact <= count; ++impact) sum += bitOf(seedOf(seed, changes, impact), impact);
    return ChainOutcome{sum >= 3 ? std::log(3.0) : 0, {{"ball", count}}};
  };
  const ChainOutcome start = outcomeOf([](const std::string&, std::size_t) { return 0.3; }, {});
  MetropolisChain chain({}, true, outcomeOf, RandomStream(5),
                        {{{kBumpSeedPlace, {0.3}}}, start.logLikelihood, {}, start.impacts});
  std::vector<double> isLarge, isLong;
  for (int i = 1; i <= 40'000; ++i) {
    chain.step(i);
    isLarge.push_back(chain.state().logLikelihood > 0), isLong.push_back(chain.state().impacts.at("ball") == 4);
  }
  const auto expectShare = [](const std::vector<double>& steps, double expected) {
    const double count = static_cast<double>(steps.size());
    const double share = std::accumulate(steps.begin(), steps.end(), 0.0) / count;
    EXPECT_NEAR(share, expected, 5 * std::sqrt(expected * (1 - expected) * autocorrelationTime(steps) / count));
  };
  expectShare(isLarge, 0.5);
  expectShare(isLong, (0.25 * 3 + 0.25) / 1.5);
}

}  // namespace
}  // namespace cradle
