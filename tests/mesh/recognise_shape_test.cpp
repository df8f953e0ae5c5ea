#include "mesh/recognise_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "sample_meshes.h"

namespace cradle {
namespace {

using std::numbers::pi;

TriangleMesh placed(const TriangleMesh& mesh, const RigidTransform& place) {
  return moved(mesh, [&](const Vec3& v) { return place * v; });
}

// As a file stores it.
TriangleMesh asFloats(const TriangleMesh& mesh) {
  return moved(mesh, [](const Vec3& v) { return Vec3(v.cast<float>().cast<double>()); });
}

std::string nameOf(const TriangleMesh& mesh) {
  return shapeName(recogniseShape(mesh));
}

template <typename Shape>
Shape expectRecognised(const TriangleMesh& mesh, const Vec3& center) {
  const RecognisedShape found = recogniseShape(mesh);
  EXPECT_TRUE(found.isConvex);
  if (!found.primitive || !std::holds_alternative<Shape>(found.primitive->shape)) {
    ADD_FAILURE() << "recognised as " << shapeName(found);
    return {};
  }
  EXPECT_LE((found.primitive->bodyFromShape.translation - center).norm(), 1e-6);
  return std::get<Shape>(found.primitive->shape);
}

TEST(RecogniseShape, BoxInItsFrameIsExact) {
  const RecognisedShape found = recogniseShape(boxMesh({1, 2, 3}));
  ASSERT_EQ(shapeName(found), "box");
  EXPECT_EQ(std::get<Box>(found.primitive->shape).size, Vec3(1, 2, 3));
  EXPECT_EQ(found.primitive->bodyFromShape.rotation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(found.primitive->bodyFromShape.translation, Vec3(0, 0, 0));
}

TEST(RecogniseShape, TurnedBoxIsPlacedWhereItIs) {
  const RigidTransform place = askew();
  const TriangleMesh mesh = asFloats(placed(boxMesh({1, 2, 3}), place));
  const RecognisedShape found = recogniseShape(mesh);
  ASSERT_EQ(shapeName(found), "box");
  // Which edge is called x is open; the corners are not.
  const PlacedPrimitive& box = *found.primitive;
  for (const Vec3& vertex : mesh.vertices) {
    const Vec3 inBox = box.bodyFromShape.inverse() * vertex;
    EXPECT_LE((inBox.cwiseAbs() - std::get<Box>(box.shape).size / 2).norm(), 1e-6);
  }
}

// As text with six decimals, the default of most programs that write OBJ files: 5e-7 m is more than 1e-6 of the size.
TriangleMesh asText(const TriangleMesh& mesh) {
  return asFloats(moved(mesh, [](const Vec3& v) { return Vec3((1e6 * v).array().round() / 1e6); }));
}

TEST(RecogniseShape, SmallShapesWrittenWithSixDecimalsAreWhatTheyAre) {
  const RigidTransform place{Quat(Eigen::AngleAxisd(0.8, Vec3(0.48, 0.6, 0.64))), {0.3, -0.2, 0.1}};
  for (const double size : {0.02, 0.1, 1.0}) {
    const auto written = [&](const DrawnMesh& drawn) { return asText(placed(solidOf(drawn), place)); };
    expectRecognised<Sphere>(written(tessellate(Sphere{size})), place.translation);
    expectRecognised<Box>(written(tessellate(Box{size * Vec3(1, 2, 3)})), place.translation);
    expectRecognised<Cylinder>(written(tessellate(Cylinder{size, 3 * size})), place.translation);
    expectRecognised<Capsule>(written(tessellate(Capsule{size, 3 * size})), place.translation);
    const TriangleMesh tapered = moved(solidOf(tessellate(Cylinder{size, 3 * size}, 24)), [&](const Vec3& v) {
      const double narrower = 1 - 0.2 * v.y() / size;
      return Vec3(narrower * v.x(), v.y(), narrower * v.z());
    });
    EXPECT_EQ(nameOf(asText(placed(tapered, place))), "convex") << size;
    EXPECT_EQ(nameOf(asText(placed(moved(lPrismMesh(), [&](const Vec3& v) { return Vec3(size * v); }), place))), "mesh")
        << size;
  }
}

// Lengths of few decimals by nature are exact.
TEST(RecogniseShape, LengthsOfFewDecimalsAreExact) {
  TriangleMesh wedge = boxMesh({1, 2, 3});
  for (Vec3& vertex : wedge.vertices)
    if (vertex.y() > 0.5 && vertex.x() > 0) vertex.y() -= 0.01;
  EXPECT_EQ(nameOf(wedge), "convex");
}

TEST(RecogniseShape, SkewedBoxIsOnlyConvex) {
  EXPECT_EQ(nameOf(moved(boxMesh({1, 2, 3}), [](const Vec3& v) { return Vec3(v.x() + 1e-5 * v.y(), v.y(), v.z()); })),
            "convex");
  EXPECT_EQ(nameOf(moved(boxMesh({1, 2, 3}), [](const Vec3& v) { return Vec3(v.x() + 1e-7 * v.y(), v.y(), v.z()); })),
            "box");
}

TEST(RecogniseShape, BoxFarAwayOrSmallIsABox) {
  EXPECT_EQ(nameOf(placed(boxMesh({1, 2, 3}), {Quat::Identity(), Vec3(4096, 0, -8192)})), "box");
  EXPECT_EQ(nameOf(boxMesh({1e-7, 2e-7, 3e-7})), "box");
}

TEST(RecogniseShape, SphereIsFoundWhereItIs) {
  EXPECT_EQ(expectRecognised<Sphere>(solidOf(tessellate(Sphere{0.3}, 32)), Vec3::Zero()).radius, 0.3);
  const TriangleMesh turned = asFloats(placed(solidOf(tessellate(Sphere{0.3}, 32)), askew()));
  // Rounded to floats at 2 m: 1.2e-7 m, less in the mean over all vertices.
  EXPECT_NEAR(expectRecognised<Sphere>(turned, askew().translation).radius, 0.3, 1e-7);
}

TEST(RecogniseShape, CoarseDentedOrStretchedSphereIsNone) {
  EXPECT_EQ(nameOf(solidOf(tessellate(Sphere{1}, 12))), "convex");  // 120 faces
  TriangleMesh mesh = solidOf(tessellate(Sphere{1}, 32));
  EXPECT_EQ(nameOf(moved(mesh, [](const Vec3& v) { return Vec3(v.x(), 1.00001 * v.y(), v.z()); })), "convex");
  mesh.vertices[40] *= 0.9;
  EXPECT_EQ(nameOf(mesh), "mesh");
}

TEST(RecogniseShape, CylinderIsFoundInAnyDirection) {
  // With length 2 r the normals have no principal axis, with length sqrt(3) r the inertia has none.
  for (const double length : {0.1, 1.0, 0.5 * std::sqrt(3), 7.0}) {
    const TriangleMesh mesh = solidOf(tessellate(Cylinder{0.5, length}, 48));
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(1, 2, -3)}) {
      const RigidTransform place{rotationBetween(Vec3::UnitY(), axis), Vec3(0.2, -0.4, 0.6)};
      const TriangleMesh turned = asFloats(placed(mesh, place));
      const Cylinder found = expectRecognised<Cylinder>(turned, place.translation);
      EXPECT_NEAR(found.radius, 0.5, 1e-6);
      EXPECT_NEAR(found.length, length, 1e-6 * (1 + length));
      const Vec3 foundAxis = recogniseShape(turned).primitive->bodyFromShape.rotation * Vec3::UnitY();
      EXPECT_LE(foundAxis.cross(axis.normalized()).norm(), 2e-6);
    }
  }
}

TEST(RecogniseShape, UprightCylinderIsExact) {
  const Cylinder found = expectRecognised<Cylinder>(solidOf(tessellate(Cylinder{0.5, 2}, 64)), Vec3::Zero());
  EXPECT_DOUBLE_EQ(found.radius, 0.5);
  EXPECT_EQ(found.length, 2);
}

TEST(RecogniseShape, FewSidedTaperedOrNotchedCylinderIsNone) {
  EXPECT_EQ(nameOf(prismMesh(16, 1, 2)), "convex");
  const TriangleMesh mesh = prismMesh(64, 1, 2);
  EXPECT_EQ(nameOf(moved(mesh, [](const Vec3& v) { return Vec3(v.x() * (1 + 1e-5 * v.y()), v.y(), v.z()); })),
            "convex");
  TriangleMesh notched = mesh;
  for (Vec3& vertex : notched.vertices)
    if (vertex.x() > 0.99) vertex.x() = 0.9;
  EXPECT_EQ(nameOf(notched), "mesh");
}

TEST(RecogniseShape, CapsuleIsFoundInAnyDirection) {
  for (const double length : {0.05, 1.0, 7.0}) {
    const TriangleMesh mesh = solidOf(tessellate(Capsule{0.5, length}, 48));
    for (const Vec3& axis : {Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(1, 2, -3)}) {
      const RigidTransform place{rotationBetween(Vec3::UnitY(), axis), Vec3(0.2, -0.4, 0.6)};
      const Capsule found = expectRecognised<Capsule>(asFloats(placed(mesh, place)), place.translation);
      EXPECT_NEAR(found.radius, 0.5, 1e-6);
      EXPECT_NEAR(found.length, length, 2e-6 * (1 + length));
    }
  }
}

TEST(RecogniseShape, EllipticCapsuleIsNone) {
  const TriangleMesh mesh = solidOf(tessellate(Capsule{0.5, 1}, 48));
  EXPECT_EQ(nameOf(moved(mesh, [](const Vec3& v) { return Vec3(v.x(), v.y(), 1.0001 * v.z()); })), "convex");
}

TEST(RecogniseShape, ConcaveMeshIsAMesh) {
  EXPECT_EQ(nameOf(lPrismMesh()), "mesh");
}

TEST(RecogniseShape, ShallowDishOfManyFacetsIsNotConvex) {
  // Each edge is bent inwards by 1e-7 of the size only, their sum by 1e-3.
  constexpr int kSide = 60;
  DrawnMesh grid;
  for (const bool isTop : {true, false})
    for (int i = 0; i <= kSide; ++i)
      for (int j = 0; j <= kSide; ++j) {
        const double x = 2.0 * i / kSide - 1, z = 2.0 * j / kSide - 1;
        grid.vertices.emplace_back(x, isTop ? 1 - 1e-3 * (1 - x * x) * (1 - z * z) : 0, z);
      }
  const auto at = [](int layer, int i, int j) {
    return static_cast<std::uint32_t>((layer * (kSide + 1) + i) * (kSide + 1) + j);
  };
  const auto addQuad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    grid.triangles.insert(grid.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      addQuad(at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j));
      addQuad(at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1));
    }
    addQuad(at(0, 0, i), at(1, 0, i), at(1, 0, i + 1), at(0, 0, i + 1));
    addQuad(at(0, kSide, i + 1), at(1, kSide, i + 1), at(1, kSide, i), at(0, kSide, i));
    addQuad(at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0), at(0, i, 0));
    addQuad(at(0, i, kSide), at(1, i, kSide), at(1, i + 1, kSide), at(0, i + 1, kSide));
  }
  EXPECT_EQ(nameOf(solidOf(grid)), "mesh");
  for (Vec3& vertex : grid.vertices) vertex.y() = vertex.y() > 0.5 ? 1 : 0;
  EXPECT_EQ(nameOf(solidOf(grid)), "convex");
}

TEST(RecogniseShape, TwoBoxesAreNotConvex) {
  const TriangleMesh one = boxMesh({1, 1, 1});
  EXPECT_EQ(nameOf(joined(one, moved(one, [](const Vec3& v) { return Vec3(v + Vec3(3, 0, 0)); }))), "mesh");
}

TEST(RecogniseShape, OpenMeshIsAMesh) {
  TriangleMesh open = boxMesh({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_EQ(nameOf(open), "mesh");
  EXPECT_EQ(nameOf({}), "mesh");
}

}  // namespace
}  // namespace cradle
