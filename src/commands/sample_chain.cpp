#include "commands/sample_chain.h"

#include <limits>

#include "core/error.h"
#include "core/interruption.h"
#include "sampling/metropolis_chain.h"

namespace cradle {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

/// A scene that was drawn, and what came of its wishes.
struct DrawnMotion {
  DrawnScene drawn;
  WishedMotion motion;
};

DrawnMotion motionOf(DrawnScene drawn) {
  WishedMotion motion = simulateWishes(drawn.loaded.scene);
  return {std::move(drawn), std::move(motion)};
}

/// Simulates what a chain proposes.
class Proposals {
 public:
  Proposals(const SceneSampler& sampler, DrawnMotion start) : sampler_(sampler), current_(std::move(start)) {}

  double logLikelihoodOf(const UniformSource& uniform) {
    proposed_ = {};
    auto drawn = sampler_.possibleSceneOf(uniform);
    if (!drawn) return kImpossible;
    proposed_ = drawn->numbers == current_.drawn.numbers ? current_ : motionOf(std::move(*drawn));
    return proposed_.motion.logLikelihood;
  }
  void accept() { current_ = std::move(proposed_); }
  const DrawnMotion& current() const { return current_; }

 private:
  const SceneSampler& sampler_;
  DrawnMotion current_, proposed_;
};

DrawnScene sceneOf(const SceneSampler& sampler, const UniformNumbers& numbers) {
  return sampler.sceneOf([&](const std::string& pointer, std::size_t index) {
    const auto ofDraw = numbers.find(pointer);
    // A record that lacks a number is of another scene: any will do for its text to differ.
    return ofDraw == numbers.end() || index >= ofDraw->second.size() ? 0.5 : ofDraw->second[index];
  });
}

}  // namespace

void requireChains(const SceneSampler& sampler) {
  if (sampler.places().empty())
    throw Error(ErrorKind::usage, "--chains", "the scene has no values to draw; a chain needs some to change");
  if (!sampler.hasWishes())
    throw Error(
        ErrorKind::usage, "--chains",
        "the scene has no wishes, which chains sample for, or draws them; leave --chains out, or add wishes to the "
        "scene");
}

void SampleChain::make(const SampleRange& range, const std::function<void()>& tell) const {
  SampleRecord record;  // the state of the chain
  record.number = range.first;
  long number = range.first;
  for (; number < range.end; ++number) {
    auto found = set_.found(number);
    if (!found || !found->chain) break;
    const UniformNumbers numbers = found->chain->numbers;
    record = std::move(*found);
    record.chain->chain = chain_, record.chain->iteration = number - range.first;
    set_.make(record, sceneOf(sampler_, numbers));
    tell();
  }
  DrawnMotion start = number == range.first ? motionOf(sampler_.sample(seed_, chain_))
                                            : DrawnMotion{sceneOf(sampler_, record.chain->numbers),
                                                          WishedMotion{record.wishes, record.chain->logLikelihood}};
  if (number == range.first) {
    record.chain = ChainRecord{chain_, 0, true, number, start.motion.logLikelihood, start.drawn.numbers};
    record.wishes = start.motion.outcomes;
    set_.make(record, start.drawn);
    tell(), ++number;
  }
  Proposals proposals(sampler_, std::move(start));
  MetropolisChain chain(sampler_.places(),
                        [&](const UniformSource& uniform) { return proposals.logLikelihoodOf(uniform); },
                        RandomStream(seed_).at("chain").at(static_cast<std::uint64_t>(chain_)),
                        {record.chain->numbers, record.chain->logLikelihood});
  for (; number < range.end; ++number) {
    throwIfInterrupted();
    const bool isAccepted = chain.step(number - range.first);
    if (isAccepted) proposals.accept();
    SampleRecord next;
    next.number = number;
    next.wishes = proposals.current().motion.outcomes;
    next.chain = ChainRecord{chain_,
                             number - range.first,
                             isAccepted,
                             isAccepted ? number : record.chain->sameAs,
                             chain.state().logLikelihood,
                             chain.state().numbers};
    set_.make(next, proposals.current().drawn);
    record = std::move(next);
    tell();
  }
}

}  // namespace cradle
