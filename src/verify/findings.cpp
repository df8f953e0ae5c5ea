#include "verify/findings.h"

#include <fmt/format.h>

#include <algorithm>

namespace cradle {
namespace {

struct AspectWords {
  const char *name, *unit;
};
constexpr std::array<AspectWords, kAspects> kWords = {{{"camera", "of 1"},
                                                       {"depth", "of the depth"},
                                                       {"normal", "of 1"},
                                                       {"segmentation", "of the depth"},
                                                       {"objectCoordinates", "m"},
                                                       {"flow", "pixels"},
                                                       {"backwardFlow", "pixels"},
                                                       {"hidden", "pixels"},
                                                       {"reprojection", "pixels"},
                                                       {"silhouette", "pixels"},
                                                       {"instances", "of the value"},
                                                       {"events", "of the value"}}};

/// Of what is allowed; infinite if nothing is, but for what does not deviate.
double shareOf(double deviation, double tolerance) {
  return deviation == 0 ? 0 : deviation / tolerance;
}

}  // namespace

const char* nameOf(Aspect aspect) {
  return kWords[static_cast<std::size_t>(aspect)].name;
}

const char* unitOf(Aspect aspect) {
  return kWords[static_cast<std::size_t>(aspect)].unit;
}

bool Findings::isWorse(double deviation, double tolerance, const Tally& than) {
  const double share = shareOf(deviation, tolerance), other = shareOf(than.deviation, than.tolerance);
  return share > other || (share == other && deviation > than.deviation);
}

bool Findings::hold() const {
  return std::all_of(tallies_.begin(), tallies_.end(), [](const Tally& tally) { return tally.holds(); });
}

std::string describe(const Fault& fault, const Tally& tally, Aspect aspect) {
  const std::string pixel = fault.place.x < 0 ? "" : fmt::format("pixel ({}, {}): ", fault.place.x, fault.place.y);
  return fmt::format("{}: {}{}: found {}, expected {}; off by {:.3g} {} where {:.3g} is allowed; {} of {} values",
                     fault.place.file, pixel, nameOf(aspect), fault.found, fault.expected, tally.deviation,
                     unitOf(aspect), tally.tolerance, tally.faults, tally.values);
}

}  // namespace cradle
