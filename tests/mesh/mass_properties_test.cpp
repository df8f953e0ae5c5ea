#include "mesh/mass_properties.h"
#include "core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "math/rotation.h"
#include "sample_meshes.h"

namespace cradle {
namespace {

using nlohmann::json;

// A triangle costs some twenty products and sums, each rounded once; the sum over triangles is compensated. Terms are
// as large as the result, so that 20 roundings of 1.1e-16 remain, doubled for the shift to the centre of mass.
constexpr double kRounding = 5e-15;

const json& exactCases() {
  static const json cases = json::parse(std::ifstream(CRADLE_SOURCE_DIR "/tests/mesh/r10.json"));
  return cases;
}

double fraction(const std::string& text) {
  const auto slash = text.find('/');
  return slash == std::string::npos ? std::stod(text) : std::stod(text) / std::stod(text.substr(slash + 1));
}

Vec3 vectorOf(const json& texts) {
  return {fraction(texts[0]), fraction(texts[1]), fraction(texts[2])};
}

Mat3 matrixOf(const json& rows) {
  Mat3 matrix;
  for (int row = 0; row < 3; ++row) matrix.row(row) = vectorOf(rows[static_cast<std::size_t>(row)]);
  return matrix;
}

// All exact cases are small polyhedra with convex faces: fans will do.
TriangleMesh meshOf(const json& text) {
  TriangleMesh mesh;
  for (const json& vertex : text["V"]) mesh.vertices.push_back(vectorOf(vertex));
  for (const json& face : text["F"])
    for (std::size_t corner = 2; corner < face.size(); ++corner)
      mesh.triangles.push_back({face[0], face[corner - 1], face[corner]});
  return mesh;
}

void expectNear(const MassProperties& found, const MassProperties& expected, double tolerance) {
  const double inertia = expected.inertiaTensor.trace(), size = std::sqrt(inertia / expected.mass);
  EXPECT_NEAR(found.mass, expected.mass, tolerance * expected.mass);
  EXPECT_LE((found.centerOfMass - expected.centerOfMass).norm(), tolerance * (size + expected.centerOfMass.norm()));
  EXPECT_LE((found.inertiaTensor - expected.inertiaTensor).norm(), tolerance * inertia)
      << found.inertiaTensor << "\n instead of\n"
      << expected.inertiaTensor;
}

class ExactMassProperties : public testing::TestWithParam<std::string> {};

TEST_P(ExactMassProperties, AreReproduced) {
  const json& exact = exactCases()["cases"][GetParam()];
  const MassProperties expected{fraction(exact["volume"]), vectorOf(exact["com"]), matrixOf(exact["I_com"])};
  const MassProperties found = computeMassProperties(meshOf(exact["mesh"]), 1);
  expectNear(found, expected, kRounding);

  // Steiner's theorem leads back to the tensor about the origin.
  const Mat3 cross = skew(found.centerOfMass);
  const Mat3 aboutOrigin = found.inertiaTensor - found.mass * cross * cross;
  EXPECT_LE((aboutOrigin - matrixOf(exact["I_origin"])).norm(), kRounding * aboutOrigin.trace());
}

INSTANTIATE_TEST_SUITE_P(MassProperties, ExactMassProperties,
                         testing::Values("box_2x3x4_centred", "box_2x3x4_corner_at_(1,2,3)", "tetrahedron_unit",
                                         "tetrahedron_scalene", "L_prism_concave"),
                         [](const auto& info) {
                           std::string name;
                           for (const char c : info.param)
                             if (std::isalnum(c)) name += c;
                           return name;
                         });

TEST(MassProperties, BoxFarFromOriginMatchesClosedForm) {
  // All coordinates are integers or halves, exact at 2.3e6; only the shift of the centre is rounded there.
  const Vec3 far(2.3e6, -1.7e6, 0.9e6), size(1, 2, 3);
  const TriangleMesh mesh = moved(boxMesh(size), [&](const Vec3& v) { return Vec3(v + far); });
  const MassProperties found = computeMassProperties(mesh, 1000);
  EXPECT_NEAR(found.mass, 6000, kRounding * 6000);
  EXPECT_EQ(found.centerOfMass, far);
  const Vec3 expected(6500, 5000, 2500);  // 6000 / 12 (b^2 + c^2)
  EXPECT_LE((found.inertiaTensor - Mat3(expected.asDiagonal())).norm(), kRounding * expected.sum());
}

TEST(MassProperties, ConcaveSolidFarFromOriginKeepsItsProducts) {
  const Vec3 far(2.3e6, -1.7e6, 0.9e6);
  const MassProperties here = computeMassProperties(lPrismMesh(), 1);
  const MassProperties there =
      computeMassProperties(moved(lPrismMesh(), [&](const Vec3& v) { return Vec3(v + far); }), 1);
  EXPECT_LE((there.inertiaTensor - here.inertiaTensor).norm(), kRounding * here.inertiaTensor.trace());
  // 4.7e-10 is the distance between doubles at 2.3e6.
  EXPECT_LE((there.centerOfMass - far - here.centerOfMass).norm(), 4.7e-10);
}

TEST(MassProperties, TurnWithTheBody) {
  const RigidTransform place = askew();
  const MassProperties before = computeMassProperties(lPrismMesh(), 2.5);
  const MassProperties after =
      computeMassProperties(moved(lPrismMesh(), [&](const Vec3& v) { return place * v; }), 2.5);
  const Mat3 rotation = place.rotation.toRotationMatrix();
  // The turned vertices are rounded themselves: 1.1e-16 of coordinates up to 4, for a body of 1 to 3.
  expectNear(after, {before.mass, place * before.centerOfMass, rotation * before.inertiaTensor * rotation.transpose()},
             4 * kRounding);
}

TEST(MassProperties, ScaleWithDensityAndSize) {
  const MassProperties one = computeMassProperties(lPrismMesh(), 1);
  const MassProperties scaled =
      computeMassProperties(moved(lPrismMesh(), [](const Vec3& v) { return Vec3(1e-3 * v); }), 7800);
  expectNear(scaled, {7800e-9 * one.mass, 1e-3 * one.centerOfMass, 7800e-15 * one.inertiaTensor}, 2 * kRounding);
}

TEST(MassProperties, CavityIsSubtracted) {
  const Vec3 outer(4, 5, 6), inner(1, 2, 3), at(0.5, -0.25, 1);
  const TriangleMesh cavity = moved(boxMesh(inner), [&](const Vec3& v) { return Vec3(v + at); });
  const MassProperties found = computeMassProperties(joined(boxMesh(outer), insideOut(cavity)), 1);
  EXPECT_NEAR(found.mass, 114, kRounding * 114);
  EXPECT_LE((found.centerOfMass + 6 * at / 114).norm(), kRounding * 6);
}

TEST(MassProperties, FacetedCylinderMatchesExactPrism) {
  for (const auto& [corners, ratio] : exactCases()["facetedCylinder"]["areaRatio"].items()) {
    const TriangleMesh mesh = prismMesh(std::stoi(corners), 1, 2);
    const MassProperties found = computeMassProperties(mesh, 1);
    const double mass = 2 * std::numbers::pi * fraction(ratio);
    const double axial = fraction(exactCases()["facetedCylinder"]["axialInertiaOverMass"][corners]);
    EXPECT_NEAR(found.mass, mass, 2 * kRounding * mass);  // sine and cosine of the corners are rounded too
    EXPECT_NEAR(found.inertiaTensor(1, 1), axial * mass, 2 * kRounding * mass);
  }
}

TEST(SignedVolume, IsNegativeInsideOut) {
  EXPECT_NEAR(signedVolume(lPrismMesh()), 4, 4 * kRounding);
  EXPECT_NEAR(signedVolume(insideOut(lPrismMesh())), -4, 4 * kRounding);
  EXPECT_EQ(signedVolume({}), 0);
}

TEST(MassProperties, InsideOutMeshIsOurOwnMistake) {
  EXPECT_THROW(computeMassProperties(insideOut(lPrismMesh()), 1), FailedCheck);
  EXPECT_THROW(computeMassProperties(lPrismMesh(), 0), FailedCheck);
}

}  // namespace
}  // namespace cradle
