// Kinematics of a sphere on a face, a sphere or a line, of a disc's rim on a face, and of a line on a line. The rows
// are those of the relative velocity of the bodies' material at the point of contact; their velocityProduct terms let
// that point move over both surfaces (rolling), and the normal turn.
//
// With n out of B, c the centre of A's sphere, a = c - r_A n - x_A and b = c - r_A n - x_B the arms, u the velocity:
//   u = v_A + w_A x a - v_B - w_B x b,   gap' = n.u,   gap'' = n'.u + n.u',
//   u' = J (accelerations) + w_A x a' - w_B x b',   a' = w_A x (c - x_A) - r_A n',   b' = a' + v_A - v_B,
// n' = w_B x n on a face, and the part of the centres' relative velocity across n over their distance on a sphere. On
// a line along e, s = c - b less its part along e takes the place of the centres' difference: s' = w - w_e with w_e =
// e (e.w) + e' (e.(c - b)) + e (e'.(c - b)), w = (c - b)'. A disc across the unit vector d touches a face by c - r_A m,
// m = (n - (n.d) d) / |n - (n.d) d|: m and m' stand for n and n' in the arms then. Tangential: the rate of u - n (n.u)
// has the part u' - n' (n.u) along the surfaces, whatever spans them.
//
// Lines c + a e_A and b + s e_B are nearest where c - b + a e_A - s e_B = g n, with N = e_A x e_B and n = N / |N|:
//   g = n.(c - b),  a = -((c - b) x e_B).N / N^2,  s = -((c - b) x e_A).N / N^2,
//   n' = (N' - n (n.N')) / |N|,  a' = ((g n' - v) x e_B).N / N^2,
// v the relative velocity of the material of both lines there; the place on A runs along its line with a'.

#include "constraints/contact_rows.h"

#include <cmath>

#include "core/error.h"

namespace cradle {
namespace {

constexpr double kFastSliding = 100;  // times slowSliding: above, the weight of the direction given is below rounding

bool isFace(double radius) {
  return std::isinf(radius);
}

Vec3 spinOf(int body, const VectorX& state) {
  return body == kFixed ? Vec3::Zero() : Vec3(angularVelocity(state, body));
}
Vec3 centerOf(int body, const VectorX& state) {
  return body == kFixed ? Vec3::Zero() : Vec3(centerOfMass(state, body));
}
Vec3 velocityOf(int body, const VectorX& state) {
  return body == kFixed ? Vec3::Zero() : Vec3(linearVelocity(state, body));
}
Vec3 turned(int body, const Vec3& direction, const std::vector<BodyFrame>& frames) {
  return body == kFixed ? direction : Vec3(frames[static_cast<std::size_t>(body)].rotation * direction);
}

Vec3 inFrameOf(int body, const Vec3& direction, const VectorX& state) {
  return body == kFixed ? direction : Vec3(orientation(state, body).normalized().conjugate() * direction);
}
Attachment attachmentAt(int body, const Vec3& point, const VectorX& state) {
  return {body, inFrameOf(body, point - centerOf(body, state), state)};
}

bool isLine(const Vec3& direction) {
  return !direction.isZero(0);
}

/// Where two lines are nearest to each other.
struct Crossing {
  Vec3 normal, normalRate;  // from B's line to A's; 1/s
  double gap;               // m, of the lines without the radii around them
  double along, alongRate;  // m, of the place on A's line from its anchor; m/s
  Vec3 alongA, alongRateA;  // direction of A's line, and its rate (1/s)
};

Crossing crossingOf(const ContactConstraint& contact, const AttachmentMotion& a, const AttachmentMotion& b,
                    const Vec3& spinA, const Vec3& spinB, const std::vector<BodyFrame>& frames) {
  const Vec3 alongA = turned(contact.centerA.body, contact.lineA, frames), rateA = spinA.cross(alongA);
  const Vec3 alongB = turned(contact.surfaceB.body, contact.lineB, frames), rateB = spinB.cross(alongB);
  const Vec3 across = alongA.cross(alongB), acrossRate = rateA.cross(alongB) + alongA.cross(rateB);
  const Vec3 apart = a.position - b.position;
  const double sine = across.norm();
  Crossing found{across / sine, Vec3::Zero(), 0, 0, 0, alongA, rateA};
  found.normalRate = (acrossRate - found.normal.dot(acrossRate) * found.normal) / sine;
  found.gap = found.normal.dot(apart);
  found.along = -apart.cross(alongB).dot(across) / (sine * sine);
  const double alongOfB = -apart.cross(alongA).dot(across) / (sine * sine);
  const Vec3 velocity = a.velocity - b.velocity + found.along * rateA - alongOfB * rateB;
  found.alongRate = (found.gap * found.normalRate - velocity).cross(alongB).dot(across) / (sine * sine);
  return found;
}

/// Normal, its rate, the gap and B's lever: what depends on the kind of B's surface, under a sphere or disc.
void placeNormal(const ContactConstraint& contact, const AttachmentMotion& a, const AttachmentMotion& b,
                 const Vec3& spinB, const std::vector<BodyFrame>& frames, ContactKinematics& place) {
  const Vec3 apart = a.position - b.position;
  if (isFace(contact.radiusB)) {
    place.normal = turned(contact.surfaceB.body, contact.normalB, frames);
    place.normalRate = spinB.cross(place.normal);
    place.gap = apart.dot(place.normal) - contact.radiusA;
    place.leverB = (b.arm + apart).cross(place.normal);
    return;
  }
  Vec3 across = apart, velocity = a.velocity - b.velocity;
  if (isLine(contact.lineB)) {
    const Vec3 along = turned(contact.surfaceB.body, contact.lineB, frames), rate = spinB.cross(along);
    across -= along.dot(apart) * along;
    velocity -= (along.dot(velocity) + rate.dot(apart)) * along + along.dot(apart) * rate;
  }
  const double distance = across.norm();
  place.normal = across / distance;
  place.normalRate = (velocity - velocity.dot(place.normal) * place.normal) / distance;
  place.gap = distance - (contact.radiusA + contact.radiusB);
  place.leverB = (b.arm + (apart - across)).cross(place.normal);
}

bool isRim(const ContactConstraint& contact) {
  return !contact.rimAxisA.isZero(0);
}

/// From the place where A touches to the centre of its sphere or disc, or its line's anchor (m), and the rate of that
/// (m/s).
struct Ascent {
  Vec3 way, rate;
};

Ascent ascentOf(const ContactConstraint& contact, const ContactKinematics& place, const Vec3& spinA,
                const std::vector<BodyFrame>& frames) {
  const double radius = contact.radiusA;
  if (!isRim(contact)) return {radius * place.normal, radius * place.normalRate};
  const Vec3 axis = turned(contact.centerA.body, contact.rimAxisA, frames), axisRate = spinA.cross(axis);
  const double cosine = place.normal.dot(axis);
  const double cosineRate = place.normalRate.dot(axis) + place.normal.dot(axisRate);
  const Vec3 across = place.normal - cosine * axis;
  const Vec3 acrossRate = place.normalRate - cosineRate * axis - cosine * axisRate;
  const double sine = across.norm();
  const Vec3 up = across / sine;
  return {radius * up, radius / sine * (acrossRate - up.dot(acrossRate) * up)};
}

/// A unit vector across another (T. Duff et al., "Building an Orthonormal Basis, Revisited", J. Computer Graphics
/// Techniques 6(1), 2017).
Vec3 across(const Vec3& n) {
  const double sign = n.z() < 0 ? -1 : 1, part = -n.x() / (sign + n.z());
  return {1 + sign * n.x() * part, sign * n.y() * part, -sign * n.x()};
}

/// Places the normal of two lines.
Ascent ascentOfLine(const ContactConstraint& contact, const Crossing& crossing, ContactKinematics& place) {
  place.normal = crossing.normal;
  place.normalRate = crossing.normalRate;
  place.gap = crossing.gap - (contact.radiusA + contact.radiusB);
  return {contact.radiusA * crossing.normal - crossing.along * crossing.alongA,
          contact.radiusA * crossing.normalRate - crossing.alongRate * crossing.alongA -
              crossing.along * crossing.alongRateA};
}

void putTangentRow(const ContactKinematics& place, const Vec3& direction, int row, ConstraintBlock& block) {
  const std::size_t i = static_cast<std::size_t>(row);
  block.linear.row(row) = direction;
  block.angularA.row(row) = place.armA.cross(direction), block.angularB.row(row) = -place.armB.cross(direction);
  block.value[i] = block.rounding[i] = 0;
  block.velocityProduct[i] =
      direction.dot(place.drift) - direction.dot(place.normalRate) * place.normal.dot(place.velocity);
}

void putNormalRow(const ContactKinematics& place, int row, ConstraintBlock& block) {
  const std::size_t i = static_cast<std::size_t>(row);
  block.linear.row(row) = place.normal;
  block.angularA.row(row) = place.leverA, block.angularB.row(row) = -place.leverB;
  block.value[i] = place.gap, block.rounding[i] = place.rounding;
  block.velocityProduct[i] = place.normalRate.dot(place.velocity) + place.normal.dot(place.drift);
}

}  // namespace

ContactConstraint constraintOf(const SurfaceContact& contact, const VectorX& state) {
  CRADLE_CHECK(std::isfinite(contact.radiusA) || std::isfinite(contact.radiusB));
  if (isFace(contact.radiusA) || (isLine(contact.lineA) && !isLine(contact.lineB)))
    return constraintOf({contact.bodyB, contact.bodyA, contact.point, -contact.normal, contact.separation,
                         contact.radiusB, contact.radiusA, contact.lineB, contact.lineA, contact.rimAxis},
                        state);
  const double half = 0.5 * contact.separation;
  const double depthB = contact.radiusB > 0 && !isFace(contact.radiusB) ? contact.radiusB : 0;
  ContactConstraint constraint;
  constraint.centerA = attachmentAt(contact.bodyA, contact.point - (half + contact.radiusA) * contact.normal, state);
  if (!contact.rimAxis.isZero(0)) {
    const Vec3& axis = contact.rimAxis;
    const Vec3 down = (contact.normal - contact.normal.dot(axis) * axis).normalized();
    constraint.centerA =
        attachmentAt(contact.bodyA, contact.point - half * contact.normal - contact.radiusA * down, state);
    constraint.rimAxisA = inFrameOf(contact.bodyA, axis, state);
  }
  constraint.radiusA = contact.radiusA;
  constraint.surfaceB = attachmentAt(contact.bodyB, contact.point + (half + depthB) * contact.normal, state);
  constraint.radiusB = contact.radiusB;
  constraint.lineB = inFrameOf(contact.bodyB, contact.lineB, state);
  const bool isReversed = contact.lineA.cross(contact.lineB).dot(contact.normal) > 0;  // the normal is out of B
  constraint.lineA = inFrameOf(contact.bodyA, isReversed ? Vec3(-contact.lineA) : contact.lineA, state);
  constraint.normalB = inFrameOf(contact.bodyB, -contact.normal, state);
  return constraint;
}

void setSlidingDirection(ContactConstraint& contact, const Vec3& direction, const VectorX& state) {
  contact.slidingDirection = inFrameOfB(contact, direction, state);
}

Vec3 inFrameOfB(const ContactConstraint& contact, const Vec3& vector, const VectorX& state) {
  return inFrameOf(contact.surfaceB.body, vector, state);
}

ContactKinematics kinematicsOf(const ContactConstraint& contact, const VectorX& state,
                               const std::vector<BodyFrame>& frames) {
  const int bodyA = contact.centerA.body, bodyB = contact.surfaceB.body;
  const AttachmentMotion a = motionOf(contact.centerA, state, frames), b = motionOf(contact.surfaceB, state, frames);
  const Vec3 spinA = spinOf(bodyA, state), spinB = spinOf(bodyB, state);
  const Vec3 velocity = velocityOf(bodyA, state) - velocityOf(bodyB, state);
  const bool areLines = isLine(contact.lineA);
  ContactKinematics place;
  if (!areLines) placeNormal(contact, a, b, spinB, frames, place);
  const Ascent ascent = areLines ? ascentOfLine(contact, crossingOf(contact, a, b, spinA, spinB, frames), place)
                                 : ascentOf(contact, place, spinA, frames);
  place.leverA = a.arm.cross(place.normal);
  place.point = a.position - ascent.way;
  place.armA = a.arm - ascent.way;
  place.armB = place.point - centerOf(bodyB, state);
  place.velocity = velocity + spinA.cross(place.armA) - spinB.cross(place.armB);
  if (isRim(contact)) place.gap = (a.position - b.position).dot(place.normal) - ascent.way.dot(place.normal);
  if (isRim(contact) || areLines)
    place.leverA = place.armA.cross(place.normal), place.leverB = place.armB.cross(place.normal);
  const Vec3 armRateA = spinA.cross(a.arm) - ascent.rate;
  place.drift = spinA.cross(armRateA) - spinB.cross(armRateA + velocity);
  place.rounding = kRowRounding * (a.position.norm() + a.arm.norm() + b.arm.norm() + contact.radiusA);
  return place;
}

Vec3 tangentialVelocity(const ContactKinematics& place) {
  return place.velocity - place.velocity.dot(place.normal) * place.normal;
}

// Mirrored rather than reversed: a velocity that turns to the other side with a part across lets the direction follow
// without a jump.
void endKeptDirection(ContactConstraint& contact, double time) {
  contact.slidingDirection = givenDirection(contact, Mat3::Identity(), time);
  contact.keepsDirection = false;
}

Vec3 givenDirection(const ContactConstraint& contact, const Mat3& worldFromB, double time) {
  if (!contact.keepsDirection) return worldFromB * contact.slidingDirection;
  const Vec3 direction = contact.slidingDirection + (time - contact.directionTime) * contact.directionRate;
  return worldFromB * direction.normalized();
}

Vec3 slidingDirection(const ContactConstraint& contact, const ContactKinematics& place,
                      const std::vector<BodyFrame>& frames, double time) {
  const int body = contact.surfaceB.body;
  const Vec3 given = givenDirection(
      contact, body == kFixed ? Mat3(Mat3::Identity()) : frames[static_cast<std::size_t>(body)].rotation, time);
  if (contact.keepsDirection) return (given - given.dot(place.normal) * place.normal).normalized();
  const Vec3 velocity = tangentialVelocity(place);
  const double slow = contact.slowSliding, fast = kFastSliding * slow;
  if (velocity.dot(given) > 0 && velocity.squaredNorm() > fast * fast) return velocity.normalized();
  const Vec3 side = (given - given.dot(place.normal) * place.normal).normalized();
  const double along = velocity.dot(side);
  const double speed = 1 + velocity.squaredNorm() / (slow * slow);
  const double weight = slow / (speed * speed * speed * speed);
  return (velocity + (std::abs(along) - along + weight) * side).normalized();
}

void findRows(const ContactConstraint& contact, const ContactKinematics& place, bool withTangents,
              ConstraintBlock& block) {
  block.bodyA = contact.centerA.body, block.bodyB = contact.surfaceB.body;
  block.turnsA = block.bodyA != kFixed, block.turnsB = block.bodyB != kFixed;
  block.isPoint = false;
  block.rows = withTangents ? 3 : 1;
  block.scale = 1, block.compliance = 0;
  putNormalRow(place, block.rows - 1, block);
  if (!withTangents) return;
  const Vec3 first = across(place.normal);
  putTangentRow(place, first, 0, block);
  putTangentRow(place, place.normal.cross(first), 1, block);
}

}  // namespace cradle
