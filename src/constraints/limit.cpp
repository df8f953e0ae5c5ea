#include "constraints/limit.h"

#include <tuple>

namespace cradle {
namespace {

/// The ends of a joint between two poses of centres of mass, at rest.
ConstraintEnd endAt(const Attachment& anchor, const RigidTransform& pose, Mat3& rotation) {
  if (anchor.body == kFixed) return {anchor.point, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), nullptr};
  rotation = pose.rotation.normalized().toRotationMatrix();
  const Vec3 arm = rotation * anchor.point;
  return {pose.translation + arm, arm, Vec3::Zero(), Vec3::Zero(), &rotation};
}

RigidTransform poseOf(int body, const VectorX& state) {
  if (body == kFixed) return {};
  return {orientation(state, body), centerOfMass(state, body)};
}

void addVelocity(int body, const VectorX& state, ConstraintEnd& end) {
  if (body == kFixed) return;
  end.velocity = linearVelocity(state, body), end.angularVelocity = angularVelocity(state, body);
}

/// The coordinate's row, whose value is that of the coordinate less the bound, and its ends.
struct CoordinateRow {
  Mat3 rotationA, rotationB;
  ConstraintEnds ends;
  ConstraintBlock block;
};

void findRow(const JointLimit& limit, const VectorX& state, CoordinateRow& found) {
  const int a = limit.anchorA.body, b = limit.anchorB.body;
  found.ends = {endAt(limit.anchorA, poseOf(a, state), found.rotationA),
                endAt(limit.anchorB, poseOf(b, state), found.rotationB)};
  addVelocity(a, state, found.ends.a), addVelocity(b, state, found.ends.b);
  found.block.rows = JointCoordinate::kRows;
  found.block.bodyA = a, found.block.bodyB = b;
  putRows(limit.bound, found.ends, found.block);
}

double excessOf(const JointLimit& limit, double value, double turning) {
  if (!limit.bound.turns) return value;
  return nearestTurn(value, limit.turned + turning - limit.bound.value);
}

AttachmentMotion motionAt(const Vec3& point, int body, const VectorX& state) {
  if (body == kFixed) return {Vec3::Zero(), point, Vec3::Zero()};
  return {point - centerOfMass(state, body), point, pointVelocity(body, point, state)};
}

LimitMotion motionOf(const RopeLimit& rope, const VectorX& state) {
  LimitMotion motion{motionOf(rope.anchorA, state), motionOf(rope.anchorB, state), Vec3::Zero(), 0, 0};
  const Vec3 separation = motion.a.position - motion.b.position;
  motion.direction = separation.stableNormalized();
  motion.slackLength = rope.maxLength - separation.norm();
  motion.lengthening = motion.direction.dot(motion.a.velocity - motion.b.velocity);
  return motion;
}

LimitMotion motionOf(const JointLimit& limit, const VectorX& state) {
  CoordinateRow row;
  findRow(limit, state, row);
  const Vec3 axis = row.ends.b.turned(limit.bound.axisB);
  Vec3 point = row.ends.a.position, direction = limit.side * axis;
  if (limit.bound.turns) {
    const Vec3 arm = row.ends.a.turned(limit.bound.acrossA);
    point += limit.size * arm;
    direction = limit.side * axis.cross(arm);
  }
  LimitMotion motion{motionAt(point, limit.anchorA.body, state), motionAt(point, limit.anchorB.body, state), direction,
                     0, 0};
  motion.slackLength = -limit.side * limit.unit() * excessOf(limit, row.block.value[0], 0);
  motion.lengthening = limit.side * limit.unit() * rateOf(row.block, 0, state);
  return motion;
}

double accelerationOf(const RopeLimit& rope, const VectorX& state, const VectorX& derivative) {
  // L'' = u.(a_A - a_B) + (|v|^2 - (u.v)^2) / L for the relative velocity v.
  const LimitMotion motion = motionOf(rope, state);
  const Vec3 velocity = motion.a.velocity - motion.b.velocity;
  const Vec3 acceleration = pointAcceleration(rope.anchorA.body, motion.a.position, state, derivative) -
                            pointAcceleration(rope.anchorB.body, motion.b.position, state, derivative);
  const double across = velocity.squaredNorm() - motion.lengthening * motion.lengthening;
  return motion.direction.dot(acceleration) + across / (rope.maxLength - motion.slackLength);
}

double accelerationOf(const JointLimit& limit, const VectorX& state, const VectorX& derivative) {
  CoordinateRow row;
  findRow(limit, state, row);
  return limit.side * limit.unit() * (rateOf(row.block, 0, derivative) + row.block.velocityProduct[0]);
}

}  // namespace

std::pair<int, int> bodiesOf(const Limit& limit) {
  return std::visit([](const auto& kind) { return std::pair(kind.anchorA.body, kind.anchorB.body); }, limit);
}

double sizeOf(const Limit& limit) {
  const auto* rope = std::get_if<RopeLimit>(&limit);
  return rope ? rope->maxLength : std::get<JointLimit>(limit).size;
}

double restitutionOf(const Limit& limit) {
  return std::visit([](const auto& kind) { return kind.restitution; }, limit);
}

LimitMotion motionOf(const Limit& limit, const VectorX& state) {
  return std::visit([&state](const auto& kind) { return motionOf(kind, state); }, limit);
}

double slackOf(const JointLimit& limit, const RigidTransform& poseA, const RigidTransform& poseB, double turning) {
  Mat3 rotationA, rotationB;
  ConstraintBlock block;
  putRows(limit.bound, {endAt(limit.anchorA, poseA, rotationA), endAt(limit.anchorB, poseB, rotationB)}, block);
  return -limit.side * limit.unit() * excessOf(limit, block.value[0], turning);
}

double turningTo(const JointLimit& limit, double time, const VectorX& state) {
  CoordinateRow row;
  findRow(limit, state, row);
  return time * (limit.rate + rateOf(row.block, 0, state)) / 2;
}

void followTurn(JointLimit& limit, double time, const VectorX& state) {
  CoordinateRow row;
  findRow(limit, state, row);
  const double rate = rateOf(row.block, 0, state);
  limit.turned = limit.bound.value + excessOf(limit, row.block.value[0], time * (limit.rate + rate) / 2);
  limit.rate = rate;
}

ConstraintBlock lengtheningRow(const Limit& limit, const LimitMotion& motion) {
  const Vec3& u = motion.direction;
  ConstraintBlock block;
  std::tie(block.bodyA, block.bodyB) = bodiesOf(limit);
  block.rows = 1;
  block.turnsA = block.bodyA != kFixed, block.turnsB = block.bodyB != kFixed;
  block.linear.row(0) = u;
  block.angularA.row(0) = motion.a.arm.cross(u), block.angularB.row(0) = -motion.b.arm.cross(u);
  return block;
}

double lengtheningAcceleration(const Limit& limit, const VectorX& state, const VectorX& derivative) {
  return std::visit([&](const auto& kind) { return accelerationOf(kind, state, derivative); }, limit);
}

Constraint constraintOf(const Limit& limit) {
  if (const auto* rope = std::get_if<RopeLimit>(&limit))
    return {rope->anchorA, rope->anchorB, RodConstraint{rope->maxLength}};
  const auto& joint = std::get<JointLimit>(limit);
  return {joint.anchorA, joint.anchorB, joint.bound};
}

double tensionOf(const Limit& limit, double multiplier) {
  if (const auto* rope = std::get_if<RopeLimit>(&limit)) return -multiplier * rope->maxLength;
  const auto& joint = std::get<JointLimit>(limit);
  return -joint.side * multiplier / joint.unit();
}

}  // namespace cradle
