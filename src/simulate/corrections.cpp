#include "simulate/corrections.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace cradle {

namespace {

constexpr std::size_t kNamedBodies = 4;  // of many, the first tell where

const char* textOf(CorrectionKind kind) {
  switch (kind) {
    case CorrectionKind::clampedEnergy:
      return "contact would have given {0} energy: velocities were made smaller (by {1:.3g} J)";
    case CorrectionKind::unsolvedContacts:
      return "forces of the contacts of {0} were not found to the tolerance: the best found were taken (off by "
             "{1:.3g} m/s or m/s^2)";
    case CorrectionKind::omittedFriction:
      return "no forces of the contacts of {0} were found with friction: they were solved without (off by {1:.3g} m/s)";
    case CorrectionKind::omittedContacts:
      return "no forces of the contacts of {0} were found: they were left out (off by {1:.3g} m/s)";
    case CorrectionKind::scaledImpulses:
      return "the impulses found for an impact of {0} would have given energy: they were made smaller (by {1:.3g} J)";
    case CorrectionKind::endlessImpacts:
      return "an impact of {0} did not come to an end ({1:.0f} rounds): contacts still close";
  }
  return "";
}

}  // namespace

std::string describe(const Correction& correction, const Scene& scene) {
  std::string names;
  for (std::size_t i = 0; i < std::min(correction.bodies.size(), kNamedBodies); ++i)
    names +=
        fmt::format("{}\"{}\"", i > 0 ? ", " : "", scene.bodies[static_cast<std::size_t>(correction.bodies[i])].name);
  if (correction.bodies.size() > kNamedBodies)
    names += fmt::format(" and {} more", correction.bodies.size() - kNamedBodies);
  return fmt::format("{}: at {:.6g} s {}; told once, counted in the trajectory's \"corrections\"", scene.path,
                     correction.time, fmt::format(fmt::runtime(textOf(correction.kind)), names, correction.amount));
}

std::string correctionName(CorrectionKind kind) {
  constexpr std::array<const char*, kCorrectionKinds> kNames = {
      "clampedEnergy", "unsolvedContacts", "omittedFriction", "omittedContacts", "scaledImpulses", "endlessImpacts"};
  return kNames[static_cast<std::size_t>(kind)];
}

void Corrections::record(Correction correction) {
  if (counts_[static_cast<std::size_t>(correction.kind)]++ == 0) first_.push_back(std::move(correction));
}

void Corrections::take(Corrections& other) {
  for (Correction& first : other.first_)
    if (counts_[static_cast<std::size_t>(first.kind)] == 0) first_.push_back(std::move(first));
  for (std::size_t kind = 0; kind < kCorrectionKinds; ++kind) counts_[kind] += other.counts_[kind];
  other = {};
}

void Corrections::addCounts(std::map<std::string, long>& counts) const {
  for (std::size_t kind = 0; kind < kCorrectionKinds; ++kind)
    if (counts_[kind] > 0) counts[correctionName(static_cast<CorrectionKind>(kind))] += counts_[kind];
}

std::vector<Correction> Corrections::takeFirst() {
  return std::exchange(first_, {});
}

}  // namespace cradle
