#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "simulate/events/active_contacts.h"
#include "simulate/one_island.h"

namespace cradle {

constexpr double kStaticFriction = 0.5, kDynamicFriction = 0.3;

/// Gravity over a slope that falls along x with that tangent, y out of it.
inline std::string slopeOf(double tangent) {
  const double cosine = 1 / std::hypot(1, tangent);
  return fmt::format(R"("gravity": [{}, {}, 0])", kGravity * tangent * cosine, -kGravity * cosine);
}

/// What lies on the plane y = 0, of materials with friction and without.
struct OnPlane : OneIsland {
  explicit OnPlane(const std::string& bodies, const std::string& more = R"("gravity": [0, -9.81, 0])")
      : OneIsland(R"("duration": 1, "materials": {
          "rough": {"restitution": 0, "staticFriction": 0.5, "dynamicFriction": 0.3},
          "smooth": {"restitution": 0, "staticFriction": 0, "dynamicFriction": 0}}, "bodies": [
          {"name": "floor", "shape": {"plane": {}}, "motion": "static", "material": "rough"}, )" +
                  bodies + "], " + more),
        tolerances(eventTolerancesOf(eventScalesOf(island))),
        active(island, tolerances),
        solver(mechanism().constraints, mechanism().bodies) {}

  void classify(const std::optional<ContactChange>& change = std::nullopt) {
    active.release(change);
    if (solver.hasConstraints()) solver.factorize(state());
    active.classify(contactsWithin(tolerances.touch), solver);
  }
  const std::vector<ContactConstraint>& contacts() { return mechanism().contacts; }
  /// N, m/s^2: what acts now.
  double normalForces() {
    double sum = 0;
    for (const ContactForce& force : island.equations.contactForces()) sum += force.normal;
    return sum;
  }
  Vec3 acceleration(int body) {
    island.equations.evaluate(0, state(), derivative);
    return linearVelocity(derivative, body);
  }

  EventTolerances tolerances;
  ActiveContacts active;
  ConstraintSolver solver;
  VectorX derivative;
};

const char* const kBox = R"({"name": "box", "shape": {"box": {"size": [0.4, 0.2, 0.6]}}, "mass": 3,
  "position": [0, 0.1, 0], "material": "rough")";

/// A ball of 1 kg and 0.2 m with 0.3 m r^2 about z, the axis that it rolls about on the slope.
const char* const kBall = R"({"name": "ball", "shape": {"sphere": {"radius": 0.2}}, "mass": 1, "material": "rough",
  "centerOfMass": [0, 0, 0], "inertiaTensor": [[0.014, 0, 0], [0, 0.01, 0], [0, 0, 0.012]], "position": [0, 0.2, 0])";

}  // namespace cradle
