#include "impact/contact_newton.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "impact/friction_cone.h"

namespace cradle {
namespace {

constexpr double kShift = 1e-9;

Vec3 newtonValue(const Vec3& z, const Vec3& u, double friction) {
  return newtonRow(z, u, friction, 0).value;
}

TEST(NewtonRow, IsOfContactsWhoseImpulseIsAboveTheirVelocity) {
  EXPECT_TRUE(pushes(Vec3(9, 9, 1), Vec3(0, 0, 0.9)));
  EXPECT_FALSE(pushes(Vec3(9, 9, 1), Vec3(0, 0, 1)));
  EXPECT_FALSE(pushes(Vec3(0, 0, 0), Vec3(0, 0, 0.1)));
}

// Each state of Coulomb's law is a root; friction that helps the sliding, that is too weak, or that lets a sticking
// contact creep is none.
TEST(NewtonRow, IsZeroWhereCoulombsLawHoldsAlone) {
  const double mu = 0.5;
  const Vec3 sliding(0.3, -0.4, 0), held(-0.6, 0.8, 2);  // |held_t| = 0.5 x 2, against the sliding
  EXPECT_LT(newtonValue(held, sliding, mu).norm(), 1e-15);
  EXPECT_EQ(newtonValue(Vec3(0.5, 0.6, 2), Vec3::Zero(), mu), Vec3::Zero());
  EXPECT_LT(newtonValue(Vec3(0, 0, 2), sliding, 0).norm(), 1e-15);
  EXPECT_GT(newtonValue(Vec3(0.6, -0.8, 2), sliding, mu).norm(), 0.4);
  EXPECT_GT(newtonValue(Vec3(-0.5, 0.6, 2), sliding, mu).norm(), 0.2);
  EXPECT_GT(newtonValue(Vec3(0.1, 0, 2), Vec3(1e-3, 0, 0), mu).norm(), 0.9e-3);
  EXPECT_EQ(newtonValue(held, Vec3(0.3, -0.4, 0.1), mu).z(), 0.1);
  // Without friction nothing sticks, whatever pulls: the equation is that of the impulse.
  EXPECT_EQ(newtonRow(Vec3(0.1, 0, 2), Vec3(0.1, 0, 0), 0, 0).equation.ofImpulse(0, 0), 1);
}

// The matrices of a step are the derivatives of the function, by central differences: with steps of 1e-5 their own
// error is 1e-10 of third derivatives of a few ones, and rounding 2e-16 / 1e-5.
TEST(NewtonRow, HasTheDerivativesOfItsFunction) {
  const double h = 1e-5, tolerance = 1e-9;
  const struct {
    Vec3 z, u;
    double friction;
  } cases[] = {{{0.1, -0.2, 2}, {0.05, 0.1, 0.3}, 0.5},     // sticks
               {{-0.9, 1.3, 2}, {0.4, -0.7, 0.2}, 0.5},     // slides
               {{0.2, 0.1, 0.5}, {-0.6, 0.8, -0.4}, 0.3},   // slides
               {{0.2, 0.1, 0.5}, {-0.6, 0.8, -0.4}, 0.0}};  // without friction
  for (const auto& [z, u, friction] : cases) {
    const ContactEquation equation = newtonRow(z, u, friction, kShift).equation;
    EXPECT_FALSE(equation.isOpen);
    Mat3 ofImpulse, ofVelocity;
    for (int i = 0; i < 3; ++i) {
      const Vec3 d = h * Vec3::Unit(i);
      ofImpulse.col(i) = (newtonValue(z + d, u, friction) - newtonValue(z - d, u, friction)) / (2 * h);
      ofVelocity.col(i) = (newtonValue(z, u + d, friction) - newtonValue(z, u - d, friction)) / (2 * h);
    }
    EXPECT_LT((equation.ofVelocity - ofVelocity).norm(), tolerance) << z.transpose();
    // The shift is added where the impulse is not in the equation: to all of a sticking contact, else to the normal.
    const bool slides = !ofImpulse.isZero(tolerance) || friction == 0;
    const Mat3 shift = kShift * Mat3(Vec3(slides ? 0 : 1, slides ? 0 : 1, 1).asDiagonal());
    EXPECT_LT((equation.ofImpulse - ofImpulse - shift).norm(), slides ? tolerance : 1e-20) << z.transpose();
  }
}

// Next to sticking, dF/dz would be singular across the pull; it stays invertible there.
TEST(NewtonRow, IsRegularAtTheBorderOfSticking) {
  const Vec3 z(0.6 * (1 + 1e-15), 0.8 * (1 + 1e-15), 2);
  const NewtonRow row = newtonRow(z, Vec3::Zero(), 0.5, 1);
  EXPECT_NE(row.value.head<2>().norm(), 0);  // slides
  const double determinant = row.equation.ofImpulse.determinant();
  EXPECT_GT(determinant, 1e-14);
  EXPECT_LT(determinant, 1e-12);
}

// From an error of 1e-2 on, quadratic convergence has errors of about 1e-4, 1e-8 and 1e-16.
TEST(NewtonRow, LeadsToCoulombsLawQuadratically) {
  Mat3 delassus;
  delassus << 1.2, 0.1, -0.2, 0.1, 0.9, 0.3, -0.2, 0.3, 0.8;
  const double mu = 0.4;
  const Vec3 root(-0.24, 0.32, 1), slip(0.3, -0.4, 0), free = slip - delassus * root;
  Vec3 z = root + 1e-2 * Vec3(0.3, 0.8, -0.5);
  for (const double largest : {1e-3, 1e-6, 1e-12}) {
    const NewtonRow row = newtonRow(z, delassus * z + free, mu, 0);
    const Mat3 matrix = row.equation.ofImpulse + row.equation.ofVelocity * delassus;
    z -= matrix.partialPivLu().solve(row.value);
    EXPECT_LT((z - root).norm(), largest);
  }
  EXPECT_LT(coulombResidual(z, delassus * z + free, mu).norm(), 1e-15);
}

}  // namespace
}  // namespace cradle
