// Counts calls of malloc in this program: all of Eigen's and the standard library's allocations go through it. With
// sanitizers, which bring their own malloc, there is nothing to count.
#ifndef __SANITIZE_ADDRESS__

#include <gtest/gtest.h>

#include <atomic>

#include "dynamics/dop853_problems.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/step_size.h"

namespace {
std::atomic<long> allocations{0};
}

extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}

namespace cradle {
namespace {

TEST(Step, AllocatesNothingAfterTheFirst) {
  const RightHandSide rightHandSide = kepler();
  const VectorX tolerance = VectorX::Constant(4, 1e-8), start = keplerAt(0);
  VectorX interpolated;
  for (const Integrator integrate : {Integrator(explicitEuler), Integrator(rk4), Integrator(dop853)}) {
    Step step;
    StepSize size{0.1};
    const auto once = [&] {
      const long before = allocations;
      integrate(rightHandSide, start, 0, 0.1, step);
      if (integrate == dop853) acceptStep(errorNorm(step, tolerance), 0.1, size);
      prepareInterpolant(rightHandSide, step);
      interpolate(step, 0.4, interpolated);
      carryEndRate(step);
      return allocations - before;
    };
    EXPECT_GT(once(), 0);  // proof that counting works
    EXPECT_EQ(once(), 0);
    EXPECT_EQ(once(), 0);
  }
}

}  // namespace
}  // namespace cradle

#endif
