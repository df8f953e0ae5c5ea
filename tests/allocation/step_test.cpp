#include <gtest/gtest.h>

#include "allocation/allocations.h"
#include "constraints/contact_motion.h"
#include "dynamics/integrator_problems.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/dormand_prince5.h"
#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/step_size.h"

namespace cradle {
namespace {

TEST(Step, AllocatesNothingAfterTheFirst) {
  const RightHandSide rightHandSide = kepler();
  const VectorX tolerance = VectorX::Constant(4, 1e-8), start = keplerAt(0);
  VectorX interpolated;
  for (const Integrator integrate :
       {Integrator(explicitEuler), Integrator(rk4), Integrator(dormandPrince5), Integrator(dop853)}) {
    Step step;
    StepSize size{0.1};
    const auto once = [&] {
      const long before = allocations();
      integrate(rightHandSide, start, 0, 0.1, step);
      if (integrate == dop853) acceptStep(dop853Error(step, tolerance), 0.1, size);
      if (integrate == dormandPrince5) acceptStep(dormandPrince5Error(step, tolerance), 0.1, size);
      prepareInterpolant(rightHandSide, step);
      interpolate(step, 0.4, interpolated);
      if (integrate == dormandPrince5) cutStep(0.5, step);
      carryEndDerivative(step);
      return allocations() - before;
    };
    EXPECT_GT(once(), 0);  // proof that counting works
    EXPECT_EQ(once(), 0);
    EXPECT_EQ(once(), 0);
  }
}

TEST(ContactForces, AllocateNothingAfterTheFirstEvaluation) {
  Mechanism mechanism;
  mechanism.bodies = {lopsided(1), solidSphere(2, 0.1)};
  mechanism.constraints = {{{0, Vec3(0, 0.1, 0)}, {kFixed, Vec3(0, 1, 0.3)}, RodConstraint{1}}};
  for (const double x : {-0.2, 0.2})
    for (const double z : {-0.3, 0.3})
      mechanism.contacts.push_back(ballOnFace({0, Vec3(x, 0, z)}, 0, {}, Vec3::UnitY(),
                                              x < 0 ? ContactMotion::sliding : ContactMotion::sticking));
  mechanism.contacts.push_back(
      ballOnFace({1, Vec3::Zero()}, 0.1, {kFixed, Vec3(0, -0.1, 0)}, Vec3::UnitY(), ContactMotion::sticking));
  EquationsOfMotion equations(mechanism);
  VectorX state = restingState(2), rate;
  const auto once = [&] {
    const long before = allocations();
    equations.evaluate(0, state, rate);
    equations.project(state);
    return allocations() - before;
  };
  EXPECT_GT(once(), 0);
  EXPECT_EQ(once(), 0);
}

}  // namespace
}  // namespace cradle
