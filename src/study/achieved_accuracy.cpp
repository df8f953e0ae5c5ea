#include "study/achieved_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/named_accuracy.h"
#include "simulate/colliders.h"
#include "simulate/simulate.h"
#include "simulate/world.h"
#include "study/motion_error.h"
#include "study/run_evidence.h"
#include "study/stepped_runs.h"
#include "trajectory/compare_trajectories.h"

namespace cradle {
namespace {

constexpr double kFiner = 100;                // times
constexpr double kLargestDisturbance = 1e-5;  // m/s and rad/s
constexpr double kMaxOffset = 0.01;           // of a body's size, up to the horizon
constexpr std::size_t kFramesBefore = 6;      // a fault comes at once: growth is what it was before

/// By how much a fixed time step has to be divided for a hundredth of the error.
double divisorOf(MethodName method) {
  if (method == MethodName::rk4) return 4;     // order 4: 256
  if (method == MethodName::dop853) return 2;  // order 8: 256
  return kFiner;                               // order 1
}

bool isHeap(const Scene& scene) {
  const Plan plan = planOf(scene);
  return std::any_of(plan.islands.begin(), plan.islands.end(),
                     [](const IslandPlan& island) { return island.method.kind == MotionKind::pile; });
}

/// Makes the scene's runs finer, and says how.
std::string refine(Scene& scene) {
  if (scene.method && scene.method->timeStep) {
    *scene.method->timeStep /= divisorOf(scene.method->name);
    return fmt::format("time step {:.3g} s", *scene.method->timeStep);
  }
  scene.accuracy = std::max(scene.accuracy / kFiner, kFinestAccuracy);
  scene.namesAccuracy = true;
  return fmt::format("accuracy {:.3g}", scene.accuracy);
}

/// Every body a little faster, in no direction that a scene is likely to have a symmetry of.
void disturb(Scene& scene, double disturbance) {
  for (Body& body : scene.bodies) {
    if (body.motion != Motion::dynamic) continue;
    body.linearVelocity += disturbance * Vec3(0.48, 0.6, 0.64);
    body.angularVelocity += disturbance * Vec3(0.64, 0.48, 0.6);
  }
}

std::vector<BodyError> bodiesOf(const Scene& scene) {
  std::vector<BodyError> bodies;
  for (const Body& body : scene.bodies)
    if (body.motion != Motion::fixed) bodies.push_back({body.name, 0, 0});
  return bodies;
}

void compare(const Frame& frame, const Frame& finer, std::vector<BodyError>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyDifference difference = differenceOf(frame.states[i], finer.states[i]);
    const double error = std::max(difference.position, difference.orientation);
    if (error > bodies[i].error) bodies[i] = {bodies[i].body, error, frame.time};
  }
}

/// m: the radius of what moves, as of its collider if it had one; 0 of a shape that can have none.
std::vector<double> radiiOf(const Scene& scene) {
  std::vector<double> radii;
  for (Body body : scene.bodies) {
    if (body.motion == Motion::fixed) continue;
    if (body.collision == CollisionChoice::none) body.collision = CollisionChoice::automatic;
    const auto collider = colliderOf(body, scene, 0);
    radii.push_back(collider ? collider->boundingRadius : 0);
  }
  return radii;
}

/// A bound on the distance of any point of a body from its place in the other state, in sizes of the body: twice its
/// radius (m).
double offsetInSizes(const BodyState& state, const BodyState& reference, double radius) {
  const double turned = state.orientation.angularDistance(reference.orientation);
  return ((state.position - reference.position).norm() + turned * radius) / (2 * radius);
}

/// Whether contact that may come about is found as events.
bool hasEvents(const Scene& scene) {
  const Plan plan = planOf(scene);
  return !scene.method && std::any_of(plan.islands.begin(), plan.islands.end(), [](const IslandPlan& island) {
    return island.method.isAdaptive() && !island.touching.empty();
  });
}

/// The run of a trajectory file, frame by frame with what came before each.
class ReadRun {
 public:
  explicit ReadRun(const TrajectoryReader& run) : run_(run), events_(run.events()) {}

  Frame frameAt(long number, RunEvidence& evidence) {
    Frame frame = run_.readFrame(number);
    for (; next_ < events_.size() && events_[next_].time <= frame.time; ++next_) evidence.add(events_[next_]);
    evidence.add(frame);
    return frame;
  }

  bool keptPromises() const {
    const auto promise = run_.meta().find("promise");
    return promise == run_.meta().end() || promise->second.find("given up") == std::string::npos;
  }

 private:
  const TrajectoryReader& run_;
  std::vector<Event> events_;
  std::size_t next_ = 0;
};

std::string textOf(const std::optional<TouchDifference>& difference, const Scene& scene) {
  if (!difference) return "";
  const auto nameOf = [&](int body) { return scene.bodies[static_cast<std::size_t>(body)].name; };
  return fmt::format("\"{}\" and \"{}\" at {:.6g} s, in {}", nameOf(difference->bodyA), nameOf(difference->bodyB),
                     difference->time, difference->isInFirst ? "the run alone" : "the finer run alone");
}

std::string textOf(const CloseImpacts& impacts, const Scene& scene) {
  const auto nameOf = [&](int body) { return scene.bodies[static_cast<std::size_t>(body)].name; };
  return fmt::format("\"{}\" meets \"{}\" and \"{}\" within one of its steps at {:.6g} s", nameOf(impacts.body),
                     nameOf(impacts.first), nameOf(impacts.second), impacts.time);
}

std::string faultOf(const AchievedAccuracy& accuracy, const RunEvidence& run, const RunEvidence& finer) {
  const auto isTooDeep = [](const RunEvidence& evidence) {
    return evidence.overlap() && evidence.overlap()->depth > evidence.overlap()->allowed;
  };
  if (isTooDeep(run)) return accuracy.overlap;
  if (isTooDeep(finer)) return "in the finer run, " + accuracy.finerOverlap;
  if (accuracy.other && accuracy.other->disagrees)
    return fmt::format("the two methods disagree by {:.1e} at {:.6g} s, more than steps and accuracy explain",
                       accuracy.other->difference, accuracy.other->time);
  return "";
}

/// All that is compared, frame by frame.
class Comparison {
 public:
  Comparison(const Scene& scene, const TrajectoryReader& run, AchievedAccuracy& result)
      : result_(result),
        run_(run),
        finerScene_(scene),
        runEvidence_(scene, planOf(scene)),
        finerEvidence_(scene, planOf(scene)),
        growth_(result.disturbance),
        radii_(radiiOf(scene)) {
    result.isHeap = isHeap(scene);
    result.finerRun = result.isHeap ? "" : refine(finerScene_);
    disturbedScene_ = finerScene_;
    disturb(disturbedScene_, result.disturbance);
    finer_.emplace(finerScene_), disturbed_.emplace(disturbedScene_);
    if (hasEvents(scene)) stepped_.emplace(scene);
    if (!run_.keptPromises()) runEvidence_.endPromises();
  }

  void take(long number, double time) {
    const Frame frame = run_.frameAt(number, runEvidence_);
    const Frame finer = finer_->frameAt(number, time), disturbed = disturbed_->frameAt(number, time);
    for (const Event& event : finer_->takeEvents(time)) {
      finerEvidence_.add(event);
      if (stepped_) stepped_->add(event);
    }
    disturbed_->takeEvents(time);
    if (!finer_->takePromiseEnds().empty()) finerEvidence_.endPromises();
    finerEvidence_.add(finer);
    const std::size_t before = largest_.size() < kFramesBefore ? 0 : largest_.size() - kFramesBefore;
    if (stepped_) stepped_->take(finer, largest_.empty() ? 0 : largest_[before] / result_.disturbance);
    growth_.take(time, motionError(disturbed.states, finer.states));
    largest_.push_back(growth_.largest());
    const Frame& reference = result_.isHeap ? disturbed : finer;
    compare(frame, reference, whole_);
    if (!result_.horizon) findHorizon(frame, reference);
    if (!growth_.isMeaningless()) compare(frame, reference, result_.bodies);
  }

  void findHorizon(const Frame& frame, const Frame& reference) {
    double farthest = kMaxOffset;
    for (std::size_t i = 0; i < frame.states.size(); ++i) {
      if (!(radii_[i] > 0)) continue;
      const double offset = offsetInSizes(frame.states[i], reference.states[i], radii_[i]);
      if (offset <= farthest) continue;
      farthest = offset;
      result_.horizon = {frame.number, frame.time, result_.bodies[i].body};
    }
  }

  void finish(const Scene& scene, double end) {
    result_.largestDifference = growth_.largest();
    result_.divergence = growth_.divergence();
    if (runEvidence_.overlap()) result_.overlap = cradle::describe(*runEvidence_.overlap(), scene);
    if (finerEvidence_.overlap()) result_.finerOverlap = cradle::describe(*finerEvidence_.overlap(), scene);
    result_.numericalEnergy = runEvidence_.numericalEnergy();
    result_.finerEnergy = finerEvidence_.numericalEnergy();
    if (stepped_) result_.other = stepped_->result();
    if (stepped_ && result_.other->closeImpacts) result_.closeImpacts = textOf(*result_.other->closeImpacts, scene);
    result_.fault = faultOf(result_, runEvidence_, finerEvidence_);
    const bool isChaos = result_.fault.empty() && growth_.isMeaningless();
    const double until = isChaos ? *result_.divergence->meaninglessFrom : end;
    if (!result_.isHeap)
      result_.touchDifference = textOf(RunEvidence::difference(runEvidence_, finerEvidence_, until), scene);
    if (!result_.fault.empty()) result_.bodies = whole_;
  }

 private:
  AchievedAccuracy& result_;
  ReadRun run_;
  Scene finerScene_, disturbedScene_;
  std::optional<World> finer_, disturbed_;
  std::optional<SteppedRuns> stepped_;
  RunEvidence runEvidence_, finerEvidence_;
  GrowthMeter growth_;
  std::vector<double> radii_;                      // m, of what moves
  std::vector<double> largest_;                    // differences that the disturbance made until each frame
  std::vector<BodyError> whole_ = result_.bodies;  // errors over the whole run
};

}  // namespace

AchievedAccuracy achievedAccuracy(const Scene& scene, const TrajectoryReader& run,
                                  const std::function<void(long)>& tick) {
  AchievedAccuracy result;
  result.bodies = bodiesOf(scene);
  result.disturbance = std::min(scene.accuracy, kLargestDisturbance);
  Comparison comparison(scene, run, result);
  for (long number = 0; number < run.frameCount(); ++number) {
    comparison.take(number, frameTime(scene, number));
    tick(number + 1);
  }
  comparison.finish(scene, frameTime(scene, std::max(0L, run.frameCount() - 2)));
  return result;
}

}  // namespace cradle
