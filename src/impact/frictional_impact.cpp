// Newton's restitution with Coulomb's friction, all contacts at once: u = G z + J v + e (J v)_n in the cone problem (J.
// J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988). Together they can gain energy;
// then the restitution is scaled down: without rebound the change of energy is z (u + J v) / 2 = z_t u_t / 2 - z G z /
// 2 <= 0. Rounds over the contacts that close are the reflections of generalized_reflections.h with friction: what hits
// one end of a row of balls leaves at the other. With one restitution below 1 at all contacts these would be impacts
// pair by pair: there the speeds with which the contacts open without friction, by that law's blend, stand in place of
// - e (J v)_n, all at once. Where nothing slides this is that law; for one contact both are Newton's.

#include "impact/frictional_impact.h"

#include <algorithm>
#include <limits>

#include "impact/cone_problem.h"
#include "impact/contact_cones.h"
#include "impact/generalized_reflections.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kClosedPart = 1e-11;  // of the fastest speed: what is left is rounding
constexpr double kSlidingPart = 1e-9;  // of the same: slower sticks
constexpr double kSolvedPart = 1e-7;   // of the same: an error of Coulomb's law that nobody sees
constexpr int kMostRounds = 100;       // then one without rebound ends it
constexpr double kLessRestitution = 0.7;
constexpr double kLeastRestitution = 1e-2;  // part of it: less is none
constexpr double kEnergyRounding = 1e-13;   // of the energy that moves

std::vector<Contact> contactsOf(const std::vector<ImpactContact>& impacts) {
  std::vector<Contact> contacts;
  for (const ImpactContact& impact : impacts) contacts.push_back(impact.contact);
  return contacts;
}

/// The impulses of one impact as they add up.
class FrictionalImpact {
 public:
  FrictionalImpact(const std::vector<ImpactContact>& impacts, const ContactCones& cones, VectorX velocities)
      : impacts_(impacts), cones_(cones), start_(std::move(velocities)), impulses_(VectorX::Zero(start_.size())) {
    fastest_ = start_.cwiseAbs().maxCoeff();
  }

  VectorX resolve();
  const ImpactFaults& faults() const { return faults_; }

 private:
  VectorX velocities() const { return start_ + cones_.inverseMass() * impulses_; }
  bool hasCommonRestitution() const;
  VectorX openingSpeeds() const;
  bool rebounds(std::size_t contact, const VectorX& speeds) const;
  std::vector<std::size_t> findMembers(const VectorX& speeds, bool withRebound) const;
  bool closes(const VectorX& speeds) const;
  void strike(const std::vector<std::size_t>& members, const VectorX& speeds, double restitutionPart);
  bool tryStrike(const std::vector<std::size_t>& members, const VectorX& speeds, double restitutionPart);

  const std::vector<ImpactContact>& impacts_;
  const ContactCones& cones_;
  VectorX start_, impulses_;
  VectorX opening_;     // m/s: of the contacts after the impact under way, or none: by their own restitution
  double fastest_ = 0;  // m/s
  ImpactFaults faults_;
};

/// One of all contacts, neither none nor elastic.
bool FrictionalImpact::hasCommonRestitution() const {
  const double restitution = impacts_[0].law.restitution;
  return impacts_.size() > 1 && restitution > 0 && restitution < 1 &&
         std::all_of(impacts_.begin(), impacts_.end(),
                     [&](const ImpactContact& impact) { return impact.law.restitution == restitution; });
}

/// How fast contacts open after an impact without friction.
VectorX FrictionalImpact::openingSpeeds() const {
  const Index contacts = std::ssize(impacts_);
  std::vector<Index> normals;
  for (Index i = 0; i < contacts; ++i) normals.push_back(3 * i + 2);
  const MatrixX inverseMass = cones_.inverseMass()(normals, normals);
  VectorX speeds = start_(normals);
  for (Index i = 0; i < contacts; ++i)
    if (cones_.isImmobile(static_cast<std::size_t>(i))) speeds[i] = 0;
  return (speeds + inverseMass * reflectionImpulses(inverseMass, speeds, impacts_)).cwiseMax(0);
}

bool FrictionalImpact::rebounds(std::size_t i, const VectorX& speeds) const {
  return impacts_[i].law.restitution > 0 && -speeds[3 * static_cast<Index>(i) + 2] > impacts_[i].restSpeed;
}

bool FrictionalImpact::closes(const VectorX& speeds) const {
  for (std::size_t i = 0; i < impacts_.size(); ++i)
    if (!cones_.isImmobile(i) && speeds[3 * static_cast<Index>(i) + 2] < -kClosedPart * fastest_) return true;
  return false;
}

/// Contacts that close, and those that touch and do not rebound.
std::vector<std::size_t> FrictionalImpact::findMembers(const VectorX& speeds, bool withRebound) const {
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < impacts_.size(); ++i) {
    if (cones_.isImmobile(i)) continue;
    const bool isClosing = speeds[3 * static_cast<Index>(i) + 2] < -kClosedPart * fastest_;
    if (isClosing || !withRebound || impacts_[i].law.restitution == 0) members.push_back(i);
  }
  return members;
}

/// With all friction static, then with dynamic friction where that slides.
bool FrictionalImpact::tryStrike(const std::vector<std::size_t>& members, const VectorX& speeds, double part) {
  std::vector<Index> rows;
  std::vector<double> frictions;
  bool haveTwoFrictions = false;
  for (const std::size_t i : members) {
    const Index row = 3 * static_cast<Index>(i);
    rows.insert(rows.end(), {row, row + 1, row + 2});
    frictions.push_back(impacts_[i].law.staticFriction);
    haveTwoFrictions = haveTwoFrictions || impacts_[i].law.staticFriction != impacts_[i].law.dynamicFriction;
  }
  const MatrixX matrix = cones_.inverseMass()(rows, rows);
  const VectorX before = speeds(rows);
  VectorX free = before;
  for (std::size_t k = 0; k < members.size(); ++k) {
    double& normal = free[3 * static_cast<Index>(k) + 2];
    if (opening_.size() > 0)
      normal -= part * opening_[static_cast<Index>(members[k])];
    else if (rebounds(members[k], speeds))
      normal *= 1 + part * impacts_[members[k]].law.restitution;
  }

  ConeSolution solution = solveConeProblem(matrix, free, frictions);
  if (haveTwoFrictions) {
    for (std::size_t k = 0; k < members.size(); ++k)
      if (solution.velocities.segment<2>(3 * static_cast<Index>(k)).norm() > kSlidingPart * fastest_)
        frictions[k] = impacts_[members[k]].law.dynamicFriction;
    solution = solveConeProblem(matrix, free, frictions);
  }
  const VectorX& z = solution.impulses;
  const double response = 0.5 * z.dot(matrix * z), gain = z.dot(before) + response;
  const bool gains = gain > kEnergyRounding * response;
  if (gains && part > 0) return false;
  if (!(solution.residual <= kSolvedPart * fastest_)) faults_.residual = std::max(faults_.residual, solution.residual);
  if (gains) faults_.scaledEnergy = std::max(faults_.scaledEnergy, gain);
  // Without rebound only what was not solved gains: as much of it as takes the most energy.
  impulses_(rows) += gains ? VectorX(std::max(0.0, -z.dot(before) / (2 * response)) * z) : z;
  return true;
}

void FrictionalImpact::strike(const std::vector<std::size_t>& members, const VectorX& speeds, double part) {
  while (!tryStrike(members, speeds, part)) {
    part *= kLessRestitution;
    if (part < kLeastRestitution) part = 0;
  }
}

VectorX FrictionalImpact::resolve() {
  if (hasCommonRestitution() && closes(start_)) {
    opening_ = openingSpeeds();
    strike(findMembers(start_, false), start_, 1);
    opening_.resize(0);
  }
  for (int round = 0; round < kMostRounds; ++round) {
    const VectorX speeds = velocities();
    if (!closes(speeds)) return impulses_;
    strike(findMembers(speeds, true), speeds, 1);
  }
  const VectorX speeds = velocities();
  faults_.rounds = kMostRounds;
  strike(findMembers(speeds, false), speeds, 0);
  return impulses_;
}

}  // namespace

ImpactFaults resolveFrictionalImpact(std::vector<ImpactContact>& impacts, const ImpulseResponse& response,
                                     VectorX& state) {
  if (impacts.empty()) return {};
  const std::vector<Contact> contacts = contactsOf(impacts);
  const ContactCones cones(contacts, response, state);
  FrictionalImpact impact(impacts, cones, cones.velocitiesIn(state));
  const VectorX impulses = impact.resolve();
  cones.apply(impulses, state);
  for (std::size_t i = 0; i < impacts.size(); ++i) impacts[i].impulse += cones.worldImpulse(i, impulses);
  return impact.faults();
}

}  // namespace cradle
