// Changes of active contacts within a step, looked for at a few points of its interpolant. Where forces are not
// unique, those of the rows (the shortest) tell only that contacts hold if they lie in the friction cones; whether any
// others do is Coulomb's problem.

#include <algorithm>
#include <cmath>

#include "simulate/events/active_contacts.h"

namespace cradle {
namespace {

using Kind = ContactChange::Kind;

constexpr int kSamples = 4;                // of a step of order 8
constexpr int kFewSamples = 2;             // of one of order 5, which is half as long
constexpr double kMarginRounding = 1e-12;  // of the force, or m/s
constexpr double kFailedRatio =
    1e-6;  // of the accelerations: less that forces leave is held; more than when it was decided
constexpr double kLocated = 1e-11;  // of a step, on the interpolant
constexpr int kMaxBorderCuts = 60;

constexpr double kLeavingRatio = 0.5;  // of what touches yet: so far beyond a face a contact has left it
// Of a margin: half of what touches yet is found to a thousandth. Bounded on both sides, it is halved rather than
// followed down beyond the border, where it is steeper by orders.
constexpr double kLeavingUnit = 1e-9;

constexpr double kJustFlat = 1 - 1e-6;  // a disc that lies down is seen to: it ends a little flatter than it may be

constexpr std::array<Kind, 4> kKinds = {Kind::release, Kind::slip, Kind::stick, Kind::leave};

}  // namespace

/// In the world, of A's sliding.
Vec3 ActiveContacts::givenDirection(std::size_t contact, const VectorX& state) const {
  const ContactConstraint& constraint = mechanism().contacts[contact];
  const int body = constraint.surfaceB.body;
  if (body == kFixed) return constraint.slidingDirection;
  return orientation(state, body).normalized() * constraint.slidingDirection;
}

/// 0 for a steep disc on its rim, 1 where it is as flat as a row may follow. Needs frames_.
double ActiveContacts::flatnessOf(const ContactConstraint& rim, const VectorX& state) const {
  const ContactKinematics place = kinematicsOf(rim, state, frames_);
  const Mat3& worldFromBody = frames_[static_cast<std::size_t>(rim.centerA.body)].rotation;
  const double sine = place.normal.cross(worldFromBody * rim.rimAxisA).norm();
  return kLeavingRatio * kJustFlat * kFlatRim / sine;
}

/// How far (m) the place where a contact's row keeps it is from where the surfaces are nearest: beyond the border of a
/// face, or when a corner becomes an edge, that stays behind; in a hollow another part of a surface comes nearer. Needs
/// frames_.
double ActiveContacts::distanceFromNearest(std::size_t contact, const VectorX& state) const {
  const ContactConstraint& row = mechanism().contacts[contact];
  const ColliderPair& pair = records_[contact].pair;
  if (pair.againstPlane) return row.rimAxisA.isZero(0) ? 0 : reach_ * flatnessOf(row, state);
  const ContactGeometry& geometry = island_.assembly.geometry;
  const bool isOfB = geometry.colliders[pair.a].body == row.centerA.body;
  const Collider &a = geometry.colliders[isOfB ? pair.a : pair.b], &b = geometry.colliders[isOfB ? pair.b : pair.a];
  const auto nearestOn = [&](const Collider& collider, const Attachment& anchor) {
    const Vec3 center = motionOf(anchor, state, frames_).position;
    if (collider.body == kFixed) return nearestOnSurface(collider, center);
    const Mat3& worldFromBody = frames_[static_cast<std::size_t>(collider.body)].rotation;
    const Vec3 origin = centerOfMass(state, collider.body);
    return Vec3(origin + worldFromBody * nearestOnSurface(collider, worldFromBody.transpose() * (center - origin)));
  };
  const ContactKinematics place = kinematicsOf(row, state, frames_);
  const double onB = (place.point - place.gap * place.normal - nearestOn(b, row.centerA)).norm();
  if (std::isinf(row.radiusB)) return onB;
  return std::max(onB, (place.point - nearestOn(a, row.surfaceB)).norm());
}

void ActiveContacts::findEventFunctions(const VectorX& state, std::vector<EventFunctions>& eventFunctions) {
  island_.equations.evaluate(state, derivative_);
  takeEventFunctions(state, eventFunctions);
}

/// Of each contact, in the order of kKinds; infinite where there is nothing to change. `state` is the one that was
/// evaluated last.
void ActiveContacts::takeEventFunctions(const VectorX& state, std::vector<EventFunctions>& eventFunctions) {
  findBodyFrames(mechanism().bodies, state, frames_);
  const std::vector<ContactForce>& forces = island_.equations.contactForces();
  eventFunctions.resize(records_.size());
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const ContactMotion motion = mechanism().contacts[i].motion;
    const double limit = records_[i].pair.material.staticFriction * forces[i].normal;
    eventFunctions[i] = {forces[i].normal / records_[i].force, INFINITY, INFINITY, INFINITY};
    if (!sphereOverMesh(island_.assembly.geometry, records_[i].pair, state).mesh)
      eventFunctions[i][3] =
          kLeavingUnit * std::max(-1.0, 1 - distanceFromNearest(i, state) / (kLeavingRatio * reach_));
    if (motion == ContactMotion::sticking)
      eventFunctions[i][1] = (limit - forces[i].tangential.norm()) / records_[i].force;
    if (motion == ContactMotion::sliding)
      eventFunctions[i][2] = forces[i].tangentialVelocity.dot(givenDirection(i, state));
  }
}

double ActiveContacts::margin(const ContactChange& change, const VectorX& state) {
  const ContactRecord& record = records_[change.contact];
  if (change.kind == Kind::leave)
    if (const SphereOverMesh sphere = sphereOverMesh(island_.assembly.geometry, record.pair, state); sphere.mesh)
      return insideBorder(record.contact, sphere);
  findEventFunctions(state, after_);
  return after_[change.contact][static_cast<std::size_t>(change.kind)];
}

void ActiveContacts::noteEnd() {
  if (!empty()) takeEventFunctions(island_.step.state, atEnd_);
}

std::optional<ContactChange> ActiveContacts::firstChange() {
  if (empty()) return std::nullopt;
  const Step& step = island_.step;
  if (knownTime_ != step.time) findEventFunctions(step.startState, before_);
  knownTime_ = NAN;
  const std::optional<ContactChange> leaving = firstLeaving();
  const bool isEndKnown = step.interpolant == InterpolantKind::degreeFour;
  const int samples = isEndKnown ? kFewSamples : kSamples;
  for (int k = 1; k <= samples; ++k) {
    const double from = static_cast<double>(k - 1) / samples, to = static_cast<double>(k) / samples;
    if (k == samples && isEndKnown) {
      std::swap(ahead_, atEnd_);
    } else {
      interpolate(step, to, sample_);
      findEventFunctions(sample_, ahead_);
    }
    std::optional<ContactChange> first;
    bool isDoubtful = false;
    for (std::size_t i = 0; i < records_.size(); ++i)
      for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
        if (!(ahead_[i][kind] < -kMarginRounding)) continue;
        if (kKinds[kind] == Kind::leave && !(before_[i][kind] > 0)) continue;
        const bool isOfForces = kKinds[kind] == Kind::release || kKinds[kind] == Kind::slip;
        if (records_[i].isRedundant && isOfForces) {
          isDoubtful = true;
          continue;
        }
        ContactChange change{kKinds[kind], 0, i};
        change.fraction = locate(change, from, before_[i][kind], to, ahead_[i][kind]);
        if (!first || change.fraction < first->fraction) first = change;
      }
    if (isDoubtful) {
      const double end = first ? first->fraction : to;
      if (const auto failure = firstInfeasible(from, end)) first = ContactChange{Kind::redundant, *failure, 0};
    }
    if (leaving && leaving->fraction <= (first ? first->fraction : to)) return leaving;
    if (first) return first;
    std::swap(before_, ahead_);
  }
  knownTime_ = step.time + step.timeStep;
  return std::nullopt;
}

/// Where between two points of the step a margin falls to zero, on the interpolant (Illinois).
double ActiveContacts::locate(const ContactChange& change, double from, double marginFrom, double to, double marginTo) {
  double weightFrom = std::max(marginFrom, kMarginRounding), weightTo = marginTo;
  for (int i = 0; i < kMaxBorderCuts && to - from > kLocated; ++i) {
    const double cut = to - (to - from) * weightTo / (weightTo - weightFrom);
    interpolate(island_.step, cut, sample_);
    const double found = margin(change, sample_);
    if (std::abs(found) <= kMarginRounding) return cut;
    if (found > 0)
      from = cut, weightFrom = found, weightTo /= 2;
    else
      to = cut, weightTo = found, weightFrom /= 2;
  }
  return to;
}

/// Whether some forces within the friction cones keep all contacts as they are.
bool ActiveContacts::areForcesFeasible(const VectorX& state) {
  findBodyFrames(mechanism().bodies, state, frames_);
  std::vector<ContactRows> rows;
  std::vector<const ContactRecord*> members;
  std::vector<ContactRecord> records = records_;
  for (std::size_t i = 0; i < records.size(); ++i) {
    ContactRows contact{mechanism().contacts[i], kinematicsOf(mechanism().contacts[i], state, frames_), {}};
    const auto tangents = tangentRows(contact.constraint, contact.place);
    contact.rows = {tangents[0], tangents[1], normalRow(contact.constraint, contact.place)};
    if (contact.constraint.motion == ContactMotion::sliding)
      records[i].direction = slidingDirection(contact.constraint, contact.place, frames_);
    rows.push_back(contact);
    members.push_back(&records[i]);
  }
  ConstraintSolver constraints(mechanism().constraints, mechanism().bodies);
  if (constraints.hasConstraints()) constraints.factorize(state, frames_);
  std::vector<ContactConstraint> active;
  std::swap(active, mechanism().contacts);
  island_.equations.evaluate(state, derivative_);
  std::swap(active, mechanism().contacts);
  const ContactResponse response(rows, mechanism().bodies, frames_, constraints);
  const ContactSolution solution = solve(members, rows, response);
  const double most =
      kFailedRatio * std::max(response.accelerations(derivative_).cwiseAbs().maxCoeff(), mechanism().gravity.norm());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Vec3 motion = solution.velocities.segment<3>(3 * static_cast<Eigen::Index>(i));
    if (std::abs(motion.z()) > most) return false;
    if (records[i].sticks && motion.head<2>().norm() > most) return false;
  }
  return true;
}

/// Where between two points of the step no forces hold the contacts any more.
std::optional<double> ActiveContacts::firstInfeasible(double from, double to) {
  interpolate(island_.step, to, sample_);
  if (areForcesFeasible(sample_)) return std::nullopt;
  while (to - from > kLocated) {
    const double middle = from + (to - from) / 2;
    interpolate(island_.step, middle, sample_);
    (areForcesFeasible(sample_) ? from : to) = middle;
  }
  return to;
}

}  // namespace cradle
