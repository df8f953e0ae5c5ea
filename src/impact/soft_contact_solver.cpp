// E. Catto, "Solver2D" (box2d.org, 2024): of the solvers compared there, sub-steps with soft contacts that are relaxed
// afterwards ("soft step") hold heaps best for their cost. Different here: contacts stiffen with their overlap, and
// those with few points are stiffer from the start. What a contact sinks in by is the load over its stiffness, which
// sub-steps limit: twice as stiff as these, for sub-steps of 1/480 s, makes stacks of boxes tremble; half as stiff,
// four sub-steps are enough, and a heap of turned boxes ends 5 mm deep. The frequency does not follow the length of the
// sub-steps, which changes from step to step: overlap would be let go as speed each time.
// A sub-step begins with the impulses of the one before. All of them together are what that one changed a body's
// velocity by, gravity apart, for rows stay as they are: bodies are given that again, and contacts need not be visited.

#include "impact/soft_contact_solver.h"

#include "impact/block_filling.h"
#include "impact/block_passes.h"
#include "impact/soft_parameters.h"

namespace cradle {
namespace {

constexpr std::size_t kMinShared = 16;  // blocks: a microsecond of work
constexpr std::size_t kAhead = 2;       // blocks: the motions that they need are asked for in time
constexpr double kPi = 3.14159265358979324;

/// A damped spring, implicit in the sub-step (E. Catto, "Soft Constraints", GDC 2011).
Softness softnessOf(int points, double subStep, const SoftScale& scale) {
  return {2 * kPi * SoftParameters::kFrequencies[points - 1] * (subStep / scale.time),
          2 * SoftParameters::kDampingRatio, SoftParameters::kHardening / scale.length,
          SoftParameters::kMaxPush * scale.speed()};
}

template <class Block>
void fetchMotions(const Block& block, const SolverMotions& motions) {
  for (const auto& bodies : block.bodies)
    for (const std::int32_t body : bodies) {
      fetchAhead<true>(motions.velocities[static_cast<std::size_t>(body)]);
      fetchAhead<false>(motions.displacements[static_cast<std::size_t>(body)]);
    }
}

template <class Lists, class Work>
void forEachList(Lists& lists, const Work& work) {
  std::apply([&](auto&... list) { (work(list), ...); }, lists);
}

}  // namespace

/// The next free lane of a list, in a new block if the last is full or of another colour.
template <class Block>
void SoftContactSolver::BlockList<Block>::add(std::int32_t manifold, std::int32_t stillBody) {
  if (lane == kLanes) {
    lane = 0;
    if (size == blocks.size()) blocks.emplace_back();
    for (int k = 0; k < kLanes; ++k) emptyLane(stillBody, k, blocks[size]);
    ++size;
  }
  blocks[size - 1].manifolds[lane++] = manifold;
}

void SoftContactSolver::arrange(const ContactColors& colors, std::int32_t stillBody) {
  forEachList(lists_, [](auto& list) { list.size = 0, list.starts.clear(); });
  for (std::size_t color = 0; color + 1 < colors.starts.size(); ++color) {
    forEachList(lists_, [](auto& list) { list.starts.push_back(list.size), list.lane = kLanes; });
    for (std::size_t i = colors.starts[color]; i < colors.starts[color + 1]; ++i) {
      const ManifoldLink& link = colors.links[i];
      forEachList(lists_, [&]<class Block>(BlockList<Block>& list) {
        if (link.count == Block::kPoints && (link.bodyB != kFixed) == Block::kBothMove)
          list.add(link.manifold, stillBody);
      });
    }
  }
  forEachList(lists_, [](auto& list) { list.starts.push_back(list.size); });
}

void SoftContactSolver::prepare(const ContactColors& colors, const std::vector<PersistentManifold>& manifolds,
                                const std::vector<SolverBody>& bodies, double subStep, WorkerThreads& threads) {
  subStep_ = subStep;
  colors_ = colors.starts.size() - 1;
  const std::int32_t stillBody = static_cast<std::int32_t>(bodies.size());
  arrange(colors, stillBody);
  arrangeTasks();
  threads.run([&](int thread) {
    forEachList(lists_, [&](auto& list) {
      const auto [first, last] = threads.partOf(list.size, thread);
      for (std::size_t i = first; i < last; ++i) {
        if (i + 1 < last) fetchAhead<true>(list.blocks[i + 1]);
        if (i + 2 < last)
          for (const std::int32_t index : list.blocks[i + 2].manifolds)
            if (index >= 0) fetchAhead<false>(manifolds[static_cast<std::size_t>(index)]);
        for (int lane = 0; lane < kLanes; ++lane) {
          const std::int32_t index = list.blocks[i].manifolds[lane];
          if (index < 0) continue;
          const PersistentManifold& manifold = manifolds[static_cast<std::size_t>(index)];
          fillLane(manifold, index, bodies, subStep, lane, list.blocks[i]);
        }
      }
    });
  });
}

/// Consecutive colours of few blocks are one task, for one thread: to share them takes longer than to do them.
void SoftContactSolver::arrangeTasks() {
  tasks_.clear();
  for (std::size_t color = 0; color < colors_; ++color) {
    std::size_t blocks = 0;
    forEachList(lists_, [&](auto& list) { blocks += list.starts[color + 1] - list.starts[color]; });
    const bool isShared = blocks >= kMinShared;
    if (isShared || tasks_.empty() || tasks_.back().isShared) tasks_.push_back({color, color, isShared});
    ++tasks_.back().lastColor;
  }
}

/// Lets `pass` work on all blocks, colour by colour, together with the other threads.
template <class Pass>
void SoftContactSolver::sweep(const SolverMotions& motions, WorkerThreads& threads, int thread, const Pass& pass) {
  for (const Task& task : tasks_) {
    for (std::size_t color = task.firstColor; color < task.lastColor && (task.isShared || thread == 0); ++color)
      forEachList(lists_, [&](auto& list) {
        const std::size_t start = list.starts[color], count = list.starts[color + 1] - start;
        const auto [first, last] = task.isShared ? threads.partOf(count, thread) : WorkerThreads::Part{0, count};
        for (std::size_t i = start + first; i < start + last; ++i) {
          if (i + kAhead < start + last) fetchMotions(list.blocks[i + kAhead], motions);
          pass(list.blocks[i]);
        }
      });
    threads.meet();
  }
}

void SoftContactSolver::solve(const Steps& steps, const Vec3& gravity, SolverMotions& motions, WorkerThreads& threads) {
  subSteps_ = steps.count;
  const Lanes subStep = same(steps.subStep);
  const auto softness = [&](int points) { return softnessOf(points, steps.subStep, scale_); };
  const Softness soft[] = {softness(1), softness(2), softness(3), softness(4)};
  const Vec3 gain = steps.subStep * gravity;
  const Lanes gainXy{gain.x(), gain.y()}, gainZ{gain.z(), 0};
  threads.run([&](int thread) {
    const auto [first, last] = threads.partOf(motions.pulls.size(), thread);
    for (int i = 0; i < steps.count; ++i) {
      for (std::size_t body = first; body < last; ++body) {
        const SolverMotions::Pull pull = motions.pulls[body];
        if (pull == SolverMotions::Pull::asleep) continue;
        BodyMotion &velocity = motions.velocities[body], &fallen = motions.fallen[body];
        const BodyMotion pushed = i > 0 ? velocity - fallen : BodyMotion{};
        if (pull == SolverMotions::Pull::gravity) velocity.xy += gainXy, velocity.zu += gainZ;
        fallen = velocity;
        velocity = velocity + pushed;
      }
      threads.meet();
      if (i == 0) sweep(motions, threads, thread, [&](auto& block) { warmBlock(block, motions); });
      sweep(motions, threads, thread, [&](auto& block) {
        softenBlock(block, soft[std::decay_t<decltype(block)>::kPoints - 1], steps.subStep, motions);
      });
      for (std::size_t body = first; body < last; ++body) {
        const BodyMotion& velocity = motions.velocities[body];
        BodyMotion& displacement = motions.displacements[body];
        displacement.xy += subStep * velocity.xy;
        displacement.zu += subStep * velocity.zu;
        displacement.vw += subStep * velocity.vw;
      }
      threads.meet();
      sweep(motions, threads, thread, [&](auto& block) { relaxBlock(block, motions); });
    }
    if (steps.rebounds)
      sweep(motions, threads, thread, [&](auto& block) { reboundBlock(block, steps.slowestRebound, motions); });
    forEachList(lists_, [&](auto& list) {
      const auto [from, to] = threads.partOf(list.size, thread);
      for (std::size_t i = from; i < to; ++i) weighBlock(list.blocks[i], steps.slowestRebound, motions);
    });
  });
}

SoftContactSolver::Taken SoftContactSolver::taken() const {
  Taken sum;
  forEachList(lists_, [&](const auto& list) {
    for (std::size_t i = 0; i < list.size; ++i)
      for (int lane = 0; lane < kLanes; ++lane) {
        if (list.blocks[i].manifolds[lane] < 0) continue;
        sum.byImpact += list.blocks[i].struck[lane];
        sum.byFriction += list.blocks[i].rubbed[lane];
      }
  });
  return sum;
}

std::vector<SoftContactSolver::MeanLoad> SoftContactSolver::meanLoads(std::size_t manifolds) const {
  std::vector<MeanLoad> loads(manifolds);
  const double rate = 1 / (subSteps_ * subStep_);
  forEachList(lists_, [&]<class Block>(const BlockList<Block>& list) {
    for (std::size_t i = 0; i < list.size; ++i) {
      const Block& block = list.blocks[i];
      for (int lane = 0; lane < kLanes; ++lane) {
        if (block.manifolds[lane] < 0) continue;
        MeanLoad& load = loads[static_cast<std::size_t>(block.manifolds[lane])];
        load.points = Block::kPoints;
        for (int k = 0; k < Block::kPoints; ++k)
          load.forces[static_cast<std::size_t>(k)] = rate * block.points[k].total[lane];
        for (int k = 0; k < 2; ++k) {
          const LaneVector& t = block.friction.tangents[k];
          load.frictionForce += rate * block.friction.totals[k][lane] * Vec3(t.x[lane], t.y[lane], t.z[lane]);
        }
        if constexpr (Block::kPoints > 1) load.twist = rate * block.twist.total[lane];
      }
    }
  });
  return loads;
}

void SoftContactSolver::store(std::vector<PersistentManifold>& manifolds, WorkerThreads& threads) const {
  threads.run([&](int thread) {
    forEachList(lists_, [&](const auto& list) {
      const auto [first, last] = threads.partOf(list.size, thread);
      for (std::size_t i = first; i < last; ++i) storeForces(list.blocks[i], subStep_, manifolds);
    });
  });
}

}  // namespace cradle
