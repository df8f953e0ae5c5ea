#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dynamics/integrators/step.h"
#include "scene/scene.h"
#include "simulate/plan/promise.h"

namespace cradle {

constexpr double kContactTimeStep = 1.0 / 960;  // s, of contact that events do not serve: 16 steps a frame at 60/s

/// Visual accuracies are coarser than this: their pictures are looked at and no more, so that time stepping takes the
/// place of events where it costs less.
constexpr double kVisualAccuracy = 1e-4;

/// How bodies are moved, from the least work to the most.
enum class MotionKind {
  freeFlight,     // closed form
  elasticFlight,  // closed form between collisions without loss, as in simulate/spheres/hard_spheres.h
  pile,           // many bodies in contact: soft sub-stepping, as in impact/soft_step.h
  fixedSteps,     // an integrator with steps of one length
  errorSteps,     // an integrator with steps as long as the error allows; contact changes at events
};

/// The method that moves an island.
struct ChosenMethod {
  MotionKind kind = MotionKind::freeFlight;
  std::string_view name;
  double timeStep = 0;             // s, of heaps and fixed steps
  Integrator integrate = nullptr;  // of fixed steps and error steps
  double tolerance = 0;            // of the local error, scaled 1 + |x|; 0: fixed steps are never cut for it
  ErrorNorm errorNorm = nullptr;   // of error steps
  int order = 0;                   // of the method
  bool keepsPromise = false;       // events serve all that may come, unless friction jams

  bool isClosedForm() const { return kind == MotionKind::freeFlight || kind == MotionKind::elasticFlight; }
  bool isAdaptive() const { return kind == MotionKind::errorSteps; }
};

/// The method of bodies whose contact is resolved once a step: RK4, with shorter steps only where its error asks for
/// them.
ChosenMethod contactSteps(double timeStep = kContactTimeStep);

/// A link of the scene.
struct LinkIndex {
  LinkKind kind = LinkKind::spring;
  std::size_t index = 0;  // among those of its kind
};

/// Bodies that depend on each other, by constraints, springs or contact that may come about, and how they are moved.
struct IslandPlan {
  std::vector<int> bodies;       // scene bodies that forces move, ascending
  std::vector<int> driven;       // scene bodies that are driven, and tied to them or may touch them, ascending
  std::vector<int> touching;     // scene bodies, fixed ones too, that may touch something during the run, ascending
  std::vector<int> nonRotating;  // of the bodies, those without torque at all times: spheres attached at their centres
  std::vector<LinkIndex> links;  // attached to the bodies, in the order of the kinds, then of the scene
  std::vector<std::size_t> pushes;  // of the bodies, indices into the scene's
  ChosenMethod method;
  std::string reason;
  std::vector<std::string_view> notNeeded;  // parts of a simulation that these bodies do not need
  Promise promise;                          // of the accuracy
};

/// The least work that a scene needs: its islands, each with its method.
struct Plan {
  std::vector<IslandPlan> islands;  // in the order of their first bodies
  double accuracy = 0;              // asked
};

/// Where something moves without bounds O(bodies), else O(pairs of bodies whose reaches overlap).
Plan planOf(const Scene& scene);

/// All bodies that move as one island without a method, for measurements of a scene as a whole.
IslandPlan wholeScene(const Scene& scene);

}  // namespace cradle
