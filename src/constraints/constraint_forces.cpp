// Constraint forces by the Schur complement J M^-1 J^T, factorised directly (D. Baraff, "Linear-time dynamics using
// Lagrange multipliers", SIGGRAPH 1996, keeps the sparse matrix of bodies and rows instead: the same cost for chains,
// and this one is positive semi-definite).

#include "constraints/constraint_forces.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace cradle {
namespace {

// Where rows depend on each other, or nearly so, a part of the diagonal is added to it: they then share their load, and
// a direction that is constrained by less than its square root gives way instead of being thrown about by rounding.
// Refinement takes out the error that this makes elsewhere: each one leaves 1e-8 / (smallest other eigenvalue of the
// scaled matrix) of it.
constexpr double kRegularPivot = 1e-6;  // of its diagonal entry: above, rows are independent
constexpr double kRegularisation = 1e-8;
constexpr double kRefined = 1e-15;  // residual that is left, as a part of the right-hand side
constexpr int kMaxRefinements = 3;

constexpr int kMaxProjectionSteps = 20;      // quadratic convergence needs 1 or 2 from a step's error
constexpr double kStalled = 0.5;             // an iteration that leaves more of an error has failed
constexpr double kFar = 1000;                // times the error: few sound mechanisms move farther to mend it
constexpr double kConverged = 0.2;           // an iteration that leaves less of an error (0.25 at a jam) was sound,
constexpr double kFarthest = 1e-3;           // if it moved nothing farther than this (m or rad)
constexpr double kMoreRegular = 1000;        // factor on the regularisation after a failure
constexpr double kMaxRegularisation = 1e-1;  // with it, every direction that is left is a singular one

constexpr double kLeftRoundings = 1e4;          // of constraints after projection, which leaves a few
constexpr double kJammedRegularisation = 1e-7;  // of the diagonal: 3e-4 of a size from where no motion is left
constexpr double kContradicted = 0.5;           // of what is asked: locked mechanisms leave 0.95, others up to 0.02
constexpr double kContradictingRatio = 1e-3;    // of the largest residual: rows with less contradict nothing

/// The three rows of a joint.
auto partOf(VectorX& multipliers, std::size_t joint) {
  return multipliers.segment<3>(static_cast<Eigen::Index>(3 * joint));
}

double largestOf(const Vec3& vector) {
  return vector.lpNorm<Eigen::Infinity>();
}

}  // namespace

void ConstraintSolver::factorize(const VectorX& state) {
  findBodyFrames(bodies_, state, frames_);
  factorize(state, frames_);
}

void ConstraintSolver::factorize(const VectorX& state, const std::vector<BodyFrame>& frames) {
  if (!hasJointsAlone()) return factorizeRows(state, frames);
  isInBlocks_ = joints_.factorize(constraints_, bodies_, state, frames) > kRegularPivot;
  multipliers_.resize(static_cast<Eigen::Index>(3 * joints_.size()));
  areJointsDependent_ = !isInBlocks_;
  if (areJointsDependent_) factorizeRows(state, frames);
}

/// Ball joints that do not depend on each other are all constraints of the bodies.
bool ConstraintSolver::hasJointsAlone() const {
  return !constraints_.empty() && !excludes_ && !areJointsDependent_ &&
         std::all_of(constraints_.begin(), constraints_.end(), [](const Constraint& constraint) {
           return std::holds_alternative<BallJointConstraint>(constraint.kind);
         });
}

void ConstraintSolver::factorizeRows(const VectorX& state, const std::vector<BodyFrame>& frames) {
  isInBlocks_ = false;
  findRows(constraints_, state, frames, rows_, excluded_);
  if (!hasKnownStructure()) analyze();
  multipliers_.resize(static_cast<Eigen::Index>(rows_.size()));  // blocks may have had others since
  for (std::size_t i = 0; i < rows_.size(); ++i) responses_[i] = responseTo(rows_[i], bodies_, frames);
  for (std::size_t i = 0; i < rows_.size(); ++i) diagonal_[i] = entry(static_cast<int>(i), static_cast<int>(i));
  for (std::size_t i = 0; i < couplings_.size(); ++i) entries_[i] = entry(couplings_[i].row, couplings_[i].column);
  factor_.factorize(diagonal_, entries_);
  isRegular_ = factor_.leastPivot() > kRegularPivot;
  if (!isRegular_) regularize(kRegularisation);
}

void ConstraintSolver::regularize(double regularisation) {
  for (std::size_t i = 0; i < rows_.size(); ++i) regularDiagonal_[i] = diagonal_[i] * (1 + regularisation);
  factor_.factorize(regularDiagonal_, entries_);
}

void ConstraintSolver::exclude(const std::vector<char>& bodies) {
  excluded_ = bodies;
  excludes_ = std::any_of(bodies.begin(), bodies.end(), [](char isOut) { return isOut; });
}

bool ConstraintSolver::isExcluded(const ConstraintRow& row) const {
  const auto isOut = [this](int body) { return body != kFixed && excluded_[static_cast<std::size_t>(body)]; };
  return !excluded_.empty() && (isOut(row.bodyA) || isOut(row.bodyB));
}

bool ConstraintSolver::hasKnownStructure() const {
  return std::equal(rows_.begin(), rows_.end(), structure_.begin(), structure_.end(),
                    [](const ConstraintRow& row, const auto& bodies) {
                      return row.bodyA == bodies.first && row.bodyB == bodies.second;
                    });
}

void ConstraintSolver::analyze() {
  structure_.clear();
  std::vector<std::vector<int>> rowsOfBody(bodies_.size());
  std::vector<std::pair<int, int>> places;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    structure_.emplace_back(rows_[i].bodyA, rows_[i].bodyB);
    std::vector<int> neighbours;
    for (const int body : {rows_[i].bodyA, rows_[i].bodyB}) {
      if (body == kFixed) continue;
      std::vector<int>& rows = rowsOfBody[static_cast<std::size_t>(body)];
      neighbours.insert(neighbours.end(), rows.begin(), rows.end());
      rows.push_back(static_cast<int>(i));
    }
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    for (const int neighbour : neighbours)
      if (neighbour != static_cast<int>(i)) places.emplace_back(static_cast<int>(i), neighbour);
  }
  couplings_.clear();
  for (const auto& [row, column] : places) couplings_.push_back({row, column});
  factor_.analyze(static_cast<int>(rows_.size()), places);
  responses_.resize(rows_.size());
  diagonal_.resize(rows_.size());
  regularDiagonal_.resize(rows_.size());
  entries_.resize(places.size());
  rightHandSide_.resize(static_cast<Eigen::Index>(rows_.size()));
  correction_.resize(rightHandSide_.size());
}

/// Of the Delassus operator.
double ConstraintSolver::entry(int row, int column) const {
  const std::size_t from = static_cast<std::size_t>(row), to = static_cast<std::size_t>(column);
  return delassusEntry(rows_[to], rows_[from], responses_[from]);
}

/// Overwrites the right-hand side in multipliers_ by the solution, refined iteratively if it has to be.
void ConstraintSolver::solve() {
  if (isInBlocks_) return joints_.solve(multipliers_);
  if (isRegular_) return factor_.solve(multipliers_);
  rightHandSide_ = multipliers_;
  factor_.solve(multipliers_);
  const double wanted = rightHandSide_.lpNorm<Eigen::Infinity>();
  double last = wanted;
  for (int i = 0; i < kMaxRefinements; ++i) {
    findResidual();
    const double residual = correction_.lpNorm<Eigen::Infinity>();
    if (!(residual > kRefined * wanted) || residual > kStalled * last) return;
    last = residual;
    factor_.solve(correction_);
    multipliers_ += correction_;
  }
}

/// Right-hand side - J M^-1 J^T multipliers.
void ConstraintSolver::findResidual() {
  for (Eigen::Index row = 0; row < multipliers_.size(); ++row)
    correction_[row] = rightHandSide_[row] - diagonal_[static_cast<std::size_t>(row)] * multipliers_[row];
  for (std::size_t i = 0; i < couplings_.size(); ++i) {
    const auto [row, column] = couplings_[i];
    correction_[row] -= entries_[i] * multipliers_[column];
    correction_[column] -= entries_[i] * multipliers_[row];
  }
}

/// Calls add(body, linear, angular) with the parts of M^-1 J^T multipliers, row by row.
template <class Add>
void ConstraintSolver::addResponse(const Add& add) const {
  if (isInBlocks_) return joints_.addResponse(multipliers_, add);
  for (std::size_t i = 0; i < rows_.size(); ++i)
    cradle::addResponse(rows_[i], responses_[i], multipliers_[static_cast<Eigen::Index>(i)], add);
}

/// Sets multipliers_ to -J v for the velocities, or accelerations, in `state`.
void ConstraintSolver::opposeRates(const VectorX& state) {
  if (isInBlocks_)
    for (std::size_t i = 0; i < joints_.size(); ++i) partOf(multipliers_, i) = -joints_.rateOf(i, state);
  else
    for (std::size_t i = 0; i < rows_.size(); ++i)
      multipliers_[static_cast<Eigen::Index>(i)] = -rateOf(rows_[i], state);
}

const VectorX& ConstraintSolver::constrainAccelerations(VectorX& derivative) {
  opposeRates(derivative);
  if (isInBlocks_)
    for (std::size_t i = 0; i < joints_.size(); ++i) partOf(multipliers_, i) -= joints_.velocityProduct(i);
  else
    for (std::size_t i = 0; i < rows_.size(); ++i)
      multipliers_[static_cast<Eigen::Index>(i)] -= rows_[i].velocityProduct;
  solve();
  addResponse([&derivative](int body, const Vec3& linear, const Vec3& angular) {
    linearVelocity(derivative, body) += linear;
    angularVelocity(derivative, body) += angular;
  });
  return multipliers_;
}

void ConstraintSolver::constrainVelocities(VectorX& state) {
  opposeRates(state);
  solve();
  addResponse([&state](int body, const Vec3& linear, const Vec3& angular) {
    linearVelocity(state, body) += linear;
    angularVelocity(state, body) += angular;
  });
}

// Newton's method, damped as by Levenberg and Marquardt: a step that does not help, or that goes far for a slow gain,
// was led astray by directions that are hardly constrained, and is tried again with less trust in them.
double ConstraintSolver::project(VectorX& state) {
  double regularisation = kRegularisation;
  factorize(state);
  const double found = largestError();
  double error = found;
  for (int i = 0; i < kMaxProjectionSteps && !holdWithin(0, 1); ++i) {
    undisplaced_ = state;
    const double farthest = displace(state);
    factorize(state);
    const double left = largestError();
    const bool isSound = farthest <= kFar * error || (left < kConverged * error && farthest <= kFarthest);
    if (isSound && left < kStalled * error) {
      error = left;
      continue;
    }
    if (isSound && left < error) break;  // at the limit of rounding
    state = undisplaced_;
    regularisation *= kMoreRegular;
    findBodyFrames(bodies_, state, frames_);
    factorizeRows(state, frames_);
    if (regularisation > kMaxRegularisation) break;
    regularize(regularisation);
  }
  constrainVelocities(state);
  return found;
}

/// One step of Newton's method. Returns how far the body that moved most was shifted (m) or turned (rad).
double ConstraintSolver::displace(VectorX& state) {
  if (isInBlocks_)
    for (std::size_t i = 0; i < joints_.size(); ++i) partOf(multipliers_, i) = -joints_.value(i);
  else
    for (std::size_t i = 0; i < rows_.size(); ++i) multipliers_[static_cast<Eigen::Index>(i)] = -rows_[i].value;
  isInBlocks_ ? joints_.solve(multipliers_) : factor_.solve(multipliers_);
  double farthest = 0;
  addResponse([&](int body, const Vec3& shift, const Vec3& turn) {
    centerOfMass(state, body) += shift;
    turnBody(state, body, turn);
    farthest = std::max({farthest, shift.norm(), turn.norm()});
  });
  return farthest;
}

double ConstraintSolver::largestError() const {
  double error = 0;
  if (isInBlocks_)
    for (std::size_t i = 0; i < joints_.size(); ++i) error = std::max(error, largestOf(joints_.value(i)));
  else
    for (const ConstraintRow& row : rows_) error = std::max(error, std::abs(row.value) / row.scale);
  return error;
}

bool ConstraintSolver::holdWithin(double error, double roundings) const {
  for (std::size_t i = 0; isInBlocks_ && i < joints_.size(); ++i)
    if (!(largestOf(joints_.value(i)) <= error + roundings * joints_.rounding(i))) return false;
  return isInBlocks_ || std::all_of(rows_.begin(), rows_.end(), [=](const ConstraintRow& row) {
           return std::abs(row.value) <= (error + roundings * row.rounding) * row.scale;
         });
}

bool ConstraintSolver::leaveNoMotion(const VectorX& state, double error) {
  return !holdWithin(error, kLeftRoundings) && contradiction(state) > kContradicted;
}

/// How much of what the velocities ask of the constraints is left, in m/s^2 of each m/s^2 asked: about 1 where there is
/// no motion, about 0 where it can go on. A direction that is constrained by less than the square root of the
/// regularisation counts as not constrained: what is asked along it is left.
double ConstraintSolver::contradiction(const VectorX& state) {
  findBodyFrames(bodies_, state, frames_);
  factorizeRows(state, frames_);
  if (isRegular_) return 0;
  regularize(kJammedRegularisation);
  for (std::size_t i = 0; i < rows_.size(); ++i) multipliers_[static_cast<Eigen::Index>(i)] = -rows_[i].velocityProduct;
  rightHandSide_ = multipliers_;
  factor_.solve(multipliers_);
  findResidual();
  const double least = kContradictingRatio * correction_.lpNorm<Eigen::Infinity>();
  double left = 0, asked = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double residual = std::abs(correction_[static_cast<Eigen::Index>(i)]) / rows_[i].scale;
    if (!(residual * rows_[i].scale > least)) continue;
    left += residual;
    asked += std::abs(rows_[i].velocityProduct) / rows_[i].scale;
  }
  return asked > 0 ? left / asked : 0;
}

double ConstraintSolver::largestRate(const VectorX& state) const {
  double largest = 0;
  if (isInBlocks_)
    for (std::size_t i = 0; i < joints_.size(); ++i) largest = std::max(largest, largestOf(joints_.rateOf(i, state)));
  else
    for (const ConstraintRow& row : rows_) largest = std::max(largest, std::abs(rateOf(row, state)) / row.scale);
  return largest;
}

}  // namespace cradle
