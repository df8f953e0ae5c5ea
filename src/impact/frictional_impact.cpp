// Newton's restitution with Coulomb's friction at all contacts at once, as a frictional contact problem (J. J. Moreau,
// "Unilateral contact and dry friction in finite freedom dynamics", 1988): impulses z in Coulomb's cones that give
//   u = G z + v - (0, 0, w),   (1)
// where G is the Delassus operator, v are the contacts' velocities before the impact, and w_i is the speed with which
// contact i is to open. For one contact w = -e v_n (Newton). For several contacts that rule would throw back the first
// sphere of a row. Their w comes from two impacts that are solved before:
//   w = sum_k p_k w_k + (1 - sum_k p_k) w_0,   (2)
// where w_k are the opening speeds after part k, of weight p_k, of the impact without friction (Rebound in
// generalized_reflections.h), and w_0 those after the impact with friction and without rebound. So w, and the result
// with it, is continuous in the restitutions; it is the plastic impact if all of them are 0, and the impact without
// friction where nothing slides.
// Energy. The impact changes the kinetic energy by z . (G z + 2 v) / 2. Without rebound (w = 0) that is
// z_t . u_t - z . G z / 2 <= 0, but a rebound with friction can add energy. All restitutions are then scaled by one
// factor with which the impact gains nothing. The factor is a root of the energy lost, so that the energy is continuous
// too. It may jump where static and dynamic friction differ and a contact begins to slide, and where the problem has
// more than one solution.
// Wedging. The problem has no solution where friction wedges a body that is to rebound. Example: a sphere in a
// right-angled corner with a coefficient of 1 or more, where the friction of each contact holds back all that the other
// one pushes. As the coefficient comes near to 1, impulses grow without bound while velocities have a limit. All
// coefficients are then multiplied by one factor, nearly the largest with which impulses are bounded.

#include "impact/frictional_impact.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "collision/root_bracketing.h"
#include "impact/contact_delassus.h"
#include "impact/frictional_contact.h"
#include "impact/frictional_tolerances.h"
#include "impact/generalized_reflections.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

// Each round resolves what the residual of the one before still lets close; half or twice as many change no test.
constexpr int kMaxImpactRounds = 10;
// Of the closing speed: if more is left after a round, no impulses can change that.
constexpr double kUnchangedRatio = 0.99;
// Of the factor on friction that wedges: twenty bisections. A tenth or ten times as much changes no test.
constexpr double kFrictionError = 1e-6;
// A problem is wedged if the sum of the magnitudes in z . G z is more times z . G z itself: then eight digits cancel,
// and the energy is known to 1e-8. A tenth or ten times as much changes no test.
constexpr double kMaxCancellation = 1e8;
// Of the energy that the impulses move: 900 unit roundoffs, for sums over contacts.
constexpr double kGainRounding = 1e-13;
constexpr double kSumRounding = 4 * std::numeric_limits<double>::epsilon();  // of the sum of the magnitudes in z . G z

std::vector<Contact> contactsOf(const std::vector<ImpactContact>& impacts) {
  std::vector<Contact> contacts;
  for (const ImpactContact& impact : impacts) contacts.push_back(impact.contact);
  return contacts;
}

/// The result of one impact.
struct ImpactResult {
  VectorX impulses, velocities;  // N s, m/s: of the contacts that can move, after the impact
  double gain = 0;               // J: energy that the impact adds, < 0 if it takes any
  double moved = 0;              // J: z . G z / 2, the energy that the impulses would give to bodies at rest
  double rounding = 0;           // J: bound on the rounding of `gain`
  double residual = 0;           // m/s: of a frictional contact problem that was not solved, else 0
  double scaledEnergy = 0;       // J: energy that the impulses would have added before they were scaled down
  double frictionFactor = 1;     // of all friction coefficients; below 1: more friction would wedge

  bool gains() const { return gain > kGainRounding * moved; }
  double certainLoss() const { return -gain - rounding; }
};

/// Contacts with their velocities before an impact.
class FrictionalImpact {
 public:
  FrictionalImpact(const std::vector<ImpactContact>& impacts, const ContactDelassus& delassus, VectorX velocities);

  /// Impulses (N s) after which nothing closes; notes what had to be done to find them.
  VectorX resolve(ImpactFaults& faults) const;

 private:
  double closingSpeed(const VectorX& velocities) const;
  bool isSolved(const ContactSolution& solution) const { return solution.residual <= tolerances_.solved; }
  ContactSolution solve(const MatrixX& matrix, const VectorX& free, const std::vector<double>& frictions,
                        double& factor) const;
  ImpactResult impactWith(const VectorX& velocities, const VectorX& opening, double frictionFactor = 1) const;
  ImpactResult plasticImpact(const VectorX& velocities) const;
  ImpactResult rebound(const ImpactResult& plastic) const;

  const std::vector<ImpactContact>& impacts_;
  const ContactDelassus& delassus_;
  VectorX start_;  // m/s: velocities of all contacts before the impact
  FrictionalImpactTolerances tolerances_;
  std::vector<Index> members_;         // contacts that can move
  bool isFace_ = false;                // all of them are of one face
  std::vector<Index> rows_, normals_;  // their rows in the Delassus operator: all three, and that of the normal
};

FrictionalImpact::FrictionalImpact(const std::vector<ImpactContact>& impacts, const ContactDelassus& delassus,
                                   VectorX velocities)
    : impacts_(impacts), delassus_(delassus), start_(std::move(velocities)), tolerances_(start_.cwiseAbs().maxCoeff()) {
  std::vector<const Contact*> contacts;
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    if (delassus.isImmobile(i)) continue;
    const Index contact = static_cast<Index>(i);
    members_.push_back(contact), contacts.push_back(&impacts[i].contact);
    for (Index axis = 0; axis < 3; ++axis) rows_.push_back(3 * contact + axis);
    normals_.push_back(rows_.back());
  }
  isFace_ = !contacts.empty() && areOfOneFace(contacts);
}

/// m/s: the largest of any contact.
double FrictionalImpact::closingSpeed(const VectorX& velocities) const {
  double closing = 0;
  for (const Index i : members_) closing = std::max(closing, -velocities[3 * i + 2]);
  return closing;
}

/// Solves the problem with the coefficients of friction times `factor`; where that wedges, with the largest factor that
/// does not, to kFrictionError, which is put into `factor`.
ContactSolution FrictionalImpact::solve(const MatrixX& matrix, const VectorX& free,
                                        const std::vector<double>& frictions, double& factor) const {
  ContactSolution solution;
  const auto isUnwedgedWith = [&](double tried) {
    std::vector<double> cut = frictions;
    for (double& friction : cut) friction *= tried;
    ContactSolution found =
        isFace_ ? solveSharedContact(matrix, free, cut, {}, {}) : solveFrictionalContact(matrix, free, cut);
    const VectorX sizes = found.impulses.cwiseAbs();
    const double all = found.impulses.dot(matrix * found.impulses), each = sizes.dot(matrix.cwiseAbs() * sizes);
    const bool isUnwedged = found.residual <= tolerances_.wedged && each <= kMaxCancellation * all;
    if (isUnwedged || solution.impulses.size() == 0) solution = std::move(found);
    return isUnwedged;
  };
  // Without friction: if impulses are as large, friction is not what makes them so.
  if (isUnwedgedWith(factor) || !isUnwedgedWith(0)) return solution;
  double unwedged = 0;
  for (double wedged = factor; wedged - unwedged > kFrictionError;) {
    const double tried = std::midpoint(unwedged, wedged);
    (isUnwedgedWith(tried) ? unwedged : wedged) = tried;
  }
  factor = unwedged;
  return solution;
}

/// The impact from contact velocities `velocities` after which contacts open with at least the speeds `opening` (m/s):
/// first with static friction everywhere, then with dynamic friction where contacts slide. Coefficients are multiplied
/// by `frictionFactor` or less.
ImpactResult FrictionalImpact::impactWith(const VectorX& velocities, const VectorX& opening,
                                          double frictionFactor) const {
  std::vector<double> frictions;
  for (const Index i : members_) frictions.push_back(impacts_[static_cast<std::size_t>(i)].material.staticFriction);
  const MatrixX matrix = delassus_.matrix()(rows_, rows_);
  const VectorX before = velocities(rows_);
  VectorX free = before;
  free(Eigen::seq(2, Eigen::last, 3)) -= opening;
  ContactSolution solution = solve(matrix, free, frictions, frictionFactor);
  bool isOther = false;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const double sliding = impacts_[static_cast<std::size_t>(members_[k])].material.dynamicFriction;
    if (!(solution.velocities.segment<2>(3 * static_cast<Index>(k)).norm() > tolerances_.sliding)) continue;
    isOther = isOther || sliding != frictions[k];
    frictions[k] = sliding;
  }
  if (isOther) solution = solve(matrix, free, frictions, frictionFactor);
  ImpactResult result;
  result.frictionFactor = frictionFactor;
  result.impulses = solution.impulses;
  result.velocities = before + matrix * solution.impulses;
  result.moved = 0.5 * solution.impulses.dot(matrix * solution.impulses);
  result.gain = solution.impulses.dot(before) + result.moved;
  const VectorX terms = solution.impulses.cwiseAbs();
  result.residual = isSolved(solution) ? 0 : solution.residual;
  result.rounding = kSumRounding * terms.dot(matrix.cwiseAbs() * terms);
  return result;
}

/// The impact without rebound. It can gain energy only if its problem was not solved. Its impulses are then scaled by
/// the factor s that takes the most energy: s (z . v) + s^2 (z . G z) / 2 is least at s = -(z . v) / (z . G z).
ImpactResult FrictionalImpact::plasticImpact(const VectorX& velocities) const {
  ImpactResult found = impactWith(velocities, VectorX::Zero(std::ssize(members_)));
  if (!found.gains()) return found;
  found.scaledEnergy = found.gain;
  const double factor = std::max(0.0, (found.moved - found.gain) / (2 * found.moved));
  found.impulses *= factor;
  found.velocities = velocities(rows_) + factor * (found.velocities - velocities(rows_));
  found.gain = factor * (found.gain - (1 - factor) * found.moved);
  found.moved *= factor * factor;
  return found;
}

/// The impact with rebound, equation (2); where that gains energy, with all restitutions times the factor at which the
/// energy lost is 0.
ImpactResult FrictionalImpact::rebound(const ImpactResult& plastic) const {
  const VectorX speeds = start_(normals_);
  const VectorX plasticOpening = plastic.velocities(Eigen::seq(2, Eigen::last, 3)).cwiseMax(0);
  const MatrixX delassus = delassus_.matrix()(normals_, normals_);
  std::vector<ImpactContact> members;
  for (const Index i : members_) members.push_back(impacts_[static_cast<std::size_t>(i)]);
  VectorX opening = VectorX::Zero(speeds.size());
  double weights = 0;  // sum of p_k
  for (const Rebound& rebound : reboundsOf(delassus, speeds, members)) {
    opening += rebound.part * (speeds + delassus * rebound.impulses).cwiseMax(0);
    weights += rebound.part;
  }
  if (weights == 0) return plastic;
  const auto reboundScaledBy = [&](double scale, double frictionFactor) {
    return impactWith(start_, scale * opening + (1 - scale * weights) * plasticOpening, frictionFactor);
  };
  ImpactResult kept = reboundScaledBy(1, 1);
  if (!kept.gains()) return kept;
  const double frictionFactor = kept.frictionFactor;
  Bracket scales{0, plastic.certainLoss(), 1, kept.certainLoss()};
  kept = plastic;
  if (!(scales.gapBefore > 0)) return kept;
  const auto lossWith = [&](double scale) {
    const ImpactResult tried = reboundScaledBy(scale, frictionFactor);
    if (tried.certainLoss() > 0) kept = tried;
    return tried.certainLoss();
  };
  closeBracket(lossWith, scales);
  return kept;
}

VectorX FrictionalImpact::resolve(ImpactFaults& faults) const {
  VectorX impulses = VectorX::Zero(start_.size()), velocities = start_;
  double closing = closingSpeed(start_);
  int round = 0;
  for (; round < kMaxImpactRounds && closing > tolerances_.closed; ++round) {
    ImpactResult found = plasticImpact(velocities);
    if (round == 0) found = rebound(found);
    faults.residual = std::max(faults.residual, found.residual);
    faults.scaledEnergy = std::max(faults.scaledEnergy, found.scaledEnergy);
    for (std::size_t k = 0; k < rows_.size(); ++k) impulses[rows_[k]] += found.impulses[static_cast<Index>(k)];
    velocities = start_ + delassus_.matrix() * impulses;
    const double before = std::exchange(closing, closingSpeed(velocities));
    if (round > 0 && closing > kUnchangedRatio * before) break;
  }
  if (closing > tolerances_.closed) faults.rounds = round;
  return impulses;
}

}  // namespace

ImpactFaults resolveFrictionalImpact(std::vector<ImpactContact>& impacts, const ImpulseResponse& response,
                                     VectorX& state) {
  if (impacts.empty()) return {};
  const std::vector<Contact> contacts = contactsOf(impacts);
  const ContactDelassus delassus(contacts, response, state);
  ImpactFaults faults;
  const VectorX impulses = FrictionalImpact(impacts, delassus, delassus.velocitiesIn(state)).resolve(faults);
  delassus.apply(impulses, state);
  for (std::size_t i = 0; i < impacts.size(); ++i) impacts[i].impulse += delassus.worldImpulse(i, impulses);
  return faults;
}

}  // namespace cradle
