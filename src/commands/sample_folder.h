#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sampling/metropolis_chain.h"
#include "sampling/wish_watch.h"
#include "scene/draws.h"

// A data set is a folder of samples, sample_000000, ..., each with its scene and what was made of it, and an index.

namespace cradle {

inline constexpr const char* kIndexFile = "index.json";

constexpr long kMaxSamples = 1'000'000;  // that folder names have digits for

/// sample_000017
std::string sampleName(long number);

/// The place of a sample in a Markov chain.
struct ChainRecord {
  long chain = 0, iteration = 0;  // from 0 on; iteration 0 is drawn without wishes
  bool isAccepted = true;         // else the state is that of the sample before
  long sameAs = 0;                // the sample that came to this state; itself if it was accepted
  ChainState state;               // of the index the likelihood alone
};

/// What is known of a sample, kept as sample.json in its folder once all of it is there.
struct SampleRecord {
  long number = 0;
  std::uint64_t seed = 0;
  std::string sceneHash;  // of the text of its scene.json
  int redrawn = 0;        // times that a body was drawn again, for it overlapped others
  std::vector<DrawnValue> draws;
  std::string stateHash;               // of its trajectory; empty without one
  std::string horizon;                 // frame from which on its motion is one of many, or "none"; empty: not known
  std::string pictures;                // which were drawn, and how; empty without any
  std::optional<std::string> failure;  // of its simulation
  std::vector<std::string> warnings;   // the same; told in its folder alone
  std::optional<std::string> tar;      // the file in the data set that it was packed into
  std::vector<WishOutcome> wishes;     // what came of them; empty without a simulation
  std::optional<ChainRecord> chain;
};

/// What a chain is worth.
struct ChainSummary {
  long chain = 0, samples = 0, accepted = 0, met = 0;  // met: samples of which all wishes are strictly met
  double autocorrelationTime = 1;                      // the longest of any number that is drawn, and of the likelihood
  double effectiveSamples() const { return static_cast<double>(samples) / autocorrelationTime; }
};

/// Of samples with their numbers, by chains.
std::vector<ChainSummary> summariesOf(const std::vector<SampleRecord>& records);

void writeRecord(const SampleRecord& record, const std::string& folder);

/// Nothing if there is none in the folder that can be read.
std::optional<SampleRecord> readRecord(const std::string& folder);

/// Refuses, with Error(output), a folder with others' files.
void requireSamplesAlone(const std::string& folder);

/// Lists in index.json the samples that are in a data set, and those that it lists and that were packed. Runs beside
/// each other may do so: the index of the last one lists all. Chains are there with their summaries.
void writeIndex(const std::string& folder, const std::string& scenePath, const std::vector<SampleRecord>& packed);

}  // namespace cradle
