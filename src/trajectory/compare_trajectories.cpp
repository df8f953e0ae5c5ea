#include "trajectory/compare_trajectories.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/error.h"
#include "core/printable.h"

namespace cradle {
namespace {

// Two frames are of the same instant up to this, relative: rounding of k * playbackSpeed / framesPerSecond.
constexpr double kSameTime = 1e-12;
constexpr std::size_t kMaxListed = 10;  // bodies named in a description

/// The indices, among the bodies that move of two trajectories, of one body.
struct BodyPair {
  std::size_t expected, actual;
};

std::vector<std::string> movingBodyNames(const TrajectoryReader& reader) {
  std::vector<std::string> names;
  for (const BodyRecord& body : reader.header().bodies)
    if (body.hasStates()) names.push_back(body.name);
  return names;
}

std::vector<BodyPair> pairBodies(const TrajectoryReader& expected, const TrajectoryReader& actual,
                                 TrajectoryComparison& result) {
  const auto expectedNames = movingBodyNames(expected), actualNames = movingBodyNames(actual);
  std::unordered_map<std::string, std::size_t> unpaired;
  for (std::size_t i = 0; i < actualNames.size(); ++i) unpaired[actualNames[i]] = i;
  std::vector<BodyPair> pairs;
  for (std::size_t i = 0; i < expectedNames.size(); ++i) {
    const auto found = unpaired.find(expectedNames[i]);
    if (found == unpaired.end()) {
      result.onlyExpected.push_back(expectedNames[i]);
      continue;
    }
    pairs.push_back({i, found->second});
    result.bodies.push_back({.body = expectedNames[i]});
    unpaired.erase(found);
  }
  for (const std::string& name : actualNames)
    if (unpaired.contains(name)) result.onlyActual.push_back(name);
  return pairs;
}

double difference(const auto& actual, const auto& expected) {
  return ((actual - expected).array().abs() / (1 + expected.array().abs())).maxCoeff();
}

double difference(const Quat& actual, const Quat& expected) {
  const Eigen::Vector4d turned = -actual.coeffs();
  return std::min(difference(actual.coeffs(), expected.coeffs()), difference(turned, expected.coeffs()));
}

/// Raises a body's maxima to those of one frame, and the worst of all with them.
void include(const BodyDifference& found, const Frame& frame, BodyDifference& body, WorstDifference& worst) {
  const auto raise = [&](double BodyDifference::*maximum, const char* quantity) {
    body.*maximum = std::max(body.*maximum, found.*maximum);
    if (found.*maximum > worst.difference) worst = {body.body, quantity, frame.number, frame.time, found.*maximum};
  };
  raise(&BodyDifference::position, "position");
  raise(&BodyDifference::orientation, "orientation");
  raise(&BodyDifference::linearVelocity, "linear velocity");
  raise(&BodyDifference::angularVelocity, "angular velocity");
}

void compareFrames(const TrajectoryReader& expected, const TrajectoryReader& actual, TrajectoryComparison& result) {
  const std::vector<BodyPair> pairs = pairBodies(expected, actual, result);
  const std::vector<double>&expectedTimes = expected.frameTimes(), &actualTimes = actual.frameTimes();
  std::size_t i = 0, j = 0;
  while (i < expectedTimes.size() && j < actualTimes.size()) {
    const double ahead = actualTimes[j] - expectedTimes[i];
    if (std::abs(ahead) > kSameTime * (1 + std::abs(expectedTimes[i]))) {
      ++(ahead < 0 ? j : i);
      continue;
    }
    const Frame reference = expected.readFrame(static_cast<long>(i++));
    const Frame frame = actual.readFrame(static_cast<long>(j++));
    for (std::size_t k = 0; k < pairs.size(); ++k)
      include(differenceOf(frame.states[pairs[k].actual], reference.states[pairs[k].expected]), reference,
              result.bodies[k], result.worst);
    ++result.commonFrames;
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxListed); ++i) shown.push_back(printableLine(names[i]));
  const std::string more = names.size() > kMaxListed ? fmt::format(" and {} more", names.size() - kMaxListed) : "";
  return fmt::format("{}{}", fmt::join(shown, ", "), more);
}

}  // namespace

BodyDifference differenceOf(const BodyState& actual, const BodyState& expected) {
  return {.body = "",
          .position = difference(actual.position, expected.position),
          .orientation = difference(actual.orientation, expected.orientation),
          .linearVelocity = difference(actual.linearVelocity, expected.linearVelocity),
          .angularVelocity = difference(actual.angularVelocity, expected.angularVelocity)};
}

double BodyDifference::largest() const {
  return std::max({position, orientation, linearVelocity, angularVelocity});
}

TrajectoryComparison compareTrajectories(const TrajectoryReader& expected, const TrajectoryReader& actual,
                                         double tolerance) {
  CRADLE_CHECK(tolerance >= 0);
  TrajectoryComparison result;
  result.tolerance = tolerance;
  result.expectedFrames = expected.frameCount();
  result.actualFrames = actual.frameCount();
  const std::string expectedHash = expected.hashOfFrames(), actualHash = actual.hashOfFrames();
  result.sameStateHash = expected.isFinished() && actual.isFinished() && expectedHash == actualHash;
  if (!result.sameStateHash) compareFrames(expected, actual, result);
  const bool sameBodies = result.onlyExpected.empty() && result.onlyActual.empty();
  result.equal =
      result.sameStateHash || (sameBodies && result.commonFrames > 0 && result.worst.difference <= tolerance);
  return result;
}

std::string TrajectoryComparison::describe() const {
  if (sameStateHash) return fmt::format("equal: the states of all {} frames have the same bits", expectedFrames);
  std::string text = fmt::format("{}: {} frames in common (expected has {}, actual {}), tolerance {}",
                                 equal ? "equal" : "different", commonFrames, expectedFrames, actualFrames, tolerance);
  if (worst.difference > 0)
    text += fmt::format("\nlargest difference {:.3g}: {} of {} in frame {} ({} s)", worst.difference, worst.quantity,
                        printableLine(worst.body), worst.frame, worst.time);
  std::vector<std::string> above;
  for (const BodyDifference& body : bodies)
    if (body.largest() > tolerance) above.push_back(fmt::format("{} ({:.3g})", body.body, body.largest()));
  if (!above.empty()) text += "\nbodies above the tolerance: " + listed(above);
  if (!onlyExpected.empty()) text += "\nbodies that only the expected trajectory moves: " + listed(onlyExpected);
  if (!onlyActual.empty()) text += "\nbodies that only the actual trajectory moves: " + listed(onlyActual);
  return text;
}

}  // namespace cradle
