// Weighted by the angle at the corner, so that it does not matter how polygons are cut into triangles (G. Thuermer,
// C. Wuethrich, "Computing vertex normals from polygonal facets", J. Graphics Tools 3(1), 1998).

#include "mesh/smooth_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <span>

#include "core/error.h"

namespace cradle {
namespace {

constexpr double kCosineOfCrease = 0.766;  // 40 degrees: between a 10-sided prism (36) and an octagonal one (45)
constexpr std::size_t kLargeFan = 256;     // corners at a position: of more, those that look alike count as one
constexpr double kFanCell = 1.0 / 32;      // of normals that look alike: 2 degrees
constexpr std::uint32_t kSeveral = 0xFFFFFFFF;

// Corners at each position: those of position p are list[start[p]] .. list[start[p + 1] - 1].
struct Fans {
  std::vector<std::uint32_t> start;
  std::vector<std::uint32_t> list;
};

Fans cornersAtPositions(const Numbering& positions) {
  Fans fans{std::vector<std::uint32_t>(positions.firstKey.size() + 1), {}};
  for (const std::uint32_t position : positions.numberOf) ++fans.start[position + 1];
  for (std::size_t p = 1; p < fans.start.size(); ++p) fans.start[p] += fans.start[p - 1];
  fans.list.resize(positions.numberOf.size());
  std::vector<std::uint32_t> next(fans.start.begin(), fans.start.end() - 1);
  for (std::uint32_t corner = 0; corner < positions.numberOf.size(); ++corner)
    fans.list[next[positions.numberOf[corner]]++] = corner;
  return fans;
}

// Arc cosine to 7e-5 (Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.45), the same bits everywhere.
float arcCosine(float x) {
  const float y = std::min(1.0f, std::abs(x));  // 1 too if x is not a number: edges of no length
  const float angle = std::sqrt(1 - y) * (1.5707288f + y * (-0.2121144f + y * (0.0742610f - y * 0.0187293f)));
  return x < 0 ? std::numbers::pi_v<float> - angle : angle;
}

// The angle with this cosine and sine, rad. The cosine of a small one is 1 to rounding, its sine is not: to the third
// order of its series the angle is right to 3/40 sine^4 of itself, 5e-7 at 0.05 rad.
float angleOf(float cosine, float sine) {
  constexpr float kSmall = 0.05f;
  if (cosine > 0 && sine < kSmall) return sine * (1 + sine * sine / 6);
  return arcCosine(cosine);
}

// The edges of a triangle, scaled so that their products neither vanish nor overflow, be they 1e-200 m or 1e200 m long.
struct Edges {
  Vec3 ab, bc, ca;
};

Edges scaledEdges(const DrawnMesh& mesh, const Triangle& triangle) {
  const Vec3 &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
  const double size = std::max((b - a).cwiseAbs().maxCoeff(), (c - a).cwiseAbs().maxCoeff());
  const double scale = 1 / std::max(size, std::numeric_limits<double>::min());
  return {scale * (b - a), scale * (c - b), scale * (a - c)};
}

Vec3 normalOf(const Edges& edges) {
  const Vec3 area = edges.ab.cross(-edges.ca);
  const double norm = area.norm();
  return norm > 0 ? Vec3(area / norm) : Vec3(Vec3::Zero());
}

// What a triangle adds to the normals at its corners.
struct Share {
  Vec3 normal;                  // unit, or zero
  std::array<float, 3> angles;  // rad, at the corners
};

std::vector<Share> shares(const DrawnMesh& mesh) {
  std::vector<Share> result;
  result.reserve(mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) {
    const Edges edges = scaledEdges(mesh, triangle);
    const Vec3f ab = edges.ab.cast<float>(), bc = edges.bc.cast<float>(), ca = edges.ca.cast<float>();
    const float ab2 = ab.squaredNorm(), bc2 = bc.squaredNorm(), ca2 = ca.squaredNorm();
    const auto twiceArea = static_cast<float>(edges.ab.cross(edges.bc).norm());
    const auto angle = [&](const Vec3f& in, const Vec3f& out, float in2, float out2) {
      const float product = std::sqrt(in2 * out2);
      return angleOf(-in.dot(out) / product, twiceArea / product);
    };
    result.push_back({normalOf(edges), {angle(ca, ab, ca2, ab2), angle(ab, bc, ab2, bc2), angle(bc, ca, bc2, ca2)}});
  }
  return result;
}

bool areSmooth(Smoothing a, Smoothing b, const Vec3& normalA, const Vec3& normalB) {
  if (a != kSmoothingUnknown && b != kSmoothingUnknown) return (a & b) != 0;
  return normalA.dot(normalB) > kCosineOfCrease;
}

// Corners at one position whose triangles are smooth with the same others.
struct FanPart {
  std::uint32_t only;   // the triangle, if it is one; else kSeveral
  Smoothing smoothing;  // theirs
  Vec3 normal;          // unit, or zero: theirs, or about
  Vec3 sum;             // of their normals, weighted by angle
};

// Each corner is a part of its own. Of a large fan, as at the tip of a cone with thousands of sides, a part is all
// corners with the same smoothing groups and about the same normal: comparing all with all would take minutes.
std::vector<FanPart> partsOfFan(std::span<const std::uint32_t> corners, const std::vector<Smoothing>& smoothing,
                                const std::vector<Share>& of) {
  std::vector<FanPart> parts;
  std::map<std::array<Smoothing, 4>, std::size_t> partAt;
  for (const std::uint32_t corner : corners) {
    const std::uint32_t own = corner / 3;
    const Vec3 &normal = of[own].normal, share = double{of[own].angles[corner % 3]} * normal;
    std::size_t part = parts.size();
    if (corners.size() > kLargeFan) {
      const auto cell = [&](int axis) { return static_cast<Smoothing>(std::lround(normal[axis] / kFanCell)); };
      part = partAt.try_emplace({smoothing[own], cell(0), cell(1), cell(2)}, part).first->second;
    }
    if (part == parts.size()) {
      parts.push_back({corners.size() > kLargeFan ? kSeveral : own, smoothing[own], normal, share});
      continue;
    }
    parts[part].sum += share;
  }
  return parts;
}

}  // namespace

Vec3 triangleNormal(const DrawnMesh& mesh, const Triangle& triangle) {
  return normalOf(scaledEdges(mesh, triangle));
}

void fillMissingNormals(const std::vector<Smoothing>& smoothing, const Numbering& positions, DrawnMesh& mesh) {
  CRADLE_CHECK(smoothing.size() == mesh.triangles.size() && mesh.normals.size() == 3 * mesh.triangles.size());
  const auto isMissing = [](const Vec3f& normal) { return normal.isZero(0); };
  if (std::none_of(mesh.normals.begin(), mesh.normals.end(), isMissing)) return;
  const Fans fans = cornersAtPositions(positions);
  const std::vector<Share> of = shares(mesh);
  for (std::size_t position = 0; position + 1 < fans.start.size(); ++position) {
    const std::span<const std::uint32_t> corners(fans.list.begin() + fans.start[position],
                                                 fans.list.begin() + fans.start[position + 1]);
    const std::vector<FanPart> parts = partsOfFan(corners, smoothing, of);
    for (const std::uint32_t corner : corners) {
      if (!isMissing(mesh.normals[corner])) continue;
      const std::uint32_t own = corner / 3;
      Vec3 sum = Vec3::Zero();  // in double: the corners of a flat face get the same float, whatever their angles
      for (const FanPart& part : parts)
        if (part.only == own || areSmooth(smoothing[own], part.smoothing, of[own].normal, part.normal)) sum += part.sum;
      if (sum.isZero(0)) sum = of[own].normal;  // opposite faces cancel
      if (sum.isZero(0)) sum = Vec3::UnitY();   // corners in line: nothing is seen of it
      mesh.normals[corner] = sum.normalized().cast<float>();
    }
  }
}

}  // namespace cradle
