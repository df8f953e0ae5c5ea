#include "simulate/events/known_gaps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulate/events/contact_record.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

/// m/s: at which the two bodies slide along each other, and turn. What goes along the normal changes no direction.
double slidingSpeed(const Contact& contact, const VectorX& state, const std::vector<double>& radii) {
  const Vec3 relative = relativeVelocity(contact, state);
  double speed = (relative - relative.dot(contact.normal) * contact.normal).norm();
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed) speed += radii[static_cast<std::size_t>(body)] * angularVelocity(state, body).norm();
  return speed;
}

}  // namespace

void KnownGaps::keep(const ImpactSequence& sequence, double largestError) {
  known_.clear();
  time_ = island_.time;
  for (std::size_t i = 0; i < sequence.contacts().size(); ++i) {
    const Contact& contact = sequence.contacts()[i];
    const Gap gap{sequence.gap(i), sequence.gapError(i)};
    const ColliderPair& pair = island_.assembly.geometry.pairs[contact.pair];
    if (gap.error < largestError) known_.push_back({pair, contact, gap, openingSpeed(contact, island_.state)});
  }
}

/// The errors of a gap grow by the change of its speed x time, by the rounding of time, and by w^2 / l on a way w along
/// the surfaces, on which the normal turns by w / l. As in a sequence, a contact without a gap that hardly opens stays
/// without.
std::optional<KnownGaps::Gap> KnownGaps::find(const Contact& contact, double largestError) const {
  const Known* known = knownAt(contact);
  if (!known) return {};
  const std::vector<double>& radii = island_.assembly.radii;
  const double elapsed = island_.time - time_, speed = openingSpeed(contact, island_.state);
  const double way = slidingSpeed(contact, island_.state, radii) * elapsed;
  const double timeRounding = std::numeric_limits<double>::epsilon() * island_.time;
  const double error = known->gap.error + std::abs(speed - known->speed) * elapsed + std::abs(speed) * timeRounding +
                       way * way / smallestSize(contact, radii);
  if (!(error < largestError)) return {};
  const bool staysClosed =
      known->gap.gap <= known->gap.error && speed > 0 && speed <= tolerances_.minOpeningSpeed(tolerances_.scales.size);
  return Gap{known->gap.gap + (staysClosed ? 0 : speed * elapsed), error};
}

std::optional<KnownGaps::Closing> KnownGaps::nextHidden() const {
  std::optional<Closing> next;
  for (const Known& known : known_) {
    const double hidden =
        EventTolerances::kHiddenGapRatio * tolerances_.gapRounding(known.contact.point.cwiseAbs().maxCoeff());
    const bool isHidden = known.gap.gap <= hidden && known.gap.gap > EventTolerances::kKnownGapRatio * known.gap.error;
    if (!isHidden || !(known.speed < -kRestSpeedFloor)) continue;
    const double time = time_ + known.gap.gap / -known.speed;
    if (time > island_.time && (!next || time < next->time)) next = Closing{time, known.contact.pair};
  }
  return next;
}

const KnownGaps::Known* KnownGaps::knownAt(const Contact& contact) const {
  const double near = EventTolerances::kSameContactPoint * smallestSize(contact, island_.assembly.radii);
  for (const Known& known : known_)
    if (isSamePair(known.pair, island_.assembly.geometry.pairs[contact.pair]) &&
        known.contact.normal.dot(contact.normal) > EventTolerances::kSameContactNormal &&
        (known.contact.point - contact.point).norm() < near)
      return &known;
  return nullptr;
}

}  // namespace cradle
