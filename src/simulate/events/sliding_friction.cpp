// With W the Delassus operator, g the free accelerations and F(lambda_n) the friction of sliding contacts, each round
// solves the frictional contact problem of W z + (g + W F) with F from the normal forces of the round before. Where
// friction and normal forces drive each other these rounds converge slowly, not at all, or to one of several solutions
// that rounding chooses: from each of them Newton's method is tried. Where friction jams (P. Painleve, 1895) there is
// no limit: the friction of the last round is not that of its normal forces.

#include "simulate/events/sliding_friction.h"

#include <algorithm>
#include <utility>

#include "constraints/contact_groups.h"

namespace cradle {
namespace {

// Of normal forces from friction, and friction from these, as starts of Newton's method.
constexpr int kMaxFrictionRounds = 10;

/// (t1, t2), unit: the directions of those that slide, 0 for the others.
std::vector<Eigen::Vector2d> slidingDirections(const std::vector<const ContactRecord*>& records,
                                               const std::vector<ContactRows>& rows) {
  std::vector<Eigen::Vector2d> directions(records.size(), Eigen::Vector2d::Zero());
  for (std::size_t k = 0; k < records.size(); ++k)
    if (records[k]->slides) directions[k] = rows[k].block.linear.topRows<2>() * records[k]->direction;
  return directions;
}

/// N: friction of those that slide, in the rows of all, for the normal forces in `forces`.
VectorX slidingFriction(const std::vector<Eigen::Vector2d>& directions, const std::vector<double>& frictions,
                        const VectorX& forces) {
  VectorX friction = VectorX::Zero(forces.size());
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const Eigen::Index contact = 3 * static_cast<Eigen::Index>(k);
    friction.segment<2>(contact) = -frictions[k] * forces[contact + 2] * directions[k];
  }
  return friction;
}

}  // namespace

bool shareLoads(const std::vector<const ContactRecord*>& records, const IslandState& island) {
  std::vector<char> joinsNothing = island.equations.resting();
  for (const DrivenBody& driven : island.assembly.mechanism.driven)
    joinsNothing[static_cast<std::size_t>(driven.body)] = 1;
  std::vector<std::pair<int, int>> joined;
  for (const ContactRecord* record : records) joined.emplace_back(record->contact.bodyA, record->contact.bodyB);
  const auto pairOf = [&](std::size_t i) { return std::minmax(joined[i].first, joined[i].second); };
  const auto normalOf = [&](std::size_t i) -> const Vec3& { return records[i]->contact.normal; };
  if (!areOfFaces(records.size(), pairOf, normalOf)) return false;
  const Constraints& constraints = island.assembly.mechanism.constraints;
  const auto isJoined = [&](int body) {
    return body != kFixed && !joinsNothing[static_cast<std::size_t>(body)] &&
           std::any_of(joined.begin(), joined.end(),
                       [&](auto& pair) { return pair.first == body || pair.second == body; });
  };
  const bool hasConstraints = std::any_of(constraints.begin(), constraints.end(), [&](const Constraint& constraint) {
    return isJoined(constraint.anchorA.body) || isJoined(constraint.anchorB.body);
  });
  return joinWithoutLoop(joined, joinsNothing, hasConstraints);
}

SlidingSolution solveContactForces(const std::vector<const ContactRecord*>& records,
                                   const std::vector<ContactRows>& rows, const DenseDelassus& delassus,
                                   const VectorX& derivative, bool sharesLoads) {
  const VectorX free = delassus.accelerations(derivative);
  std::vector<double> frictions, staticFrictions;
  bool slides = false;
  for (const ContactRecord* record : records) {
    const ContactMaterial& material = record->pair.material;
    frictions.push_back(record->slides || record->slips ? material.dynamicFriction : material.staticFriction);
    staticFrictions.push_back(record->slides ? 0 : frictions.back());
    slides = slides || (record->slides && material.dynamicFriction > 0);
  }
  const MatrixX& matrix = delassus.matrix();
  const auto solve = [&](const VectorX& g, const VectorX& near) {
    return sharesLoads ? solveSharedContact(matrix, g, staticFrictions, {}, near)
                       : solveFrictionalContact(matrix, g, staticFrictions, near);
  };
  if (!slides) return {solve(free, {})};
  const std::vector<Eigen::Vector2d> directions = slidingDirections(records, rows);
  if (sharesLoads)
    if (const ContactSolution kept = solveSharedContact(matrix, free, frictions, directions, {}); kept.converged)
      return {kept};
  VectorX friction = VectorX::Zero(free.size()), used;
  SlidingSolution solution;
  for (int round = 0; round < kMaxFrictionRounds; ++round) {
    used = friction;
    static_cast<ContactSolution&>(solution) = solve(free + matrix * used, solution.impulses);
    friction = slidingFriction(directions, frictions, solution.impulses);
    const ContactSolution found =
        sharesLoads ? solveSharedContact(matrix, free, frictions, directions, solution.impulses + friction)
                    : solveSlidingContact(matrix, free, frictions, directions, solution.impulses + friction);
    if (found.converged) return {found};
  }
  const VectorX error = matrix * (friction - used);
  solution.velocities += error;
  solution.frictionError = error.cwiseAbs().maxCoeff();
  solution.impulses += friction;
  return solution;
}

}  // namespace cradle
