// Constraint forces by the Schur complement J M^-1 J^T, factorised directly (D. Baraff, "Linear-time dynamics using
// Lagrange multipliers", SIGGRAPH 1996, keeps the sparse matrix of bodies and rows instead: the same cost for chains,
// and this one is positive semi-definite).

#include "constraints/constraint_forces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace cradle {
namespace {

// Where rows depend on each other, or nearly so, a part of the diagonal is added to it: they then share their load, and
// a direction that is constrained by less than its square root gives way instead of being thrown about by rounding.
// Refinement takes out the error that this makes elsewhere: each one leaves 1e-8 / (smallest other eigenvalue of the
// scaled matrix) of it.
constexpr double kRegularPivot = 1e-6;   // of its diagonal entry: above, rows are independent
constexpr double kRoundedPivot = 1e-12;  // of its diagonal entry: below, rounding is all that is left of it
constexpr double kRegularisation = 1e-8;
constexpr double kRefined = 1e-15;   // residual that is left, as a part of the right-hand side
constexpr int kMaxRefinements = 60;  // 3 are usual; the last ones leave 1e-15 if each leaves half

constexpr int kMaxProjectionSteps = 20;      // quadratic convergence needs 1 or 2 from a step's error
constexpr double kStalled = 0.5;             // an iteration that leaves more of an error has failed
constexpr double kMaxShiftRatio = 1000;      // times the error: few sound mechanisms move farther to mend it
constexpr double kConverged = 0.2;           // an iteration that leaves less of an error (0.25 at a jam) was sound,
constexpr double kFarthest = 1e-3;           // if it moved nothing farther than this (m or rad)
constexpr double kMoreRegular = 1000;        // factor on the regularisation after a failure
constexpr double kMaxRegularisation = 1e-1;  // with it, every direction that is left is a singular one

constexpr double kLeftRoundings = 1e4;          // of constraints after projection, which leaves a few
constexpr double kJammedRegularisation = 1e-7;  // of the diagonal: 3e-4 of a size from where no motion is left
constexpr double kContradicted = 0.5;           // of what is asked: locked mechanisms leave 0.95, others up to 0.02
constexpr double kContradictingRatio = 1e-3;    // of the largest residual: rows with less contradict nothing

}  // namespace

void ConstraintSolver::factorize(const VectorX& state) {
  findBodyFrames(bodies_, state, frames_);
  factorize(state, frames_);
}

void ConstraintSolver::factorize(const VectorX& state, const std::vector<BodyFrame>& frames) {
  findBlocks(state, frames);
  if (!factor_ || !hasKnownStructure()) analyze();
  assemble();
  factor_->factorize();
  isRegular_ = factor_->leastPivot() > kRegularPivot;
  if (isRegular_) return;
  const bool areIndependent = factor_->leastPivot() > kRoundedPivot && areRowsIndependent();
  factor_->factorize(areIndependent ? 0 : kRegularisation);
}

/// Whether the rows are independent by where the bodies are, and it is their masses that leave small pivots: those of
/// the tie of a heavy body to a light one are a part of their diagonal that is the ratio of the masses.
bool ConstraintSolver::areRowsIndependent() {
  assembleWithEqualMasses();
  factor_->factorize();
  const bool areIndependent = factor_->leastPivot() > kRegularPivot;
  assemble();
  return areIndependent;
}

/// The Delassus operator if all bodies had a mass of 1 kg, and their radii of gyration.
void ConstraintSolver::assembleWithEqualMasses() {
  ownResponses_ = responses_;
  const auto massOf = [this](int body) {
    const bool isMoved = body != kFixed && !bodies_[static_cast<std::size_t>(body)].isDriven();
    return isMoved ? bodies_[static_cast<std::size_t>(body)].mass : 1.0;
  };
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const double massA = massOf(blocks_[i].bodyA), massB = massOf(blocks_[i].bodyB);
    responses_[i].inverseMassA *= massA, responses_[i].inverseMassB *= massB;
    if (blocks_[i].turnsA) responses_[i].turnA *= massA;
    if (blocks_[i].turnsB) responses_[i].turnB *= massB;
  }
  assemble();
  responses_ = ownResponses_;
}

void ConstraintSolver::findBlocks(const VectorX& state, const std::vector<BodyFrame>& frames) {
  blocks_.resize(constraints_.size()), responses_.resize(constraints_.size());
  std::size_t blocks = 0;
  for (const Constraint& constraint : constraints_) {
    if (isExcluded(constraint)) continue;
    findRows(constraint, state, frames, blocks_[blocks]);
    if (!moves(constraint.anchorA.body)) blocks_[blocks].bodyA = kFixed, blocks_[blocks].turnsA = false;
    if (!moves(constraint.anchorB.body)) blocks_[blocks].bodyB = kFixed, blocks_[blocks].turnsB = false;
    findResponse(blocks_[blocks], bodies_, frames, responses_[blocks]);
    ++blocks;
  }
  blocks_.resize(blocks), responses_.resize(blocks);
}

void ConstraintSolver::exclude(const std::vector<char>& bodies, const std::vector<char>& fixed) {
  excluded_ = bodies;
  fixed_ = fixed;
}

bool ConstraintSolver::moves(int body) const {
  return body != kFixed && (fixed_.empty() || !fixed_[static_cast<std::size_t>(body)]);
}

bool ConstraintSolver::isExcluded(const Constraint& constraint) const {
  const int bodyA = constraint.anchorA.body, bodyB = constraint.anchorB.body;
  const auto isOut = [this](int body) {
    return moves(body) && !excluded_.empty() && excluded_[static_cast<std::size_t>(body)];
  };
  return isOut(bodyA) || isOut(bodyB) || !(moves(bodyA) || moves(bodyB));
}

bool ConstraintSolver::hasKnownStructure() const {
  return std::equal(blocks_.begin(), blocks_.end(), structure_.begin(), structure_.end(),
                    [](const ConstraintBlock& block, const std::array<int, 3>& known) {
                      return block.bodyA == known[0] && block.bodyB == known[1] && block.rows == known[2];
                    });
}

/// Which constraints share a body, and the rows of each.
void ConstraintSolver::analyze() {
  structure_.clear(), couplings_.clear();
  std::vector<std::vector<int>> blocksOf(bodies_.size());
  std::vector<std::pair<int, int>> places;
  std::vector<int> sizes;
  Eigen::Index rows = 0;
  for (const ConstraintBlock& block : blocks_) {
    const int index = static_cast<int>(sizes.size());
    structure_.push_back({block.bodyA, block.bodyB, block.rows});
    sizes.push_back(block.rows);
    rows += block.rows;
    const std::size_t first = places.size();
    for (const int body : {block.bodyA, block.bodyB}) {
      if (body == kFixed) continue;
      for (const int other : blocksOf[static_cast<std::size_t>(body)])
        if (std::find(places.begin() + static_cast<std::ptrdiff_t>(first), places.end(), std::pair(index, other)) ==
            places.end())
          places.emplace_back(index, other);
      blocksOf[static_cast<std::size_t>(body)].push_back(index);
    }
  }
  if (!factor_) factor_ = std::make_unique<BlockLdlt>();
  factor_->analyze(sizes, places);
  for (const auto& [first, second] : places) {
    const std::size_t row = static_cast<std::size_t>(first), column = static_cast<std::size_t>(second);
    couplings_.push_back({row, column, sharedBodies(blocks_[row], blocks_[column])});
  }
  multipliers_.resize(rows), rightHandSide_.resize(rows), residual_.resize(rows);
}

/// The Delassus operator.
void ConstraintSolver::assemble() {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const ConstraintBlock& block = blocks_[i];
    withRows(block.rows, [&](auto rows) {
      double* const entries = factor_->diagonal(i);
      putDelassus<rows>(block, responses_[i], entries);
      if (block.compliance > 0)
        for (int row = 0; row < rows; ++row) entries[row * rows + row] += block.compliance;
    });
  }
  for (std::size_t i = 0; i < couplings_.size(); ++i) {
    const ConstraintBlock &row = blocks_[couplings_[i].row], &column = blocks_[couplings_[i].column];
    const BlockResponse& response = responses_[couplings_[i].column];
    withRows(row.rows, [&](auto rows) {
      withRows(column.rows, [&](auto columns) {
        putDelassus<rows, columns>(row, column, couplings_[i].shared, response, factor_->beside(i), rows);
      });
    });
  }
}

/// Sets what is asked of rows that move nothing to zero: what they would leave says nothing of the others.
void ConstraintSolver::ignoreEmptyRows() {
  Eigen::Index index = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (int row = 0; row < blocks_[i].rows; ++row, ++index)
      if (factor_->diagonal(i)[row * blocks_[i].rows + row] == 0) multipliers_[index] = 0;
}

/// Overwrites the right-hand side in multipliers_ by the solution, refined iteratively if it has to be.
void ConstraintSolver::solve() {
  if (isRegular_) return factor_->solve(multipliers_);
  ignoreEmptyRows();
  rightHandSide_ = multipliers_;
  factor_->solve(multipliers_);
  const double wanted = rightHandSide_.lpNorm<Eigen::Infinity>();
  double last = wanted;
  for (int i = 0; i < kMaxRefinements; ++i) {
    residual_ = rightHandSide_;
    factor_->subtractProduct(multipliers_, residual_);
    const double left = residual_.lpNorm<Eigen::Infinity>();
    if (!(left > kRefined * wanted) || left > kStalled * last) return;
    last = left;
    factor_->solve(residual_);
    multipliers_ += residual_;
  }
}

/// Adds M^-1 J^T multipliers, constraint by constraint: to a state, or by calls of add(body, linear, angular).
template <class Add>
void ConstraintSolver::addResponses(Add&& add) const {
  const double* multipliers = multipliers_.data();
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    addResponse(blocks_[k], responses_[k], multipliers, add);
    multipliers += blocks_[k].rows;
  }
}

/// Calls visit(block, row, index) for each row; `index` is its place among all.
template <class Visit>
void ConstraintSolver::forEachRow(const Visit& visit) const {
  Eigen::Index index = 0;
  for (const ConstraintBlock& block : blocks_)
    for (std::size_t row = 0; row < static_cast<std::size_t>(block.rows); ++row) visit(block, row, index++);
}

/// Sets multipliers_ to -J v for the velocities in `state`.
void ConstraintSolver::opposeVelocities(const VectorX& state) {
  double* next = multipliers_.data();
  for (const ConstraintBlock& block : blocks_)
    withRows(block.rows, [&](auto rows) {
      findRates<rows>(block, state, next);
      for (int i = 0; i < rows; ++i, ++next) *next = -*next;
    });
}

/// Sets multipliers_ to -(J a + (dJ/dt) v) for the accelerations in `derivative`.
void ConstraintSolver::opposeAccelerations(const VectorX& derivative) {
  double* next = multipliers_.data();
  for (const ConstraintBlock& block : blocks_)
    withRows(block.rows, [&](auto rows) {
      findRates<rows>(block, derivative, next);
      for (std::size_t i = 0; i < rows; ++i, ++next) *next = -(*next + block.velocityProduct[i]);
    });
}

const VectorX& ConstraintSolver::constrainAccelerations(VectorX& derivative) {
  opposeAccelerations(derivative);
  solve();
  addResponses(derivative);
  return multipliers_;
}

void ConstraintSolver::constrainDisplacements(VectorX& displacement) {
  opposeVelocities(displacement);
  forEachRow([this](const ConstraintBlock& block, std::size_t row, Eigen::Index index) {
    multipliers_[index] -= block.value[row];
  });
  solve();
  addResponses(displacement);
}

void ConstraintSolver::constrainVelocities(VectorX& state) {
  opposeVelocities(state);
  solve();
  addResponses(state);
}

void ConstraintSolver::putMultipliers(VectorX& all) const {
  Eigen::Index next = 0, row = 0;
  for (const Constraint& constraint : constraints_) {
    const Eigen::Index rows = rowCount(constraint);
    if (!isExcluded(constraint)) {
      all.segment(row, rows) = multipliers_.segment(next, rows);
      next += rows;
    }
    row += rows;
  }
}

// Newton's method, damped as by Levenberg and Marquardt: a step that does not help, or that goes far for a slow gain,
// is tried again. Ties that pull a light body both ways turn it far there and back, and turns do not commute: where
// that leaves more than rounding, what they do to each body is added up before. After that the step was led astray by
// directions that are hardly constrained, and is tried again with less trust in them.
double ConstraintSolver::project(VectorX& state) {
  double regularisation = kRegularisation;
  bool inSum = false;
  factorize(state);
  const double found = largestError();
  double error = found;
  for (int i = 0; i < kMaxProjectionSteps && !holdWithin(0, 1); ++i) {
    undisplaced_ = state;
    const double farthest = displace(inSum, state);
    factorize(state);
    const double left = largestError();
    const bool isSound = farthest <= kMaxShiftRatio * error || (left < kConverged * error && farthest <= kFarthest);
    if (isSound && left < kStalled * error) {
      error = left;
      continue;
    }
    if (isSound && left < error) break;  // at the limit of rounding
    state = undisplaced_;
    factorize(state);
    if (!holdWithin(0, kLeftRoundings) && !std::exchange(inSum, true)) continue;
    regularisation *= kMoreRegular;
    if (regularisation > kMaxRegularisation) break;
    factor_->factorize(regularisation);
  }
  constrainVelocities(state);
  return found;
}

/// One step of Newton's method, tie by tie, or in the sum for each body. Returns how far the body that moved most was
/// shifted (m) or turned (rad).
double ConstraintSolver::displace(bool inSum, VectorX& state) {
  forEachRow([this](const ConstraintBlock& block, std::size_t row, Eigen::Index index) {
    multipliers_[index] = -block.value[row];
  });
  factor_->solve(multipliers_);
  double farthest = 0;
  const auto move = [&](int body, const Vec3& shift, const Vec3& turn) {
    centerOfMass(state, body) += shift;
    turnBody(state, body, turn);
    farthest = std::max({farthest, shift.norm(), turn.norm()});
  };
  if (!inSum) {
    addResponses(move);
    return farthest;
  }
  sum_.setZero(state.size());
  addResponses(sum_);
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body)
    move(body, linearVelocity(sum_, body), angularVelocity(sum_, body));
  return farthest;
}

double ConstraintSolver::largestError() const {
  double error = 0;
  forEachRow([&](const ConstraintBlock& block, std::size_t row, Eigen::Index) {
    error = std::max(error, std::abs(block.value[row]) / block.scale);
  });
  return error;
}

bool ConstraintSolver::holdWithin(double error, double roundings) const {
  bool holds = true;
  forEachRow([&](const ConstraintBlock& block, std::size_t row, Eigen::Index) {
    holds = holds && std::abs(block.value[row]) <= (error + roundings * block.rounding[row]) * block.scale;
  });
  return holds;
}

bool ConstraintSolver::leaveNoMotion(const VectorX& state, double error) {
  return !holdWithin(error, kLeftRoundings) && contradiction(state) > kContradicted;
}

/// How much of what the velocities ask of the constraints is left, in m/s^2 of each m/s^2 asked: about 1 where there is
/// no motion, about 0 where it can go on. Masses do not tell which: they are taken as equal. A direction that is
/// constrained by less than the square root of the regularisation counts as not constrained: what is asked along it is
/// left.
double ConstraintSolver::contradiction(const VectorX& state) {
  factorize(state);
  if (isRegular_) return 0;
  assembleWithEqualMasses();
  factor_->factorize(kJammedRegularisation);
  forEachRow([this](const ConstraintBlock& block, std::size_t row, Eigen::Index index) {
    multipliers_[index] = -block.velocityProduct[row];
  });
  residual_ = multipliers_;
  factor_->solve(multipliers_);
  factor_->subtractProduct(multipliers_, residual_);
  const double least = kContradictingRatio * residual_.lpNorm<Eigen::Infinity>();
  double left = 0, asked = 0;
  forEachRow([&](const ConstraintBlock& block, std::size_t row, Eigen::Index index) {
    const double residual = std::abs(residual_[index]);
    if (!(residual > least)) return;
    left += residual / block.scale;
    asked += std::abs(block.velocityProduct[row]) / block.scale;
  });
  return asked > 0 ? left / asked : 0;
}

ConstraintRate ConstraintSolver::largestRate(const VectorX& state) const {
  ConstraintRate largest;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    withRows(blocks_[i].rows, [&](auto rows) {
      std::array<double, rows> rates;
      findRates<rows>(blocks_[i], state, rates.data());
      for (const double rate : rates)
        if (std::abs(rate) / blocks_[i].scale > largest.rate) largest = {std::abs(rate) / blocks_[i].scale, i};
    });
  return largest;
}

}  // namespace cradle
