#include "mesh/primitives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/solid.h"
#include "sample_meshes.h"

namespace cradle {
namespace {

constexpr double kDensity = 780;

double inertiaError(const MassProperties& found, const MassProperties& exact) {
  return (found.inertiaTensor - exact.inertiaTensor).norm() / exact.inertiaTensor.norm();
}

// Vertices lie on the shape, so that a facet of angle a stands off by r (1 - cos(a / 2)): a quarter when a is halved.
// An error c a^2 (1 + k a^2) makes that ratio 4 + 3 k a^2; sine and cosine have |k| < 1/2: 0.06 for a = 2 pi / 32.
template <typename Shape>
void expectSecondOrder(const Shape& shape) {
  const MassProperties exact = massProperties(shape, kDensity);
  const auto at = [&](int segments) { return computeMassProperties(solidOf(tessellate(shape, segments)), kDensity); };
  const MassProperties coarse = at(32), medium = at(64), fine = at(128);
  EXPECT_LT(fine.mass, exact.mass);
  EXPECT_NEAR((exact.mass - coarse.mass) / (exact.mass - medium.mass), 4, 0.06);
  EXPECT_NEAR((exact.mass - medium.mass) / (exact.mass - fine.mass), 4, 0.015);
  EXPECT_NEAR(inertiaError(medium, exact) / inertiaError(fine, exact), 4, 0.03);
  EXPECT_LE(fine.centerOfMass.norm(), 1e-15);
}

TEST(Primitives, SphereMeshConvergesToClosedForm) {
  expectSecondOrder(Sphere{0.7});
}

TEST(Primitives, CylinderMeshConvergesToClosedForm) {
  expectSecondOrder(Cylinder{0.7, 1.9});
}

TEST(Primitives, CapsuleMeshConvergesToClosedForm) {
  expectSecondOrder(Capsule{0.7, 1.9});
}

TEST(Primitives, BoxMeshHasItsClosedForm) {
  const Box box{{1, 2, 3}};
  const MassProperties exact = massProperties(box, kDensity);
  const MassProperties found = computeMassProperties(solidOf(tessellate(box)), kDensity);
  EXPECT_NEAR(exact.mass, 6 * kDensity, 1e-12 * exact.mass);
  EXPECT_NEAR(exact.inertiaTensor(0, 0), 6 * kDensity * 13 / 12, 1e-12 * exact.mass);
  EXPECT_NEAR(found.mass, exact.mass, 1e-14 * exact.mass);
  EXPECT_LE(inertiaError(found, exact), 1e-14);
}

// A facet of a surface is smaller than the surface by the same factors as above.
template <typename Shape>
void expectShellOfSecondOrder(const Shape& shape) {
  const MassProperties exact = shellProperties(shape, kDensity);
  const auto at = [&](int segments) {
    return computeShellProperties(solidOf(tessellate(shape, segments)), 0.01, 100 * kDensity);
  };
  const MassProperties medium = at(64), fine = at(128);
  EXPECT_NEAR((exact.mass - medium.mass) / (exact.mass - fine.mass), 4, 0.015);
  EXPECT_NEAR(inertiaError(medium, exact) / inertiaError(fine, exact), 4, 0.03);
  EXPECT_LE(fine.centerOfMass.norm(), 1e-15);
}

TEST(Primitives, ShellsAreThoseOfTheirMeshes) {
  expectShellOfSecondOrder(Sphere{0.7});
  expectShellOfSecondOrder(Cylinder{0.7, 1.9});
  expectShellOfSecondOrder(Capsule{0.7, 1.9});
  const Box box{{1, 2, 3}};
  const MassProperties exact = shellProperties(box, kDensity);
  const MassProperties found = computeShellProperties(solidOf(tessellate(box)), 0.01, 100 * kDensity);
  EXPECT_NEAR(exact.mass, 22 * kDensity, 1e-12 * exact.mass);
  EXPECT_NEAR(found.mass, exact.mass, 1e-14 * exact.mass);
  EXPECT_LE(inertiaError(found, exact), 1e-14);
  // Of a cube of edge a: 5/18 m a^2.
  const MassProperties cube = shellProperties(Box{{2, 2, 2}}, 1);
  EXPECT_NEAR(cube.inertiaTensor(1, 1), 5.0 / 18 * 24 * 4, 1e-13);
  EXPECT_NEAR(shellProperties(Sphere{0.5}, 3).inertiaTensor(2, 2), 2.0 / 3 * 3 * std::numbers::pi * 0.25, 1e-14);
}

TEST(Primitives, CapsuleWithoutLengthIsSphere) {
  const MassProperties capsule = massProperties(Capsule{0.3, 0}, kDensity),
                       sphere = massProperties(Sphere{0.3}, kDensity);
  EXPECT_NEAR(capsule.mass, sphere.mass, 1e-15 * sphere.mass);
  EXPECT_LE(inertiaError(capsule, sphere), 1e-15);
}

TEST(Primitives, ClosedFormsMatchReferenceNumbers) {
  const MassProperties sphere = massProperties(Sphere{1}, 1), cylinder = massProperties(Cylinder{1, 2}, 1);
  EXPECT_NEAR(sphere.mass, 4.1887902047863909846, 1e-15);
  EXPECT_NEAR(sphere.inertiaTensor(1, 1), 1.6755160819145563938, 1e-15);
  EXPECT_NEAR(cylinder.mass, 6.2831853071795864769, 1e-15);
  EXPECT_NEAR(cylinder.inertiaTensor(0, 0), 3.6651914291880921115, 1e-15);
  EXPECT_NEAR(cylinder.inertiaTensor(1, 1), 3.1415926535897932385, 1e-15);
  EXPECT_EQ(cylinder.inertiaTensor(0, 0), cylinder.inertiaTensor(2, 2));
}

void expectWellDrawn(const DrawnMesh& mesh, double largestTurn) {
  EXPECT_TRUE(checkSolid(solidOf(mesh)).isSolid);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.materials.size(), 1U);
  EXPECT_EQ(mesh.materials[0].triangleCount, mesh.triangles.size());
  for (const Vec3f& normal : mesh.normals) EXPECT_NEAR(normal.norm(), 1, 2e-7);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 face = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).normalized();
    for (const std::uint32_t corner : {a, b, c})
      EXPECT_GE(face.dot(mesh.normals[corner].cast<double>()), std::cos(largestTurn));
  }
}

TEST(Primitives, MeshesAreSolidsWithOutwardNormals) {
  // A facet's normal differs from that at its corners by at most half its angle either way; 1.5 covers both ways.
  const double facet = 2 * std::numbers::pi / 32;
  expectWellDrawn(tessellate(Sphere{2}, 32), 1.5 * facet);
  expectWellDrawn(tessellate(Cylinder{2, 0.3}, 32), 1.5 * facet);
  expectWellDrawn(tessellate(Capsule{2, 0.3}, 32), 1.5 * facet);
  expectWellDrawn(tessellate(Box{{1, 2, 3}}), 1e-6);
  EXPECT_EQ(tessellate(Box{{1, 2, 3}}).vertices.size(), 24U);
}

}  // namespace
}  // namespace cradle
