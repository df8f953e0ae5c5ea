// Newton's restitution with Coulomb's friction, all contacts at once, as a frictional contact problem (J. J. Moreau,
// "Unilateral contact and dry friction in finite freedom dynamics", 1988): u = G z + v - (0, 0, w), w the speed with
// which a contact is to open. For one contact w = - e v_n. For more, contact by contact that would be what throws back
// the first sphere of a row; the speeds with which contacts open after the impact without friction
// (generalized_reflections.h), as far as that rebounds, stand in its place, and for the rest those after the impact
// with friction and without rebound:
//   w = sum over the parts s of the rebound of s w_s, plus (1 - sum of s) w_0.
// So w and what follows from it is continuous in the restitutions, is the plastic impact without any, and the impact
// without friction where nothing slides.
// Restitution with friction can add energy; without it the change z (u + v) / 2 = z_t u_t / 2 - z G z / 2 is <= 0. Then
// all restitutions are scaled by one factor, with which the impact gains nothing: a root, so that what is kept of the
// energy is continuous too. It may jump where static and dynamic friction differ and a contact begins to slide, and
// where the frictional contact problem has more than one solution.
// It has none where friction wedges what is to rebound: of a sphere in a right-angled corner, from a coefficient of 1
// on, each contact's friction holds back all that the other pushes. Impulses grow without bound as friction comes near
// to that, and velocities have a limit: all frictions are cut by one factor, with which impulses are still bounded.

#include "impact/frictional_impact.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "collision/root_bracketing.h"
#include "impact/contact_delassus.h"
#include "impact/frictional_contact.h"
#include "impact/generalized_reflections.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kClosedRatio = 1e-11;     // of the fastest speed: what is left is rounding
constexpr double kSlidingRatio = 1e-9;     // of the same: slower sticks
constexpr double kSolvedRatio = 1e-7;      // of the same: an error of Coulomb's law that nobody sees
constexpr double kWedgedRatio = 1e-4;      // of the same: more is left where no impulses solve the problem
constexpr int kMaxRounds = 10;             // of what was not solved: each leaves less
constexpr double kFrictionError = 1e-6;    // of friction that wedges: so near to the most that does not
constexpr double kWedgedEnergies = 1e8;    // energies of each impulse by itself, in those of all: more wedge
constexpr double kEnergyRounding = 1e-13;  // of the energy that moves
constexpr double kSumRounding = 4 * std::numeric_limits<double>::epsilon();  // of the terms of an energy

std::vector<Contact> contactsOf(const std::vector<ImpactContact>& impacts) {
  std::vector<Contact> contacts;
  for (const ImpactContact& impact : impacts) contacts.push_back(impact.contact);
  return contacts;
}

/// What an impact comes to: impulses (N s), velocities (m/s) and the energy (J) that it adds, < 0 if it takes any.
struct Strike {
  VectorX impulses, velocities;
  double gain = 0, moved = 0;  // moved: what the impulses would give to bodies at rest
  double rounding = 0;         // J: of the gain
  double residual = 0;         // m/s: of what was not solved
  double scaledEnergy = 0;     // J: that all of the impulses found would have added
  double frictionFactor = 1;   // below 1: more of the frictions would wedge

  bool gains() const { return gain > kEnergyRounding * moved; }
  double certainLoss() const { return -gain - rounding; }
};

/// Contacts with their velocities before an impact.
class FrictionalImpact {
 public:
  FrictionalImpact(const std::vector<ImpactContact>& impacts, const ContactDelassus& cones, VectorX velocities);

  /// Impulses (N s) after which nothing closes; notes what had to be done to find them.
  VectorX resolve(ImpactFaults& faults) const;

 private:
  bool closes(const VectorX& velocities) const;
  bool isSolved(const ContactSolution& solution) const { return solution.residual <= kSolvedRatio * fastest_; }
  ContactSolution solve(const MatrixX& matrix, const VectorX& free, const std::vector<double>& frictions,
                        double& factor) const;
  Strike strike(const VectorX& velocities, const VectorX& opening, double frictionFactor = 1) const;
  Strike strikeWithoutRebound(const VectorX& velocities) const;
  Strike rebound(const Strike& plastic) const;

  const std::vector<ImpactContact>& impacts_;
  const ContactDelassus& cones_;
  VectorX start_;                      // m/s
  double fastest_ = 0;                 // m/s
  std::vector<Index> members_;         // contacts that can move
  std::vector<Index> rows_, normals_;  // theirs
};

FrictionalImpact::FrictionalImpact(const std::vector<ImpactContact>& impacts, const ContactDelassus& cones,
                                   VectorX velocities)
    : impacts_(impacts), cones_(cones), start_(std::move(velocities)), fastest_(start_.cwiseAbs().maxCoeff()) {
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    if (cones.isImmobile(i)) continue;
    const Index contact = static_cast<Index>(i);
    members_.push_back(contact);
    for (Index axis = 0; axis < 3; ++axis) rows_.push_back(3 * contact + axis);
    normals_.push_back(rows_.back());
  }
}

bool FrictionalImpact::closes(const VectorX& velocities) const {
  return std::any_of(members_.begin(), members_.end(),
                     [&](Index i) { return velocities[3 * i + 2] < -kClosedRatio * fastest_; });
}

/// With these frictions times `factor`, or where that wedges, with the largest factor that does not.
ContactSolution FrictionalImpact::solve(const MatrixX& matrix, const VectorX& free,
                                        const std::vector<double>& frictions, double& factor) const {
  ContactSolution solution;
  const auto isUnwedgedWith = [&](double tried) {
    std::vector<double> cut = frictions;
    for (double& friction : cut) friction *= tried;
    ContactSolution found = solveFrictionalContact(matrix, free, cut);
    const VectorX sizes = found.impulses.cwiseAbs();
    const double all = found.impulses.dot(matrix * found.impulses), each = sizes.dot(matrix.cwiseAbs() * sizes);
    const bool isUnwedged = found.residual <= kWedgedRatio * fastest_ && each <= kWedgedEnergies * all;
    if (isUnwedged || solution.impulses.size() == 0) solution = std::move(found);
    return isUnwedged;
  };
  if (isUnwedgedWith(factor)) return solution;
  double least = 0;
  for (double most = factor; most - least > kFrictionError;) {
    const double tried = std::midpoint(least, most);
    (isUnwedgedWith(tried) ? least : most) = tried;
  }
  if (least > 0) factor = least;  // else it is not friction that makes impulses large
  return solution;
}

/// With all friction static, then with dynamic friction where that slides; times `frictionFactor` at most. Contacts
/// open with `opening` (m/s) at least.
Strike FrictionalImpact::strike(const VectorX& velocities, const VectorX& opening, double frictionFactor) const {
  std::vector<double> frictions;
  bool haveTwoFrictions = false;
  for (const Index i : members_) {
    const ContactMaterial& material = impacts_[static_cast<std::size_t>(i)].material;
    frictions.push_back(material.staticFriction);
    haveTwoFrictions = haveTwoFrictions || material.staticFriction != material.dynamicFriction;
  }
  const MatrixX matrix = cones_.matrix()(rows_, rows_);
  const VectorX before = velocities(rows_);
  VectorX free = before;
  free(Eigen::seq(2, Eigen::last, 3)) -= opening;
  ContactSolution solution = solve(matrix, free, frictions, frictionFactor);
  if (haveTwoFrictions) {
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (solution.velocities.segment<2>(3 * static_cast<Index>(k)).norm() > kSlidingRatio * fastest_)
        frictions[k] = impacts_[static_cast<std::size_t>(members_[k])].material.dynamicFriction;
    solution = solve(matrix, free, frictions, frictionFactor);
  }
  Strike strike;
  strike.frictionFactor = frictionFactor;
  strike.impulses = solution.impulses;
  strike.velocities = before + matrix * solution.impulses;
  strike.moved = 0.5 * solution.impulses.dot(matrix * solution.impulses);
  strike.gain = solution.impulses.dot(before) + strike.moved;
  const VectorX terms = solution.impulses.cwiseAbs();
  strike.residual = isSolved(solution) ? 0 : solution.residual;
  strike.rounding = kSumRounding * terms.dot(matrix.cwiseAbs() * terms);
  return strike;
}

/// Only what was not solved gains: as much of it as takes the most energy.
Strike FrictionalImpact::strikeWithoutRebound(const VectorX& velocities) const {
  Strike found = strike(velocities, VectorX::Zero(std::ssize(members_)));
  if (!found.gains()) return found;
  found.scaledEnergy = found.gain;
  const double part = std::max(0.0, (found.moved - found.gain) / (2 * found.moved));
  found.impulses *= part;
  found.velocities = velocities(rows_) + part * (found.velocities - velocities(rows_));
  found.gain = part * (found.gain - (1 - part) * found.moved);
  found.moved *= part * part;
  return found;
}

/// With as much of the restitutions as gains no energy.
Strike FrictionalImpact::rebound(const Strike& plastic) const {
  const VectorX speeds = start_(normals_);
  const VectorX slowest = plastic.velocities(Eigen::seq(2, Eigen::last, 3)).cwiseMax(0);
  const MatrixX delassus = cones_.matrix()(normals_, normals_);
  std::vector<ImpactContact> members;
  for (const Index i : members_) members.push_back(impacts_[static_cast<std::size_t>(i)]);
  VectorX opening = VectorX::Zero(speeds.size());
  double part = 0;
  for (const Rebound& rebound : reboundsOf(delassus, speeds, members)) {
    opening += rebound.part * (speeds + delassus * rebound.impulses).cwiseMax(0);
    part += rebound.part;
  }
  if (part == 0) return plastic;
  const auto strikeWith = [&](double scale, double frictionFactor) {
    return strike(start_, scale * opening + (1 - scale * part) * slowest, frictionFactor);
  };
  Strike kept = strikeWith(1, 1);
  if (!kept.gains()) return kept;
  const double frictionFactor = kept.frictionFactor;
  Bracket scales{0, plastic.certainLoss(), 1, kept.certainLoss()};
  kept = plastic;
  if (!(scales.gapBefore > 0)) return kept;
  const auto lossWith = [&](double scale) {
    const Strike tried = strikeWith(scale, frictionFactor);
    if (tried.certainLoss() > 0) kept = tried;
    return tried.certainLoss();
  };
  closeBracket(lossWith, scales);
  return kept;
}

VectorX FrictionalImpact::resolve(ImpactFaults& faults) const {
  VectorX impulses = VectorX::Zero(start_.size()), velocities = start_;
  for (int round = 0; round < kMaxRounds && closes(velocities); ++round) {
    Strike found = strikeWithoutRebound(velocities);
    if (round == 0) found = rebound(found);
    faults.residual = std::max(faults.residual, found.residual);
    faults.scaledEnergy = std::max(faults.scaledEnergy, found.scaledEnergy);
    for (std::size_t k = 0; k < rows_.size(); ++k) impulses[rows_[k]] += found.impulses[static_cast<Index>(k)];
    velocities = start_ + cones_.matrix() * impulses;
  }
  if (closes(velocities)) faults.rounds = kMaxRounds;
  return impulses;
}

}  // namespace

ImpactFaults resolveFrictionalImpact(std::vector<ImpactContact>& impacts, const ImpulseResponse& response,
                                     VectorX& state) {
  if (impacts.empty()) return {};
  const std::vector<Contact> contacts = contactsOf(impacts);
  const ContactDelassus cones(contacts, response, state);
  ImpactFaults faults;
  const VectorX impulses = FrictionalImpact(impacts, cones, cones.velocitiesIn(state)).resolve(faults);
  cones.apply(impulses, state);
  for (std::size_t i = 0; i < impacts.size(); ++i) impacts[i].impulse += cones.worldImpulse(i, impulses);
  return faults;
}

}  // namespace cradle
