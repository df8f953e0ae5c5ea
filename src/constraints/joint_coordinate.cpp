#include "constraints/joint_coordinate.h"

#include <cmath>
#include <numbers>

#include "math/elementary.h"

namespace cradle {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// dq/dt = u . (w_A - w_B) with the axis u of B, and du/dt = w_B x u.
void putTurn(const JointCoordinate& joint, const ConstraintEnds& ends, ConstraintBlock& block) {
  const Vec3 axis = ends.b.turned(joint.axisB);
  const Vec3 acrossA = ends.a.turned(joint.acrossA), acrossB = ends.b.turned(joint.acrossB);
  const SinCos value = sinCos(joint.value);
  const double sine = axis.dot(acrossB.cross(acrossA)), cosine = acrossB.dot(acrossA);
  block.linear.row(0).setZero();
  block.angularA.row(0) = axis, block.angularB.row(0) = -axis;
  block.value[0] = atan2(sine * value.cos - cosine * value.sin, cosine * value.cos + sine * value.sin);
  block.velocityProduct[0] = ends.b.angularVelocity.cross(axis).dot(ends.a.angularVelocity - ends.b.angularVelocity);
  block.rounding[0] = kRowRounding;
}

/// q = u . d with the axis u of B and d from anchor B to anchor A: as the rows of a slider.
void putSlide(const JointCoordinate& joint, const ConstraintEnds& ends, ConstraintBlock& block) {
  const auto& [a, b] = ends;
  const Vec3 d = a.position - b.position, dRate = a.pointVelocity() - b.pointVelocity();
  const Vec3 axis = b.turned(joint.axisB), axisRate = b.angularVelocity.cross(axis);
  block.linear.row(0) = axis;
  block.angularA.row(0) = a.arm.cross(axis), block.angularB.row(0) = -(b.arm + d).cross(axis);
  block.value[0] = axis.dot(d) - joint.value;
  block.velocityProduct[0] =
      axis.dot(ends.centripetalAcceleration()) + 2 * axisRate.dot(dRate) + b.angularVelocity.cross(axisRate).dot(d);
  block.rounding[0] = kRowRounding * (a.position.cwiseAbs() + a.arm.cwiseAbs() + b.arm.cwiseAbs() + d.cwiseAbs()).sum();
}

}  // namespace

double nearestTurn(double angle, double near) {
  return angle + kTurn * std::round((near - angle) / kTurn);
}

void putRows(const JointCoordinate& joint, const ConstraintEnds& ends, ConstraintBlock& block) {
  block.turnsA = ends.a.rotation, block.turnsB = ends.b.rotation;  // wherever the anchors are
  block.compliance = joint.compliance;
  joint.turns ? putTurn(joint, ends, block) : putSlide(joint, ends, block);
}

}  // namespace cradle
