#include "impact/rope_impulse.h"

#include <Eigen/QR>
#include <algorithm>
#include <numeric>

namespace cradle {
namespace {

/// The state with the velocities alone that one N s in a rope gives.
VectorX answerOf(const RopeLimit& rope, const std::vector<RigidBody>& bodies, ConstraintSolver& constraints,
                 const VectorX& state) {
  VectorX answer = state;
  answer.segment(poseComponents(state), bodyCount(state) * kVelocitySize).setZero();
  const RopeMotion motion = motionOf(rope, state);
  applyImpulse(bodies, rope.anchorA.body, motion.a.arm, -motion.direction, answer);
  applyImpulse(bodies, rope.anchorB.body, motion.b.arm, motion.direction, answer);
  if (constraints.hasConstraints()) constraints.constrainVelocities(answer);
  return answer;
}

/// 0 <= impulses, complementary to shortening * impulses - wanted >= 0: the ropes that would have to push are left out
/// one by one.
VectorX solvePulls(const MatrixX& shortening, const VectorX& wanted) {
  std::vector<Eigen::Index> pulling(static_cast<std::size_t>(wanted.size()));
  std::iota(pulling.begin(), pulling.end(), 0);
  VectorX impulses = VectorX::Zero(wanted.size());
  while (!pulling.empty()) {
    // Ropes that pull at the same point in the same direction share their load.
    const VectorX found = shortening(pulling, pulling).completeOrthogonalDecomposition().solve(wanted(pulling));
    Eigen::Index least = 0;
    if (found.minCoeff(&least) >= 0) {
      impulses(pulling) = found;
      break;
    }
    pulling.erase(pulling.begin() + least);
  }
  return impulses;
}

}  // namespace

void applyPulls(std::vector<RopePull>& pulls, const std::vector<RigidBody>& bodies, ConstraintSolver& constraints,
                VectorX& state) {
  const Eigen::Index size = std::ssize(pulls);
  std::vector<VectorX> answers;
  for (const RopePull& pull : pulls) answers.push_back(answerOf(*pull.rope, bodies, constraints, state));
  MatrixX shortening(size, size);
  VectorX wanted(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const RopePull& pull = pulls[static_cast<std::size_t>(i)];
    wanted[i] = motionOf(*pull.rope, state).lengthening + pull.reboundSpeed;
    for (Eigen::Index j = 0; j < size; ++j)
      shortening(i, j) = -motionOf(*pull.rope, answers[static_cast<std::size_t>(j)]).lengthening;
  }
  const VectorX impulses = solvePulls(shortening, wanted);
  const Eigen::Index from = poseComponents(state), velocities = bodyCount(state) * kVelocitySize;
  for (Eigen::Index i = 0; i < size; ++i) {
    pulls[static_cast<std::size_t>(i)].impulse = impulses[i];
    state.segment(from, velocities) += impulses[i] * answers[static_cast<std::size_t>(i)].segment(from, velocities);
  }
}

}  // namespace cradle
