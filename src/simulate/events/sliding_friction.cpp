// With W the Delassus operator, g the free accelerations and F(lambda_n) the friction of sliding contacts, each round
// solves the frictional contact problem of W z + (g + W F) with F from the normal forces of the round before. Where
// friction and normal forces drive each other these rounds converge slowly, or not at all, so that they are
// accelerated by Anderson mixing (D. G. Anderson, 1965). Where friction jams (P. Painleve, 1895) there is no limit: the
// friction of the last round is not that of its normal forces.

#include "simulate/events/sliding_friction.h"

#include <algorithm>
#include <cmath>

#include "math/anderson_mixing.h"
#include "simulate/events/event_tolerances.h"

namespace cradle {
namespace {

constexpr int kMaxFrictionRounds = 200;   // of normal forces from friction, and friction from these
constexpr int kPlainFrictionRounds = 10;  // before they are mixed: most end sooner
constexpr int kMaxRoundsInVain = 10;      // without progress: in each of these ...
constexpr double kProgress = 0.9;         // ... the change is no smaller a fraction of the smallest

/// N: the normal forces of those that slide, 0 for the others.
VectorX slidingNormalForces(const std::vector<const ContactRecord*>& records, const VectorX& forces) {
  VectorX normals = VectorX::Zero(std::ssize(records));
  for (Eigen::Index k = 0; k < normals.size(); ++k)
    if (records[static_cast<std::size_t>(k)]->slides) normals[k] = forces[3 * k + 2];
  return normals;
}

/// N: friction of those that slide, in the rows of all, for these normal forces.
VectorX slidingFriction(const std::vector<const ContactRecord*>& records, const std::vector<ContactRows>& rows,
                        const VectorX& normals) {
  VectorX friction = VectorX::Zero(3 * normals.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (!records[k]->slides) continue;
    const Eigen::Index contact = static_cast<Eigen::Index>(k);
    const double size = records[k]->pair.material.dynamicFriction * normals[contact];
    friction.segment<2>(3 * contact) = -size * (rows[k].block.linear.topRows<2>() * records[k]->direction);
  }
  return friction;
}

}  // namespace

SlidingSolution solveContactForces(const std::vector<const ContactRecord*>& records,
                                   const std::vector<ContactRows>& rows, const DenseDelassus& delassus,
                                   const VectorX& derivative) {
  const VectorX free = delassus.accelerations(derivative);
  std::vector<double> frictions;
  bool slides = false;
  for (const ContactRecord* record : records) {
    frictions.push_back(record->slides ? 0 : record->pair.material.staticFriction);
    slides = slides || (record->slides && record->pair.material.dynamicFriction > 0);
  }
  VectorX normals = VectorX::Zero(std::ssize(records)), friction = VectorX::Zero(free.size()), used;
  SlidingSolution solution;
  AndersonMixing mixing;
  double least = INFINITY;
  int roundsInVain = 0;
  bool isFound = false;
  for (int round = 0; round < kMaxFrictionRounds; ++round) {
    used = friction;
    static_cast<ContactSolution&>(solution) =
        solveFrictionalContact(delassus.matrix(), free + delassus.matrix() * used, frictions, solution.impulses);
    isFound = !slides;
    if (isFound) break;
    const VectorX found = slidingNormalForces(records, solution.impulses), next = slidingFriction(records, rows, found);
    const double change = (next - friction).cwiseAbs().maxCoeff();
    friction = next;
    isFound = change <= EventTolerances::kFrictionConverged * found.maxCoeff();
    if (isFound) break;
    if (round >= kPlainFrictionRounds) roundsInVain = change < kProgress * least ? 0 : roundsInVain + 1;
    least = std::min(least, change);
    if (roundsInVain == kMaxRoundsInVain) break;
    normals = round < kPlainFrictionRounds ? found : VectorX(mixing.next(normals, found).cwiseMax(0));
    if (round >= kPlainFrictionRounds) friction = slidingFriction(records, rows, normals);
  }
  if (!isFound) {
    friction = slidingFriction(records, rows, slidingNormalForces(records, solution.impulses));
    const VectorX error = delassus.matrix() * (friction - used);
    solution.velocities += error;
    solution.frictionError = error.cwiseAbs().maxCoeff();
  }
  solution.impulses += friction;
  return solution;
}

}  // namespace cradle
