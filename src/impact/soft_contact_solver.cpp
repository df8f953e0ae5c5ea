// E. Catto, "Solver2D" (box2d.org, 2024): of the solvers compared there the one that sub-steps with soft contacts and
// relaxes them ("soft step") holds stacks and piles best for its cost. Different here: gravity and the impulses of the
// step before enter once a step, so that a pile at rest is at rest in each sub-step; and a contact is soft only against
// changes of its impulse within the step, so that what lies still does not sink in by its weight.

#include "impact/soft_contact_solver.h"

#include "impact/block_filling.h"
#include "impact/block_passes.h"

namespace cradle {
namespace {

static const int kSubSteps = getenv("SS") ? atoi(getenv("SS")) : 4;            // boxes need as many to come to rest
static const double kFrequency = getenv("FR") ? atof(getenv("FR")) : 60;       // Hz: of contacts as springs, a quarter of the sub-steps' at 60 steps a second
static const double kDampingRatio = getenv("DR") ? atof(getenv("DR")) : 5;     // far above 1: overlap goes, and does not come back as speed
constexpr double kMostPush = 4;         // m/s
constexpr double kPi = 3.14159265358979324;

/// A damped spring, implicit in the sub-step (E. Catto, "Soft Constraints", GDC 2011).
Softness softnessOf(double timeStep, int points) {
  static const double f1 = getenv("F1") ? atof(getenv("F1")) : 120, f2 = getenv("F2") ? atof(getenv("F2")) : 85;
  const double omega = 2 * kPi * (points == 1 ? f1 : points == 2 ? f2 : kFrequency);
  static const double hard = getenv("HD") ? atof(getenv("HD")) : 0;
  return {timeStep, timeStep * omega, 2 * kDampingRatio, hard, kMostPush};
}

template <class Lists, class Work>
void forEachList(Lists& lists, const Work& work) {
  std::apply([&](auto&... list) { (work(list), ...); }, lists);
}

}  // namespace

template <class Block>
void SoftContactSolver::arrange(const ContactColors& colors, const std::vector<ContactManifold>& manifolds,
                                std::int32_t stillBody, BlockList<Block>& list) {
  list.size = 0;
  list.starts.clear();
  for (std::size_t color = 0; color + 1 < colors.starts.size(); ++color) {
    list.starts.push_back(list.size);
    int lane = kLanes;
    for (std::size_t i = colors.starts[color]; i < colors.starts[color + 1]; ++i) {
      const ContactManifold& manifold = manifolds[static_cast<std::size_t>(colors.manifolds[i])];
      if (manifold.patch.count != Block::kPoints || (manifold.bodyB != kFixed) != Block::kBothMove) continue;
      if (lane == kLanes) {
        lane = 0;
        if (list.size == list.blocks.size()) list.blocks.emplace_back();
        for (int k = 0; k < kLanes; ++k) emptyLane(stillBody, k, list.blocks[list.size]);
        ++list.size;
      }
      list.blocks[list.size - 1].manifolds[lane++] = colors.manifolds[i];
    }
  }
  list.starts.push_back(list.size);
}

void SoftContactSolver::prepare(const ContactColors& colors, const std::vector<ContactManifold>& manifolds,
                                const std::vector<SolverBody>& bodies, WorkerThreads& threads) {
  colors_ = colors.starts.size() - 1;
  rebounds_ = false;
  for (const std::int32_t index : colors.manifolds)
    rebounds_ = rebounds_ || manifolds[static_cast<std::size_t>(index)].law.restitution > 0;
  const std::int32_t stillBody = static_cast<std::int32_t>(bodies.size());
  forEachList(lists_, [&](auto& list) { arrange(colors, manifolds, stillBody, list); });
  threads.run([&](int thread) {
    forEachList(lists_, [&](auto& list) {
      const auto [first, last] = threads.partOf(list.size, thread);
      for (std::size_t i = first; i < last; ++i)
        for (int lane = 0; lane < kLanes; ++lane) {
          const std::int32_t index = list.blocks[i].manifolds[lane];
          if (index < 0) continue;
          const ContactManifold& manifold = manifolds[static_cast<std::size_t>(index)];
          fillLane(manifold, index, bodies, manifold.law.dynamicFriction, lane, list.blocks[i]);
        }
    });
  });
}

/// Lets `pass` work on all blocks, colour by colour, together with the other threads.
template <class Pass>
void SoftContactSolver::sweep(WorkerThreads& threads, int thread, const Pass& pass) {
  for (std::size_t color = 0; color < colors_; ++color) {
    forEachList(lists_, [&](auto& list) {
      const std::size_t start = list.starts[color];
      const auto [first, last] = threads.partOf(list.starts[color + 1] - start, thread);
      for (std::size_t i = start + first; i < start + last; ++i) pass(list.blocks[i]);
    });
    threads.meet();
  }
}

void SoftContactSolver::solve(double timeStep, double slowestRebound, SolverMotions& motions, WorkerThreads& threads) {
  const Softness softs[] = {softnessOf(timeStep / kSubSteps, 1), softnessOf(timeStep / kSubSteps, 2), softnessOf(timeStep / kSubSteps, 3), softnessOf(timeStep / kSubSteps, 4)};
  const Softness& soft = softs[0];
  const Lanes subStep = same(soft.timeStep);
  static const bool schemeB = getenv("SB");
  threads.run([&](int thread) {
    if (!schemeB) sweep(threads, thread, [&](auto& block) { warmBlock(block, motions); });
    const auto [first, last] = threads.partOf(motions.displacements.size() - 1, thread);
    for (int i = 0; i < kSubSteps; ++i) {
      if (schemeB) {
        for (std::size_t body = first; body < last; ++body) {
          BodyMotion& velocity = motions.velocities[body];
          if (i == 0) velocity.xy[1] += 9.81 * timeStep;
          velocity.xy[1] -= 9.81 * soft.timeStep;
        }
        threads.meet();
        sweep(threads, thread, [&](auto& block) { warmBlock(block, motions); });
      }
      sweep(threads, thread, [&](auto& block) { softenBlock(block, softs[std::decay_t<decltype(block)>::kPoints - 1], motions); });
      for (std::size_t body = first; body < last; ++body) {
        const BodyMotion& velocity = motions.velocities[body];
        BodyMotion& displacement = motions.displacements[body];
        displacement.xy += subStep * velocity.xy;
        displacement.zu += subStep * velocity.zu;
        displacement.vw += subStep * velocity.vw;
      }
      threads.meet();
      sweep(threads, thread, [&](auto& block) { relaxBlock(block, motions); });
    }
    if (rebounds_) sweep(threads, thread, [&](auto& block) { reboundBlock(block, slowestRebound, motions); });
  });
}

void SoftContactSolver::store(std::vector<ContactManifold>& manifolds, WorkerThreads& threads) const {
  threads.run([&](int thread) {
    forEachList(lists_, [&](const auto& list) {
      const auto [first, last] = threads.partOf(list.size, thread);
      for (std::size_t i = first; i < last; ++i) storeImpulses(list.blocks[i], manifolds);
    });
  });
}

}  // namespace cradle
