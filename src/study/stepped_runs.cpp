#include "study/stepped_runs.h"

#include <algorithm>

#include "core/error.h"
#include "study/motion_error.h"

namespace cradle {
namespace {

constexpr double kOtherTimeStep = 1.0 / 3840;  // s: a quarter of what contact steps have
constexpr double kBeyondOwnError = 30;         // times what twice the step changes: no error of the steps any more
constexpr double kSeenDifference =
    1e-2;  // of two methods, in the second digit; less is what their laws of impact leave open
constexpr double kLawDifference = 1e-4;  // times the growth of small differences: the same where these grow

Scene withSteps(Scene scene, double timeStep) {
  scene.method = Method{MethodName::rk4, timeStep, "the check of accuracy"};
  return scene;
}

Frame frameOf(World& run, const Frame& other) {
  Frame frame = run.frameAt(other.number, other.time);
  run.takeEvents(other.time);
  return frame;
}

}  // namespace

SteppedRuns::SteppedRuns(const Scene& scene)
    : fineScene_(withSteps(scene, kOtherTimeStep)), coarseScene_(withSteps(scene, 2 * kOtherTimeStep)) {
  result_.timeStep = kOtherTimeStep;
  attempt([&] { fine_.emplace(fineScene_), coarse_.emplace(coarseScene_); });
}

/// Steps may fail where events do not.
template <class Action>
void SteppedRuns::attempt(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    result_.failure = error.what();
  }
}

void SteppedRuns::add(const Event& event) {
  if (event.kind != EventKind::impact || event.bodyB < 0 || closeImpacts_) return;
  const auto partnerOf = [](const Event& impact, int body) {
    return impact.bodyA == body ? impact.bodyB : impact.bodyA;
  };
  for (const int body : {event.bodyA, event.bodyB}) {
    if (fineScene_.bodies[static_cast<std::size_t>(body)].motion == Motion::fixed) continue;
    const auto [last, isFirst] = lastImpacts_.try_emplace(body, event);
    if (!isFirst && event.time <= last->second.time + kOtherTimeStep &&
        partnerOf(event, body) != partnerOf(last->second, body))
      closeImpacts_ = CloseImpacts{event.time, body, partnerOf(last->second, body), partnerOf(event, body)};
    last->second = event;
  }
}

void SteppedRuns::take(const Frame& frame, double growth) {
  if (!result_.failure.empty() || result_.disagrees || result_.closeImpacts) return;
  attempt([&] {
    const Frame fine = frameOf(*fine_, frame), coarse = frameOf(*coarse_, frame);
    const double difference = motionError(fine.states, frame.states);
    result_.ownError = std::max(result_.ownError, motionError(coarse.states, fine.states));
    if (difference > result_.difference) result_.difference = difference, result_.time = frame.time;
    if (difference <= std::max({kSeenDifference, kBeyondOwnError * result_.ownError, kLawDifference * growth})) return;
    result_.closeImpacts = closeImpacts_;
    result_.disagrees = !closeImpacts_;
  });
}

}  // namespace cradle
