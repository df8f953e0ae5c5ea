#include "collision/feature_neighbour_list.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/mesh_contact.h"
#include "collision/mesh_gap.h"
#include "collision/random_poses.h"
#include "math/rotation.h"
#include "mesh/sample_meshes.h"

// A list that is kept while a body moves over another one gives the same bits as a new list at each place, and as
// searches from trees do: what it leaves out would show as another gap or another contact.

namespace cradle {
namespace {

/// A closed wheel with teeth, whose flat sides are of many triangles.
TriangleMesh wheelMesh(int teeth) {
  TriangleMesh mesh;
  const auto corners = static_cast<std::uint32_t>(4 * teeth);
  for (const double height : {-0.1, 0.1}) {
    for (std::uint32_t i = 0; i < corners; ++i) {
      const double angle = 2 * M_PI * i / corners, radius = i % 4 < 2 ? 0.5 : 0.4;
      mesh.vertices.emplace_back(radius * std::cos(angle), height, radius * std::sin(angle));
    }
    mesh.vertices.emplace_back(0, height, 0);
  }
  const std::uint32_t top = corners + 1;
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t next = (i + 1) % corners;
    mesh.triangles.push_back({corners, i, next});
    mesh.triangles.push_back({top + corners, top + next, top + i});
    mesh.triangles.push_back({i, top + i, next});
    mesh.triangles.push_back({next, top + i, top + next});
  }
  return mesh;
}

void expectSame(const MeshGap& one, const MeshGap& other) {
  EXPECT_EQ(one.separation, other.separation);
  EXPECT_EQ(one.pointA, other.pointA);
  EXPECT_EQ(one.pointB, other.pointB);
  EXPECT_EQ(one.normal, other.normal);
}

void expectSame(const std::vector<ContactPoint>& ones, const std::vector<ContactPoint>& others) {
  ASSERT_EQ(ones.size(), others.size());
  for (std::size_t i = 0; i < ones.size(); ++i) {
    EXPECT_EQ(ones[i].point, others[i].point);
    EXPECT_EQ(ones[i].normal, others[i].normal);
    EXPECT_EQ(ones[i].separation, others[i].separation);
  }
}

/// Half of a wheel's triangles, an open sheet.
MeshSurface torn() {
  TriangleMesh mesh = wheelMesh(5);
  mesh.triangles.resize(mesh.triangles.size() / 2);
  return sheetOf(mesh);
}

struct Surfaces {
  MeshSurface wheel = surfaceOf(wheelMesh(8)), other = surfaceOf(wheelMesh(5)), prism = surfaceOf(lPrismMesh());
  MeshSurface sheet = torn();
};

// Walks of steps from 1e-8 to 1e-2 m, along and about axes at random, around places where the solids touch.
TEST(FeatureNeighbourList, KeptGivesTheBitsOfANewOne) {
  const Surfaces surfaces;
  RandomPoses random(3);
  int touching = 0, overlapping = 0;
  for (const MeshSurface* b : {&surfaces.other, &surfaces.prism, &surfaces.sheet})
    for (int walk = 0; walk < 40; ++walk) {
      FeatureNeighbourList kept;
      // Every other wheel lies flat.
      RigidTransform pose = random.pose(0.5);
      if (walk % 2 == 0) pose = {rotationAbout(Vec3::UnitY(), random.number(0, 6)), Vec3(0.1, 0.2, 0.05)};
      for (int step = 0; step < 40; ++step) {
        const double length = std::pow(10, random.number(-8, -2)), margin = std::pow(10, random.number(-8, -2));
        SCOPED_TRACE(testing::Message() << walk << " " << step);
        pose = {(rotationAbout(random.direction(), length) * pose.rotation).normalized(),
                pose.translation + length * random.direction()};
        const MeshPair pair(surfaces.wheel, *b, pose);
        FeatureNeighbourList forGap, forContacts;
        const MeshGap gap = gapBetween(pair, kept, margin);
        expectSame(gap, gapBetween(pair, forGap, margin));
        std::vector<ContactPoint> found, expected;
        appendContacts(pair, kept, margin, found);
        appendContacts(pair, forContacts, margin, expected);
        expectSame(found, expected);
        touching += found.empty() ? 0 : 1;
        overlapping += gap.separation < 0 ? 1 : 0;
      }
    }
  EXPECT_GT(touching, 500);
  EXPECT_GT(overlapping, 200);
}

/// Counts features within a reach (m).
struct Counting {
  const MeshPair& pair;
  double within;
  int vertices = 0, edges = 0, crossings = 0;

  double reach() const { return within * within; }
  void vertexOverFace(Partner partner, std::uint32_t vertex, std::uint32_t face) {
    const Vec3 seen = pair.seenFromOther(partner, pair.surface(partner).vertices[vertex]);
    const FlatTriangle triangle = triangleOf(pair.surface(otherThan(partner)), face);
    vertices += std::abs(triangle.heightOf(seen)) <= within && triangle.isAbove(seen) ? 1 : 0;
  }
  void edgeOverEdge(std::uint32_t, std::uint32_t) { ++edges; }
  void edgeThroughFace(Partner, std::uint32_t, std::uint32_t) { ++crossings; }
};

// A wheel of 32 corners flat above another one: 33 of its vertices (its middle is one) are over the other's side, which
// they could touch, and none of the vertices of both rims is over a face that it is in line with.
TEST(FeatureNeighbourList, LeavesOutVerticesOverFacesThatTheirSurfaceHides) {
  const MeshSurface wheel = surfaceOf(wheelMesh(8)), plate = surfaceOf(boxMesh(Vec3(2, 0.2, 2)));
  const MeshPair pair(plate, wheel, {Quat::Identity(), Vec3(0, 0.2001, 0)});
  Counting counting{pair, 1e-3};
  FeatureNeighbourList near;
  near.visitNear(pair, counting);
  // The middle is over the diagonal of the plate, and so over both of its triangles.
  EXPECT_GE(counting.vertices, 33);
  EXPECT_LE(counting.vertices, 33 + 5);
}

// Bodies that are farther from each other than the reach have nothing near, and what is kept does not serve for ever.
TEST(FeatureNeighbourList, FollowsWhatMoves) {
  const MeshSurface wheel = surfaceOf(wheelMesh(8));
  FeatureNeighbourList near;
  for (const double height : {0.5, 0.2001, 0.5, 0.2001}) {
    const MeshPair pair(wheel, wheel, {Quat::Identity(), Vec3(0, height, 0)});
    Counting counting{pair, 1e-3};
    near.visitNear(pair, counting);
    EXPECT_EQ(counting.vertices > 0, height < 0.3) << height;
  }
}

}  // namespace
}  // namespace cradle
