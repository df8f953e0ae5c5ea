#pragma once

#include <string>
#include <vector>

#include "dynamics/free_rotation.h"
#include "simulate/assembly.h"
#include "simulate/balls/ball_impact.h"
#include "simulate/balls/event_queue.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// An island of balls that bounce without loss, in motion: closed form from collision to collision, in the order of
/// time.
class FlyingBalls {
 public:
  /// Keeps a reference to `scene`, whose island this is.
  FlyingBalls(const Scene& scene, Assembly assembly, BallWorld world);
  FlyingBalls(const FlyingBalls&) = delete;
  FlyingBalls& operator=(const FlyingBalls&) = delete;

  /// The state at `time` (s), not earlier than in the call before; at an instant of collisions the state after them.
  /// Throws Error(limit) if collisions do not come to an end, or a ball comes to lie on another; Error(interrupted).
  const VectorX& stateAt(double time);

  const Assembly& assembly() const { return assembly_; }

  /// Parabolas evaluated for collisions, ways out of cells, and frames.
  long evaluations() const { return evaluations_; }

  /// Events since the last call: up to the time asked for.
  std::vector<Event> takeEvents();

 private:
  void advance();
  void moveOrigin();
  void cross(int ball);
  void collide(int ball);
  void foresee(int ball);
  void schedule(int ball);
  void record();
  void countHit(int ball);
  void refuseLastingContact() const;
  double timeSinceStart() const { return origin_ + (originRest_ + time_); }
  double sinceOrigin(double time) const { return (time - origin_) - originRest_; }
  int sceneBodyOf(int other) const;
  std::string nameOf(int other) const;

  const Scene& scene_;
  Assembly assembly_;
  BallWorld world_;
  BallFlights flights_;
  BallImpact impact_;
  EventQueue queue_;
  std::vector<Meeting> meetings_;    // by ball
  std::vector<Crossing> crossings_;  // by ball
  std::vector<FreeRotation> rotations_;
  struct Window {
    double start = 0;  // s
    long hits = 0;
  };
  std::vector<Window> windows_;  // by ball
  std::vector<Event> events_;
  VectorX state_;
  double origin_ = 0, originRest_ = 0;  // s: their sum is the time 0 of all that follows, and of flights and meetings
  double time_ = 0;                     // s, of the last event
  long eventsSinceOrigin_ = 0;
  long evaluations_ = 0;
};

/// The balls of an island that FlyingBalls can move: a BallWorld in which nothing lies on anything but planes at the
/// start.
std::optional<BallWorld> flyingBallsOf(const Scene& scene, const IslandPlan& island);

}  // namespace cradle
