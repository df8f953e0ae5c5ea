#include "simulate/steps/group_problem.h"

#include <cmath>

namespace cradle {
namespace {

constexpr std::size_t kFewDenseContacts = 6;  // solved densely, to rounding

void noteUnsolved(const StepGroup& group, const ContactSolution& solution, double tolerance,
                  std::vector<SteppingFault>& faults) {
  if (!solution.converged && !(solution.residual <= tolerance))
    faults.push_back({CorrectionKind::unsolvedContacts, group.moved.bodies, solution.residual});
}

}  // namespace

void limitEnergy(const MovedBodies& moved, double most, const Mechanism& mechanism, VectorX& state,
                 std::vector<SteppingFault>& faults) {
  const double taken = clampEnergy(moved, most, mechanism, state);
  if (taken > 0) faults.push_back({CorrectionKind::clampedEnergy, moved.bodies, taken});
}

void GroupProblem::set(const StepGroup& group, const std::vector<Contact>& contacts, const VectorX& state) {
  contacts_ = contacts;
  sparse_.set(contacts_, assembly_.mechanism.bodies, state);
  dense_.reset();
  if (group.isConstrained) dense_.emplace(contacts_, ImpulseResponse(assembly_.mechanism.bodies, constraints_), state);
}

bool GroupProblem::isSolvedDensely() const {
  return dense_ || contacts_.size() <= kFewDenseContacts;
}

VectorX GroupProblem::solve(const StepGroup& group, const ContactProblem& problem, std::vector<SteppingFault>& faults) {
  if (isSolvedDensely()) return solveDensely(group, problem, faults);
  const double tolerance = StepTolerances::kSolvedRatio * problem.free.cwiseAbs().maxCoeff();
  WarmStart start = warmStartOf(group);
  const ContactSolution solution = solveSparsely(problem.free, problem.frictions, tolerance, start);
  penalties_[group.firstBody] = start.penalty;
  noteUnsolved(group, solution, tolerance, faults);
  return solution.impulses;
}

ContactSolution GroupProblem::solveSparsely(const VectorX& free, const std::vector<double>& frictions, double tolerance,
                                            WarmStart& start) {
  const ContactSolution solution = solveFrictionalContact(sparse_.scaledOperator(), free, frictions, tolerance, start);
  iterations_ += solution.iterations;
  return solution;
}

/// A wedged body may have no solution, and the search for one may lead beyond all bounds: friction, then all impulses,
/// are left out where the residual exceeds the largest free velocity.
VectorX GroupProblem::solveDensely(const StepGroup& group, const ContactProblem& problem,
                                   std::vector<SteppingFault>& faults) const {
  const MatrixX matrix = delassus();
  const double most = problem.free.cwiseAbs().maxCoeff();
  ContactSolution solution = solveFrictionalContact(matrix, problem.free, problem.frictions);
  if (!(solution.residual <= most)) {
    faults.push_back({CorrectionKind::omittedFriction, group.moved.bodies, solution.residual});
    solution = solveFrictionalContact(matrix, problem.free, std::vector<double>(problem.frictions.size(), 0));
  }
  if (!(solution.residual <= most)) {
    faults.push_back({CorrectionKind::omittedContacts, group.moved.bodies, solution.residual});
    solution.impulses.setZero();
  }
  noteUnsolved(group, solution, StepTolerances::kSolvedRatio * most, faults);
  return solution.impulses;
}

VectorX GroupProblem::solveFrictionless(const VectorX& free, double tolerance) {
  const std::vector<double> frictions(contacts_.size(), 0);
  if (isSolvedDensely()) return solveFrictionalContact(delassus(), free, frictions).impulses;
  WarmStart start{VectorX::Zero(free.size()), VectorX::Zero(free.size()), 0};
  return solveSparsely(free, frictions, tolerance, start).impulses;
}

/// Impulses and velocities of the step before, by the nearest contact of the same bodies.
WarmStart GroupProblem::warmStartOf(const StepGroup& group) const {
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(group.members.size());
  WarmStart start{VectorX::Zero(size), VectorX::Zero(size), 0};
  const auto penalty = penalties_.find(group.firstBody);
  if (penalty != penalties_.end()) start.penalty = penalty->second;
  for (std::size_t i = 0; i < group.members.size(); ++i) {
    const Contact& contact = group.contacts[i];
    const Eigen::Index at = 3 * static_cast<Eigen::Index>(i);
    double nearest = INFINITY;
    for (std::size_t k = 0; k < memory_.contacts.size(); ++k) {
      const Contact& other = memory_.contacts[k].contact;
      if (other.bodyA != contact.bodyA || other.bodyB != contact.bodyB) continue;
      const double distance = (other.point - contact.point).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      start.impulses.segment<3>(at) = memory_.ratio * (sparse_.axes(i).transpose() * memory_.contacts[k].impulse);
      start.velocities.segment<3>(at) = sparse_.axes(i).transpose() * memory_.slips[k];
    }
  }
  return start;
}

}  // namespace cradle
