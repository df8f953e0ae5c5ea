// What a constraint costs in an evaluation of the equations of motion, by kind and length of a chain: rows,
// factorisation and solution of ConstraintSolver, beside a dense factorisation (Eigen's LDLT) of a matrix of as many
// rows, given.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>

#include "constraints/constraint_forces.h"
#include "math/rotation.h"

namespace cradle {
namespace {

/// A chain of bodies that hangs on the world by constraints of one kind.
template <class Kind>
struct Chain {
  std::vector<RigidBody> bodies;
  Constraints constraints;
  VectorX state;
  std::vector<BodyFrame> frames;

  Chain(int count, const Kind& kind) : state(VectorX::Zero(stateSize(count))) {
    for (int i = 0; i < count; ++i) {
      bodies.push_back(makeRigidBody({1, Vec3::Zero(), Vec3(0.1, 0.2, 0.25).asDiagonal()}));
      centerOfMass(state, i).x() = 0.3 * (i + 1);
      setOrientation(state, i, rotationAbout(Vec3(1, 2, 3), 0.1 * i));
      angularVelocity(state, i) = Vec3(0.1, 0.2, 0.3);
      const Attachment before = i > 0 ? Attachment{i - 1, Vec3(0.15, 0, 0.02)} : Attachment{};
      constraints.push_back({{i, Vec3(-0.15, 0.01, 0)}, before, kind});
    }
    findBodyFrames(bodies, state, frames);
  }
};

template <class Kind>
void ofAChain(benchmark::State& loop, const Kind& kind) {
  const Chain<Kind> chain(static_cast<int>(loop.range(0)), kind);
  ConstraintSolver solver(chain.constraints, chain.bodies);
  VectorX rates = chain.state;
  for (auto _ : loop) {
    solver.factorize(chain.state, chain.frames);
    rates = chain.state;
    benchmark::DoNotOptimize(solver.constrainAccelerations(rates).data());
  }
}

void dense(benchmark::State& loop) {
  const Eigen::Index size = loop.range(0);
  const MatrixX matrix =
      2 * MatrixX::Identity(size, size) + MatrixX::Constant(size, size, 1.0 / static_cast<double>(size));
  Eigen::LDLT<MatrixX> factor(size);
  VectorX x(size), ones = VectorX::Ones(size);
  for (auto _ : loop) {
    factor.compute(matrix);
    x = factor.solve(ones);
    benchmark::DoNotOptimize(x.data());
  }
}

const HingeConstraint kHinge{Vec3::UnitZ(), {Vec3::UnitX(), Vec3::UnitY()}};

BENCHMARK_CAPTURE(ofAChain, rods, RodConstraint{0.3})->Arg(1)->Arg(3)->Arg(10)->Arg(30)->Arg(100);
BENCHMARK_CAPTURE(ofAChain, ballJoints, BallJointConstraint())->Arg(1)->Arg(3)->Arg(10)->Arg(30)->Arg(100);
BENCHMARK_CAPTURE(ofAChain, hinges, kHinge)->Arg(1)->Arg(3)->Arg(10)->Arg(30)->Arg(100);
BENCHMARK(dense)->Arg(3)->Arg(10)->Arg(30)->Arg(100);

}  // namespace
}  // namespace cradle

BENCHMARK_MAIN();
