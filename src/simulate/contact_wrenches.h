#pragma once

#include <utility>
#include <vector>

#include "collision/separation.h"
#include "simulate/assembly.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// What acts on B at one point of a contact: a force, or an impulse over some time.
struct ContactLoad {
  int bodyA = 0, bodyB = 0;   // of the scene
  Vec3 point = Vec3::Zero();  // m, world
  double pressure = 0;        // N or N s: with which A presses along the normal; < 0: pulls
  Vec3 normalForce = Vec3::Zero(), friction = Vec3::Zero();  // N or N s, world
  Vec3 torque = Vec3::Zero();                                // N m or N m s, beside the moments of both
};

/// The load of a force (N or N s, world) on B at a contact of a pair.
ContactLoad loadOf(const Contact& contact, const ColliderPair& pair, const Vec3& force, const Assembly& assembly);

/// Adds loads up to one wrench for each pair of bodies, at its centre of pressure: the mean of the points, weighted by
/// their pressures.
class WrenchSum {
 public:
  /// Adds a fraction of a load.
  void add(const ContactLoad& load, double fraction = 1);

  /// The wrenches, ascending by pairs of bodies. To be called once, after the last load.
  std::vector<ContactWrench> wrenches();

 private:
  /// The sum of loads that came one after the other.
  struct Pair {
    int bodyA, bodyB;
    Vec3 origin;  // m: of moments and points
    Vec3 force = Vec3::Zero(), normalForce = Vec3::Zero(), torque = Vec3::Zero();
    double weight = 0;             // N or N s, of the points
    Vec3 weighted = Vec3::Zero();  // N m or N m s: sum of weights times points

    std::pair<int, int> bodies() const { return {bodyA, bodyB}; }
    void add(const Pair& other);
  };

  std::vector<Pair> pairs_;
};

}  // namespace cradle
