#pragma once

#include <tuple>
#include <vector>

#include "core/worker_threads.h"
#include "impact/contact_blocks.h"
#include "impact/contact_colors.h"

namespace cradle {

/// Moves bodies in contact through one step: fast, and accurate enough for the eye. Gauss-Seidel with sub-steps, two
/// contacts at a time; the result does not depend on the number of threads.
class SoftContactSolver {
 public:
  /// Arranges the manifolds for work. Velocities and scaled frames of all bodies must be known.
  void prepare(const ContactColors& colors, const std::vector<ContactManifold>& manifolds,
               const std::vector<SolverBody>& bodies, WorkerThreads& threads);

  /// From the velocities in `motions` (gravity's gain of the step included) and displacements of zero to the velocities
  /// and displacements at the end. Contacts that closed faster than `slowestRebound` (m/s) rebound.
  void solve(double timeStep, double slowestRebound, SolverMotions& motions, WorkerThreads& threads);

  /// Impulses of the step, for the next one.
  void store(std::vector<ContactManifold>& manifolds, WorkerThreads& threads) const;

 private:
  template <class Block>
  struct BlockList {
    std::vector<Block> blocks;  // at least `size`
    std::size_t size = 0;
    std::vector<std::size_t> starts;  // of each colour, and the end
  };
  using BlockLists =
      std::tuple<BlockList<ContactBlock<1, true>>, BlockList<ContactBlock<2, true>>, BlockList<ContactBlock<3, true>>,
                 BlockList<ContactBlock<4, true>>, BlockList<ContactBlock<1, false>>, BlockList<ContactBlock<2, false>>,
                 BlockList<ContactBlock<3, false>>, BlockList<ContactBlock<4, false>>>;

  template <class Block>
  void arrange(const ContactColors& colors, const std::vector<ContactManifold>& manifolds, std::int32_t stillBody,
               BlockList<Block>& list);
  template <class Pass>
  void sweep(WorkerThreads& threads, int thread, const Pass& pass);

  BlockLists lists_;
  std::size_t colors_ = 0;
  bool rebounds_ = false;
};

}  // namespace cradle
