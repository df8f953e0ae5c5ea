#include "mesh/smooth_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/number_distinct.h"

namespace cradle {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

/// The mantle of a cone with its tip at the origin, one triangle a side.
DrawnMesh coneOf(int sides, double height) {
  DrawnMesh cone;
  const auto onRim = [&](int side) {
    const double angle = kTwoPi * side / sides;
    return Vec3(std::cos(angle), -height, std::sin(angle));
  };
  for (int side = 0; side < sides; ++side) {
    const auto first = static_cast<std::uint32_t>(cone.vertices.size());
    for (const Vec3& corner : {Vec3(Vec3::Zero()), onRim(side + 1), onRim(side)}) cone.vertices.push_back(corner);
    cone.triangles.push_back({first, first + 1, first + 2});
  }
  cone.normals.assign(cone.vertices.size(), Vec3f::Zero());
  return cone;
}

void fill(DrawnMesh& mesh) {
  const Numbering positions = numberDistinct(mesh.vertices.size(), [&](std::size_t i) {
    const Vec3& v = mesh.vertices[i];
    return std::array{keyBits(v.x()), keyBits(v.y()), keyBits(v.z())};
  });
  fillMissingNormals(std::vector<Smoothing>(mesh.triangles.size(), kSmoothingUnknown), positions, mesh);
}

/// At the tip, the sides within `reach` (rad, about the axis) of a side are those whose normals are less than 40
/// degrees from its own. The sum of unit normals (sin a, cos a) r with equal height h over them has the radial part
/// r sinc(reach).
Vec3 normalAtTip(const Vec3& radial, double height) {
  const double slant = std::hypot(1, height), level = height / slant, up = 1 / slant;
  const double cosine = (0.766 - up * up) / (level * level);
  const double reach = cosine <= -1 ? std::numbers::pi : std::acos(cosine);
  return (level * std::sin(reach) / reach * radial + up * Vec3::UnitY()).normalized();
}

TEST(FillMissingNormals, OfLargeFansAreThoseOfSmallOnes) {
  for (const double height : {0.5, 1.0, 3.0})
    for (const int sides : {200, 256, 257, 1000, 20000}) {  // above 256 about equal normals count as one
      DrawnMesh cone = coneOf(sides, height);
      fill(cone);
      for (int side = 0; side < sides; side += sides / 20) {
        const double angle = kTwoPi * (side + 0.5) / sides;
        const Vec3 radial(std::cos(angle), 0, std::sin(angle));
        const Vec3 normal = cone.normals[3 * static_cast<std::size_t>(side)].cast<double>();
        // Cells of 1/32 may take in or leave out half a cell, sqrt(3)/64 = 0.027 rad, at either end of the reach, and a
        // side (2 pi / 200) does the same without cells: together less than 0.06 rad of the direction of a mean of
        // them.
        EXPECT_LT((normal - normalAtTip(radial, height)).norm(), 0.06) << sides << " sides, height " << height;
        EXPECT_FLOAT_EQ(cone.normals[3 * static_cast<std::size_t>(side)].norm(), 1.0f);
      }
    }
}

}  // namespace
}  // namespace cradle
