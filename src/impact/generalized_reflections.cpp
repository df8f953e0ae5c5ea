// B. Smith, D. M. Kaufman, E. Vouga, R. Tamstorf, E. Grinspun, "Reflections on Simultaneous Impact", ACM Trans. Graph.
// 31(4), 2012. With J the contacts' normals, v -> v+ = v + W J^T lambda. A reflection: 0 <= lambda perp J (v+ + v) >= 0
// on the contacts that close. Restitution e: the blend (1 - e) v_LCP + e v_GR of the same paper, v_LCP with
// 0 <= lambda perp J v+ >= 0 on all contacts. A blend contact by contact can gain energy; so with different e each
// reflection takes 0 <= lambda perp J v+ + E J v >= 0: where lambda > 0, it does the work -(1 - e) |J v| lambda / 2 <=
// 0.

#include "impact/generalized_reflections.h"

#include <algorithm>

#include "core/error.h"
#include "impact/linear_complementarity.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kReflectionClosedPart = 1e-12;  // of the fastest speed: what is left is rounding
constexpr long kMostReflections = 10000;         // for each contact; a row of n balls needs n
constexpr long kMostMixedReflections = 100;      // restitutions that differ: then one impact without rebound ends it

/// An impact by the normals of its contacts alone: speeds J v and inverse masses J W J^T.
class NormalImpact {
 public:
  NormalImpact(const MatrixX& inverseMass, const VectorX& speeds, const std::vector<ImpactContact>& impacts)
      : inverseMass_(inverseMass), speeds_(speeds), restSpeeds_(speeds.size()) {
    for (Index i = 0; i < speeds.size(); ++i) restSpeeds_[i] = impacts[static_cast<std::size_t>(i)].restSpeed;
  }

  /// Impulses (N s) that end all closing without rebound, after `impulses`.
  VectorX stop(const VectorX& impulses) const {
    return impulses + solveLinearComplementarity(inverseMass_, speeds_ + inverseMass_ * impulses);
  }

  /// Adds reflections to `impulses` until nothing closes, at most so many. False: something does still.
  bool reflect(const VectorX& restitutions, long most, VectorX& impulses) const;

 private:
  void reflectOnce(const std::vector<Index>& closing, const VectorX& speeds, const VectorX& restitutions,
                   VectorX& impulses) const;

  const MatrixX& inverseMass_;  // 1/kg
  const VectorX& speeds_;       // m/s: < 0 closing
  VectorX restSpeeds_;          // m/s
};

bool NormalImpact::reflect(const VectorX& restitutions, long most, VectorX& impulses) const {
  const double closed = kReflectionClosedPart * speeds_.cwiseAbs().maxCoeff();
  for (long count = 0; count <= most; ++count) {
    const VectorX speeds = speeds_ + inverseMass_ * impulses;
    std::vector<Index> closing;
    for (Index i = 0; i < speeds.size(); ++i)
      if (speeds[i] < -closed) closing.push_back(i);
    if (closing.empty()) return true;
    reflectOnce(closing, speeds, restitutions, impulses);
  }
  return false;
}

void NormalImpact::reflectOnce(const std::vector<Index>& closing, const VectorX& speeds, const VectorX& restitutions,
                               VectorX& impulses) const {
  VectorX offset = speeds;
  for (const Index i : closing)
    if (-speeds[i] > restSpeeds_[i]) offset[i] *= 1 + restitutions[i];
  impulses(closing) += solveLinearComplementarity(inverseMass_(closing, closing), VectorX(offset(closing)));
}

VectorX restitutionsOf(const std::vector<ImpactContact>& impacts) {
  VectorX restitutions(impacts.size());
  for (std::size_t i = 0; i < impacts.size(); ++i) restitutions[static_cast<Index>(i)] = impacts[i].law.restitution;
  return restitutions;
}

[[noreturn]] void failEndless(std::size_t contacts) {
  throw Error(ErrorKind::unstable, "",
              "an impact among " + std::to_string(contacts) + " contacts does not come to an end by reflections");
}

/// What all of the above comes to for one contact.
void reflectAlone(ImpactContact& impact, const ImpulseResponse& response, VectorX& state) {
  const Contact& contact = impact.contact;
  const double speed = contact.normal.dot(relativeVelocity(contact, state));
  if (!(speed < 0)) return;
  const VectorX answer = response.answerTo(contact, contact.normal, state);
  const double inverseMass = contact.normal.dot(relativeVelocity(contact, state, answer));
  if (isImmobile(contact, response, state, inverseMass)) return;
  const double restitution = -speed > impact.restSpeed ? impact.law.restitution : 0;
  const double impulse = -(1 + restitution) * speed / inverseMass;
  const Index velocities = state.size() - poseComponents(state);
  state.tail(velocities) += impulse * answer.tail(velocities);
  impact.impulse += impulse * contact.normal;
}

}  // namespace

VectorX reflectionImpulses(const MatrixX& inverseMass, const VectorX& speeds,
                           const std::vector<ImpactContact>& impacts) {
  const NormalImpact impact(inverseMass, speeds, impacts);
  const VectorX restitutions = restitutionsOf(impacts), none = VectorX::Zero(restitutions.size());
  const double restitution = restitutions[0];
  VectorX impulses = none;
  if ((restitutions.array() == restitution).all()) {
    const long most = kMostReflections * static_cast<long>(impacts.size());
    if (restitution > 0 && !impact.reflect(VectorX::Ones(none.size()), most, impulses)) failEndless(impacts.size());
    if (restitution < 1) impulses = (restitution * impulses + (1 - restitution) * impact.stop(none)).eval();
  } else if (!impact.reflect(restitutions, kMostMixedReflections, impulses)) {
    impulses = impact.stop(impulses);
  }
  return impulses;
}

void resolveReflections(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state) {
  if (impacts.empty()) return;
  if (impacts.size() == 1) return reflectAlone(impacts[0], response, state);
  const Index size = std::ssize(impacts), velocities = state.size() - poseComponents(state);
  std::vector<VectorX> answers;  // states: velocities from a unit impulse at each contact
  for (const ImpactContact& impact : impacts)
    answers.push_back(response.answerTo(impact.contact, impact.contact.normal, state));
  MatrixX inverseMass(size, size);
  VectorX speeds(size);
  for (Index i = 0; i < size; ++i) {
    const Contact& contact = impacts[static_cast<std::size_t>(i)].contact;
    speeds[i] = contact.normal.dot(relativeVelocity(contact, state));
    for (Index j = 0; j < size; ++j)
      inverseMass(i, j) = contact.normal.dot(relativeVelocity(contact, state, answers[static_cast<std::size_t>(j)]));
  }
  inverseMass = (0.5 * (inverseMass + inverseMass.transpose())).eval();
  for (Index i = 0; i < size; ++i)
    if (isImmobile(impacts[static_cast<std::size_t>(i)].contact, response, state, inverseMass(i, i))) speeds[i] = 0;
  const VectorX impulses = reflectionImpulses(inverseMass, speeds, impacts);
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    const double impulse = impulses[static_cast<Index>(i)];
    state.tail(velocities) += impulse * answers[i].tail(velocities);
    impacts[i].impulse += impulse * impacts[i].contact.normal;
  }
}

}  // namespace cradle
