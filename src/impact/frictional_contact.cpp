// One method after the other: Newton's method from the warm start; ADMM (contact_admm.h) and an interior point method
// (contact_interior_point.h), which find which contacts are open, stick and slide, and after each of them Newton's
// method on the equations of P. Alart and A. Curnier ("A mixed formulation for frictional contact problems prone to
// Newton like solution methods", 1991), which finishes from there: often it needs no more than a rough guess.

#include "impact/frictional_contact.h"

#include <Eigen/Cholesky>
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
// Scaled inverse masses, whose mean is 1:
constexpr double kProximal = 1e-7;      // makes ADMM converge for singular problems
constexpr double kRegular = 1e-9;       // makes Newton's matrix regular
constexpr double kFirstPenalty = 1e-4;  // of ADMM: heavy on light wants it small, many contacts large
constexpr double kRegularRatio = 1e-9;  // of the largest inverse mass: what makes singular matrices regular
constexpr int kFirstRound = 10;         // iterations of ADMM before Newton's method is tried
constexpr int kRoundGrowth = 2;         // and before each further trial: far from the end, trials are waste
constexpr Index kFewContacts = 12;      // more are often redundant
constexpr int kMaxNewtonSteps = 20, kFewNewtonSteps = 6;  // with few contacts, and with more
constexpr int kMaxTrials = 8;  // of ADMM and interior points; two more solve 1 of 14 that are left, and double the time
constexpr int kProximalSteps = 3;  // each leaves a billionth of the error, or of one in a stiff direction

/// What a search takes for small, from the largest velocity of a problem (m/s) and the tolerance that was asked for
/// (m/s; 0: rounding).
struct SearchTolerances {
  SearchTolerances(double fastest, double asked)
      : isRounding(asked == 0),
        interiorTrial(isRounding ? 4 : 1),
        solved(isRounding ? kConvergedRatio * fastest : asked),
        solvedHard(10 * solved),
        good(isRounding ? 1e-9 * fastest : 0),
        maxRounding(1e-6 * fastest),
        interior(std::max(0.5 * solved, 1e-9 * fastest)) {}

  bool isRounding;
  // The trial that is one of interior points, the others are of ADMM. These share the loads of redundant contacts about
  // evenly, interior points do not: where forces are asked for to rounding ADMM has four trials first.
  int interiorTrial;
  // m/s: residuals
  double solved;       // enough
  double solvedHard;   // enough where the interior point method was not
  double good;         // where more trials only find rounding
  double maxRounding;  // more is no rounding, but impulses that grow without bound
  double interior;     // where the interior point method ends: it comes no nearer than to 1e-9
};

/// A search for a solution, in the operator's units.
class Search {
 public:
  Search(const DelassusOperator& op, const VectorX& free, const std::vector<double>& frictions, double tolerance);

  /// From `start`, which is moved to where it ends.
  ContactSolution run(WarmStart& start);

 private:
  double friction(Index contact) const { return contacts_.frictions[static_cast<std::size_t>(contact)]; }
  VectorX velocitiesOf(const VectorX& z) const { return op_.multiply(z) + contacts_.free; }
  double residual(const VectorX& z, const VectorX& u) const;
  double rounding(const VectorX& z) const { return kRounding * op_.magnitude(z) / op_.scales.minCoeff(); }
  bool isSolved(double residual, const VectorX& z) const;
  bool isOpen();
  void begin(const WarmStart& start);
  bool find();
  void iterate(int iterations);
  void goInside();
  bool accept(double tolerance);
  enum class Step { any, least };  // of changes that a step may choose from
  bool polish(double tolerance, VectorX& z, VectorX& u) const;
  bool converge(Step kind, double tolerance, VectorX& z, VectorX& u, bool& isUnique) const;
  bool stepByNewton(Step kind, VectorX& z, VectorX& u) const;
  void correctVelocities(const VectorX& u);

  const DelassusOperator& op_;
  ScaledContacts contacts_;
  SearchTolerances tolerances_;
  AdmmIterate iterate_;
  VectorX impulses_, velocities_;    // the best so far
  double leastResidual_ = INFINITY;  // m/s
  long iterations_ = 0;
};

Search::Search(const DelassusOperator& op, const VectorX& free, const std::vector<double>& frictions, double tolerance)
    : op_(op), contacts_{free, frictions}, tolerances_(free.cwiseAbs().maxCoeff(), tolerance) {
  for (Index i = 0; i < op.scales.size(); ++i) contacts_.free.segment<3>(3 * i) *= op.scales[i];
}

/// The largest of all contacts', in m/s.
double Search::residual(const VectorX& z, const VectorX& u) const {
  double largest = 0;
  for (Index i = 0; i < op_.scales.size(); ++i) {
    const Vec3 error = coulombResidual(z.segment<3>(3 * i), u.segment<3>(3 * i), friction(i));
    if (!error.allFinite()) return INFINITY;
    largest = std::max(largest, error.cwiseAbs().maxCoeff() / op_.scales[i]);
  }
  return largest;
}

bool Search::isSolved(double residual, const VectorX& z) const {
  if (residual <= tolerances_.solved) return true;
  return residual <= tolerances_.maxRounding && residual <= rounding(z);
}

/// False if the step is one of many.
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
    const NewtonRow row = newtonRow(z.segment<3>(3 * i), u.segment<3>(3 * i), friction(i), kRegular);
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

/// Newton's method with steps of one kind, to `tolerance` (m/s). Changes impulses and velocities only if it converges,
/// and says then whether its steps were the only ones. `isUnique` must be true before.
bool Search::converge(Step kind, double tolerance, VectorX& impulses, VectorX& velocities, bool& isUnique) const {
  VectorX z = impulses, u = velocities;
  const int most = op_.scales.size() > kFewContacts ? kFewNewtonSteps : kMaxNewtonSteps;
  for (int step = 0; step < most; ++step) {
    isUnique = stepByNewton(kind, z, u) && isUnique;
    const double left = residual(z, u);
    if (!(left < INFINITY)) return false;
    if (left > tolerance && !isSolved(left, z)) continue;
    impulses = z, velocities = u;
    if (!tolerances_.isRounding) return true;
    isUnique = stepByNewton(kind, z, u) && isUnique;  // what is left is often rounding then
    if (residual(z, u) < left) impulses = z, velocities = u;
    return true;
  }
  return false;
}

/// Newton's method, to `tolerance` (m/s); changes impulses and velocities only if it converges. Of many solutions it
/// finds one that rounding chooses: the least steps find a symmetric one, which is taken if what it leaves is rounding.
bool Search::polish(double tolerance, VectorX& impulses, VectorX& velocities) const {
  const VectorX z = impulses, u = velocities;
  bool isUnique = true;
  if (!converge(Step::any, tolerance, impulses, velocities, isUnique)) return false;
  if (isUnique || !op_.factorizeForLeast) return true;
  VectorX leastZ = z, leastU = u;
  if (converge(Step::least, tolerance, leastZ, leastU, isUnique) && residual(leastZ, leastU) <= rounding(leastZ))
    impulses = leastZ, velocities = leastU;
  return true;
}

/// Keeps the iterate's impulses if they are better than the best so far. True if they, or where Newton's method leads
/// from them, are a solution to `tolerance` (m/s).
bool Search::accept(double tolerance) {
  VectorX z = iterate_.impulses, u = velocitiesOf(z);
  double left = residual(z, u);
  const bool isFound = left <= tolerance || isSolved(left, z) || polish(tolerance, z, u);
  if (isFound) left = residual(z, u);
  if (left < leastResidual_) impulses_ = z, velocities_ = u, leastResidual_ = left;
  return isFound;
}

/// ADMM, with a penalty that is balanced again and again.
void Search::iterate(int iterations) {
  const auto solveShifted = [this](VectorX& b) { b = op_.solve(b, nullptr); };
  double factorised = 0;
  for (int done = 0; done < iterations; done += kFirstRound) {
    if (iterate_.penalty != factorised) {
      op_.factorizeShifted(iterate_.penalty + kProximal);
      factorised = iterate_.penalty;
    }
    iterateAdmm(contacts_, kProximal, solveShifted, kFirstRound, iterate_);
    iterate_.penalty = balancedPenalty(iterate_, op_.leastShift, op_.largest);
  }
  iterations_ += iterations;
}

/// The interior point method, from nothing.
void Search::goInside() {
  const double tolerance = tolerances_.interior * op_.scales.minCoeff();
  iterations_ += solveByInteriorPoint(contacts_, op_, tolerance, iterate_.impulses);
  correctVelocities(velocitiesOf(iterate_.impulses));
}

/// The iterate's velocities from those that its impulses give.
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
  iterate_.penalty = start.penalty > 0 ? start.penalty : kFirstPenalty;
}

/// Whether nothing closes: no impulses are the solution.
bool Search::isOpen() {
  impulses_ = VectorX::Zero(contacts_.free.size()), velocities_ = contacts_.free;
  leastResidual_ = residual(impulses_, velocities_);
  return isSolved(leastResidual_, impulses_);
}

bool Search::find() {
  if (isOpen()) return true;
  // From nothing, Newton's method would share loads of redundant contacts in an arbitrary way.
  const bool isWarm = iterate_.impulses.cwiseAbs().maxCoeff() > 0;
  if ((isWarm || !tolerances_.isRounding) && accept(tolerances_.solved)) return true;
  int round = kFirstRound;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    if (trial == tolerances_.interiorTrial) {
      goInside();
    } else {
      iterate(round);
      round *= kRoundGrowth;
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
  // In the cones exactly; where a tolerance is left, velocities would suffer by it.
  for (Index i = 0; i < op_.scales.size() && tolerances_.isRounding; ++i)
    impulses_.segment<3>(3 * i) = projectOnCone(impulses_.segment<3>(3 * i), friction(i));
  solution.impulses = impulses_, solution.velocities = velocitiesOf(impulses_);
  for (Index i = 0; i < op_.scales.size(); ++i) {
    solution.impulses.segment<3>(3 * i) *= op_.scales[i], solution.velocities.segment<3>(3 * i) /= op_.scales[i];
    start.impulses.segment<3>(3 * i) *= op_.scales[i], start.velocities.segment<3>(3 * i) /= op_.scales[i];
  }
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

/// How well impulses in the cones solve a problem.
ContactSolution judged(const MatrixX& G, const VectorX& g, const std::vector<double>& frictions, VectorX impulses) {
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
  // The velocities that belong to impulses of such a residual are off by |G| times it.
  solution.converged = solution.residual <= (1 + largest) * kConvergedRatio * g.cwiseAbs().maxCoeff();
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
  const auto smooth = [&] { return judged(G, g, frictions, solveNormals(G, g)); };
  if (std::all_of(frictions.begin(), frictions.end(), [](double friction) { return friction == 0; })) return smooth();
  ContactSolution solution;
  if (frictions.size() == 1) {
    solution = judged(G, g, frictions, solveSingleContact(G, g, frictions[0]));
  } else {
    WarmStart start{near.size() > 0 ? near : VectorX::Zero(g.size()), VectorX::Zero(g.size()), 0};
    solution = Search(operatorOf(G), g, frictions, 0).run(start);
  }
  if (solution.residual <= g.cwiseAbs().maxCoeff()) return solution;
  // Impulses that wedge a body grow without bound, and say nothing.
  const ContactSolution frictionless = smooth();
  return frictionless.residual < solution.residual ? frictionless : solution;
}

}  // namespace cradle
