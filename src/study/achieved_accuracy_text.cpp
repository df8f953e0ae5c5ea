// What is found, in words.

#include <fmt/format.h>

#include <algorithm>

#include "core/printable.h"
#include "study/achieved_accuracy.h"

namespace cradle {
namespace {

std::string evidenceText(const AchievedAccuracy& accuracy) {
  const auto orNone = [](const std::string& overlap) { return overlap.empty() ? "none" : overlap; };
  std::string text = fmt::format(
      "Deepest overlap in frames: {}; in the other run: {}\n"
      "Numerical energy (change of kinetic + potential + dissipated - work): {:.1e} of the largest kinetic energy; "
      "in the other run: {:.1e}\n",
      orNone(accuracy.overlap), orNone(accuracy.finerOverlap), accuracy.numericalEnergy, accuracy.finerEnergy);
  if (accuracy.other) {
    const OtherMethod& other = *accuracy.other;
    text += fmt::format(
        "Another method (RK4, all contact resolved every {:.3g} s) differs by {:.1e} at {:.6g} s; half as many steps "
        "change it by {:.1e}\n",
        other.timeStep, other.difference, other.time, other.ownError);
    if (!accuracy.closeImpacts.empty())
      text +=
          fmt::format("  It tells nothing from there on: {}, which makes one impact of both\n", accuracy.closeImpacts);
    if (!other.failure.empty()) text += fmt::format("  It ended before its time: {}\n", other.failure);
  }
  if (!accuracy.touchDifference.empty())
    text += fmt::format("The two runs differ in what touched: {}\n", accuracy.touchDifference);
  return text;
}

std::string sensitivityText(const AchievedAccuracy& accuracy) {
  if (!accuracy.divergence)
    return fmt::format("{:.0e} m/s and rad/s more at the start make a difference of {:.1e}: not chaotic.",
                       accuracy.disturbance, accuracy.largestDifference);
  const Divergence& divergence = *accuracy.divergence;
  const std::string text =
      fmt::format("Chaotic: {:.0e} m/s and rad/s more at the start grow by e in {:.3g} s (rate {:.3g} 1/s)",
                  accuracy.disturbance, 1 / divergence.rate, divergence.rate);
  if (!divergence.meaninglessFrom) return text + fmt::format(", to {:.1e} by the end.", accuracy.largestDifference);
  return text + fmt::format(
                    ",\nto more than {} at {:.6g} s: from there on, states are one possible motion of many, and "
                    "no error is given.",
                    kSecondDigit, *divergence.meaninglessFrom);
}

}  // namespace

std::string describe(const AchievedAccuracy& accuracy) {
  std::size_t width = 4;
  for (const BodyError& body : accuracy.bodies) width = std::max(width, printableLine(body.body).size());
  const std::string by = accuracy.isHeap ? "one that starts a little faster, for a heap has no finer run"
                                         : "a run at " + accuracy.finerRun;
  std::string text =
      fmt::format("Checked by {}: largest |x - x_ref| / (1 + |x_ref|) of positions (m) and orientations\n", by);
  for (const BodyError& body : accuracy.bodies)
    text += fmt::format("  {:<{}}  {:8.1e}  at {:.6g} s\n", printableLine(body.body), width, body.error, body.time);
  if (accuracy.horizon)
    text += fmt::format(
        "From frame {} on ({:.6g} s) the motion is one of many: \"{}\" is off by 1 % of its size. Up to there it is "
        "the "
        "scene's.\n",
        accuracy.horizon->frame, accuracy.horizon->time, printableLine(accuracy.horizon->body));
  text += evidenceText(accuracy);
  if (accuracy.fault.empty()) return text + sensitivityText(accuracy);
  return text + fmt::format("A fault, not chaos: {}. No accuracy is known from there on.", accuracy.fault);
}

}  // namespace cradle
