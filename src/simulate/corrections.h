#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace cradle {

/// What a method does to a motion beside the laws of mechanics, because it found no better.
enum class CorrectionKind {
  clampedEnergy,     // velocities made smaller: contact would have given energy (J)
  unsolvedContacts,  // forces of contacts that leave an error of their law (m/s, or m/s^2): the best found are taken
  omittedFriction,   // contacts solved without friction: with it, no forces were found (m/s)
  omittedContacts,   // contacts without any force: none were found (m/s)
  scaledImpulses,    // impulses made smaller: those found would have given energy (J)
  endlessImpacts,    // impacts that did not come to an end: contacts still close (rounds)
};
constexpr std::size_t kCorrectionKinds = 6;

/// As `meta` and messages name it.
std::string correctionName(CorrectionKind kind);

/// One of them.
struct Correction {
  CorrectionKind kind = CorrectionKind::clampedEnergy;
  double time = 0;          // s
  std::vector<int> bodies;  // of the scene, at least one
  double amount = 0;        // in the unit of its kind: by how much
};

/// A sentence about it, with time and bodies.
std::string describe(const Correction& correction, const Scene& scene);

/// Counts corrections, and keeps the first of each kind.
class Corrections {
 public:
  void record(Correction correction);

  /// Takes all that another one has recorded, and empties it.
  void take(Corrections& other);

  /// The first that is not taken yet; null if there is none.
  const Correction* first() const { return first_.empty() ? nullptr : &first_.front(); }

  /// Those that were the first of their kind, since the last call.
  std::vector<Correction> takeFirst();

  /// How often each kind happened.
  const std::array<long, kCorrectionKinds>& counts() const { return counts_; }

  /// Adds how often each kind happened, by its name; what did not is left out.
  void addCounts(std::map<std::string, long>& counts) const;

 private:
  std::array<long, kCorrectionKinds> counts_ = {};
  std::vector<Correction> first_;
};

}  // namespace cradle
