#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "collision/broad_phase.h"
#include "collision/time_of_impact.h"
#include "dynamics/integrators/step.h"
#include "simulate/assembly.h"
#include "simulate/events/event_log.h"
#include "simulate/impact_bumps.h"
#include "simulate/push_schedule.h"
#include "simulate/resting_bodies.h"

namespace cradle {

/// An island as all ways of moving it see it: what it is made of, where it is now, and the step that led here.
struct IslandState {
  /// Keeps a reference to `scene`.
  IslandState(const Scene& scene, Assembly assembly);
  IslandState(const IslandState&) = delete;
  IslandState& operator=(const IslandState&) = delete;

  bool mayTouch() const { return !assembly.geometry.colliders.empty(); }

  /// Sets the pairs that may come nearer than `margin` (m) to each other within the step. Its end derivative must be
  /// there.
  void findNearPairs(double margin);

  /// Sets the pairs that are nearer than that now.
  void findNearPairsNow(double margin);

  /// Sets `step` to one from `from`, the state of now, with that length (s), at whose end driven bodies are where they
  /// are to be.
  void integrate(Integrator method, const VectorX& from, double length);
  void integrate(Integrator method, double length) { integrate(method, state, length); }

  /// s: the next instant at which forces change or the motion of a driven body has a jump. No step may go beyond it.
  double nextChange() const { return std::min(pushes.nextChange(), nextJump_); }

  /// s: no step may go beyond it: the scene's end, or where the island is to stop before that.
  double lastStepEnd = 0;

  /// Lets pushes begin and end that do so now, and wakes what they act upon, and driven bodies that begin to move. True
  /// if there were any, or driven bodies that have come to a stop.
  bool makeChanges();

  /// Wakes a body with all that rests with it, with events.
  void wake(int body);

  /// Throws Error(unstable) that names the bodies of a contact that driven bodies press together.
  [[noreturn]] void failAtNoRoom(const Contact& contact) const;

  /// Throws Error(unstable) if a body is squeezed between others of which one is so much heavier that the forces on it,
  /// rounded, would move it.
  void requireComparableMasses(const std::vector<Contact>& touching) const;

  /// Contact that cannot be computed must not come about: passing through each other silently would be a lie. Throws
  /// Error(scene).
  void requireUnsolvedPairsApart() const;

  const Scene& scene;
  Assembly assembly;
  EquationsOfMotion equations;
  RightHandSide rightHandSide;
  EventLog log;
  RestingBodies resting;
  PushSchedule pushes;
  ImpactBumps bumps;
  ImpactSearch search;
  double time;    // s
  VectorX state;  // after all events of now
  Step step;      // that ended now

 private:
  BroadPhase broadPhase_;
  std::vector<double> motions_;  // m: how far the points of each body may go within the step
  double nextJump_;              // s: of driven bodies
};

}  // namespace cradle
