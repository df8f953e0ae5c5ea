// Signs of the event functions are compared between a few points of the step, and a change of sign is located by the
// Illinois method (M. Dowell, P. Jarratt, 1971). Where forces are not unique, those of the rows (of minimum norm) prove
// that contacts hold if they lie in the friction cones; whether any others do is Coulomb's problem. But the motion has
// the friction of those of the rows: where they pull, it would drive what slides, whatever other forces could be.

#include "simulate/events/contact_changes.h"

#include <algorithm>
#include <cmath>

#include "collision/mesh_surface.h"
#include "constraints/contact_groups.h"
#include "math/parabola.h"
#include "simulate/events/contacts_on_meshes.h"
#include "simulate/events/cylinder_rims.h"
#include "simulate/events/sliding_friction.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

using Kind = ContactChange::Kind;

constexpr int kEventSamples = 4;      // of a step of order 8
constexpr int kFewEventSamples = 2;   // of one of order 5, which is half as long
constexpr int kMaxBorderCuts = 60;    // halves of a step: none is left, to rounding
constexpr int kMaxSecants = 20;       // of infeasibility; six are usual
constexpr double kBehindKink = -0.9;  // a larger infeasibility is behind its kink, whatever rounding does

// The event function of leaving is kLeavingUnit (1 - d / leaving), d the distance from the nearest point, and not below
// -kLeavingUnit: where it is zero to kEventFunction, d is found to a thousandth. The bound keeps the Illinois method in
// its bracket, as d grows faster by orders of magnitude beyond the border.
constexpr double kLeavingUnit = 1e3 * EventTolerances::kEventFunction;

constexpr double kJustFlat = 1 - 1e-6;  // a disc that lies down ends a little flatter than a row may follow

constexpr std::array<Kind, 6> kKinds = {Kind::release, Kind::slip, Kind::stick,
                                        Kind::leave,   Kind::load, Kind::redundant};
// Of the event functions: what is left of the friction of a whole pair, and of the agreement of rows.
constexpr std::size_t kOfPair = kKinds.size(), kOfRows = kOfPair + 1;

// Event functions whose parabola through three samples falls below this may fall below zero between them: it misses
// the least of a cosine by some 1e-4 where samples are 1/32 of a period apart.
constexpr double kShallow = 0.01;
constexpr int kMaxDipTrials = 3;  // at the least of the parabola, and of those with it

}  // namespace

/// The direction of A's sliding that its row has by itself; unit, world.
Vec3 ContactChanges::slidingDirectionAt(std::size_t contact, double time, const VectorX& state) const {
  const ContactConstraint& constraint = mechanism().contacts[contact];
  const int body = constraint.surfaceB.body;
  const Mat3 worldFromB =
      body == kFixed ? Mat3(Mat3::Identity()) : orientation(state, body).normalized().toRotationMatrix();
  return givenDirection(constraint, worldFromB, time);
}

/// The axis about which a disc on its rim is tilted, as long as the sine of the angle. Needs frames_ of the state.
Vec3 ContactChanges::tiltOf(const ContactConstraint& rim, const VectorX& state) const {
  const ContactKinematics place = kinematicsOf(rim, state, frames_);
  const Mat3& worldFromBody = frames_[static_cast<std::size_t>(rim.centerA.body)].rotation;
  return place.normal.cross(worldFromBody * rim.rimAxisA);
}

/// 0 for a steep disc on its rim, 1 where it is as flat as a row may follow. Needs frames_ of the state.
double ContactChanges::flatnessOf(const ContactConstraint& rim, const VectorX& state) const {
  return kJustFlat * kFlatRim / tiltOf(rim, state).norm();
}

/// The fraction of the step between two points behind which a disc on its rim is tilted the other way; none for other
/// contacts. At both points it may be far from flat, and lie down between them.
std::optional<double> ContactChanges::firstOverturning(std::size_t contact, double from, double to) {
  const ContactConstraint& rim = mechanism().contacts[contact];
  if (rim.rimAxisA.isZero(0)) return std::nullopt;
  const auto tiltAt = [&](double fraction) {
    interpolate(island_.step, fraction, sample_);
    findBodyFrames(mechanism().bodies, sample_, frames_);
    return tiltOf(rim, sample_);
  };
  const Vec3 tilt = tiltAt(from);
  if (!(tilt.dot(tiltAt(to)) < 0)) return std::nullopt;
  while (to - from > EventTolerances::kChangeInstant) {
    const double middle = from + (to - from) / 2;
    (tilt.dot(tiltAt(middle)) > 0 ? from : to) = middle;
  }
  return to;
}

/// Distance (m) of the point where a contact's row keeps it from the point where the surfaces are nearest. It grows
/// beyond the border of a face, at a corner that becomes an edge, and in a hollow where another part of a surface comes
/// nearer. Needs frames_ of the state.
double ContactChanges::distanceFromNearest(std::size_t contact, const ContactRecord& record,
                                           const VectorX& state) const {
  const ContactConstraint& row = mechanism().contacts[contact];
  const ColliderPair& pair = record.pair;
  if (pair.againstPlane) return row.rimAxisA.isZero(0) ? 0 : tolerances_.leaving * flatnessOf(row, state);
  const ContactGeometry& geometry = island_.assembly.geometry;
  const bool isOfB = geometry.colliders[pair.a].body == row.centerA.body;
  const Collider &a = geometry.colliders[isOfB ? pair.a : pair.b], &b = geometry.colliders[isOfB ? pair.b : pair.a];
  const auto nearestOn = [&](const Collider& collider, const Vec3& center) {
    if (collider.body == kFixed) return nearestOnSurface(collider, center);
    const Mat3& worldFromBody = frames_[static_cast<std::size_t>(collider.body)].rotation;
    const Vec3 origin = centerOfMass(state, collider.body);
    return Vec3(origin + worldFromBody * nearestOnSurface(collider, worldFromBody.transpose() * (center - origin)));
  };
  const ContactKinematics place = kinematicsOf(row, state, frames_);
  const Vec3 onB = place.point - place.gap * place.normal;
  // Where lines cross, each has its own end: the error of the interpolant, which lets edges overlap, says nothing then.
  if (!row.lineA.isZero(0))
    return std::max((place.point - nearestOn(a, place.point)).norm(), (onB - nearestOn(b, onB)).norm());
  if (!row.rimAxisA.isZero(0))
    return std::max((onB - nearestOn(b, place.point + row.radiusA * place.normal)).norm(),
                    tolerances_.leaving * flatnessOf(row, state));
  const double apartOnB = (onB - nearestOn(b, motionOf(row.centerA, state, frames_).position)).norm();
  if (std::isinf(row.radiusB)) return apartOnB;
  Vec3 centerB = motionOf(row.surfaceB, state, frames_).position;
  if (!row.lineB.isZero(0)) centerB = onB - row.radiusB * place.normal;
  if (a.kind() == ColliderKind::cylinder) centerB = place.point;  // from inside, its end may be nearer than its side
  return std::max(apartOnB, (place.point - nearestOn(a, centerB)).norm());
}

/// N: the normal forces with which the pair of a contact slides, as evaluated last. Points of one face share them in
/// many ways, and their sum tells.
double ContactChanges::slidingNormalForce(std::size_t contact, const std::vector<ContactRecord>& records) const {
  double sum = 0;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (records[i].contact.pair == records[contact].contact.pair &&
        mechanism().contacts[i].motion == ContactMotion::sliding)
      sum += island_.equations.contactForces()[i].normal;
  return sum;
}

/// Whether a contact is of a face that slides with friction.
bool ContactChanges::slidesAsFace(std::size_t contact, const std::vector<ContactRecord>& records) const {
  if (!records[contact].sharesLoads) return false;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (records[i].contact.pair == records[contact].contact.pair &&
        mechanism().contacts[i].motion == ContactMotion::sliding)
      return true;
  return false;
}

/// Of the friction that holds the pair of a contact, as evaluated last, what is left, over the force.
double ContactChanges::stickingLeft(std::size_t contact, const std::vector<ContactRecord>& records) const {
  double limit = 0;
  Vec3 tangential = Vec3::Zero();
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].contact.pair != records[contact].contact.pair) continue;
    const ContactForce& force = island_.equations.contactForces()[i];
    limit += records[i].pair.material.staticFriction * force.normal, tangential += force.tangential;
  }
  return limit > 0 ? (limit - tangential.norm()) / limit : INFINITY;
}

/// Below zero where rows contradict each other: no forces keep all contacts, however friction and loads may be.
double ContactChanges::agreementOf(std::size_t contact) const {
  const ContactForce& force = island_.equations.contactForces()[contact];
  const double most = EventTolerances::kInfeasibleRatio * std::max(force.asked, mechanism().gravity.norm());
  return force.left > most ? most / force.left - 1 : INFINITY;
}

/// How far the idle contacts of an active one are from carrying load, over its force.
double ContactChanges::idleLeft(std::size_t contact, const std::vector<ContactRecord>& records) const {
  double least = INFINITY;
  for (const IdleContact& idle : records[contact].idle) {
    double force = 0;  // N, that it would carry
    for (const auto& [other, part] : idle.parts) force += part * island_.equations.contactForces()[other].normal;
    least = std::min(least, EventTolerances::kLoadedRatio - force / records[contact].force);
  }
  return least;
}

void ContactChanges::evaluate(const std::vector<ContactRecord>& records, double fraction, const VectorX& state,
                              std::vector<EventFunctions>& values) {
  island_.equations.evaluate(timeAt(fraction), state, derivative_);
  takeEvaluated(records, timeAt(fraction), state, values);
}

/// Event functions of each contact at `state`, for which the equations were evaluated last; infinite where there is
/// nothing to change.
void ContactChanges::takeEvaluated(const std::vector<ContactRecord>& records, double time, const VectorX& state,
                                   std::vector<EventFunctions>& values) {
  findBodyFrames(mechanism().bodies, state, frames_);
  const std::vector<ContactForce>& forces = island_.equations.contactForces();
  values.resize(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const ContactMotion motion = mechanism().contacts[i].motion;
    const double limit = records[i].pair.material.staticFriction * forces[i].normal;
    values[i].fill(INFINITY);
    values[i][0] = forces[i].normal / records[i].force;
    if (!sphereOverMesh(island_.assembly.geometry, records[i].pair, state).mesh)
      values[i][3] = kLeavingUnit * std::max(-1.0, 1 - distanceFromNearest(i, records[i], state) / tolerances_.leaving);
    if (motion == ContactMotion::sticking) values[i][1] = (limit - forces[i].tangential.norm()) / records[i].force;
    if (records[i].isRedundant) values[i][kOfRows] = agreementOf(i);
    if (motion == ContactMotion::sticking && records[i].isRedundant) values[i][kOfPair] = stickingLeft(i, records);
    if (motion == ContactMotion::sliding)
      values[i][2] = forces[i].tangentialVelocity.dot(slidingDirectionAt(i, time, state));
    if (motion == ContactMotion::sliding && records[i].isRedundant)
      values[i][5] = slidingNormalForce(i, records) / records[i].force;
    values[i][4] = idleLeft(i, records);
  }
}

double ContactChanges::margin(const ContactChange& change, const std::vector<ContactRecord>& records, double fraction,
                              const VectorX& state) {
  const ContactRecord& record = records[change.contact];
  if (change.kind == Kind::leave)
    if (const SphereOverMesh sphere = sphereOverMesh(island_.assembly.geometry, record.pair, state); sphere.mesh)
      return insideVoronoiRegion(record.contact, sphere);
  evaluate(records, fraction, state, after_);
  return after_[change.contact][static_cast<std::size_t>(change.kind)];
}

void ContactChanges::noteEnd(const std::vector<ContactRecord>& records) {
  if (!records.empty()) takeEvaluated(records, timeAt(1), island_.step.state, atEnd_);
}

std::optional<ContactChange> ContactChanges::first(const std::vector<ContactRecord>& records) {
  if (records.empty()) return std::nullopt;
  const Step& step = island_.step;
  if (knownTime_ != step.time) evaluate(records, 0, step.startState, before_);
  knownTime_ = NAN;
  const std::optional<FeatureChange> leaving = firstFeatureChange(records, island_);
  const bool isEndKnown = step.interpolant == InterpolantKind::degreeFour;
  const int samples = isEndKnown ? kFewEventSamples : kEventSamples;
  for (int k = 1; k <= samples; ++k) {
    const double from = static_cast<double>(k - 1) / samples, to = static_cast<double>(k) / samples;
    if (k == samples && isEndKnown) {
      std::swap(ahead_, atEnd_);
    } else {
      interpolate(step, to, sample_);
      evaluate(records, to, sample_, ahead_);
    }
    std::optional<ContactChange> found = firstBetween(records, from, to);
    if (!found && k > 1) found = firstInDip(records, from - 1.0 / samples, from, to);
    if (found) found = firstBefore(records, from, *found);
    if (leaving && leaving->fraction <= (found ? found->fraction : to))
      return ContactChange{Kind::leave, leaving->fraction, leaving->record, found ? found->latest : to};
    if (found) return found;
    std::swap(earlier_, before_), std::swap(before_, ahead_);
  }
  knownTime_ = step.time + step.timeStep;
  return std::nullopt;
}

/// A change in a dip of a force or of what is left of friction, which is above zero at three points of the step, with
/// the event functions earlier_, before_ and ahead_, but not between them. Those of the points stay as they are if
/// there is none.
std::optional<ContactChange> ContactChanges::firstInDip(const std::vector<ContactRecord>& records, double earlier,
                                                        double from, double to) {
  const std::vector<EventFunctions> atFrom = before_, atTo = ahead_;
  for (std::size_t i = 0; i < records.size(); ++i)
    for (const std::size_t kind : {std::size_t(0), std::size_t(1), kOfPair}) {
      std::array<Sample, 3> samples{{{earlier, earlier_[i][kind]}, {from, atFrom[i][kind]}, {to, atTo[i][kind]}}};
      const auto isAbove = [](const Sample& sample) { return sample.value > 0 && std::isfinite(sample.value); };
      if (!std::all_of(samples.begin(), samples.end(), isAbove)) continue;
      for (int trial = 0; trial < kMaxDipTrials; ++trial) {
        const std::optional<Sample> least = leastOf(samples);
        if (!least || least->value > kShallow) break;
        interpolate(island_.step, least->at, sample_);
        evaluate(records, least->at, sample_, ahead_);
        const double found = ahead_[i][kind];
        if (found < -EventTolerances::kEventFunction) {
          const bool isEarly = least->at < from;
          if (isEarly) before_ = earlier_;
          if (const auto change = firstBetween(records, isEarly ? earlier : from, least->at)) return change;
          break;
        }
        auto& [a, b, c] = samples;
        if (found >= b.value) break;
        (least->at < b.at ? c : a) = b, b = {least->at, found};
      }
      before_ = atFrom, ahead_ = atTo;
    }
  return std::nullopt;
}

/// The first change between a point of the step, whose event functions are before_, and a change that was found behind
/// it, or this one: an event function may fall below zero before that, and be above it again at the next point.
ContactChange ContactChanges::firstBefore(const std::vector<ContactRecord>& records, double from, ContactChange found) {
  const auto isEarlier = [&](double to) {
    interpolate(island_.step, to, sample_);
    evaluate(records, to, sample_, ahead_);
    const std::optional<ContactChange> earlier = firstZero(records, from, to);
    if (!earlier || !(earlier->fraction < found.fraction - kAtOnce)) return false;
    found = *earlier;
    return true;
  };
  while (found.fraction - from > kAtOnce)
    if (!isEarlier(from + (found.fraction - from) / 2) && !isEarlier(found.fraction)) break;
  return found;
}

/// The first change between two points of the step, whose event functions are before_ and ahead_.
std::optional<ContactChange> ContactChanges::firstBetween(const std::vector<ContactRecord>& records, double from,
                                                          double to) {
  const std::optional<ContactChange> first = firstZero(records, from, to);
  if (std::none_of(isInDoubt_.begin(), isInDoubt_.end(), [](char isInDoubt) { return isInDoubt != 0; })) return first;
  const std::optional<double> failure = firstInfeasible(records, from, first ? first->fraction : to);
  return failure ? ContactChange{Kind::redundant, *failure, 0, *failure} : first;
}

/// The same, but for contacts whose forces do not prove that they last: these are put into isInDoubt_.
std::optional<ContactChange> ContactChanges::firstZero(const std::vector<ContactRecord>& records, double from,
                                                       double to) {
  std::optional<ContactChange> first;
  std::vector<double> fractions;
  isInDoubt_.assign(records.size(), 0);
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (ahead_[i][kOfRows] < 0) isInDoubt_[i] = 1;
    for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
      double end = to, marginEnd = ahead_[i][kind];
      if (kKinds[kind] == Kind::leave && marginEnd >= -EventTolerances::kEventFunction)
        if (const auto flat = firstOverturning(i, from, to)) {
          interpolate(island_.step, *flat, sample_);
          end = *flat, marginEnd = margin({Kind::leave, 0, i}, records, *flat, sample_);
        }
      if (!(marginEnd < -EventTolerances::kEventFunction)) continue;
      if (kKinds[kind] == Kind::leave && !(before_[i][kind] > 0)) continue;
      // What starts to slide may still go the other way, as slowly as tells no direction, and is turned.
      if (kKinds[kind] == Kind::stick && before_[i][kind] < 0 && marginEnd > before_[i][kind]) continue;
      // Friction of sliding shares the loads of redundant contacts as rows do: none may pull.
      const bool isRelease = kKinds[kind] == Kind::release && !slidesAsFace(i, records);
      if (records[i].isRedundant && (isRelease || kKinds[kind] == Kind::slip)) {
        isInDoubt_[i] = 1;
        continue;
      }
      ContactChange change{kKinds[kind], 0, i};
      change.fraction = locate(change, records, from, before_[i][kind], end, marginEnd);
      fractions.push_back(change.fraction);
      if (!first || change.fraction < first->fraction) first = change;
    }
  }
  if (first) first->latest = to;
  for (const double fraction : fractions)
    if (fraction > first->fraction + kAtOnce) first->latest = std::min(first->latest, fraction);
  return first;
}

/// The fraction of the step between two points at which an event function falls to zero, on the interpolant (Illinois).
double ContactChanges::locate(const ContactChange& change, const std::vector<ContactRecord>& records, double from,
                              double marginFrom, double to, double marginTo) {
  // An event function that starts at zero, and grows at first, has its root behind that: the start is moved there.
  for (double cut = to;
       !(marginFrom > EventTolerances::kEventFunction) && cut - from > EventTolerances::kChangeInstant;) {
    cut = from + (cut - from) / 2;
    interpolate(island_.step, cut, sample_);
    const double found = margin(change, records, cut, sample_);
    if (found > EventTolerances::kEventFunction)
      from = cut, marginFrom = found;
    else if (found < -EventTolerances::kEventFunction)
      to = cut, marginTo = found;
    else
      break;
  }
  double weightFrom = std::max(marginFrom, EventTolerances::kEventFunction), weightTo = marginTo;
  for (int i = 0; i < kMaxBorderCuts && to - from > EventTolerances::kChangeInstant; ++i) {
    const double cut = to - (to - from) * weightTo / (weightTo - weightFrom);
    interpolate(island_.step, cut, sample_);
    const double found = margin(change, records, cut, sample_);
    if (std::abs(found) <= EventTolerances::kEventFunction) return cut;
    if (found > 0)
      from = cut, weightFrom = found, weightTo /= 2;
    else
      to = cut, weightTo = found, weightFrom /= 2;
  }
  return to;
}

/// Rows of active contacts at `state`, in which those that slide do so in the directions of `sliding`.
ContactChanges::GroupRows ContactChanges::rowsOfGroup(const std::vector<int>& contacts,
                                                      std::vector<ContactRecord>& sliding, double time,
                                                      const VectorX& state) const {
  GroupRows group;
  for (const int i : contacts) {
    const std::size_t contact = static_cast<std::size_t>(i);
    const ContactRows rows = rowsOf(mechanism().contacts[contact], state, frames_);
    if (rows.constraint.motion == ContactMotion::sliding)
      sliding[contact].direction = slidingDirection(rows.constraint, rows.place, frames_, time);
    group.rows.push_back(rows);
    group.records.push_back(&sliding[contact]);
  }
  return group;
}

/// Not above zero if some forces within the friction cones keep all contacts as they are at a fraction of the step:
/// none opens or closes, none that sticks slides. It is the largest acceleration (1 is as much as may be left) that
/// does, less 1, and so grows from -1 on, with a kink where forces begin to fail. Groups without a contact in doubt are
/// kept.
double ContactChanges::infeasibility(const std::vector<ContactRecord>& records, double fraction) {
  interpolate(island_.step, fraction, sample_);
  const VectorX& state = sample_;
  findBodyFrames(mechanism().bodies, state, frames_);
  ConstraintSolver constraints(mechanism().constraints, mechanism().bodies);
  if (constraints.hasConstraints()) constraints.factorize(state, frames_);
  // With all contacts for the forces of motors, and then without.
  if (!mechanism().motors.empty()) island_.equations.evaluate(timeAt(fraction), state, derivative_);
  island_.equations.evaluateWithoutContacts(timeAt(fraction), state, derivative_);
  std::vector<char> joinsNothing = island_.equations.resting();
  for (const DrivenBody& driven : mechanism().driven) joinsNothing[static_cast<std::size_t>(driven.body)] = 1;
  std::vector<ContactRecord> sliding = records;  // with the directions of sliding at `state`
  double left = 0, largest = mechanism().gravity.norm();
  for (const ContactGroup& group : findContactGroups(mechanism().contacts, mechanism().constraints, joinsNothing)) {
    const GroupRows members = rowsOfGroup(group.contacts, sliding, timeAt(fraction), state);
    const DenseDelassus delassus(blocksOf(members.rows), mechanism().bodies, frames_, &constraints);
    largest = std::max(largest, delassus.accelerations(derivative_).cwiseAbs().maxCoeff());
    const auto isInDoubt = [this](int contact) { return isInDoubt_[static_cast<std::size_t>(contact)] != 0; };
    if (std::none_of(group.contacts.begin(), group.contacts.end(), isInDoubt)) continue;
    const SlidingSolution solution =
        solveContactForces(members.records, members.rows, delassus, derivative_, shareLoads(members.records, island_));
    for (std::size_t k = 0; k < members.records.size(); ++k) {
      const Vec3 acceleration = solution.velocities.segment<3>(3 * static_cast<Eigen::Index>(k));
      const double along = members.records[k]->sticks ? acceleration.head<2>().norm() : 0;
      left = std::max({left, std::abs(acceleration.z()), along});
    }
  }
  const double most = EventTolerances::kInfeasibleRatio * largest;
  return (left - most) / most;
}

/// Moves two fractions of the step, of which forces keep the contacts at `last` and not at `first`, to both sides of
/// the instant from which they fail, by secants: halvings would take three times as many trials. Behind the kink the
/// infeasibility is as good as linear.
void ContactChanges::narrow(const std::vector<ContactRecord>& records, Trial& last, Trial& first) {
  const double apart = EventTolerances::kChangeInstant / 4;
  Trial beyond = first;
  for (int i = 0; i < kMaxSecants && first.fraction - last.fraction > 2 * apart; ++i) {
    const bool isBracketLinear = last.infeasibility > kBehindKink;
    const Trial& other = isBracketLinear ? last : beyond;
    const double slope = (other.infeasibility - first.infeasibility) / (other.fraction - first.fraction);
    double cut = first.fraction + ((isBracketLinear ? 0 : kBehindKink / 2) - first.infeasibility) / slope;
    // From the nearer side of a root that is known the farther one is tried.
    if (isBracketLinear) cut += cut - last.fraction < first.fraction - cut ? apart : -apart;
    if (!(cut > last.fraction && cut < first.fraction)) cut = last.fraction + (first.fraction - last.fraction) / 2;
    const Trial trial{cut, infeasibility(records, cut)};
    if (trial.infeasibility > 0)
      beyond = first, first = trial;
    else
      last = trial;
  }
}

/// The fraction of the step between two points from which no forces keep the contacts any more: of halvings of the
/// interval, so that it does not hang on the way in which it is found.
std::optional<double> ContactChanges::firstInfeasible(const std::vector<ContactRecord>& records, double from,
                                                      double to) {
  Trial last{from, -1}, first{to, infeasibility(records, to)};
  if (first.infeasibility <= 0) return std::nullopt;
  narrow(records, last, first);
  while (to - from > EventTolerances::kChangeInstant) {
    const double middle = from + (to - from) / 2;
    const bool isFeasible = middle <= last.fraction || (middle < first.fraction && infeasibility(records, middle) <= 0);
    (isFeasible ? from : to) = middle;
  }
  return to;
}

}  // namespace cradle
