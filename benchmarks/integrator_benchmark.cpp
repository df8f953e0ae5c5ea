// What a step costs beside the evaluations of the right-hand side, which is nearly empty here: states of one body and
// of about eleven.

#include <benchmark/benchmark.h>

#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/rk4.h"

namespace {

using namespace cradle;

RightHandSide almostNothing() {
  return {[](double, const VectorX& state, VectorX& rate) { rate[0] = state[0]; }, nullptr, 0};
}

/// A step taken, its rates filled: memory as it comes may hold numbers that are slow to compute with.
Step stepOf(Integrator integrate, Eigen::Index size) {
  Step step;
  integrate(almostNothing(), VectorX::Constant(size, 1), 0, 0.1, step);
  for (VectorX& rate : step.stageDerivatives) rate.setConstant(size, 0.1);
  step.work.setConstant(0.1);
  step.startDerivative.setConstant(0.1);
  step.endDerivative.setConstant(size, 0.1);
  return step;
}

void takeStep(benchmark::State& run, Integrator integrate) {
  const RightHandSide rightHandSide = almostNothing();
  const VectorX state = VectorX::Constant(run.range(0), 1);
  Step step = stepOf(integrate, run.range(0));
  for (auto _ : run) integrate(rightHandSide, state, 0, 0.1, step);
}

void judgeStep(benchmark::State& run) {
  const VectorX tolerance = VectorX::Constant(run.range(0), 1e-6);
  const Step step = stepOf(dop853, run.range(0));
  for (auto _ : run) benchmark::DoNotOptimize(dop853Error(step, tolerance));
}

void prepare(benchmark::State& run) {
  const RightHandSide rightHandSide = almostNothing();
  Step step = stepOf(dop853, run.range(0));
  for (auto _ : run) {
    step.hasEndDerivative = false;
    prepareInterpolant(rightHandSide, step);
  }
}

void evaluate(benchmark::State& run) {
  const RightHandSide rightHandSide = almostNothing();
  const VectorX state = VectorX::Constant(15, 1);
  VectorX rate = state;
  for (auto _ : run) {
    rightHandSide.derivative(0, state, rate);
    benchmark::ClobberMemory();
  }
}

BENCHMARK_CAPTURE(takeStep, rk4, rk4)->Arg(15)->Arg(150);
BENCHMARK_CAPTURE(takeStep, dop853, dop853)->Arg(15)->Arg(150);
BENCHMARK(judgeStep)->Arg(15)->Arg(150);
BENCHMARK(prepare)->Arg(15)->Arg(150);
BENCHMARK(evaluate);

}  // namespace

BENCHMARK_MAIN();
