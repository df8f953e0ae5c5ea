#pragma once

#include <functional>
#include <optional>

#include "commands/data_set.h"

namespace cradle {

/// Numbers of samples, half-open.
struct SampleRange {
  long first, end;
};

/// Throws Error(usage) if a scene has no draws, or no wishes but such as are drawn: then chains sample nothing.
void requireChains(const SceneSampler& sampler);

/// A Markov chain over the draws of a scene, for its wishes, of which each state is a sample. Chain c begins with the
/// sample c that is drawn without wishes.
class SampleChain {
 public:
  /// Keeps references.
  SampleChain(const SceneSampler& sampler, const DataSet& set, std::uint64_t seed, long chain)
      : sampler_(sampler), set_(set), seed_(seed), chain_(chain) {}

  /// Makes samples, from the chain's start on; goes on behind those that are there, whole, as if it had not been ended.
  /// tell() is called for each.
  void make(const SampleRange& range, const std::function<void()>& tell) const;

 private:
  std::optional<SampleRecord> lastWhole(const SampleRange& range, const std::function<void()>& tell) const;
  SampleRecord begin(long number) const;

  const SceneSampler& sampler_;
  const DataSet& set_;
  std::uint64_t seed_;
  long chain_;
};

}  // namespace cradle
