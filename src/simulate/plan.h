#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dynamics/integrators/step.h"
#include "scene/scene.h"

namespace cradle {

constexpr double kContactTimeStep = 1.0 / 960;  // s, of contact that events do not serve: 16 steps a frame at 60/s

/// The method that moves an island.
struct ChosenMethod {
  Integrator integrate = nullptr;  // null: closed form
  std::string_view name;
  double timeStep = 0;         // s, fixed; 0: chosen by the error
  double tolerance = 0;        // of the local error, scaled 1 + |x|, if the error chooses the step
  bool hasCollisions = false;  // closed form between collisions without loss
  bool isPile = false;         // many bodies in contact: the fast step, as in impact/pile_step.h

  bool isClosedForm() const { return !integrate && !isPile; }
  bool isAdaptive() const { return integrate && timeStep == 0; }
};

/// Bodies that depend on each other, by ties, springs or contact that may come about, and how they are moved.
struct IslandPlan {
  std::vector<int> bodies;    // scene bodies that move, ascending
  std::vector<int> touching;  // scene bodies, fixed ones too, that may touch something during the run, ascending
  std::vector<int> unturned;  // of the bodies, those on which no torque ever acts: balls held at their centres
  ChosenMethod method;
  std::string_view reason;
  std::vector<std::string_view> leftOut;  // what these bodies do not need
};

/// What a scene needs, and no more.
struct Plan {
  std::vector<IslandPlan> islands;  // in the order of their first bodies
  double accuracy = 0;              // asked
};

/// O(pairs of bodies), some 1e-8 s for each.
Plan planOf(const Scene& scene);

/// All that moves as one island without a method, for what looks at a scene as a whole.
IslandPlan wholeScene(const Scene& scene);

/// The methods of all islands, each named once; and what accuracy they promise.
std::string methodNames(const Plan& plan);
std::string accuracyPromised(const Plan& plan);

/// The plan in words, a few lines for each kind of island.
std::string describe(const Plan& plan, const Scene& scene);

}  // namespace cradle
