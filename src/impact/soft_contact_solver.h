#pragma once

#include <array>
#include <tuple>
#include <vector>

#include "core/worker_threads.h"
#include "impact/contact_blocks.h"
#include "impact/contact_colors.h"
#include "impact/soft_scale.h"

namespace cradle {

/// Moves bodies in contact through one step: fast, and accurate enough for the eye. Gauss-Seidel with sub-steps, two
/// contacts at a time; the result does not depend on the number of threads.
class SoftContactSolver {
 public:
  explicit SoftContactSolver(const SoftScale& scale = {}) : scale_(scale) {}

  /// Arranges the manifolds for sub-steps of that length (s).
  void prepare(const ContactColors& colors, const std::vector<PersistentManifold>& manifolds,
               const std::vector<SolverBody>& bodies, double subStep, WorkerThreads& threads);

  struct Steps {
    double subStep;  // s
    int count;
    double slowestRebound;  // m/s: contacts that close more slowly do not rebound
    bool rebounds;          // whether some contacts do
  };
  /// From the velocities in `motions` and displacements of zero to the velocities and displacements at the end.
  void solve(const Steps& steps, const Vec3& gravity, SolverMotions& motions, WorkerThreads& threads);

  /// Energy (J) that contacts took in the last step. < 0: gave.
  struct Taken {
    double byImpact = 0, byFriction = 0;  // of contacts that met faster than the slowest rebound, of others
  };
  Taken taken() const;

  /// What a manifold carried in the last step, in the mean.
  struct MeanLoad {
    int points = 0;                                              // of the manifold; 0: it took no part
    std::array<double, PredictedManifold::kMaxPoints> forces{};  // N, along the normal, at each
    Vec3 frictionForce = Vec3::Zero();                           // N, world, on B at the middle of the points
    double twist = 0;                                            // N m, about the normal, on B
  };
  /// Of so many manifolds, by their indices.
  std::vector<MeanLoad> meanLoads(std::size_t manifolds) const;

  /// Forces of the last sub-step, for the next step.
  void store(std::vector<PersistentManifold>& manifolds, WorkerThreads& threads) const;

 private:
  template <class Block>
  struct BlockList {
    std::vector<Block> blocks;  // at least `size`
    std::size_t size = 0;
    std::vector<std::size_t> starts;  // of each colour, and the end
    int lane = kLanes;                // next free one of the last block

    void add(std::int32_t manifold, std::int32_t stillBody);
  };
  using BlockLists =
      std::tuple<BlockList<ContactBlock<1, true>>, BlockList<ContactBlock<2, true>>, BlockList<ContactBlock<3, true>>,
                 BlockList<ContactBlock<4, true>>, BlockList<ContactBlock<1, false>>, BlockList<ContactBlock<2, false>>,
                 BlockList<ContactBlock<3, false>>, BlockList<ContactBlock<4, false>>>;

  void arrange(const ContactColors& colors, std::int32_t stillBody);
  void arrangeTasks();
  template <class Pass>
  void sweep(const SolverMotions& motions, WorkerThreads& threads, int thread, const Pass& pass);

  struct Task {
    std::size_t firstColor, lastColor;  // [first, last)
    bool isShared;                      // by all threads
  };

  const SoftScale scale_;
  BlockLists lists_;
  std::vector<Task> tasks_;
  std::size_t colors_ = 0;
  double subStep_ = 0;  // s, of the blocks' impulses
  int subSteps_ = 0;    // in the last step
};

}  // namespace cradle
