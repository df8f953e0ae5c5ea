// B. Smith, D. M. Kaufman, E. Vouga, R. Tamstorf, E. Grinspun, "Reflections on Simultaneous Impact", ACM Trans. Graph.
// 31(4), 2012. With J the contacts' normals, v -> v+ = v + W J^T lambda. A reflection: 0 <= lambda perp J (v+ + v) >= 0
// on the contacts that close. Restitution e: the blend (1 - e) v_LCP + e v_GR of the same paper, v_LCP with
// 0 <= lambda perp J v+ >= 0 on all contacts. A blend contact by contact can gain energy. With different e the blend is
// the mean, over levels s uniform in 0..1, of impacts in which contacts with e > s are elastic and the others plastic:
// each of them gains none, nor does their mean, as kinetic energy is convex; equal e make it the blend above; and it is
// linear in each e between the others. In these impacts a reflection takes 0 <= lambda perp J v+ + E J v >= 0, E = 0 or
// 1: where lambda > 0, it does the work -(1 - E) |J v| lambda / 2 <= 0.

#include "impact/generalized_reflections.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "impact/linear_complementarity.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kReflectionClosedRatio = 1e-12;  // of the fastest speed: what is left is rounding
constexpr double kSpeedRounding = 16 * std::numeric_limits<double>::epsilon();  // of the terms of a speed
constexpr long kMaxReflections = 10000;     // for each contact; a row of n spheres needs n, then one impact without
                                            // rebound ends it
constexpr long kMaxMixedReflections = 100;  // where some contacts are plastic: more would but slow down what is left

/// An impact by the normals of its contacts alone: speeds J v and inverse masses J W J^T.
class NormalImpact {
 public:
  NormalImpact(const MatrixX& delassus, const VectorX& speeds, const std::vector<ImpactContact>& impacts)
      : delassus_(delassus), speeds_(speeds), restSpeeds_(speeds.size()) {
    for (Index i = 0; i < speeds.size(); ++i) restSpeeds_[i] = impacts[static_cast<std::size_t>(i)].restSpeed;
  }

  /// Impulses (N s) that end all closing without rebound, after `impulses`.
  VectorX stop(const VectorX& impulses) const {
    return impulses + solveLinearComplementarity(delassus_, speeds_ + delassus_ * impulses);
  }

  /// Impulses (N s) of reflections until nothing closes, with restitutions 1 or 0.
  VectorX reflect(const VectorX& restitutions) const;

 private:
  std::vector<Index> closingAfter(const VectorX& impulses) const;
  VectorX reflectOnce(std::vector<Index> closing, const VectorX& speeds, const VectorX& restitutions) const;

  const MatrixX& delassus_;  // 1/kg
  const VectorX& speeds_;    // m/s: < 0 closing
  VectorX restSpeeds_;       // m/s
};

std::vector<Index> NormalImpact::closingAfter(const VectorX& impulses) const {
  const double closed = kReflectionClosedRatio * speeds_.cwiseAbs().maxCoeff();
  const VectorX speeds = speeds_ + delassus_ * impulses, terms = delassus_.cwiseAbs() * impulses;
  std::vector<Index> closing;
  for (Index i = 0; i < speeds.size(); ++i)
    if (speeds[i] < -std::max(closed, kSpeedRounding * terms[i])) closing.push_back(i);
  return closing;
}

VectorX NormalImpact::reflect(const VectorX& restitutions) const {
  const bool isElastic = restitutions.minCoeff() == 1;
  const long most = isElastic ? kMaxReflections * static_cast<long>(speeds_.size()) : kMaxMixedReflections;
  VectorX impulses = VectorX::Zero(speeds_.size());
  for (long count = 0; count <= most; ++count) {
    const std::vector<Index> closing = closingAfter(impulses);
    if (closing.empty()) return impulses;
    impulses += reflectOnce(closing, speeds_ + delassus_ * impulses, restitutions);
  }
  return stop(impulses);
}

/// Where nothing rebounds, what that makes close and does not rebound either is stopped at once too: one after the
/// other, a light body between heavy ones would need as many reflections as the masses differ.
VectorX NormalImpact::reflectOnce(std::vector<Index> closing, const VectorX& speeds,
                                  const VectorX& restitutions) const {
  const auto rebounds = [&](Index i, double speed) { return restitutions[i] > 0 && -speed > restSpeeds_[i]; };
  VectorX offset = speeds, impulses = VectorX::Zero(speeds.size());
  bool isPlastic = true;
  for (const Index i : closing) {
    if (!rebounds(i, speeds[i])) continue;
    offset[i] *= 1 + restitutions[i];
    isPlastic = false;
  }
  while (true) {
    impulses(closing) = solveLinearComplementarity(delassus_(closing, closing), VectorX(offset(closing)));
    if (!isPlastic) return impulses;
    const VectorX after = speeds + delassus_ * impulses, terms = delassus_.cwiseAbs() * impulses;
    const std::size_t before = closing.size();
    for (Index i = 0; i < after.size(); ++i) {
      if (std::find(closing.begin(), closing.end(), i) != closing.end()) continue;
      if (!(after[i] < -kSpeedRounding * (std::abs(speeds[i]) + terms[i]))) continue;
      if (rebounds(i, after[i])) return impulses;
      closing.push_back(i);
    }
    if (closing.size() == before) return impulses;
  }
}

/// What all of the above comes to for one contact.
void reflectAlone(ImpactContact& impact, const ImpulseResponse& response, VectorX& state) {
  const Contact& contact = impact.contact;
  const double speed = contact.normal.dot(relativeVelocity(contact, state));
  if (!(speed < 0)) return;
  const VectorX answer = response.responseTo(contact, contact.normal, state);
  const double delassus = contact.normal.dot(relativeVelocity(contact, state, answer));
  if (response.areConstrained() &&
      isImmobile(delassus, contact.normal.dot(response.unconstrainedDelassusAt(contact, state) * contact.normal)))
    return;
  const double restitution = -speed > impact.restSpeed ? impact.material.restitution : 0;
  const double impulse = -(1 + restitution) * speed / delassus;
  const Index velocities = state.size() - poseComponents(state);
  state.tail(velocities) += impulse * answer.tail(velocities);
  impact.impulse += impulse * contact.normal;
}

}  // namespace

std::vector<Rebound> reboundsOf(const MatrixX& delassus, const VectorX& speeds,
                                const std::vector<ImpactContact>& impacts) {
  std::vector<double> levels{0};
  for (const ImpactContact& impact : impacts) levels.push_back(impact.material.restitution);
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  const NormalImpact impact(delassus, speeds, impacts);
  std::vector<Rebound> rebounds;
  for (std::size_t level = 1; level < levels.size(); ++level) {
    VectorX elastic(speeds.size());
    for (Index i = 0; i < elastic.size(); ++i)
      elastic[i] = impacts[static_cast<std::size_t>(i)].material.restitution >= levels[level] ? 1 : 0;
    rebounds.push_back({levels[level] - levels[level - 1], impact.reflect(elastic)});
  }
  return rebounds;
}

namespace {

/// The impulses (N s) along the normals by the law of reboundsOf, of all parts together.
VectorX reflectionImpulses(const MatrixX& delassus, const VectorX& speeds, const std::vector<ImpactContact>& impacts) {
  const VectorX none = VectorX::Zero(speeds.size());
  VectorX impulses = none;
  double plastic = 1;
  for (const Rebound& rebound : reboundsOf(delassus, speeds, impacts)) {
    impulses += rebound.part * rebound.impulses;
    plastic -= rebound.part;
  }
  if (plastic > 0) impulses += plastic * NormalImpact(delassus, speeds, impacts).stop(none);
  return impulses;
}

}  // namespace

void resolveReflections(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state) {
  if (impacts.empty()) return;
  if (impacts.size() == 1) return reflectAlone(impacts[0], response, state);
  std::vector<ConstraintRow> normals;
  for (const ImpactContact& impact : impacts) normals.push_back(rowAlong(impact.contact.normal, impact.contact, state));
  const DenseDelassus delassus = response.delassusOf(std::move(normals), state);
  VectorX speeds = delassus.velocities(state);
  for (Index i = 0; i < speeds.size(); ++i)
    if (delassus.isImmobile(i)) speeds[i] = 0;
  const VectorX impulses = reflectionImpulses(delassus.matrix(), speeds, impacts);
  delassus.apply(impulses, state);
  for (std::size_t i = 0; i < impacts.size(); ++i)
    impacts[i].impulse += impulses[static_cast<Index>(i)] * impacts[i].contact.normal;
}

}  // namespace cradle
