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

  ChainOutcome outcomeOf(const UniformSource& uniform, const std::vector<NamedBumpChange>& bumpChanges) {
    proposed_ = {};
    auto drawn = sampler_.possibleSceneOf(uniform, bumpChanges);
    if (!drawn) return {kImpossible};
    const bool isCurrent = drawn->numbers == current_.drawn.numbers && drawn->bumpChanges == current_.drawn.bumpChanges;
    proposed_ = isCurrent ? current_ : motionOf(std::move(*drawn));
    return {proposed_.motion.logLikelihood, proposed_.motion.impacts};
  }
  void accept() { current_ = std::move(proposed_); }
  const DrawnMotion& current() const { return current_; }

 private:
  const SceneSampler& sampler_;
  DrawnMotion current_, proposed_;
};

DrawnScene sceneOf(const SceneSampler& sampler, const ChainState& state) {
  const auto numberOf = [&numbers = state.numbers](const std::string& pointer, std::size_t index) {
    const auto ofDraw = numbers.find(pointer);
    // A record that lacks a number is of another scene: any will do for its text to differ.
    return ofDraw == numbers.end() || index >= ofDraw->second.size() ? 0.5 : ofDraw->second[index];
  };
  return sampler.sceneOf(numberOf, state.bumpChanges);
}

/// What the next sample of a chain follows from.
SampleRecord stateOf(const SampleRecord& sample) {
  SampleRecord state;
  state.number = sample.number, state.wishes = sample.wishes, state.chain = sample.chain;
  return state;
}

}  // namespace

void requireChains(const SceneSampler& sampler) {
  if (sampler.places().empty() && !sampler.hasBumps())
    throw Error(ErrorKind::usage, "--chains", "the scene has no values to draw; a chain needs some to change");
  if (!sampler.hasWishes())
    throw Error(
        ErrorKind::usage, "--chains",
        "the scene has no wishes, which chains sample for, or draws them; leave --chains out, or add wishes to the "
        "scene");
}

/// The last of the samples that are there, from the start on, with all that is asked for.
std::optional<SampleRecord> SampleChain::lastWhole(const SampleRange& range, const std::function<void()>& tell) const {
  std::optional<SampleRecord> last;
  for (long number = range.first; number < range.end; ++number) {
    const auto found = set_.found(number);
    if (!found || !found->chain) break;
    last = found;
    last->chain->chain = chain_, last->chain->iteration = number - range.first;
    set_.make(*last, sceneOf(sampler_, found->chain->state));
    tell();
  }
  return last;
}

SampleRecord SampleChain::begin(long number) const {
  const DrawnMotion start = motionOf(sampler_.sample(seed_, chain_));
  SampleRecord record;
  record.number = number;
  record.wishes = start.motion.outcomes;
  record.chain =
      ChainRecord{chain_, 0, true, number, {start.drawn.numbers, start.motion.logLikelihood, {}, start.motion.impacts}};
  set_.make(record, start.drawn);
  return record;
}

void SampleChain::make(const SampleRange& range, const std::function<void()>& tell) const {
  const auto whole = lastWhole(range, tell);
  SampleRecord record = whole ? stateOf(*whole) : begin(range.first);
  if (!whole) tell();
  const ChainState& state = record.chain->state;
  Proposals proposals(sampler_, {sceneOf(sampler_, state), {record.wishes, state.logLikelihood, state.impacts}});
  MetropolisChain chain(
      sampler_.places(), sampler_.hasBumps(),
      [&](const UniformSource& uniform, const std::vector<NamedBumpChange>& bumpChanges) {
        return proposals.outcomeOf(uniform, bumpChanges);
      },
      RandomStream(seed_).at("chain").at(static_cast<std::uint64_t>(chain_)), state);
  while (record.number + 1 < range.end) {
    throwIfInterrupted();
    const long iteration = record.chain->iteration + 1;
    const bool isAccepted = chain.step(iteration);
    if (isAccepted) proposals.accept();
    ++record.number;
    record.wishes = proposals.current().motion.outcomes;
    record.chain =
        ChainRecord{chain_, iteration, isAccepted, isAccepted ? record.number : record.chain->sameAs, chain.state()};
    set_.make(record, proposals.current().drawn);
    tell();
  }
}

}  // namespace cradle
