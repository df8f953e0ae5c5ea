#include "constraints/slider.h"

#include "constraints/orthogonal_directions.h"

namespace cradle {

// With du/dt = w_B x u, dC/dt = u . (v_A + w_A x r_A - v_B - w_B x (r_B + d)), and
// d^2C/dt^2 = u . (accelerations of the anchors) + 2 (w_B x u) . dd/dt + (w_B x (w_B x u)) . d.
void putRows(const SliderConstraint& slider, const ConstraintEnds& ends, ConstraintBlock& block) {
  block.turnsA = ends.a.rotation, block.turnsB = ends.b.rotation;  // wherever the anchors are
  const auto& [a, b] = ends;
  const Vec3 d = a.position - b.position, dRate = a.pointVelocity() - b.pointVelocity();
  const Vec3 &armA = a.arm, armB = b.arm + d, &spinB = b.angularVelocity;  // both to anchor A
  const double size = (a.position.cwiseAbs() + a.arm.cwiseAbs() + b.arm.cwiseAbs() + d.cwiseAbs()).sum();
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3 u = b.turned(slider.acrossB[i]), uRate = spinB.cross(u);
    const Eigen::Index row = static_cast<Eigen::Index>(i);
    block.linear.row(row) = u;
    block.angularA.row(row) = armA.cross(u), block.angularB.row(row) = -armB.cross(u);
    block.value[i] = u.dot(d);
    block.velocityProduct[i] = u.dot(ends.centripetalAcceleration()) + 2 * uRate.dot(dRate) + spinB.cross(uRate).dot(d);
    block.rounding[i] = kRowRounding * size;
  }
  putSameOrientation(slider.aFromB, ends, 2, block);
}

}  // namespace cradle
