#pragma once

#include <string>
#include <utility>
#include <vector>

#include "collision/collider.h"
#include "constraints/equations_of_motion.h"
#include "constraints/limit.h"
#include "scene/scene.h"
#include "simulate/colliders.h"
#include "simulate/plan/plan.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Names of what moves, in the order of the mechanism; of constraints with their kind: `hinge "lid"`.
struct PartNames {
  std::vector<std::string> bodies, springs, constraints;
};

/// A hinge or a slider of an island.
struct AssembledJoint {
  Constraint coordinate;           // whose kind is a JointCoordinate: 0 at the start
  std::size_t index = 0;           // among the scene's hinges and sliders, in this order
  int motor = -1;                  // index into the mechanism's motors, or -1
  std::vector<std::size_t> stops;  // indices into the assembly's limits
  JointState start;                // where the island begins to move; 0 at time 0
};

/// A push that acts already when an island begins to move.
struct StartedPush {
  std::size_t push = 0;       // index into the scene's
  Vec3 point = Vec3::Zero();  // m: where, from the centre of mass in the body's frame
};

/// An island of a scene turned into what the methods work on.
struct Assembly {
  Mechanism mechanism;
  ContactGeometry geometry;
  std::vector<Limit> limits;
  std::vector<AssembledJoint> joints;
  double startTime = 0;             // s: when the island begins to move
  VectorX state;                    // then
  std::vector<int> sceneBodies;     // scene body of each moving body, ascending
  std::vector<std::size_t> pushes;  // of the island, indices into the scene's
  std::vector<StartedPush> startedPushes;
  bool isContinued = false;   // its bodies were of other islands before the start time, or up to it
  PartNames names;            // taut ropes stand behind the constraints named here
  double smallestSize = 1;    // m: of all that may ever come into the island, and of what is in it
  std::vector<double> radii;  // m: of each moving body's collider about its centre of mass; 0 without one
  std::vector<int> colliderBodies, planeBodies;  // scene body of each collider and plane of the geometry
  std::vector<std::pair<int, int>> limitBodies;  // scene bodies A, B of each limit; kWorld
  std::vector<std::string> warnings;
  bool hasLongSteps = false;  // a warning tells that the method's steps are too long for a spring
};

/// The constraints that hold both ways: those of the scene's links, and of pinned places. Taut limits stand behind
/// them.
Constraints tiesOf(const Assembly& assembly);

/// Index of a scene body among ascending ones, or -1 (kFixed) if it is not there. O(log n).
int indexAmong(const std::vector<int>& bodies, int body);

/// Scene bodies A, B of a pair of colliders.
std::pair<int, int> bodiesOf(const Assembly& assembly, const ColliderPair& pair);

/// The island at time 0. The scene must have passed refuseUnsupported. Start velocities that violate constraints are
/// projected, with a warning.
Assembly assemble(const Scene& scene, const IslandPlan& island);

/// A part of an assembled island that moves by itself: of its bodies and links, with the colliders of the whole. It is
/// where the scene has it: its state is beginAt's. O(bodies, links and fixed bodies of the part, log whole).
Assembly assemblePart(const Scene& scene, const IslandPlan& part, const Assembly& whole);

/// Lets an island begin to move at `time` (s), in that state, with such coordinates of its joints, and with these of
/// its pushes under way.
void beginAt(double time, const VectorX& state, const std::vector<JointState>& joints, std::vector<StartedPush> pushes,
             Assembly& assembly);

/// Throws Error(scene) that names everything in the scene that no method simulates yet, one a line.
void refuseUnsupported(const Scene& scene);

constexpr std::size_t kMaxFaultsTold = 50;  // more than anyone reads at once

/// Throws Error(scene) that tells of the first kMaxFaultsTold faults, if there are any, and how many more there are; of
/// kMaxFaultsCounted, that there are at least as many.
void refuse(const std::vector<std::string>& faults);

}  // namespace cradle
