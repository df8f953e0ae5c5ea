// Generalized reflections (GR): B. Smith, D. M. Kaufman, E. Vouga, R. Tamstorf, E. Grinspun, "Reflections on
// Simultaneous Impact", ACM Trans. Graph. 31(4), 2012. Let J be the Jacobian of the contact normals, W the response of
// velocities to impulses, and v+ = v + W J^T lambda. One reflection solves, for the contacts that close (J v < 0),
//   0 <= lambda perp J (v+ + v) >= 0.   (1)
// Equal restitutions e: the paper's blend (1 - e) v_LCP + e v_GR, where v_GR is the result of reflections until nothing
// closes, and v_LCP that of the plastic impact, 0 <= lambda perp J v+ >= 0 for all contacts.
// Different restitutions: a blend contact by contact could gain energy. Instead, the result is the mean, over levels s
// uniform in 0..1, of impacts in which contacts with e > s are elastic (E = 1) and the others plastic (E = 0). A
// reflection of such an impact solves
//   0 <= lambda perp J v+ + E J v >= 0,   (2)
// which does the work -(1 - E) |J v| lambda / 2 <= 0 at each contact with lambda > 0. No impact gains energy, nor does
// their mean, as kinetic energy is convex. The mean is the paper's blend where all e are equal, and linear in each e
// between the other ones.

#include "impact/generalized_reflections.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "impact/linear_complementarity.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

// Of the fastest speed: slower closing is rounding. 1e4 unit roundoffs, for sums over many reflections.
constexpr double kReflectionClosedRatio = 1e-12;
// Of the sum of the magnitudes in J W J^T z.
constexpr double kSpeedRounding = 16 * std::numeric_limits<double>::epsilon();
// Reflections for each contact. A row of n spheres needs n; an impact that needs more ends with a plastic impact.
constexpr long kMaxReflections = 10000;
// Reflections in all, where some contacts are plastic: each takes energy at these, so that more of them would only slow
// down a motion that is nearly over.
constexpr long kMaxMixedReflections = 100;
// Of the fastest closing speed: if more of it is left after as many plastic reflections in a row as there are contacts,
// no impulse can end it, such as of a body that is stuck between two that joints hold.
constexpr double kMinPlasticProgress = 0.5;
// Of the fastest speed: speeds that come back to within it go round in a circle, such as those of a body that closes by
// turns on two sides between which joints leave it no motion. Bodies of which one is 1e11 times as heavy as another may
// look so. [1e-12, 1e-8]
constexpr double kSameSpeedRatio = 1e-11;

/// An impact as its contact normals see it: speeds J v (m/s) and the Delassus operator J W J^T (1/kg).
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
  VectorX reflectOnce(std::vector<Index> closing, const VectorX& speeds, const VectorX& restitutions,
                      bool& isPlastic) const;

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
  VectorX impulses = VectorX::Zero(speeds_.size()), known = speeds_;
  Index inVain = 0;
  double least = 0;  // m/s: fastest closing before the reflections in vain
  for (long count = 0; count <= most && inVain <= speeds_.size(); ++count) {
    const std::vector<Index> closing = closingAfter(impulses);
    if (closing.empty()) return impulses;
    const VectorX speeds = speeds_ + delassus_ * impulses;
    // Circles are found as by R. P. Brent, "An improved Monte Carlo factorization algorithm", BIT 20, 1980.
    const double same = kSameSpeedRatio * speeds.cwiseAbs().maxCoeff();
    if (count > 0 && (speeds - known).cwiseAbs().maxCoeff() <= same) break;
    if ((count & (count - 1)) == 0) known = speeds;
    const double fastest = -speeds.minCoeff();
    bool isPlastic = false;
    impulses += reflectOnce(closing, speeds, restitutions, isPlastic);
    if (isPlastic && fastest > kMinPlasticProgress * least && inVain > 0)
      ++inVain;
    else
      inVain = isPlastic, least = fastest;
  }
  return stop(impulses);
}

/// One reflection, equation (2), of the closing contacts; `isPlastic`: none of them rebounds. Contacts that a plastic
/// reflection makes close, and that do not rebound either, join it at once: if they were stopped one after the other, a
/// light body between heavy ones would need about as many reflections as the ratio of the masses.
VectorX NormalImpact::reflectOnce(std::vector<Index> closing, const VectorX& speeds, const VectorX& restitutions,
                                  bool& isPlastic) const {
  const auto rebounds = [&](Index i, double speed) { return restitutions[i] > 0 && -speed > restSpeeds_[i]; };
  VectorX offset = speeds, impulses = VectorX::Zero(speeds.size());
  isPlastic = true;
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

/// The same law for a single contact, in closed form: the impulse is -(1 + e) J v / (J W J^T).
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

/// The impulses (N s) along the normals: the mean of all parts of the impact (reboundsOf), the plastic one included.
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
  std::vector<ConstraintBlock> normals;
  for (const ImpactContact& impact : impacts)
    normals.push_back(rowsAlong(impact.contact.normal, impact.contact, state));
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
