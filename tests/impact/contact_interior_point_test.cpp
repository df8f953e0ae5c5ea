#include "impact/contact_interior_point.h"

#include <gtest/gtest.h>

#include <random>

#include "impact/friction_cone.h"

namespace cradle {
namespace {

// Contacts on bodies with 12 freedoms, so that 8 of 24 rows are redundant; one in four without friction. Coulomb's law
// holds to what interior points reach before rounding rules.
TEST(ConeInterior, ComesNearASolutionOfRedundantContacts) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 20; ++trial) {
    MatrixX rows(24, 16);
    VectorX velocities(16);
    for (double& entry : rows.reshaped()) entry = 0.3 * uniform(random);
    for (double& entry : velocities) entry = uniform(random);
    const MatrixX g = rows * rows.transpose();
    const DelassusOperator op = operatorOf(g);
    ScaledContacts cones{rows * velocities, {0, 0.3, 0.5, 0.7, 0, 0.3, 0.5, 0.7}};
    for (Eigen::Index i = 0; i < 8; ++i) cones.free.segment<3>(3 * i) *= op.scales[i];
    VectorX z = VectorX::Zero(24);
    solveByInteriorPoint(cones, op, 1e-7, z);
    const VectorX u = op.multiply(z) + cones.free;
    for (Eigen::Index i = 0; i < 8; ++i) {
      const double friction = cones.frictions[static_cast<std::size_t>(i)];
      EXPECT_LT(coulombResidual(z.segment<3>(3 * i), u.segment<3>(3 * i), friction).norm(), 1e-5) << trial;
    }
  }
}

}  // namespace
}  // namespace cradle
