#include "simulate/steps/group_problem.h"

#include <cmath>

namespace cradle {
namespace {

// Solved densely, to rounding: of bodies without constraints, and with them. A chain of 20 links on the floor takes as
// long with 4 to 20 in place of 12, and seven times as long with 40.
constexpr std::size_t kFewDenseContacts = 6, kFewTiedContacts = 12;

void noteUnsolved(const StepGroup& group, const ContactSolution& solution, double tolerance,
                  std::vector<SteppingFault>& faults) {
  if (!solution.converged && !(solution.residual <= tolerance))
    faults.push_back({CorrectionKind::unsolvedContacts, group.moved.bodies, solution.residual});
}

}  // namespace

void clampEnergyWithFault(const MovedBodies& moved, double most, const Mechanism& mechanism, VectorX& state,
                          std::vector<SteppingFault>& faults) {
  const double taken = clampEnergy(moved, most, mechanism, state);
  if (taken > 0) faults.push_back({CorrectionKind::clampedEnergy, moved.bodies, taken});
}

void GroupProblem::hold(const std::vector<std::size_t>& motors) {
  heldMotors_ = motors;
  ties_.clear();
  if (motors.empty()) return;
  ties_ = assembly_.mechanism.constraints;
  for (const std::size_t motor : motors) ties_.push_back(assembly_.mechanism.motors[motor].joint);
}

/// The velocity of a motor's coordinate that an impulse of 1 gives, with all joints: 1/kg or 1/(kg m^2).
double GroupProblem::motorMobility(const JointMotor& motor, const VectorX& state) {
  const std::vector<RigidBody>& bodies = assembly_.mechanism.bodies;
  VectorX moved = state;
  moved.tail(state.size() - poseComponents(state)).setZero();
  findBodyFrames(bodies, moved, frames_);
  const ConstraintBlock row = rowOf(motor, moved, frames_);
  BlockResponse response;
  findResponse(row, bodies, frames_, response);
  constexpr double kUnit = 1;
  addResponse(row, response, &kUnit, moved);
  constraints_.constrainVelocities(moved);
  return rateOf(row, 0, moved);
}

void GroupProblem::factorize(const VectorX& state) {
  if (constraints_.hasConstraints()) constraints_.factorize(state);
  if (!isHolding()) return;
  const std::size_t first = ties_.size() - heldMotors_.size();
  for (std::size_t i = 0; i < heldMotors_.size(); ++i)
    std::get<JointCoordinate>(ties_[first + i].kind).compliance =
        kCompliance * motorMobility(assembly_.mechanism.motors[heldMotors_[i]], state);
  held_.factorize(state);
}

VectorX GroupProblem::motorImpulses(const VectorX& impulses, const VectorX& state) {
  VectorX change = state;
  change.tail(state.size() - poseComponents(state)).setZero();
  const ImpulseResponse bodiesAlone(assembly_.mechanism.bodies);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    bodiesAlone.apply(contacts_[i], axes(i) * impulses.segment<3>(3 * static_cast<Eigen::Index>(i)), change);
  held_.constrainVelocities(change);
  VectorX multipliers = VectorX::Zero(rowCount(ties_));
  held_.putMultipliers(multipliers);
  return multipliers.tail(std::ssize(heldMotors_));
}

void GroupProblem::set(const StepGroup& group, const std::vector<Contact>& contacts, const VectorX& state) {
  contacts_ = contacts;
  isSolvedDensely_ = contacts.size() <= (group.isConstrained ? kFewTiedContacts : kFewDenseContacts);
  dense_.reset();
  if (!group.isConstrained) {
    sparse_.set(contacts, assembly_.mechanism.bodies, state);
  } else if (!isSolvedDensely_) {
    sparse_.set(contacts, assembly_.mechanism.bodies, ties(), state);
  } else {
    sparse_.set(contacts, assembly_.mechanism.bodies, state);
    dense_.emplace(contacts, ImpulseResponse(assembly_.mechanism.bodies, ties()), state);
  }
}

/// Of all solutions about the one of the least impulses: the first solves the problem of contacts that give way by D
/// times their impulses, and the second, of contacts that give way by D times what differs from the first, hardly gives
/// way at all (the proximal point method, R. T. Rockafellar, SIAM J. Control Optim. 14, 1976).
ContactSolution GroupProblem::solveSharing(const VectorX& free, const std::vector<double>& frictions) const {
  MatrixX w = delassus();
  const VectorX compliance = kCompliance * w.diagonal();
  w.diagonal() += compliance;
  const ContactSolution first = solveFrictionalContact(w, free, frictions);
  return solveFrictionalContact(w, free - compliance.cwiseProduct(first.impulses), frictions, first.impulses);
}

/// A wedged body may have no solution, and the search for one may lead beyond all bounds: friction, then all impulses,
/// are left out where the residual exceeds the largest free velocity.
VectorX GroupProblem::solve(const StepGroup& group, const ContactProblem& problem, std::vector<SteppingFault>& faults) {
  const double most = problem.free.cwiseAbs().maxCoeff(), tolerance = StepTolerances::kSolvedRatio * most;
  WarmStart start;
  if (!isSolvedDensely_) start = warmStartOf(group);
  ContactSolution solution = solve(problem.free, problem.frictions, tolerance, start);
  if (!isSolvedDensely_) penalties_[group.firstBody] = start.penalty;
  if (!(solution.residual <= most)) {
    faults.push_back({CorrectionKind::omittedFriction, group.moved.bodies, solution.residual});
    start = coldStart();
    solution = solve(problem.free, std::vector<double>(problem.frictions.size(), 0), tolerance, start);
  }
  if (!(solution.residual <= most)) {
    faults.push_back({CorrectionKind::omittedContacts, group.moved.bodies, solution.residual});
    solution.impulses.setZero();
  }
  noteUnsolved(group, solution, tolerance, faults);
  return solution.impulses;
}

/// Of few contacts to rounding, else from `start` and to `tolerance` (m/s).
ContactSolution GroupProblem::solve(const VectorX& free, const std::vector<double>& frictions, double tolerance,
                                    WarmStart& start) {
  if (isSolvedDensely_ && !assembly_.mechanism.motors.empty()) return solveSharing(free, frictions);
  if (isSolvedDensely_) return solveFrictionalContact(delassus(), free, frictions);
  const ContactSolution solution = solveFrictionalContact(sparse_.scaledOperator(), free, frictions, tolerance, start);
  iterations_ += solution.iterations;
  return solution;
}

VectorX GroupProblem::solveFrictionless(const VectorX& free, double tolerance) {
  WarmStart start = coldStart();
  return solve(free, std::vector<double>(contacts_.size(), 0), tolerance, start).impulses;
}

WarmStart GroupProblem::coldStart() const {
  const Eigen::Index size = 3 * std::ssize(contacts_);
  return {VectorX::Zero(size), VectorX::Zero(size), 0};
}

/// Impulses and velocities of the step before, by the nearest contact of the same bodies.
WarmStart GroupProblem::warmStartOf(const StepGroup& group) const {
  WarmStart start = coldStart();
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
