// A sequence of methods. Newton's method from the warm start (contact_newton.h: equations of P. Alart and A. Curnier,
// "A mixed formulation for frictional contact problems prone to Newton like solution methods", 1991) comes first. Then
// come trials of ADMM (contact_admm.h) or of an interior point method (contact_interior_point.h), which find out which
// contacts are open, stick or slide. Newton's method finishes from the end of each trial: it often needs no more than a
// rough guess.

#include "impact/frictional_contact.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "impact/contact_admm.h"
#include "impact/contact_interior_point.h"
#include "impact/contact_newton.h"
#include "impact/frictional_tolerances.h"
#include "impact/linear_complementarity.h"
#include "impact/single_contact.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kProductRounding = 16 * std::numeric_limits<double>::epsilon();  // of the sums of terms in G z
// Scaled inverse masses; the mean of a contact's is 1. A tenth or ten times as much of any of them changes no test.
constexpr double kProximal = 1e-7;      // added to the diagonal: ADMM then converges for singular problems
constexpr double kNewtonShift = 1e-9;   // added to the diagonal: redundant contacts then have regular Newton equations
constexpr double kStartPenalty = 1e-4;  // of ADMM: heavy bodies on light ones want it small, many contacts large
// Of a diagonal element, to which it is added: singular problems of the normals then are regular.
constexpr double kNormalShiftRatio = 1e-9;
// Iterations of ADMM before Newton's method is tried, and their growth for each further trial: far from a solution
// trials of Newton's method are waste.
constexpr int kFirstAdmmIterations = 10, kAdmmGrowth = 2;
// More contacts than these are often redundant, and Newton's method then seldom converges: it has fewer steps. Half of
// kNewtonStepsOfMany breaks the symmetry of a rack of balls; half or twice as much of the others changes no test.
constexpr Index kMaxIndependentContacts = 12;
constexpr int kNewtonStepsOfFew = 20, kNewtonStepsOfMany = 6;
// Trials of ADMM and interior points: half as many leave the hardest problems unsolved; two more solve 1 of 14 that are
// left, and double the time.
constexpr int kMaxTrials = 8;
// Of the proximal point method: each leaves a billionth of the error (kNormalShiftRatio), or of one in a stiff
// direction.
constexpr int kProximalSteps = 3;
// By which redundant contacts give way, of the inverse mass of the heaviest: above what singular equations have of the
// largest pivot (kSingularPivotRatio).
constexpr double kCompliance = 1e-5;
// Along the surfaces, of the same: contacts that friction hardly holds would creep for long before they slide.
constexpr double kTangentialRatio = 1e-4;
constexpr int kMaxProximalSteps = 5;  // three or four are usual
// Of what the step before left, and of the fastest velocity: by rounding, velocities are not quite those of one body;
// contacts then creep at a speed that no further step reduces.
constexpr double kCreepRatio = 0.5, kMaxCreep = 1e-9;

/// A search for a solution, in the operator's scaled units; residuals and tolerances are in m/s.
class Search {
 public:
  Search(const DelassusOperator& op, const VectorX& free, const std::vector<double>& frictions, double tolerance,
         std::vector<Eigen::Vector2d> directions = {}, bool isRegular = false);

  /// From `start`, which is moved to where it ends.
  ContactSolution run(WarmStart& start);

 private:
  double friction(Index contact) const { return contacts_.frictions[static_cast<std::size_t>(contact)]; }
  bool slides(Index contact) const { return !directions_.empty() && !direction(contact).isZero(0); }
  const Eigen::Vector2d& direction(Index contact) const { return directions_[static_cast<std::size_t>(contact)]; }
  VectorX velocitiesOf(const VectorX& z) const { return op_.multiply(z) + contacts_.free; }
  double residual(const VectorX& z, const VectorX& u) const;
  double rounding(const VectorX& z) const { return kProductRounding * op_.magnitude(z) / op_.scales.minCoeff(); }
  bool isSolved(double residual, const VectorX& z) const;
  bool isOpen();
  void begin(const WarmStart& start);
  bool find();
  void runAdmm(int iterations);
  void runInteriorPoint();
  bool accept(double tolerance);
  enum class Step { any, least };  // which of the solutions of singular Newton equations a step takes
  bool polish(double tolerance, VectorX& z, VectorX& u) const;
  bool converge(Step kind, double tolerance, VectorX& z, VectorX& u, bool& isUnique) const;
  bool stepByNewton(Step kind, VectorX& z, VectorX& u) const;
  void correctVelocities(const VectorX& u);

  const DelassusOperator& op_;
  ScaledContacts contacts_;
  std::vector<Eigen::Vector2d> directions_;  // of contacts that slide already, zero of others; empty if none does
  bool isRegular_;                           // there is one solution: Newton's method finds it to rounding
  SearchTolerances tolerances_;
  AdmmIterate iterate_;
  VectorX impulses_, velocities_;    // of the smallest residual so far
  double leastResidual_ = INFINITY;  // m/s
  long iterations_ = 0;
};

Search::Search(const DelassusOperator& op, const VectorX& free, const std::vector<double>& frictions, double tolerance,
               std::vector<Eigen::Vector2d> directions, bool isRegular)
    : op_(op),
      contacts_{free, frictions},
      directions_(std::move(directions)),
      isRegular_(isRegular),
      tolerances_(free.cwiseAbs().maxCoeff(), tolerance) {
  for (Index i = 0; i < op.scales.size(); ++i) contacts_.free.segment<3>(3 * i) *= op.scales[i];
}

/// The residual (m/s) of the contact that is farthest from Coulomb's law.
double Search::residual(const VectorX& z, const VectorX& u) const {
  double largest = 0;
  for (Index i = 0; i < op_.scales.size(); ++i) {
    const Vec3 impulse = z.segment<3>(3 * i), velocity = u.segment<3>(3 * i);
    const Vec3 error = slides(i) ? slidingResidual(impulse, velocity, friction(i), direction(i))
                                 : coulombResidual(impulse, velocity, friction(i));
    if (!error.allFinite()) return INFINITY;
    largest = std::max(largest, error.cwiseAbs().maxCoeff() / op_.scales[i]);
  }
  return largest;
}

bool Search::isSolved(double residual, const VectorX& z) const {
  if (residual <= tolerances_.solved) return true;
  return residual <= tolerances_.maxRounding && residual <= rounding(z);
}

/// One step of Newton's method. False if its equations are singular: many steps solve them.
bool Search::stepByNewton(Step kind, VectorX& z, VectorX& u) const {
  std::vector<ContactEquation> equations(contacts_.frictions.size());
  VectorX sides = VectorX::Zero(z.size());
  for (Index i = 0; i < op_.scales.size(); ++i) {
    bool& isOpen = equations[static_cast<std::size_t>(i)].isOpen;
    isOpen = !pushes(z.segment<3>(3 * i), u.segment<3>(3 * i));
    if (isOpen) z.segment<3>(3 * i).setZero();
  }
  u = velocitiesOf(z);
  for (Index i = 0; i < op_.scales.size(); ++i) {
    ContactEquation& equation = equations[static_cast<std::size_t>(i)];
    if (equation.isOpen) continue;
    const Vec3 impulse = z.segment<3>(3 * i), velocity = u.segment<3>(3 * i);
    const double shift = isRegular_ ? 0 : kNewtonShift;
    const NewtonRow row = slides(i) ? slidingRow(impulse, velocity, friction(i), direction(i), shift)
                                    : newtonRow(impulse, velocity, friction(i), shift);
    equation = row.equation;
    sides.segment<3>(3 * i) = -row.value;
  }
  bool isUnique = true;
  if (kind == Step::least)
    op_.factorizeForLeast(equations);
  else
    isUnique = op_.factorize(equations);
  z += op_.solve(sides, nullptr);
  u = velocitiesOf(z);
  return isUnique;
}

/// Newton's method with steps of one kind, to `tolerance` (m/s). Changes impulses and velocities only if it converges.
/// `isUnique`, which must be true before, is false afterwards if the equations of any step were singular.
bool Search::converge(Step kind, double tolerance, VectorX& impulses, VectorX& velocities, bool& isUnique) const {
  VectorX z = impulses, u = velocities;
  const int most = op_.scales.size() > kMaxIndependentContacts ? kNewtonStepsOfMany : kNewtonStepsOfFew;
  for (int step = 0; step < most; ++step) {
    isUnique = stepByNewton(kind, z, u) && isUnique;
    const double left = residual(z, u);
    if (!(left < INFINITY)) return false;
    if (left > tolerance && !isSolved(left, z)) continue;
    impulses = z, velocities = u;
    if (!tolerances_.isRounding) return true;
    isUnique = stepByNewton(kind, z, u) && isUnique;  // quadratic convergence: one step more leaves rounding
    if (residual(z, u) < left) impulses = z, velocities = u;
    return true;
  }
  return false;
}

/// Newton's method, to `tolerance` (m/s); changes impulses and velocities only if it converges. Where there are many
/// solutions, rounding chooses among them. Steps of least norm lead to a solution that is as symmetric as the problem;
/// it is taken if its residual is rounding.
bool Search::polish(double tolerance, VectorX& impulses, VectorX& velocities) const {
  const VectorX z = impulses, u = velocities;
  bool isUnique = true;
  if (!converge(Step::any, tolerance, impulses, velocities, isUnique)) return false;
  if (isUnique || isRegular_ || !op_.factorizeForLeast) return true;
  VectorX leastZ = z, leastU = u;
  if (converge(Step::least, tolerance, leastZ, leastU, isUnique) && residual(leastZ, leastU) <= rounding(leastZ))
    impulses = leastZ, velocities = leastU;
  return true;
}

/// Tries the iterate's impulses and, from them, Newton's method. Keeps the result if its residual is the smallest so
/// far. True if it is a solution to `tolerance` (m/s).
bool Search::accept(double tolerance) {
  VectorX z = iterate_.impulses, u = velocitiesOf(z);
  double left = residual(z, u);
  const bool isNear = left <= tolerance || isSolved(left, z);
  const bool isFound = (isNear && !isRegular_) || polish(tolerance, z, u) || isNear;
  if (isFound) left = residual(z, u);
  if (left < leastResidual_) impulses_ = z, velocities_ = u, leastResidual_ = left;
  return isFound;
}

/// ADMM; the penalty is balanced after each kFirstAdmmIterations iterations.
void Search::runAdmm(int iterations) {
  const auto solveShifted = [this](VectorX& b) { b = op_.solve(b, nullptr); };
  double factorised = 0;
  for (int done = 0; done < iterations; done += kFirstAdmmIterations) {
    if (iterate_.penalty != factorised) {
      op_.factorizeShifted(iterate_.penalty + kProximal);
      factorised = iterate_.penalty;
    }
    iterateAdmm(contacts_, kProximal, solveShifted, kFirstAdmmIterations, iterate_);
    iterate_.penalty = balancedPenalty(iterate_, op_.minShift, op_.largest);
  }
  iterations_ += iterations;
}

/// The interior point method. It begins without a warm start.
void Search::runInteriorPoint() {
  const double tolerance = tolerances_.interior * op_.scales.minCoeff();
  iterations_ += solveByInteriorPoint(contacts_, op_, tolerance, iterate_.impulses);
  correctVelocities(velocitiesOf(iterate_.impulses));
}

/// Sets the iterate's velocities to `u` with De Saxce's correction.
void Search::correctVelocities(const VectorX& u) {
  iterate_.velocities.resize(u.size());
  for (Index i = 0; i < op_.scales.size(); ++i)
    iterate_.velocities.segment<3>(3 * i) = correctedVelocity(u.segment<3>(3 * i), friction(i));
  iterate_.unbounded = iterate_.impulses;
}

void Search::begin(const WarmStart& start) {
  iterate_.impulses = start.impulses, iterate_.velocities = start.velocities;
  for (Index i = 0; i < op_.scales.size(); ++i) {
    iterate_.impulses.segment<3>(3 * i) /= op_.scales[i];
    iterate_.velocities.segment<3>(3 * i) *= op_.scales[i];
  }
  iterate_.unbounded = iterate_.impulses;
  iterate_.penalty = start.penalty > 0 ? start.penalty : kStartPenalty;
}

/// Whether impulses of zero are the solution: no contact closes.
bool Search::isOpen() {
  impulses_ = VectorX::Zero(contacts_.free.size()), velocities_ = contacts_.free;
  leastResidual_ = residual(impulses_, velocities_);
  return isSolved(leastResidual_, impulses_);
}

bool Search::find() {
  if (isOpen()) return true;
  // From impulses of zero, Newton's method would share the loads of redundant contacts in an arbitrary way.
  const bool isWarm = iterate_.impulses.cwiseAbs().maxCoeff() > 0;
  if ((isWarm || isRegular_ || !tolerances_.isRounding) && accept(tolerances_.solved)) return true;
  if (!directions_.empty()) return false;
  int round = kFirstAdmmIterations;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    if (trial == tolerances_.interiorTrial) {
      runInteriorPoint();
    } else {
      runAdmm(round);
      round *= kAdmmGrowth;
    }
    const bool isHard = trial > tolerances_.interiorTrial;
    if (accept(isHard ? tolerances_.solvedHard : tolerances_.solved)) return true;
    if (isHard && leastResidual_ <= tolerances_.good) return false;
  }
  return false;
}

ContactSolution Search::run(WarmStart& start) {
  begin(start);
  ContactSolution solution;
  solution.converged = find();
  solution.residual = leastResidual_;
  solution.iterations = iterations_;
  iterate_.impulses = impulses_;
  correctVelocities(velocities_);
  start = {impulses_, iterate_.velocities, iterate_.penalty};
  // Impulses end inside the cones exactly. With a tolerance asked for, the projection could cost velocities as much.
  for (Index i = 0; i < op_.scales.size() && tolerances_.isRounding; ++i)
    if (!slides(i)) impulses_.segment<3>(3 * i) = projectOnCone(impulses_.segment<3>(3 * i), friction(i));
  solution.impulses = impulses_, solution.velocities = velocitiesOf(impulses_);
  for (Index i = 0; i < op_.scales.size(); ++i) {
    solution.impulses.segment<3>(3 * i) *= op_.scales[i], solution.velocities.segment<3>(3 * i) /= op_.scales[i];
    start.impulses.segment<3>(3 * i) *= op_.scales[i], start.velocities.segment<3>(3 * i) /= op_.scales[i];
  }
  return solution;
}

/// Whether no pivot of the Cholesky factorisation, as a part of its diagonal element, is at most kNormalShiftRatio.
bool isRegular(const MatrixX& matrix) {
  const Eigen::LLT<MatrixX> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  const auto left = factor.matrixLLT().diagonal().cwiseAbs2();
  return (left.array() > kNormalShiftRatio * matrix.diagonal().array()).all();
}

/// 1/kg, of each component: by which redundant contacts give way.
VectorX complianceOf(const MatrixX& G) {
  const VectorX scales = scalesOf(G);
  const double largest = 1 / (scales.minCoeff() * scales.minCoeff());
  const double smallest = 1 / (scales.maxCoeff() * scales.maxCoeff());
  const double normal = kCompliance * std::max(smallest, kCompliance * largest);
  const Vec3 ofOne(kTangentialRatio * normal, kTangentialRatio * normal, normal);
  return ofOne.replicate(scales.size(), 1);
}

MatrixX yieldingBy(const VectorX& compliance, const MatrixX& G) {
  MatrixX yielding = G;
  yielding.diagonal() += compliance;
  return yielding;
}

/// Forces with which all contacts stay closed, those with a direction slide, and the others stick, whatever their cones
/// say: as symmetric as the problem, and near its solution where friction is near its limit. `regular` is G with a
/// compliance.
VectorX forcesOfKept(const MatrixX& regular, const VectorX& g, const std::vector<double>& frictions,
                     const std::vector<Eigen::Vector2d>& directions) {
  MatrixX matrix = regular;
  VectorX side = -g;
  for (Index i = 0; i < std::ssize(directions); ++i) {
    const Eigen::Vector2d& direction = directions[static_cast<std::size_t>(i)];
    if (direction.isZero(0)) continue;
    const auto rows = Eigen::seqN(3 * i, 2);
    matrix(rows, Eigen::all).setZero();  // in their place: friction of the normal force
    matrix(rows, rows).setIdentity();
    matrix(rows, 3 * i + 2) = frictions[static_cast<std::size_t>(i)] * direction;
    side(rows).setZero();
  }
  return matrix.partialPivLu().solve(side);
}

/// The problem of redundant contacts: of its many solutions the one of contacts that give way equally, by a compliance
/// that vanishes. So loads are shared in the way that rows of active contacts do (MinimumNormSolver), and what sticks
/// slides only where no forces can hold it. By the proximal point method (R. T. Rockafellar, "Monotone operators and
/// the proximal point algorithm", 1976), from impulses of zero: what the first problem, of contacts that do give way,
/// leaves of a solution is the compliance's part of it, and each further one leaves that part of what is left.
ContactSolution solveRedundant(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                               const std::vector<Eigen::Vector2d>& directions, const VectorX& near) {
  const VectorX compliance = complianceOf(G);
  const MatrixX yielding = yieldingBy(compliance, G);
  const DelassusOperator op = operatorOf(yielding);
  const double fastest = g.cwiseAbs().maxCoeff(), rounding = kProductRounding * fastest;
  const auto normals = Eigen::seq(2, Eigen::last, 3);
  ContactSolution solution;
  VectorX unloaded = VectorX::Zero(g.size());  // impulses to which contacts have given way; < 0: they are as far apart
  WarmStart start{near, unloaded, 0};
  double left = INFINITY;  // m/s: by which contacts give way
  bool isEnough = false;
  long iterations = 0;
  for (int step = 0; step < kMaxProximalSteps && !isEnough; ++step) {
    solution = Search(op, g - compliance.cwiseProduct(unloaded), frictions, 0, directions, true).run(start);
    iterations += solution.iterations;
    if (!solution.converged) return solution;
    const VectorX velocities = G * solution.impulses + g;
    VectorX given = solution.impulses;
    given(normals) = unloaded(normals) - velocities(normals).cwiseQuotient(compliance(normals));
    const double before = std::exchange(left, 0);
    for (Index i = 0; i < g.size(); ++i)
      if (solution.impulses[3 * (i / 3) + 2] > 0)
        left = std::max(left, compliance[i] * std::abs(given[i] - unloaded[i]));
    isEnough = left <= rounding || (left <= kMaxCreep * fastest && left > kCreepRatio * before);
    unloaded = given;
  }
  if (!isEnough) {  // friction is at its limit nearly everywhere
    solution = Search(operatorOf(G), g, frictions, 0, directions).run(start);
    solution.converged = solution.converged && solution.iterations == 0;
  }
  solution.velocities = G * solution.impulses + g;
  solution.iterations += iterations;
  return solution;
}

/// The problem without friction: the normal components alone, by pivoting. Loads of redundant contacts are shared as
/// evenly as can be, by the proximal point method (R. T. Rockafellar, "Monotone operators and the proximal point
/// algorithm", 1976); where the problem has no solution, the method comes as near to one as can be.
VectorX solveNormals(const MatrixX& G, const VectorX& g) {
  const auto normals = Eigen::seq(2, Eigen::last, 3);
  MatrixX matrix = G(normals, normals);
  const VectorX free = g(normals);
  VectorX pushes = VectorX::Zero(free.size());
  if (isRegular(matrix)) {
    pushes = solveLinearComplementarity(matrix, free);
  } else {
    const VectorX shift = kNormalShiftRatio * matrix.diagonal();
    matrix.diagonal() += shift;
    for (int i = 0; i < kProximalSteps; ++i)
      pushes = solveLinearComplementarity(matrix, VectorX(free - shift.cwiseProduct(pushes)));
  }
  VectorX impulses = VectorX::Zero(g.size());
  impulses(normals) = pushes;
  return impulses;
}

/// Impulses in the cones as a solution, with their velocities and residual.
ContactSolution withResidual(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                             VectorX impulses) {
  const VectorX scales = scalesOf(G);
  ContactSolution solution{std::move(impulses), {}, 0, false};
  solution.velocities = G * solution.impulses + g;
  double largest = 0;  // row sum of the scaled G: a bound on its eigenvalues
  for (Index i = 0; i < scales.size(); ++i) {
    const Vec3 z = solution.impulses.segment<3>(3 * i) / scales[i];
    const Vec3 u = solution.velocities.segment<3>(3 * i) * scales[i];
    const Vec3 error = coulombResidual(z, u, frictions[static_cast<std::size_t>(i)]);
    solution.residual = std::max(solution.residual, error.cwiseAbs().maxCoeff() / scales[i]);
    Vec3 sums = Vec3::Zero();
    for (Index k = 0; k < scales.size(); ++k)
      sums += scales[k] * G.block<3, 3>(3 * i, 3 * k).cwiseAbs().rowwise().sum();
    largest = std::max(largest, scales[i] * sums.maxCoeff());
  }
  // Impulses with a residual r have velocities with an error of |G| r.
  solution.converged = solution.residual <= (1 + largest) * SearchTolerances::kConvergedRatio * g.cwiseAbs().maxCoeff();
  return solution;
}

}  // namespace

ContactSolution solveFrictionalContact(const DelassusOperator& G, const VectorX& g,
                                       const std::vector<double>& frictions, double tolerance, WarmStart& start) {
  return Search(G, g, frictions, tolerance).run(start);
}

ContactSolution solveFrictionalContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                       const VectorX& near) {
  if (frictions.empty()) return {};
  const auto frictionless = [&] { return withResidual(G, g, frictions, solveNormals(G, g)); };
  if (std::all_of(frictions.begin(), frictions.end(), [](double friction) { return friction == 0; }))
    return frictionless();
  ContactSolution solution;
  if (frictions.size() == 1) {
    solution = withResidual(G, g, frictions, solveSingleContact(G, g, frictions[0]));
  } else {
    WarmStart start{near.size() > 0 ? near : VectorX::Zero(g.size()), VectorX::Zero(g.size()), 0};
    solution = Search(operatorOf(G), g, frictions, 0).run(start);
  }
  if (solution.residual <= g.cwiseAbs().maxCoeff()) return solution;
  // A residual above the free velocities is that of impulses that wedge a body: they grow without bound.
  ContactSolution smooth = frictionless();
  return smooth.residual < solution.residual ? smooth : solution;
}

ContactSolution solveSlidingContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                    const std::vector<Eigen::Vector2d>& directions, const VectorX& near) {
  WarmStart start{near, VectorX::Zero(g.size()), 0};
  return Search(operatorOf(G), g, frictions, 0, directions).run(start);
}

ContactSolution solveSharedContact(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions,
                                   const std::vector<Eigen::Vector2d>& directions, const VectorX& near) {
  const auto isZero = [](double friction) { return friction == 0; };
  if (std::all_of(frictions.begin(), frictions.end(), isZero)) return solveFrictionalContact(G, g, frictions, near);
  const VectorX start = near.size() > 0 ? near : forcesOfKept(yieldingBy(complianceOf(G), G), g, frictions, directions);
  if (!isRegular(G)) {
    ContactSolution shared = solveRedundant(G, g, frictions, directions, start);
    if (shared.converged) return shared;
  }
  return directions.empty() ? solveFrictionalContact(G, g, frictions, near)
                            : solveSlidingContact(G, g, frictions, directions, start);
}

}  // namespace cradle
