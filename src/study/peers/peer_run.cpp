#include "study/peers/peer_run.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "constraints/invariants.h"
#include "core/cpu_stopwatch.h"
#include "core/interruption.h"
#include "dynamics/integrators/semi_implicit_euler.h"
#include "simulate/energy_guard.h"

namespace cradle {
namespace {

constexpr double kSameTime = 1e-6;  // of a step
constexpr double kFineStep = 1e-6;  // s: engines that choose their steps get no allowance for the error of a long one

Frame frameOf(const Assembly& assembly, const VectorX& state, long number, double time) {
  Frame frame{number, time, {}, {}};
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    frame.states.push_back({centerOfMass(state, body), orientation(state, body), linearVelocity(state, body),
                            angularVelocity(state, body)});
  const Invariants sums = invariantsOf(assembly.mechanism, state);
  frame.energy.kinetic = sums.kinetic, frame.energy.potential = sums.potential;
  frame.energy.momentum = sums.momentum, frame.energy.angularMomentum = sums.angularMomentum;
  return frame;
}

bool hasDrives(const Assembly& assembly) {
  return !assembly.mechanism.driven.empty() || !assembly.mechanism.motors.empty();
}

}  // namespace

SteppedWorld::SteppedWorld(double timeStep, long evaluationsPerStep)
    : timeStep_(timeStep), evaluationsPerStep_(evaluationsPerStep) {}

void SteppedWorld::advance(double time) {
  const long steps = static_cast<long>(std::ceil(time / timeStep_ - kSameTime));
  for (; steps_ < steps; ++steps_) step();
}

RunCost runPeer(const Peer& peer, double setting, const Scene& scene, const Assembly& assembly,
                const std::function<void(const Frame&)>& take) {
  const std::unique_ptr<PeerWorld> world = peer.open(scene, assembly, setting);
  const double timeStep = peer.setting == SettingKind::timeStep ? setting : kFineStep;
  const ChosenMethod method{MotionKind::fixedSteps, "semi-implicit Euler", timeStep, semiImplicitEuler, 0, nullptr, 1};
  EnergyGuard guard(assembly, assembly.state, method, scene.duration);
  VectorX state = assembly.state;
  const bool isDriven = hasDrives(assembly);  // no engine tells the work of drives: all that changes is taken for it
  const double startEnergy = mechanicalEnergy(assembly.mechanism, state);
  CpuStopwatch integration;
  for (long number = 0; number <= lastFrame(scene); ++number) {
    const double time = frameTime(scene, number);
    integration.start();
    world->advance(time);
    world->read(state);
    integration.stop();
    if (isDriven) pushWork(state) = mechanicalEnergy(assembly.mechanism, state) - startEnergy;
    guard.check(state, time, timeStep);
    take(frameOf(assembly, state, number, time));
    throwIfInterrupted();
  }
  return {integration.seconds(), world->evaluations()};
}

bool mayChangeEnergy(const Assembly& assembly) {
  if (hasDrives(assembly)) return true;
  for (const SpringForce& spring : assembly.mechanism.springs)
    if (spring.damping > 0) return true;
  std::set<std::size_t> surfaces;
  for (const Collider& collider : assembly.geometry.colliders)
    surfaces.insert(static_cast<std::size_t>(collider.surface));
  for (const PlaneCollider& plane : assembly.geometry.planes) surfaces.insert(static_cast<std::size_t>(plane.surface));
  for (const std::size_t a : surfaces)
    for (const std::size_t b : surfaces) {
      const ContactMaterial& material = assembly.geometry.materials[a][b];
      if (material.restitution < 1 || material.dynamicFriction > 0) return true;
    }
  return false;
}

}  // namespace cradle
