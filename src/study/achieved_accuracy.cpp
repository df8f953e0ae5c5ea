#include "study/achieved_accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/named_accuracy.h"
#include "simulate/run.h"
#include "simulate/simulate.h"
#include "study/motion_error.h"
#include "trajectory/compare_trajectories.h"

namespace cradle {
namespace {

constexpr double kFiner = 100;                // times
constexpr double kLargestDisturbance = 1e-5;  // m/s and rad/s
constexpr double kSteadyGrowth = 100;         // times 1 + t: phases that drift apart grow like time alone
constexpr double kFirstGrowth = 10;           // times the disturbance: from there on, growth is measured
constexpr double kSecondDigit = 1e-2;

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
    if (body.motion == Motion::dynamic) bodies.push_back({body.name, 0, 0});
  return bodies;
}

void compare(const Frame& frame, const Frame& finer, std::vector<BodyError>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyDifference difference = differenceOf(frame.states[i], finer.states[i]);
    const double error = std::max(difference.position, difference.orientation);
    if (error > bodies[i].error) bodies[i] = {bodies[i].body, error, frame.time};
  }
}

/// Follows how a small difference grows.
class GrowthMeter {
 public:
  explicit GrowthMeter(double disturbance) : disturbance_(disturbance) {}

  void take(double time, double difference) {
    largest_ = std::max(largest_, difference);
    isFast_ = isFast_ || difference > kSteadyGrowth * disturbance_ * (1 + time);
    if (meaninglessFrom_) return;
    const Point now{time, difference};
    if (first_.difference == 0 && difference > kFirstGrowth * disturbance_) first_ = last_ = now;
    if (first_.difference > 0 && difference > last_.difference) last_ = now;
    if (difference > kSecondDigit) meaninglessFrom_ = time;
  }

  double largest() const { return largest_; }
  bool isMeaningless() const { return isFast_ && meaninglessFrom_; }
  std::optional<Divergence> divergence() const {
    if (!isFast_) return std::nullopt;
    const double seconds = last_.time - first_.time;
    const double rate = seconds > 0 ? std::log(last_.difference / first_.difference) / seconds : HUGE_VAL;
    return Divergence{rate, meaninglessFrom_};
  }

 private:
  struct Point {
    double time = 0, difference = 0;  // s; 0: not yet
  };
  double disturbance_, largest_ = 0;
  bool isFast_ = false;
  Point first_, last_;  // between which growth is measured
  std::optional<double> meaninglessFrom_;
};

}  // namespace

AchievedAccuracy achievedAccuracy(const Scene& scene, const TrajectoryReader& run,
                                  const std::function<void(long)>& tick) {
  AchievedAccuracy result;
  result.bodies = bodiesOf(scene);
  result.disturbance = std::min(scene.accuracy, kLargestDisturbance);
  Scene finerScene = scene;
  result.isHeap = isHeap(scene);
  result.finerRun = result.isHeap ? "" : refine(finerScene);
  Scene disturbedScene = finerScene;
  disturb(disturbedScene, result.disturbance);
  Run finerRun(finerScene), disturbedRun(disturbedScene);
  GrowthMeter growth(result.disturbance);
  for (long number = 0; number < run.frameCount(); ++number) {
    const double time = frameTime(scene, number);
    const Frame finer = finerRun.frameAt(number, time), disturbed = disturbedRun.frameAt(number, time);
    finerRun.takeEvents(time);
    disturbedRun.takeEvents(time);
    growth.take(time, motionError(disturbed.states, finer.states));
    if (!growth.isMeaningless()) compare(run.readFrame(number), result.isHeap ? disturbed : finer, result.bodies);
    tick(number + 1);
  }
  result.largestDifference = growth.largest();
  result.divergence = growth.divergence();
  return result;
}

std::string describe(const AchievedAccuracy& accuracy) {
  std::size_t width = 4;
  for (const BodyError& body : accuracy.bodies) width = std::max(width, body.body.size());
  const std::string by = accuracy.isHeap ? "one that starts a little faster, for a heap has no finer run"
                                         : "a run at " + accuracy.finerRun;
  std::string text =
      fmt::format("Checked by {}: largest |x - x_ref| / (1 + |x_ref|) of positions (m) and orientations\n", by);
  for (const BodyError& body : accuracy.bodies)
    text += fmt::format("  {:<{}}  {:8.1e}  at {:.6g} s\n", body.body, width, body.error, body.time);
  if (!accuracy.divergence)
    return text + fmt::format("{:.0e} m/s and rad/s more at the start make a difference of {:.1e}: not chaotic.",
                              accuracy.disturbance, accuracy.largestDifference);
  const Divergence& divergence = *accuracy.divergence;
  text += fmt::format("Chaotic: {:.0e} m/s and rad/s more at the start grow by e in {:.3g} s (rate {:.3g} 1/s)",
                      accuracy.disturbance, 1 / divergence.rate, divergence.rate);
  if (!divergence.meaninglessFrom) return text + fmt::format(", to {:.1e} by the end.", accuracy.largestDifference);
  return text + fmt::format(
                    ",\nto more than {} at {:.6g} s: from there on, states are one possible motion of many, and "
                    "no error is given.",
                    kSecondDigit, *divergence.meaninglessFrom);
}

}  // namespace cradle
