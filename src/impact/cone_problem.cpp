// The alternating direction method of multipliers on the cone problem with De Saxce's correction (J. Carpentier, Q. Le
// Lidec, L. Montaut, "From compliant to rigid contact simulation: a unified and efficient approach", 2024) finds which
// contacts are open, stick and slide; Newton's method on P. Alart and A. Curnier's equations ("A mixed formulation for
// frictional contact problems prone to Newton like solution methods", 1991) finishes to rounding from there.
// Impulses and velocities are scaled contact by contact, so that each has inverse mass 1: light and heavy bodies then
// converge together.

#include "impact/cone_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "impact/friction_cone.h"
#include "impact/single_contact.h"

namespace cradle {
namespace {

using Index = Eigen::Index;
using Mat2 = Eigen::Matrix2d;
using Vec2 = Eigen::Vector2d;

constexpr double kConvergedPart = 1e-12;  // of the largest velocity
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();  // of the sums in G z
constexpr double kProximalPart = 1e-6;     // eta, of the largest inverse mass: makes singular problems regular
constexpr double kFirstPenaltyPart = 1e-3;  // rho at the start, of the same
constexpr int kRoundLength = 10;            // iterations between two trials of Newton's method
constexpr int kMostRounds = 60;
constexpr double kUnbalanced = 10;          // ratio of residuals beyond which rho is changed
constexpr double kPenaltyStep = 4;
constexpr double kLeastPenaltyPart = 1e-7;
constexpr double kRegularPart = 1e-10;      // of the largest inverse mass: what makes Newton's matrix regular
constexpr int kMostNewtonSteps = 20;

/// A cone problem scaled so that each contact has inverse mass 1 and the largest free velocity is 1.
class ScaledProblem {
 public:
  ScaledProblem(const MatrixX& g, const VectorX& free, const std::vector<double>& frictions);
  ConeSolution solve();

 private:
  static double friction(const std::vector<double>& frictions, Index contact) {
    return frictions[static_cast<std::size_t>(contact)];
  }
  double friction(Index contact) const { return friction(frictions_, contact); }
  void iterate(int count);
  void rebalance();
  void setPenalty(double penalty);
  bool isConverged(const VectorX& z, const VectorX& u, double& residual) const;
  bool finish(VectorX& z) const;
  void addNewtonRows(Index contact, const Vec3& z, const Vec3& u, MatrixX& rows, VectorX& sides,
                     Index at) const;
  ConeSolution unscaled(const VectorX& z) const;

  const MatrixX& given_;
  const VectorX& givenFree_;
  const std::vector<double>& frictions_;
  Index contacts_;
  VectorX scale_;          // of impulses, by contact
  double velocityScale_ = 1;
  MatrixX g_;
  VectorX free_;
  double largest_ = 0;     // bound on the largest eigenvalue of g_
  double penalty_ = 0;     // rho
  Eigen::LLT<MatrixX> factor_;
  VectorX x_, y_, dual_, yBefore_;
  VectorX best_;
  double bestResidual_ = INFINITY;
};

ScaledProblem::ScaledProblem(const MatrixX& g, const VectorX& free, const std::vector<double>& frictions)
    : given_(g), givenFree_(free), frictions_(frictions), contacts_(std::ssize(frictions)), scale_(contacts_) {
  for (Index i = 0; i < contacts_; ++i) {
    const double inverseMass = g.diagonal().segment<3>(3 * i).sum() / 3;
    scale_[i] = inverseMass > 0 ? 1 / std::sqrt(inverseMass) : 1;
  }
  g_.resize(3 * contacts_, 3 * contacts_);
  free_.resize(3 * contacts_);
  for (Index i = 0; i < contacts_; ++i) {
    for (Index j = 0; j < contacts_; ++j)
      g_.block<3, 3>(3 * i, 3 * j) = scale_[i] * scale_[j] * g.block<3, 3>(3 * i, 3 * j);
    free_.segment<3>(3 * i) = scale_[i] * free.segment<3>(3 * i);
  }
  velocityScale_ = free_.cwiseAbs().maxCoeff();
  if (velocityScale_ > 0) free_ /= velocityScale_;
  largest_ = g_.cwiseAbs().rowwise().sum().maxCoeff();
}

void ScaledProblem::setPenalty(double penalty) {
  penalty_ = penalty;
  MatrixX shifted = g_;
  shifted.diagonal().array() += penalty + kProximalPart * largest_;
  factor_.compute(shifted);
}

void ScaledProblem::iterate(int count) {
  const double proximal = kProximalPart * largest_;
  VectorX side(free_.size());
  for (int k = 0; k < count; ++k) {
    side = dual_ - free_ + penalty_ * y_ + proximal * x_;
    for (Index i = 0; i < contacts_; ++i) side[3 * i + 2] -= friction(i) * dual_.segment<2>(3 * i).norm();
    x_ = side;
    factor_.solveInPlace(x_);
    yBefore_ = y_;
    for (Index i = 0; i < contacts_; ++i)
      y_.segment<3>(3 * i) = projectOnCone(x_.segment<3>(3 * i) - dual_.segment<3>(3 * i) / penalty_, friction(i));
    dual_ -= penalty_ * (x_ - y_);
  }
}

/// A penalty that lets both residuals fall together.
void ScaledProblem::rebalance() {
  const double primal = (x_ - y_).cwiseAbs().maxCoeff(), dual = penalty_ * (y_ - yBefore_).cwiseAbs().maxCoeff();
  if (primal > kUnbalanced * dual)
    setPenalty(std::min(penalty_ * kPenaltyStep, largest_));
  else if (dual > kUnbalanced * primal)
    setPenalty(std::max(penalty_ / kPenaltyStep, kLeastPenaltyPart * largest_));
}

bool ScaledProblem::isConverged(const VectorX& z, const VectorX& u, double& residual) const {
  residual = 0;
  bool converged = true;
  const double largestVelocity = std::max(1.0, u.cwiseAbs().maxCoeff());
  for (Index i = 0; i < contacts_; ++i) {
    const double error = coulombResidual(z.segment<3>(3 * i), u.segment<3>(3 * i), friction(i)).cwiseAbs().maxCoeff();
    residual = std::max(residual, error);
  }
  const double sums = (g_.cwiseAbs() * z.cwiseAbs()).maxCoeff();
  converged = residual <= std::max(kConvergedPart * largestVelocity, kRounding * sums);
  return converged;
}

/// One contact's rows of Newton's matrix, A + B G, and right-hand side, for contacts that push.
void ScaledProblem::addNewtonRows(Index contact, const Vec3& z, const Vec3& u, MatrixX& rows,
                                  VectorX& sides, Index at) const {
  const double mu = friction(contact), pressing = z.z() - u.z();
  Mat3 a = kRegularPart * largest_ * Mat3::Identity(), b = Mat3::Identity();
  Vec3 value = u;
  const Vec2 pull = z.head<2>() - u.head<2>();
  const double size = pull.norm();
  if (mu == 0) {
    a.topLeftCorner<2, 2>().setIdentity();
    b.topLeftCorner<2, 2>().setZero();
    value.head<2>() = z.head<2>();
  } else if (size > mu * pressing) {
    const Vec2 e = pull / size;
    const Mat2 turning = mu * pressing / size * (Mat2::Identity() - e * e.transpose());
    a.topLeftCorner<2, 2>() = Mat2::Identity() - turning;
    a.topRightCorner<2, 1>() = -mu * e;
    b.topLeftCorner<2, 2>() = turning;
    b.topRightCorner<2, 1>() = mu * e;
    value.head<2>() = z.head<2>() - mu * pressing * e;
  }
  rows.block(at, 0, 3, rows.cols()) = b * rows.block(at, 0, 3, rows.cols());
  rows.block<3, 3>(at, at) += a;
  sides.segment<3>(at) = -value;
}

/// Newton's method from `z`. Changes `z` only if it converges.
bool ScaledProblem::finish(VectorX& start) const {
  VectorX z = start, u = g_ * z + free_;
  std::vector<Index> pushing;
  for (int step = 0; step < kMostNewtonSteps; ++step) {
    pushing.clear();
    for (Index i = 0; i < contacts_; ++i) {
      if (z[3 * i + 2] - u[3 * i + 2] > 0)
        for (Index k = 0; k < 3; ++k) pushing.push_back(3 * i + k);
      else
        z.segment<3>(3 * i).setZero();
    }
    if (!pushing.empty()) {
      MatrixX rows = g_(pushing, pushing);
      VectorX sides(std::ssize(pushing));
      u = g_ * z + free_;
      for (std::size_t at = 0; at < pushing.size(); at += 3) {
        const Index contact = pushing[at] / 3;
        addNewtonRows(contact, z.segment<3>(3 * contact), u.segment<3>(3 * contact), rows, sides,
                      static_cast<Index>(at));
      }
      const VectorX change = rows.partialPivLu().solve(sides);
      if (!change.allFinite()) return false;
      z(pushing) += change;
    }
    u = g_ * z + free_;
    double residual = 0;
    if (isConverged(z, u, residual)) {
      start = z;
      return true;
    }
  }
  return false;
}

ConeSolution ScaledProblem::unscaled(const VectorX& z) const {
  ConeSolution solution;
  solution.impulses.resize(z.size());
  for (Index i = 0; i < contacts_; ++i)
    solution.impulses.segment<3>(3 * i) =
        scale_[i] * velocityScale_ * projectOnCone(z.segment<3>(3 * i), friction(i));
  solution.velocities = given_ * solution.impulses + givenFree_;
  for (Index i = 0; i < contacts_; ++i) {
    const Vec3 scaledImpulse = solution.impulses.segment<3>(3 * i) / scale_[i];
    const Vec3 scaledVelocity = solution.velocities.segment<3>(3 * i) * scale_[i];
    const Vec3 error = coulombResidual(scaledImpulse, scaledVelocity, friction(i)) / scale_[i];
    solution.residual = std::max(solution.residual, error.norm());
  }
  return solution;
}

ConeSolution ScaledProblem::solve() {
  x_ = y_ = dual_ = VectorX::Zero(free_.size());
  if (velocityScale_ == 0) return unscaled(y_);
  setPenalty(kFirstPenaltyPart * largest_);
  best_ = y_;
  for (int round = 0; round < kMostRounds; ++round) {
    iterate(kRoundLength);
    double residual = 0;
    VectorX z = y_;
    const bool isDone = isConverged(y_, g_ * y_ + free_, residual);
    if (residual < bestResidual_) best_ = y_, bestResidual_ = residual;
    if (isDone || finish(z)) return unscaled(z);
    rebalance();
  }
  ConeSolution solution = unscaled(best_);
  solution.converged = false;
  return solution;
}

/// A closed form is right unless what would have to be pushed cannot move.
void judgeOne(const MatrixX& G, double friction, ConeSolution& solution) {
  const double inverseMass = std::max(G.trace() / 3, std::numeric_limits<double>::min());
  const Vec3 error = coulombResidual(inverseMass * solution.impulses, solution.velocities, friction);
  solution.residual = error.norm();
  const double sums = (G.cwiseAbs() * solution.impulses.cwiseAbs()).maxCoeff();
  solution.converged = solution.residual <= kRounding * sums + kConvergedPart * solution.velocities.norm();
}

}  // namespace

ConeSolution solveConeProblem(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions) {
  if (frictions.size() == 1) {
    ConeSolution solution;
    solution.impulses = solveSingleContact(G, g, frictions[0]);
    solution.velocities = G * solution.impulses + g;
    judgeOne(G, frictions[0], solution);
    return solution;
  }
  if (frictions.empty()) return {};
  return ScaledProblem(G, g, frictions).solve();
}

}  // namespace cradle
