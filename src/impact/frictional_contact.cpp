// ADMM (contact_admm.h), or an interior point method (contact_interior_point.h) where that is slow, finds which
// contacts are open, stick and slide; Newton's method on the equations of P. Alart and A. Curnier ("A mixed formulation
// for frictional contact problems prone to Newton like solution methods", 1991) finishes to rounding from there. It is
// tried again and again: often it needs no more than a rough guess.

#include "impact/frictional_contact.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "impact/contact_admm.h"
#include "impact/contact_interior_point.h"
#include "impact/contact_newton.h"
#include "impact/linear_complementarity.h"
#include "impact/single_contact.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kConvergedRatio = 1e-12;                                  // of the largest velocity
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();  // of the sums in G z
constexpr double kMaxRoundingRatio =
    1e-6;  // of the largest velocity: more is no rounding, but impulses that grow without bound
constexpr double kProximalRatio = 1e-7;      // of the largest inverse mass: makes singular problems regular
constexpr double kFirstPenaltyRatio = 1e-5;  // of the same; heavy on light wants it small, many contacts large
constexpr double kFurtherPenaltyRatios[] = {1e-3, 0.1};
constexpr int kFirstRound = 10;          // iterations before Newton's method is tried
constexpr double kRoundGrowth = 1.2;     // and before each further trial: far from the end, trials are waste
constexpr Index kFewContacts = 12;       // more are often redundant
constexpr double kGoodRatio = 1e-9;      // of the largest velocity: good enough where rounding is far off
constexpr int kMaxIterations = 500;      // from each of them
constexpr double kInteriorRatio = 1e-9;  // of the largest velocity: where the interior point method ends
constexpr double kRegularRatio = 1e-9;   // of the largest inverse mass: what makes Newton's matrix regular
constexpr int kProximalSteps = 3;        // each leaves a billionth of the error, or of one in a stiff direction
constexpr int kMaxNewtonSteps = 20, kFewNewtonSteps = 6;  // with few contacts, and with more

/// Impulses and velocities multiplied contact by contact so that each has inverse mass 1 and the largest free velocity
/// is 1.
class ScaledProblem {
 public:
  ScaledProblem(const MatrixX& g, const VectorX& free, const std::vector<double>& frictions);

  /// Impulses in the given units. Found: to rounding; else as near as was come. `near`: those of a problem like this
  /// one, or none.
  VectorX solve(const VectorX& near);

  /// In the given units.
  ContactSolution judge(VectorX impulses) const;

 private:
  double friction(Index contact) const { return cones_.frictions[static_cast<std::size_t>(contact)]; }
  bool solveFrom(double penalty);
  bool solveFromInside();
  bool accept(VectorX& z);
  void setPenalty(double penalty);
  double residual(const VectorX& z, const VectorX& u) const;
  bool isConverged(double residual, const VectorX& z, const VectorX& u) const;
  bool polish(VectorX& impulses) const;
  void stepByNewton(VectorX& z) const;
  VectorX scaled(const VectorX& impulses) const;
  VectorX unscaled(const VectorX& z) const;

  const MatrixX& givenMatrix_;
  const VectorX& givenFree_;
  VectorX scale_;  // of impulses, by contact
  double velocityScale_ = 1;
  MatrixX g_;
  ScaledContacts cones_;
  double largest_ = 0;  // bound on the eigenvalues of g_
  AdmmIterate iterate_;
  Eigen::LLT<MatrixX> factor_;
  VectorX best_;
  double leastResidual_ = 0;
};

ScaledProblem::ScaledProblem(const MatrixX& g, const VectorX& free, const std::vector<double>& frictions)
    : givenMatrix_(g), givenFree_(free), scale_(frictions.size()), g_(g.rows(), g.cols()), cones_{free, frictions} {
  const Index contacts = scale_.size();
  for (Index i = 0; i < contacts; ++i) {
    const double inverseMass = g.diagonal().segment<3>(3 * i).sum() / 3;
    scale_[i] = inverseMass > 0 ? 1 / std::sqrt(inverseMass) : 1;
    cones_.free.segment<3>(3 * i) *= scale_[i];
  }
  for (Index j = 0; j < contacts; ++j)
    for (Index i = 0; i < contacts; ++i)
      g_.block<3, 3>(3 * i, 3 * j) = scale_[i] * scale_[j] * g.block<3, 3>(3 * i, 3 * j);
  const double fastest = cones_.free.cwiseAbs().maxCoeff();
  if (fastest > 0) velocityScale_ = fastest;
  cones_.free /= velocityScale_;
  largest_ = g_.cwiseAbs().colwise().sum().maxCoeff();
}

void ScaledProblem::setPenalty(double penalty) {
  if (penalty == iterate_.penalty) return;
  iterate_.penalty = penalty;
  MatrixX shifted = g_;
  shifted.diagonal().array() += penalty + kProximalRatio * largest_;
  factor_.compute(shifted);
}

/// The largest of all contacts'.
double ScaledProblem::residual(const VectorX& z, const VectorX& u) const {
  double largest = 0;
  for (Index i = 0; i < scale_.size(); ++i) {
    const Vec3 error = coulombResidual(z.segment<3>(3 * i), u.segment<3>(3 * i), friction(i));
    if (!error.allFinite()) return INFINITY;
    largest = std::max(largest, error.cwiseAbs().maxCoeff());
  }
  return largest;
}

bool ScaledProblem::isConverged(double residual, const VectorX& z, const VectorX& u) const {
  if (!(residual <= kMaxRoundingRatio)) return false;
  if (residual <= kConvergedRatio * std::max(1.0, u.cwiseAbs().maxCoeff())) return true;
  return residual <= kRounding * (g_.cwiseAbs() * z.cwiseAbs()).maxCoeff();
}

void ScaledProblem::stepByNewton(VectorX& z) const {
  VectorX u = g_ * z + cones_.free;
  std::vector<Index> pushing;
  for (Index i = 0; i < scale_.size(); ++i) {
    if (pushes(z.segment<3>(3 * i), u.segment<3>(3 * i)))
      pushing.insert(pushing.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    else
      z.segment<3>(3 * i).setZero();
  }
  if (pushing.empty()) return;
  u = g_ * z + cones_.free;
  MatrixX rows = g_(pushing, pushing);
  VectorX sides(pushing.size());
  for (Index at = 0; at < sides.size(); at += 3) {
    const Index first = pushing[static_cast<std::size_t>(at)];
    const NewtonRow row =
        newtonRow(z.segment<3>(first), u.segment<3>(first), friction(first / 3), kRegularRatio * largest_);
    rows.middleRows<3>(at) = (row.ofVelocity * rows.middleRows<3>(at)).eval();
    rows.block<3, 3>(at, at) += row.ofImpulse;
    sides.segment<3>(at) = -row.value;
  }
  z(pushing) += VectorX(rows.partialPivLu().solve(sides));
}

/// Newton's method. Changes the impulses only if it converges.
bool ScaledProblem::polish(VectorX& impulses) const {
  VectorX z = impulses;
  const int most = scale_.size() > kFewContacts ? kFewNewtonSteps : kMaxNewtonSteps;
  for (int step = 0; step < most; ++step) {
    stepByNewton(z);
    const VectorX u = g_ * z + cones_.free;
    const double left = residual(z, u);
    if (isConverged(left, z, u)) {
      impulses = z;
      stepByNewton(z);  // what is left is often rounding then
      if (residual(z, g_ * z + cones_.free) < left) impulses = z;
      return true;
    }
    if (!(left < INFINITY)) return false;
  }
  return false;
}

VectorX ScaledProblem::solve(const VectorX& near) {
  best_ = VectorX::Zero(cones_.free.size());
  leastResidual_ = residual(best_, cones_.free);
  if (isConverged(leastResidual_, best_, cones_.free)) return unscaled(best_);
  if (near.size() > 0) {
    VectorX z = scaled(near);
    if (accept(z)) return unscaled(best_);
  }
  if (solveFrom(kFirstPenaltyRatio * largest_) || solveFromInside()) return unscaled(best_);
  if (leastResidual_ <= kGoodRatio) return unscaled(best_);
  for (const double part : kFurtherPenaltyRatios)
    if (solveFrom(part * largest_)) break;
  return unscaled(best_);
}

bool ScaledProblem::solveFromInside() {
  Eigen::PartialPivLU<MatrixX> factor;
  ContactOperator op;
  op.multiply = [this](const VectorX& z, VectorX& u) { u = g_ * z + cones_.free; };
  op.respond = [this, &factor](const std::vector<Mat3>& scalingBlocks, bool isNew, const VectorX& c, VectorX& du) {
    if (isNew) {
      MatrixX matrix(g_.rows(), g_.cols());
      for (Index i = 0; i < scale_.size(); ++i)
        matrix.middleCols<3>(3 * i) = g_.middleCols<3>(3 * i) * scalingBlocks[static_cast<std::size_t>(i)];
      matrix.diagonal().array() += 1;
      factor.compute(matrix);
    }
    du = factor.solve(g_ * c);
  };
  VectorX z = VectorX::Zero(cones_.free.size());
  solveByInteriorPoint(cones_, op, kInteriorRatio, z);
  return accept(z);
}

/// Keeps impulses that are better than the best so far. True if they, or where Newton's method leads from them, are a
/// solution.
bool ScaledProblem::accept(VectorX& z) {
  const VectorX u = g_ * z + cones_.free;
  const double left = residual(z, u);
  const bool isFound = isConverged(left, z, u) || polish(z);
  if (isFound || left < leastResidual_) best_ = z, leastResidual_ = left;
  return isFound;
}

/// From nothing, with a penalty to begin with.
bool ScaledProblem::solveFrom(double penalty) {
  iterate_.impulses = iterate_.velocities = iterate_.unbounded = VectorX::Zero(cones_.free.size());
  setPenalty(penalty);
  const auto solveShifted = [this](VectorX& b) { factor_.solveInPlace(b); };
  double round = kFirstRound;
  for (int done = 0; done < kMaxIterations; done += static_cast<int>(round), round *= kRoundGrowth) {
    iterateAdmm(cones_, kProximalRatio * largest_, solveShifted, static_cast<int>(round), iterate_);
    VectorX z = iterate_.impulses;
    if (accept(z)) return true;
    setPenalty(balancedPenalty(iterate_, largest_));
  }
  return false;
}

VectorX ScaledProblem::scaled(const VectorX& impulses) const {
  VectorX z(impulses.size());
  for (Index i = 0; i < scale_.size(); ++i)
    z.segment<3>(3 * i) = impulses.segment<3>(3 * i) / (scale_[i] * velocityScale_);
  return z;
}

/// In the cones exactly.
VectorX ScaledProblem::unscaled(const VectorX& z) const {
  VectorX impulses(z.size());
  for (Index i = 0; i < scale_.size(); ++i)
    impulses.segment<3>(3 * i) = scale_[i] * velocityScale_ * projectOnCone(z.segment<3>(3 * i), friction(i));
  return impulses;
}

ContactSolution ScaledProblem::judge(VectorX impulses) const {
  ContactSolution solution{std::move(impulses), {}, 0, false};
  solution.velocities = givenMatrix_ * solution.impulses + givenFree_;
  VectorX z = solution.impulses / velocityScale_, u = solution.velocities / velocityScale_;
  for (Index i = 0; i < scale_.size(); ++i) {
    z.segment<3>(3 * i) /= scale_[i];
    u.segment<3>(3 * i) *= scale_[i];
    const Vec3 error = coulombResidual(z.segment<3>(3 * i), u.segment<3>(3 * i), friction(i));
    solution.residual = std::max(solution.residual, velocityScale_ / scale_[i] * error.cwiseAbs().maxCoeff());
  }
  // What was off the cones by the residual is in them now; the velocities have changed by that.
  solution.converged = isConverged(residual(z, u) / (1 + largest_), z, u);
  return solution;
}

bool isRegular(const MatrixX& matrix) {
  const Eigen::LLT<MatrixX> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  const auto left = factor.matrixLLT().diagonal().cwiseAbs2();
  return (left.array() > kRegularRatio * matrix.diagonal().array()).all();
}

/// Without friction: the normal parts alone, by pivoting. Where redundant contacts leave a choice, the load is shared
/// as evenly as can be, by the proximal point method (R. T. Rockafellar, "Monotone operators and the proximal point
/// algorithm", 1976), which where nothing solves the problem comes as near as can be.
VectorX solveNormals(const MatrixX& G, const VectorX& g) {
  const auto normals = Eigen::seq(2, Eigen::last, 3);
  MatrixX matrix = G(normals, normals);
  const VectorX free = g(normals);
  VectorX pushes = VectorX::Zero(free.size());
  if (isRegular(matrix)) {
    pushes = solveLinearComplementarity(matrix, free);
  } else {
    const VectorX shift = kRegularRatio * matrix.diagonal();
    matrix.diagonal() += shift;
    for (int i = 0; i < kProximalSteps; ++i)
      pushes = solveLinearComplementarity(matrix, VectorX(free - shift.cwiseProduct(pushes)));
  }
  VectorX impulses = VectorX::Zero(g.size());
  impulses(normals) = pushes;
  return impulses;
}

}  // namespace

ContactSolution solveFrictionalContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                       const VectorX& near) {
  if (frictions.empty()) return {};
  ScaledProblem problem(G, g, frictions);
  const bool hasFriction =
      std::any_of(frictions.begin(), frictions.end(), [](double friction) { return friction > 0; });
  if (!hasFriction) return problem.judge(solveNormals(G, g));
  const ContactSolution solution =
      problem.judge(frictions.size() == 1 ? VectorX(solveSingleContact(G, g, frictions[0])) : problem.solve(near));
  if (solution.residual <= g.cwiseAbs().maxCoeff()) return solution;
  // Impulses that wedge a body grow without bound, and say nothing.
  const ContactSolution smooth = problem.judge(solveNormals(G, g));
  return smooth.residual < solution.residual ? smooth : solution;
}

}  // namespace cradle
