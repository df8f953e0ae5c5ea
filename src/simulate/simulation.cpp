#include "simulate/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/time_of_impact.h"
#include "core/error.h"
#include "core/interruption.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/pose_interpolant.h"
#include "dynamics/invariants.h"

namespace cradle {
namespace {

constexpr double kImpactPart = 1e-3;  // of the touching tolerance: how well an impact's gap is closed
constexpr int kMostCorrections = 60;  // steps tried to that end; 3 are usual
constexpr int kManyEvents = 16;       // in a step: beyond, it is not cut any more
constexpr int kMostEvents = 10000;
constexpr double kEventWindow = 1.0 / 960;  // s, in which there may be so many, of methods without a fixed step
constexpr double kRopeTolerance = 1e-13;    // of the length, or of the tension that is left
constexpr double kTimeRounding = 1e-9;      // of a step: remainders below it are rounding

constexpr double kSameTime = 1e-12;      // s, relative beyond 1 s
constexpr double kManyTurns = 100;       // rad: beyond, orientations need a tighter tolerance
constexpr double kTurningPart = 0.1;     // of the tolerance, for these
constexpr double kShortTimeStep = 1e-9;  // of the run's duration: nobody waits for so many steps
constexpr int kMostShortSteps = 1000;    // in a row; after an event some are short
constexpr double kMostTieError = 1e-9;   // m (a m of coordinates) or rad: projection leaves 1e-15
constexpr double kUnitLength = 1e-9;     // how far |q|^2 may be from 1 before it is made 1

/// Errors of orientations add up over the turns: those of bodies that turn by more than 100 rad are kept smaller.
VectorX toleranceOf(const ChosenMethod& method, const VectorX& state, double duration) {
  VectorX tolerance = stateTolerance(bodyCount(state), method.tolerance, method.tolerance);
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    if (angularVelocity(state, body).norm() * duration > kManyTurns)
      tolerance.segment<4>(body * kPoseSize + 3) *= kTurningPart;
  return tolerance;
}

}  // namespace

Simulation::Simulation(const Scene& scene, Assembly assembly, const ChosenMethod& method)
    : scene_(scene),
      assembly_(std::move(assembly)),
      method_(method),
      equations_(assembly_.mechanism),
      rightHandSide_(equations_.rightHandSide()),
      log_(assembly_),
      contacts_(assembly_, equations_, log_, method_.timeStep),
      ropes_(assembly_, equations_, contacts_, log_, method_.timeStep),
      pushes_(scene, assembly_.movingBodies, log_),
      guard_(assembly_, method_, scene.duration),
      solver_(assembly_.mechanism.constraints, assembly_.mechanism.bodies),
      motions_(assembly_.mechanism.bodies.size()),
      state_(assembly_.state) {
  contacts_.resolve(time_, state_, state_);
  ropes_.resolve(time_, state_);
  beginAndEndPushes();
  requireUnsolvedPairsApart();
  if (method_.isAdaptive()) tolerance_ = toleranceOf(method_, state_, scene.duration);
  if (solver_.hasConstraints()) solver_.factorize(state_);
  startTieError_ = solver_.largestError();
}

const VectorX& Simulation::stateAt(double time) {
  const double same = kSameTime * std::max(1.0, time);
  while (time_ < time - same) {
    throwIfInterrupted();
    if (isAtRest())
      restUntil(time);
    else
      advance(time);
  }
  if (time_ <= time + same) {
    reported_ = state_;
  } else {
    interpolate(step_, (time - step_.time) / step_.timeStep, reported_);
    if (keepsTies_ && solver_.hasConstraints()) solver_.project(reported_);
  }
  normalizeOrientations(reported_);
  for (std::size_t i = 0; i < assembly_.mechanism.bodies.size(); ++i)
    if (!assembly_.mechanism.bodies[i].turns) spin(static_cast<Eigen::Index>(i), time, reported_);
  return reported_;
}

/// Sets the orientation of a body whose spin is constant: the state keeps that of the start.
void Simulation::spin(Eigen::Index body, double time, VectorX& state) const {
  turnBody(state, body, time * Vec3(angularVelocity(state, body)));
}

/// Takes a step. `frame` (s) is the next time whose state is asked for.
void Simulation::advance(double frame) {
  const double stepEnd = nextStepEnd();

  // How far do bodies move freely?
  takeStep(stepEnd);
  const bool atEvent = stopAtFirstEvent();
  time_ = step_.time + step_.timeStep;
  if (!atEvent && time_ > stepEnd - kTimeRounding * step_.timeStep) time_ = stepEnd;

  // What the step's interpolant needs belongs to the forces of now.
  if (time_ > frame) prepareInterpolant(rightHandSide_, step_);

  // Take out what the step left wrong: lengths of rods, closing and overlapping contacts. Then what changes here?
  before_ = state_;
  state_ = step_.state;
  tidyState();
  contacts_.isCrowded() ? contacts_.resolveStep(time_, before_, state_) : contacts_.resolve(time_, before_, state_);
  const std::size_t rods = assembly_.mechanism.constraints.rods.size();
  ropes_.resolve(time_, state_);
  keepsTies_ = assembly_.mechanism.constraints.rods.size() == rods;
  beginAndEndPushes();
  guard_.check(state_, time_, step_.timeStep);
  requireUnsolvedPairsApart();

  if (atEvent) countEvent();
  if (eventsInWindow_ > kManyEvents) contacts_.setCrowded();
  if (method_.isAdaptive() || time_ < static_cast<double>(stepNumber_ + 1) * method_.timeStep) return;
  ++stepNumber_;
}

/// The end of the fixed step under way, or of the run; a push that begins or ends comes first.
double Simulation::nextStepEnd() const {
  double end = scene_.duration;
  if (!method_.isAdaptive()) {
    const double gridEnd = static_cast<double>(stepNumber_ + 1) * method_.timeStep;
    if (gridEnd <= end - kTimeRounding * method_.timeStep) end = gridEnd;
  }
  return std::min(end, pushes_.nextChange());
}

void Simulation::takeStep(double stepEnd) {
  if (std::exchange(isContinuous_, false)) carryEndRate(step_);
  if (method_.isAdaptive())
    takeAdaptiveStep(stepEnd);
  else
    integrate(stepEnd);
}

/// Steps until one is as accurate as asked.
void Simulation::takeAdaptiveStep(double stepEnd) {
  if (stepSize_.timeStep == 0) {
    beginStep(rightHandSide_, state_, time_, stepEnd - time_, step_);
    stepSize_.timeStep = firstTimeStep(rightHandSide_, tolerance_, step_);
  }
  while (true) {
    const double planned = stepSize_.timeStep, left = stepEnd - time_;
    const double length = planned >= left * (1 - kTimeRounding) ? left : planned;
    integrate(time_ + length);
    if (acceptStep(errorNorm(step_, tolerance_), step_.timeStep, stepSize_)) break;
    keepStartRate(step_);
    if (stepSize_.timeStep < kShortestTimeStep * scene_.duration) guard_.failAtShortestStep(state_, time_);
  }
  shortSteps_ = step_.timeStep < kShortTimeStep * scene_.duration ? shortSteps_ + 1 : 0;
  if (shortSteps_ > kMostShortSteps) guard_.failAtShortSteps(state_, time_, step_.timeStep);
}

/// Constraints hold to rounding after each step. Orientations are of unit length nearly enough for the equations, which
/// take their direction; a state that nothing touches lets the next step begin with this one's last rate. (Ropes may
/// pull at it yet.)
void Simulation::tidyState() {
  bool isTouched = false;
  if (solver_.hasConstraints()) {
    solver_.project(state_);
    if (method_.isAdaptive()) requireTiesKept();
    isTouched = true;
  }
  for (Eigen::Index body = 0; body < bodyCount(state_); ++body)
    isTouched = isTouched || std::abs(orientation(state_, body).squaredNorm() - 1) > kUnitLength;
  if (isTouched || !method_.isAdaptive()) normalizeOrientations(state_);
  isContinuous_ = method_.isAdaptive() && !isTouched && !ropes_.hasRopes();
}

/// Where ties leave no motion, forces without bound stop the bodies: what would follow is no motion of theirs. Anchors
/// that did not quite meet at the start never will.
void Simulation::requireTiesKept() const {
  const double error = solver_.largestError(), size = state_.head(poseComponents(state_)).cwiseAbs().maxCoeff();
  if (error > startTieError_ + kMostTieError * (1 + size)) guard_.failAtTies(state_, time_, error);
}

bool Simulation::isAtRest() const {
  return contacts_.allRest() && time_ < pushes_.nextChange();
}

/// Nothing happens before a push begins.
void Simulation::restUntil(double time) {
  time_ = std::min(time, pushes_.nextChange());
  stepNumber_ = static_cast<long>(std::floor(time_ / method_.timeStep + kTimeRounding));
  beginAndEndPushes();
}

void Simulation::integrate(double stepEnd) {
  method_.integrate(rightHandSide_, state_, time_, stepEnd - time_, step_);
}

/// What may come near within the step.
void Simulation::findNearPairs() {
  for (std::size_t body = 0; body < motions_.size(); ++body)
    motions_[body] = motionBound(step_, static_cast<int>(body), assembly_.radii[body]);
  broadPhase_.update(step_.startState, motions_, contacts_.margin(), assembly_.geometry);
}

/// Cuts the step at the first event in it. The state there is a step of its own, never the interpolant, whose error
/// would let bodies overlap.
bool Simulation::stopAtFirstEvent() {
  if (assembly_.geometry.colliders.empty() && !ropes_.hasRopes()) return false;
  prepareInterpolant(rightHandSide_, step_);
  findNearPairs();
  const auto impact =
      contacts_.isCrowded() ? std::nullopt : firstImpact(assembly_.geometry, step_, contacts_.touchTolerance());
  const auto change = ropes_.firstChange(step_);
  const double whole = step_.timeStep;
  if (impact && !(change && change->fraction < impact->fraction)) {
    shortenStepTo(impact->fraction * whole, kImpactPart * contacts_.touchTolerance(), [&](const VectorX& state) {
      return separation(assembly_.geometry, assembly_.geometry.pairs[impact->pair], impact->feature, state);
    });
  } else if (change) {
    shortenStepTo(change->fraction * whole, kRopeTolerance,
                  [&](const VectorX& state) { return ropes_.margin(*change, state); });
  }
  return impact || change;
}

/// Finds the length of step whose end is at the event, from the interpolant's guess: `margin` > 0 before the event, and
/// left between 0 and `tolerance` of it. The Illinois variant of regula falsi (M. Dowell, P. Jarratt, 1971).
void Simulation::shortenStepTo(double length, double tolerance, const std::function<double(const VectorX&)>& margin) {
  const double whole = step_.timeStep;
  const auto marginAfter = [&](double part) {
    keepStartRate(step_);
    integrate(time_ + part);
    return margin(step_.state);
  };
  double early = 0, earlyMargin = std::max(margin(state_), tolerance);  // a rope that rebounds starts at its length
  double late = length, lateMargin = marginAfter(late);
  while (lateMargin > 0 && late < whole) {  // the method is later than its interpolant
    early = late, earlyMargin = lateMargin;
    late = std::min(whole, 2 * late), lateMargin = marginAfter(late);
  }
  double earlyWeight = earlyMargin, lateWeight = lateMargin;
  for (int i = 0; i < kMostCorrections && lateMargin < -tolerance; ++i) {
    const double part = late + (early - late) * lateWeight / (lateWeight - earlyWeight);
    const double found = marginAfter(part);
    if (std::abs(found) <= tolerance) return;
    if (found > 0) {
      early = part, earlyWeight = found, lateWeight /= 2;
    } else {
      late = part, lateMargin = lateWeight = found, earlyWeight /= 2;
    }
  }
  keepStartRate(step_);
  integrate(time_ + late);
}

void Simulation::beginAndEndPushes() {
  if (time_ < pushes_.nextChange()) return;
  isContinuous_ = false;
  for (const int body : pushes_.apply(time_, state_, assembly_.mechanism.pushes)) contacts_.wake(time_, body, state_);
}

/// Contact that cannot be computed must not come about: passing through each other silently would be a lie.
void Simulation::requireUnsolvedPairsApart() const {
  for (const ColliderPair& pair : assembly_.geometry.unsolvedPairs) {
    const int a = assembly_.geometry.colliders[pair.a].body, b = bodyBOf(assembly_.geometry, pair);
    if (separationBound(assembly_.geometry, pair, poseOf(state_, a), poseOf(state_, b)) > 0) continue;
    const auto nameOf = [this](int body) {
      const auto sceneBody = static_cast<std::size_t>(assembly_.sceneBodies[static_cast<std::size_t>(body)]);
      return scene_.bodies[sceneBody].name;
    };
    throw Error(ErrorKind::scene, scene_.path,
                fmt::format("\"{}\" and \"{}\" come within reach of each other at {:.6g} s; their contact cannot be "
                            "simulated yet: keep them apart, or give one of them \"collision\": \"none\"",
                            nameOf(a), nameOf(b), time_));
  }
}

void Simulation::countEvent() {
  const double window = method_.isAdaptive() ? kEventWindow : method_.timeStep;
  if (time_ > windowStart_ + window) windowStart_ = time_, eventsInWindow_ = 0;
  if (++eventsInWindow_ <= kMostEvents) return;
  throw Error(ErrorKind::limit, "",
              fmt::format("more than {} impacts and pulls of ropes within {:.3g} s at {:.6g} s; lower a restitution of "
                          "1 between bodies that cannot separate, or take a smaller \"timeStep\"",
                          kMostEvents, window, time_));
}

}  // namespace cradle
