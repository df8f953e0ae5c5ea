#include "simulate/rows_of_contacts.h"

#include <cmath>

namespace cradle {
namespace {

constexpr double kSameInertia = 1e-9;  // relative: what bodies that are meant to be equal differ by, and more

SurfaceContact surfacesOf(const Contact& contact) {
  return {contact.bodyA,   contact.bodyB,   contact.point, contact.normal, contact.separation,
          contact.radiusA, contact.radiusB, contact.lineA, contact.lineB,  contact.rimAxis};
}

/// 1/(kg m^2): how easily a body turns, whatever its orientation.
double easeOfTurning(int body, const std::vector<BodyFrame>& frames) {
  return body == kFixed ? 0 : frames[static_cast<std::size_t>(body)].inverseInertia.trace();
}

Vec3 spinOf(int body, const VectorX& state) {
  return body == kFixed ? Vec3::Zero() : Vec3(angularVelocity(state, body));
}

/// Whether body `a` turns the normal of a contact less than `b`: not a matter of their order. Of two that differ by
/// rounding alone neither does.
bool isSteadier(int a, int b, const VectorX& state, const std::vector<BodyFrame>& frames) {
  const double easeA = easeOfTurning(a, frames), easeB = easeOfTurning(b, frames);
  if (std::abs(easeA - easeB) > kSameInertia * (easeA + easeB)) return easeA < easeB;
  const double spinA = spinOf(a, state).norm(), spinB = spinOf(b, state).norm();
  return spinA < spinB - kSameInertia * (spinA + spinB);
}

/// What the drift (m/s^2) of the material in the middle of the gap is beside that at A's surface, half of the gap from
/// there: w x (-s n / 2)', w the relative angular velocity. It lies across the normal. The middle is the same place
/// whichever body is A.
Vec3 driftToMiddle(const ContactConstraint& constraint, const ContactKinematics& place, const VectorX& state) {
  const Vec3 turning = spinOf(constraint.centerA.body, state) - spinOf(constraint.surfaceB.body, state);
  const double rate = place.normal.dot(place.velocity);
  const Vec3 drift = -0.5 * turning.cross(rate * place.normal + place.gap * place.normalRate);
  return drift - drift.dot(place.normal) * place.normal;
}

}  // namespace

ContactRows rowsOf(const ContactConstraint& constraint, const VectorX& state, const std::vector<BodyFrame>& frames) {
  ContactRows rows{constraint, kinematicsOf(constraint, state, frames), {}};
  findRows(constraint, rows.place, true, rows.block);
  return rows;
}

bool canLast(const Contact& contact) {
  const bool isLineA = !contact.lineA.isZero(0), isLineB = !contact.lineB.isZero(0);
  const bool isRound = std::isfinite(contact.radiusA) && std::isfinite(contact.radiusB);  // neither face nor unknown
  if (isLineA || isLineB) return isRound && ((isLineA && isLineB) || contact.radiusA + contact.radiusB > 0);
  const bool isSharp = !(contact.radiusA > 0 || contact.radiusB > 0);
  return !isSharp && !std::isnan(contact.radiusA) && !std::isnan(contact.radiusB) &&
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
    surfaces.lineA.setZero(), surfaces.lineB.setZero();
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
  Vec3 drift = sense * driftToMiddle(rows.constraint, rows.place, state);
  for (int i = 0; i < rows.block.rows; ++i)
    drift += sense * rows.block.velocityProduct[static_cast<std::size_t>(i)] * rows.block.linear.row(i).transpose();
  return drift;
}

std::vector<ConstraintBlock> blocksOf(const std::vector<ContactRows>& contacts) {
  std::vector<ConstraintBlock> blocks;
  for (const ContactRows& contact : contacts) blocks.push_back(contact.block);
  return blocks;
}

}  // namespace cradle
