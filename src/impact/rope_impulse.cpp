#include "impact/rope_impulse.h"

#include <Eigen/QR>
#include <algorithm>
#include <numeric>
#include <utility>

#include "constraints/dense_delassus.h"

namespace cradle {
namespace {

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
  std::vector<ConstraintBlock> rows;
  VectorX wanted(std::ssize(pulls));
  for (const RopePull& pull : pulls) {
    const LimitMotion motion = motionOf(*pull.rope, state);
    wanted[std::ssize(rows)] = motion.lengthening + pull.reboundSpeed;
    rows.push_back(lengtheningRow(*pull.rope, motion));
  }
  std::vector<BodyFrame> frames;
  findBodyFrames(bodies, state, frames);
  const DenseDelassus delassus(std::move(rows), bodies, frames, &constraints);
  const VectorX impulses = solvePulls(delassus.matrix(), wanted);
  delassus.apply(-impulses, state);
  for (std::size_t i = 0; i < pulls.size(); ++i) pulls[i].impulse = impulses[static_cast<Eigen::Index>(i)];
}

}  // namespace cradle
