#pragma once

#include <map>
#include <span>
#include <vector>

#include "impact/pairwise.h"
#include "scene/scene.h"
#include "simulate/assembly.h"
#include "simulate/events/event_log.h"

namespace cradle {

/// How many impacts with bumps each scene body has had; none for those that are not there.
using BumpCounts = std::map<int, int>;

/// Tilts the normals of impacts, as far as the scene's surfaces are rougher than their shapes (S. Chenney and D.
/// Forsyth, "Sampling plausible solutions to multi-body constraint problems", SIGGRAPH 2000). The tilt of the n-th
/// impact of a body is a function of the seed, the body's name and n; of two bodies that forces move the impact is one
/// of the first in the scene. Slow impacts, at the end of bouncing, have none and do not count.
class ImpactBumps {
 public:
  /// Of a fall: impacts after one from less than that part of the smaller body's radius have no bumps.
  static constexpr double kMinFallRatio = 0.01;

  /// Keeps references to both.
  ImpactBumps(const Scene& scene, const Assembly& assembly) : scene_(scene), assembly_(assembly) {}

  /// Whether the scene has any.
  bool any() const { return scene_.bumps && scene_.bumps->deviation > 0; }

  /// Whether contact is so fast, in m/s of closing, that it has bumps.
  bool isFastEnough(const Contact& contact, double closingSpeed) const;

  /// Turns the normals of the contacts that close in `state`, all of one pair by the same angle, but where they would
  /// open then. Impacts of a pair at one time are one. False if there was none to be turned.
  bool tilt(double time, const VectorX& state, std::span<ImpactContact> impacts);

  /// Warns, once, of an impact that has none, for the contacts of a step are one problem, if it changed a speed by so
  /// much (m/s) that it should.
  void noteWithout(double time, const Contact& contact, double change, EventLog& log);

  /// Of this island's bodies, by that time (s).
  BumpCounts countsBy(double time) const;

  /// To be called before the first impact.
  void goOnFrom(const BumpCounts& counts) { counts_ = counts; }

 private:
  struct Struck {
    double time = 0;  // s
    std::pair<int, int> bodies;
    int body = 0, impact = 0;
  };
  bool mayTilt(const Contact& contact, const VectorX& state) const;
  Quat turnOf(double time, const Contact& contact);
  int numberOf(double time, std::pair<int, int> bodies);
  std::uint64_t seedOf(int body, int impact) const;

  const Scene& scene_;
  const Assembly& assembly_;
  BumpCounts counts_;
  std::vector<Struck> struck_;  // here, in the order of time
  bool hasWarned_ = false;
};

}  // namespace cradle
