#include <gtest/gtest.h>

#include "allocation/allocations.h"
#include "experiments/experiment.h"
#include "simulate/island_solver.h"

namespace cradle {
namespace {

/// A box on a spring, with a pendulum of a rod, a ball joint and a hinge below it.
Scene tiedBodies(const std::string& method) {
  return sceneOf(R"({"schema": "cradle-scene/1", "name": "t", "duration": 10, )" + method + R"( "bodies": [
    {"name": "a", "shape": {"box": {"size": [0.2, 0.3, 0.1]}}, "collision": "none"},
    {"name": "b", "shape": {"box": {"size": [0.1, 0.1, 0.1]}}, "position": [0.3, -0.5, 0], "collision": "none"},
    {"name": "c", "shape": {"box": {"size": [0.1, 0.3, 0.1]}}, "position": [0.6, -0.5, 0], "collision": "none"},
    {"name": "d", "shape": {"box": {"size": [0.1, 0.1, 0.2]}}, "position": [0.9, -0.5, 0], "collision": "none"}],
    "springs": [{"bodyA": "a", "anchorA": [0.1, 0.15, 0], "anchorB": [0, 1, 0], "stiffness": 3000, "damping": 1}],
    "rods": [{"bodyA": "a", "anchorA": [0, -0.15, 0], "bodyB": "b", "anchorB": [0, 0, 0.05]}],
    "ballJoints": [{"bodyA": "b", "anchorA": [0.15, 0, 0], "bodyB": "c", "anchorB": [-0.15, 0, 0]}],
    "hinges": [{"bodyA": "c", "anchorA": [0.15, 0, 0], "bodyB": "d", "anchorB": [-0.15, 0, 0], "axis": [0, 0, 1]}]})");
}

TEST(IslandSolver, AllocatesNothingInASmoothStep) {
  for (const char* method : {"", R"("method": {"name": "rk4", "timeStep": 0.001},)"}) {
    const Scene scene = tiedBodies(method);
    const Plan plan = planOf(scene);
    ASSERT_EQ(plan.islands.size(), 1u);
    IslandSolver simulation(scene, assemble(scene, plan.islands[0]), plan.islands[0].method);
    simulation.stateAt(0.1);  // the first steps make the memory that is used ever after
    const long before = allocations(), evaluations = simulation.evaluations();
    simulation.stateAt(1);
    EXPECT_EQ(allocations(), before) << method;
    EXPECT_GT(simulation.evaluations(), evaluations + 100);
  }
}

}  // namespace
}  // namespace cradle
