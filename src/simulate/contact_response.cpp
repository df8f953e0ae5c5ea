#include "simulate/contact_response.h"

#include <cmath>

namespace cradle {
namespace {

using Index = Eigen::Index;

constexpr double kSameInertia = 1e-9;  // relative: what bodies that are meant to be equal differ by, and more

void applyTo(int body, const Vec3& impulse, const Vec3& angularImpulse, const std::vector<RigidBody>& bodies,
             const std::vector<BodyFrame>& frames, VectorX& velocities) {
  if (body == kFixed) return;
  const std::size_t index = static_cast<std::size_t>(body);
  linearVelocity(velocities, body) += bodies[index].inverseMass * impulse;
  angularVelocity(velocities, body) += frames[index].inverseInertia * angularImpulse;
}

SurfaceContact surfacesOf(const Contact& contact) {
  return {contact.bodyA,   contact.bodyB,   contact.point, contact.normal,  contact.separation,
          contact.radiusA, contact.radiusB, contact.edge,  contact.rimAxisA};
}

ContactRows rowsOf(const ContactConstraint& constraint, const VectorX& state, const std::vector<BodyFrame>& frames) {
  const ContactKinematics place = kinematicsOf(constraint, state, frames);
  const auto tangents = tangentRows(constraint, place);
  return {constraint, place, {tangents[0], tangents[1], normalRow(constraint, place)}};
}

/// 1/(kg m^2): how easily a body turns, whatever its orientation.
double easeOfTurning(int body, const std::vector<BodyFrame>& frames) {
  return body == kFixed ? 0 : frames[static_cast<std::size_t>(body)].inverseInertia.trace();
}

double turningRateOf(int body, const VectorX& state) {
  return body == kFixed ? 0 : angularVelocity(state, body).norm();
}

/// Whether body `a` turns the normal of a contact less than `b`: not a matter of their order. Of two that differ by
/// rounding alone neither does.
bool isSteadier(int a, int b, const VectorX& state, const std::vector<BodyFrame>& frames) {
  const double easeA = easeOfTurning(a, frames), easeB = easeOfTurning(b, frames);
  if (std::abs(easeA - easeB) > kSameInertia * (easeA + easeB)) return easeA < easeB;
  const double spinA = turningRateOf(a, state), spinB = turningRateOf(b, state);
  return spinA < spinB - kSameInertia * (spinA + spinB);
}

}  // namespace

bool canLast(const Contact& contact) {
  const bool isEdge = contact.edge != Vec3::Zero(), isSharp = !(contact.radiusA > 0 || contact.radiusB > 0);
  return !isSharp && (isEdge || (!std::isnan(contact.radiusA) && !std::isnan(contact.radiusB))) &&
         (std::isfinite(contact.radiusA) || std::isfinite(contact.radiusB));
}

ContactRows rowsOf(const Contact& contact, const VectorX& state, const std::vector<BodyFrame>& frames) {
  SurfaceContact surfaces = surfacesOf(contact);
  if (!canLast(contact)) {
    // A sphere turns around an edge that it comes to as around a corner; what is not round is as good as a corner of
    // one body on a face of the other.
    const bool isSphereA = contact.radiusA > 0 && std::isfinite(contact.radiusA);
    const bool isSphereB = contact.radiusB > 0 && std::isfinite(contact.radiusB);
    const bool isFaceOfA = !isSphereA && !isSphereB && isSteadier(contact.bodyA, contact.bodyB, state, frames);
    surfaces.radiusA = isSphereA ? contact.radiusA : isFaceOfA ? INFINITY : 0;
    surfaces.radiusB = isSphereB ? contact.radiusB : isSphereA || isFaceOfA ? 0 : INFINITY;
  }
  return rowsOf(constraintOf(surfaces, state), state, frames);
}

Vec3 followContact(const VectorX& before, const VectorX& state, const std::vector<BodyFrame>& frames,
                   Contact& contact) {
  if (!canLast(contact)) {
    const auto along = [&](int body) { return poseOf(state, body) * (poseOf(before, body).inverse() * contact.point); };
    contact.point = 0.5 * (along(contact.bodyA) + along(contact.bodyB));
    return Vec3::Zero();
  }
  const ContactRows rows = rowsOf(constraintOf(surfacesOf(contact), before), state, frames);
  const double sense = rows.constraint.centerA.body == contact.bodyA ? -1 : 1;
  contact.point = rows.place.point - 0.5 * rows.place.gap * rows.place.normal;
  contact.normal = sense * rows.place.normal;
  Vec3 drift = Vec3::Zero();
  for (const ConstraintRow& row : rows.rows) drift += sense * row.velocityProduct * row.linearA;
  return drift;
}

ContactResponse::ContactResponse(const std::vector<ContactRows>& contacts, const std::vector<RigidBody>& bodies,
                                 const std::vector<BodyFrame>& frames, ConstraintSolver& constraints)
    : contacts_(contacts), delassus_(3 * contacts.size(), 3 * contacts.size()) {
  for (const ContactRows& contact : contacts)
    for (const ConstraintRow& row : contact.rows) {
      VectorX answer = VectorX::Zero(stateSize(std::ssize(bodies)));
      applyTo(row.bodyA, row.linearA, row.angularA, bodies, frames, answer);
      applyTo(row.bodyB, row.linearB, row.angularB, bodies, frames, answer);
      if (constraints.hasConstraints()) constraints.constrainVelocities(answer);
      delassus_.col(std::ssize(impulseResponses_)) = velocities(answer);
      impulseResponses_.push_back(std::move(answer));
    }
  delassus_ = (0.5 * (delassus_ + delassus_.transpose())).eval();
}

VectorX ContactResponse::velocities(const VectorX& state) const {
  VectorX result(3 * contacts_.size());
  Index next = 0;
  for (const ContactRows& contact : contacts_)
    for (const ConstraintRow& row : contact.rows) result[next++] = rateOf(row, state);
  return result;
}

VectorX ContactResponse::accelerations(const VectorX& derivative) const {
  VectorX result(3 * contacts_.size());
  Index next = 0;
  for (const ContactRows& contact : contacts_)
    for (const ConstraintRow& row : contact.rows) result[next++] = rateOf(row, derivative) + row.velocityProduct;
  return result;
}

void ContactResponse::apply(const VectorX& impulses, VectorX& velocities) const {
  for (std::size_t i = 0; i < impulseResponses_.size(); ++i)
    velocities += impulses[static_cast<Index>(i)] * impulseResponses_[i];
}

}  // namespace cradle
