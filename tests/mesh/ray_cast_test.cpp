#include "mesh/ray_cast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh/sample_meshes.h"

namespace cradle {
namespace {

TEST(RayCast, HitsWhereClosedFormsSay) {
  const Ray along{{0.3, 0.2, 5}, {0, 0, -1}};
  EXPECT_NEAR(castRay(along, Sphere{1}).value(), 5 - std::sqrt(1 - 0.13), 1e-15);
  EXPECT_NEAR(castRay(along, Box{Vec3(2, 1, 3)}).value(), 3.5, 1e-15);
  EXPECT_NEAR(castRay(along, Cylinder{1, 1}).value(), 5 - std::sqrt(1 - 0.09), 1e-15);
  EXPECT_NEAR(castRay(along, Capsule{1, 1}).value(), 5 - std::sqrt(1 - 0.09), 1e-15);
  const Ray down{{0.3, 5, 0.4}, {0, -1, 0}};
  EXPECT_NEAR(castRay(down, Cylinder{1, 1}).value(), 4.5, 1e-15);
  EXPECT_NEAR(castRay(down, Capsule{1, 1}).value(), 4.5 - std::sqrt(0.75), 1e-15);
}

TEST(RayCast, MissesWhatLiesBesideOrBehind) {
  const Ray beside{{1.01, 0, 5}, {0, 0, -1}}, away{{0, 0, 5}, {0, 0, 1}};
  for (const Ray& ray : {beside, away}) {
    EXPECT_FALSE(castRay(ray, Sphere{1}));
    EXPECT_FALSE(castRay(ray, Box{Vec3(2, 2, 2)}));
    EXPECT_FALSE(castRay(ray, Cylinder{1, 1}));
    EXPECT_FALSE(castRay(ray, Capsule{1, 1}));
  }
}

TEST(RayCast, FromInsideHitsTheFarWall) {
  const Ray ray{{0.1, 0, 0}, {1, 0, 0}};
  EXPECT_NEAR(castRay(ray, Sphere{1}).value(), 0.9, 1e-15);
  EXPECT_NEAR(castRay(ray, Box{Vec3(2, 2, 2)}).value(), 0.9, 1e-15);
  EXPECT_NEAR(castRay(ray, Cylinder{1, 1}).value(), 0.9, 1e-15);
  EXPECT_NEAR(castRay(ray, Capsule{1, 1}).value(), 0.9, 1e-15);
}

// Random rays against primitives and their tessellations: two independent computations. A facet of n around lies within
// r (1 - cos(pi / n)) of the surface, which a ray at an angle of up to acos(0.2) to it meets five times as far.
template <class Primitive>
void compareWithTessellation(const Primitive& primitive, const TriangleMesh& mesh, double facetError) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 origin = 4 * point().normalized();
    const Ray ray{origin, (point() - origin).normalized()};
    const auto exact = castRay(ray, primitive), faceted = castRay(ray, mesh);
    if (!exact || !faceted) continue;  // a grazing ray may meet one alone
    const Vec3 hit = ray.origin + *exact * ray.direction;
    if (std::abs(hit.normalized().dot(ray.direction)) < 0.2) continue;
    ++hits;
    EXPECT_NEAR(*exact, *faceted, 10 * facetError) << i;
  }
  EXPECT_GT(hits, 100);
}

TEST(RayCast, AgreesWithTheTessellationOfEveryPrimitive) {
  const int segments = 256;
  const double facetError = 1 - std::cos(M_PI / segments);
  compareWithTessellation(Sphere{1}, solidOf(tessellate(Sphere{1}, segments)), facetError);
  compareWithTessellation(Box{Vec3(1, 1.5, 0.7)}, solidOf(tessellate(Box{Vec3(1, 1.5, 0.7)})), 1e-13);
  compareWithTessellation(Cylinder{0.8, 1.2}, solidOf(tessellate(Cylinder{0.8, 1.2}, segments)), facetError);
  compareWithTessellation(Capsule{0.7, 0.9}, solidOf(tessellate(Capsule{0.7, 0.9}, segments)), facetError);
}

// Rays at the shared edges and corners of a box's triangles never slip through.
TEST(RayCast, DoesNotSlipThroughEdgesAndCorners) {
  const TriangleMesh box = solidOf(tessellate(Box{Vec3(2, 2, 2)}));
  for (const double x : {-0.7, -0.1, 0.0, 0.3, 0.9})
    EXPECT_NEAR(castRay({{x, x, 5}, {0, 0, -1}}, box).value(), 4, 1e-14);
  const Vec3 corner(1, 1, 1), origin(3, 2.5, 4);
  EXPECT_NEAR(castRay({origin, (corner - origin).normalized()}, box).value(), (corner - origin).norm(), 1e-11);
}

}  // namespace
}  // namespace cradle
