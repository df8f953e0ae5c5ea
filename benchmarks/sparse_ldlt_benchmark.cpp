// Is there a size below which a dense factorisation of J M^-1 J^T would be cheaper? A chain's matrix (tridiagonal) and
// a full one, factorised and solved by ours and by Eigen's dense LDLT.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>

#include "constraints/sparse_ldlt.h"

namespace cradle {
namespace {

enum class Pattern { chain, full };

/// 2 on the diagonal, -1/2 between neighbours or 1/n everywhere else: positive definite.
struct Problem {
  std::vector<std::pair<int, int>> places;
  std::vector<double> diagonal, entries;
  MatrixX dense;

  Problem(int size, Pattern pattern) : diagonal(static_cast<std::size_t>(size), 2.0) {
    dense = 2 * MatrixX::Identity(size, size);
    for (int row = 1; row < size; ++row)
      for (int column = pattern == Pattern::full ? 0 : row - 1; column < row; ++column) {
        const double value = pattern == Pattern::full ? 1.0 / size : -0.5;
        places.emplace_back(row, column);
        entries.push_back(value);
        dense(row, column) = dense(column, row) = value;
      }
  }
};

void sparse(benchmark::State& state, Pattern pattern) {
  const int size = static_cast<int>(state.range(0));
  const Problem problem(size, pattern);
  SparseLdlt factor;
  factor.analyze(size, problem.places);
  VectorX x(size);
  for (auto _ : state) {
    x.setOnes();
    factor.factorize(problem.diagonal, problem.entries);
    factor.solve(x);
    benchmark::DoNotOptimize(x.data());
  }
}

void dense(benchmark::State& state, Pattern pattern) {
  const int size = static_cast<int>(state.range(0));
  const Problem problem(size, pattern);
  Eigen::LDLT<MatrixX> factor(size);
  VectorX x(size), ones = VectorX::Ones(size);
  for (auto _ : state) {
    factor.compute(problem.dense);
    x = factor.solve(ones);
    benchmark::DoNotOptimize(x.data());
  }
}

BENCHMARK_CAPTURE(sparse, chain, Pattern::chain)->Arg(1)->Arg(3)->Arg(10)->Arg(30)->Arg(100);
BENCHMARK_CAPTURE(dense, chain, Pattern::chain)->Arg(1)->Arg(3)->Arg(10)->Arg(30)->Arg(100);
BENCHMARK_CAPTURE(sparse, full, Pattern::full)->Arg(3)->Arg(10)->Arg(30)->Arg(100);
BENCHMARK_CAPTURE(dense, full, Pattern::full)->Arg(3)->Arg(10)->Arg(30)->Arg(100);

}  // namespace
}  // namespace cradle

BENCHMARK_MAIN();
