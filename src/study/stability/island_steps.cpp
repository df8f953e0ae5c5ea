#include "study/stability/island_steps.h"

#include "simulate/plan/plan.h"

namespace cradle {

IslandSteps::IslandSteps(const Scene& scene, Integrator integrate, double timeStep, bool projects)
    : assembly_(assemble(scene, wholeScene(scene))),
      equations_(assembly_.mechanism),
      rightHandSide_(equations_.rightHandSide()),
      integrate_(integrate),
      timeStep_(timeStep),
      projects_(projects),
      state_(assembly_.state) {}

void IslandSteps::advance() {
  integrate_(rightHandSide_, state_, time(), timeStep_, step_);
  state_ = step_.state;
  normalizeOrientations(state_);
  if (projects_) equations_.project(state_);
  ++steps_;
}

}  // namespace cradle
