#pragma once

#include <string>
#include <vector>

#include "dynamics/free_rotation.h"
#include "simulate/assembly.h"
#include "simulate/spheres/event_queue.h"
#include "simulate/spheres/sphere_impact.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Event-driven motion of an island of hard spheres that bounce without loss: closed form from collision to collision,
/// in the order of time (B. D. Lubachevsky, J. Computational Physics 94, 1991).
class HardSpheres {
 public:
  /// Keeps a reference to `scene`, whose island this is.
  HardSpheres(const Scene& scene, Assembly assembly, SphereWorld world);

  /// All that a run needs beside scene and assembly to go on; `origin`, `originRest` and `time` are as below.
  struct Record {
    VectorX state;
    std::vector<SphereFlights::Record> flights;
    double origin = 0, originRest = 0, time = 0;  // s
  };
  /// Goes on from a record: predictions are made anew.
  HardSpheres(const Scene& scene, Assembly assembly, SphereWorld world, const Record& record);
  HardSpheres(const HardSpheres&) = delete;
  HardSpheres& operator=(const HardSpheres&) = delete;

  /// The state at `time` (s), not earlier than in the call before; at an instant of collisions the state after them.
  /// Throws Error(limit) if collisions do not come to an end, or a sphere comes to lie on another; Error(interrupted).
  const VectorX& stateAt(double time);

  /// What planes carry of spheres that roll or lie on them, in the state of the last call of stateAt.
  std::vector<ContactWrench> contactWrenches() const;

  const Assembly& assembly() const { return assembly_; }

  /// To be called when all events were taken.
  Record record() const { return {state_, flights_.record(), origin_, originRest_, time_}; }

  /// As IslandSolver's.
  long work() const { return kWorkOfEvaluation * evaluations_; }

  /// Parabolas evaluated for collisions, ways out of cells, and frames.
  long evaluations() const { return evaluations_; }

  /// Events since the last call: up to the time asked for.
  std::vector<Event> takeEvents();

 private:
  static constexpr long kWorkOfEvaluation = 8;  // 2.5 us each, with the search for collisions behind it

  void advance();
  void moveOrigin();
  void cross(int sphere);
  void collide(int sphere);
  void predict(int sphere);
  void schedule(int sphere);
  void addEvents();
  void countHit(int sphere);
  void refuseLastingContact() const;
  double timeSinceStart() const { return origin_ + (originRest_ + time_); }
  double sinceOrigin(double time) const { return (time - origin_) - originRest_; }
  int sceneBodyOf(int other) const;
  std::string nameOf(int other) const;

  const Scene& scene_;
  Assembly assembly_;
  SphereWorld world_;
  SphereFlights flights_;
  SphereImpact impact_;
  EventQueue queue_;
  std::vector<PredictedCollision> collisions_;  // by sphere
  std::vector<CellCrossing> crossings_;         // by sphere
  std::vector<FreeRotation> rotations_;
  struct Window {
    double start = 0;  // s
    long hits = 0;
  };
  std::vector<Window> windows_;  // by sphere
  std::vector<Event> events_;
  VectorX state_;
  double origin_ = 0, originRest_ = 0;  // s: their sum is the time 0 of all times below, and of flights and collisions
  double time_ = 0;                     // s, of the last event
  long eventsSinceOrigin_ = 0;
  long evaluations_ = 0;
};

/// The spheres of an island that HardSpheres can move: a SphereWorld in which nothing lies on anything but planes at
/// the start.
std::optional<SphereWorld> hardSpheresOf(const Scene& scene, const IslandPlan& island);

}  // namespace cradle
