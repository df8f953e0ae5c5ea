#pragma once

#include <functional>
#include <string>
#include <vector>

#include "math/random_stream.h"
#include "sampling/bump_changes.h"
#include "scene/draws.h"

namespace cradle {

/// Where a Markov chain is.
struct ChainState {
  UniformNumbers numbers;    // that its scene is drawn with; those that nothing needed yet are not there
  double logLikelihood = 0;  // -infinity: it cannot be
  std::vector<NamedBumpChange> bumpChanges = {};  // one a body and impact
  ImpactCounts impacts = {};                      // of its motion, if that has bumps
};

/// The outcome of numbers and bumps that were drawn.
struct ChainOutcome {
  double logLikelihood = 0;  // -infinity: it cannot be
  ImpactCounts impacts = {};
};

/// Samples draws by how likely what follows from them is (N. Metropolis et al. 1953, W. K. Hastings 1970): the numbers
/// in (0, 1) of which the draws are functions are the state, so that the prior is uniform, and steps that are as likely
/// back as forth are accepted by the ratio of likelihoods (C. Kelemen et al., "A simple and robust mutation strategy
/// for the Metropolis light transport algorithm", 2002, call it primary sample space). One step of ten draws everything
/// anew, three draw one value anew, three move one value by a little and three all of them; how little is drawn too,
/// from 1e-4 to 1e-1 of the range, each decade equally often. Where there are bumps, half of the steps that do not draw
/// everything anew give those of one body another seed from one of its impacts on; which one, of all impacts of the
/// motion, is uniform (S. Chenney and D. Forsyth, SIGGRAPH 2000). Everything is a function of the stream and the number
/// of the step.
class MetropolisChain {
 public:
  /// The outcome of the numbers of a source, with such bumps.
  using Evaluate = std::function<ChainOutcome(const UniformSource&, const std::vector<NamedBumpChange>&)>;

  /// `places`: pointers of all draws; `stream` is the chain's own.
  MetropolisChain(std::vector<std::string> places, bool hasBumps, Evaluate evaluate, const RandomStream& stream,
                  ChainState start);

  /// The step with that number, from 1 on: whether it was accepted. Else the state is as before.
  bool step(long number);

  const ChainState& state() const { return state_; }

 private:
  /// The state to which a step goes if it is accepted.
  struct Proposal {
    UniformNumbers numbers;
    std::vector<NamedBumpChange> bumpChanges;
    std::string changedBody;  // whose bumps are new from that impact on; empty: nobody's
    int changedFrom = 0;
  };
  Proposal proposal(RandomStream& random) const;
  void changeBumps(RandomStream& random, Proposal& next) const;
  double logProposalRatio(const Proposal& next, const ImpactCounts& impacts) const;
  /// Takes numbers that are there, and those of the prior for others, which it adds.
  UniformSource sourceOf(UniformNumbers& numbers) const;

  std::vector<std::string> places_;
  bool hasBumps_;
  Evaluate evaluate_;
  RandomStream stream_;
  ChainState state_;
};

/// Steps of a stationary series that are worth one independent one: 1 + 2 sum of autocorrelations, up to where the sum
/// of two neighbours is no longer positive (C. J. Geyer, "Practical Markov chain Monte Carlo", Statistical Science 7,
/// 1992, initial positive sequence). The length for a series that never changes. O(length x result).
double autocorrelationTime(const std::vector<double>& series);

}  // namespace cradle
