// EPA: G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", GDC 2001. A
// polytope inside the Minkowski difference A - B is expanded by support points where its surface is nearest to the
// origin. The depth lies between the distance of the nearest face (lower bound) and the overlap that the best normal
// sees (upper bound). Round surfaces are not approached by ever more faces: hill climbing leads from a face's normal to
// the exact local maximum near it, and more faces only have to prove that no other maximum is better. The polytope need
// not hold the origin: distances of faces have signs, so that cores that only touch are no special case.

#include "collision/epa.h"

#include <array>

#include "collision/convex_tolerances.h"
#include "collision/gjk.h"
#include "collision/hill_climbing.h"

namespace cradle {
namespace {

// Points of the polytope: 20 to 100 are usual; where these are too few, the best normal so far is taken.
constexpr std::size_t kMaxPolytopePoints = 128;
constexpr std::size_t kMaxPolytopeFaces = 2 * kMaxPolytopePoints - 4;  // Euler's formula for a closed triangle mesh
constexpr std::size_t kMaxClimbs = 8;  // where these are too few, the best normal so far is taken
// Of the depth: the search ends when the bounds on the depth are as near to each other. That is the error that the
// header states: of ways out that differ by less, either may be taken.
constexpr double kProvenRatio = 1e-3;
// A face's normal is climbed from if three things hold. They save climbs. With a tenth of kCoarseRatio maxima of
// aligned cylinders are missed; a tenth or ten times as much of any other changes no test. First, the surface is nearer
// to the face than this part of depth and size: the normal is that of the surface there.
constexpr double kCoarseRatio = 0.05;
// Second, the normal sees no more overlap than the best one but for this part of the depth. Depths count here as larger
// by a part of the size, so that shallow ones do not exclude all normals.
constexpr double kPromisingRatio = 0.2, kShallowRatio = 0.002;
// Third, it is 0.1 rad away from the normals that climbs have begun and ended at.
constexpr double kOtherCosine = 0.995;

/// A convex polytope of triangles.
class ExpandingPolytope {
 public:
  struct Face {
    std::array<std::uint32_t, 3> corners;  // counter-clockwise seen from outside
    Vec3 normal;                           // unit, outwards
    double offset;                         // m, from the origin
  };

  /// A tetrahedron. The points must not lie in one plane. `rounding` (m) is that of a point's height over a face.
  ExpandingPolytope(const std::array<Vec3, 4>& corners, double rounding) : rounding_(rounding) {
    for (std::size_t i = 0; i < 4; ++i) points_[i] = corners[i];
    pointCount_ = 4;
    const Vec3 up = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const bool isAbove = up.dot(corners[3] - corners[0]) > 0;
    isSound_ = isAbove ? add(0, 2, 1) && add(0, 1, 3) && add(1, 2, 3) && add(2, 0, 3)
                       : add(0, 1, 2) && add(1, 0, 3) && add(2, 1, 3) && add(0, 2, 3);
  }

  bool isSound() const { return isSound_; }
  bool isFull() const { return pointCount_ == kMaxPolytopePoints; }

  const Face& nearest() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < faceCount_; ++i)
      if (faces_[i].offset < faces_[best].offset) best = i;
    return faces_[best];
  }

  /// Replaces the faces that see a point by those between it and their outline. False if no face sees it by more than
  /// rounding, or if a new face has no area.
  bool expand(const Vec3& point) {
    std::size_t sides = 0, kept = 0;  // edges of the outline; faces that do not see the point
    // An edge between two faces that see the point comes twice, in opposite directions: it is not of the outline.
    const auto addSide = [&](std::uint32_t from, std::uint32_t to) {
      for (std::size_t i = 0; i < sides; ++i)
        if (outline_[i][0] == to && outline_[i][1] == from) return void(outline_[i] = outline_[--sides]);
      outline_[sides++] = {from, to};
    };
    for (std::size_t i = 0; i < faceCount_; ++i) {
      const Face face = faces_[i];
      if (face.normal.dot(point) <= face.offset + rounding_)
        faces_[kept++] = face;
      else
        for (std::size_t k = 0; k < 3; ++k) addSide(face.corners[k], face.corners[(k + 1) % 3]);
    }
    if (sides < 3) return false;
    faceCount_ = kept;
    const auto corner = static_cast<std::uint32_t>(pointCount_);
    points_[pointCount_++] = point;
    for (std::size_t i = 0; i < sides; ++i)
      if (!add(outline_[i][0], outline_[i][1], corner)) return false;
    return true;
  }

 private:
  bool add(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const Vec3 area = (points_[j] - points_[i]).cross(points_[k] - points_[i]);
    const double length = area.norm();
    if (!(length > 0) || faceCount_ == kMaxPolytopeFaces) return false;
    const Vec3 normal = area / length;
    faces_[faceCount_++] = {{i, j, k}, normal, normal.dot(points_[i])};
    return true;
  }

  double rounding_;  // m
  std::array<Vec3, kMaxPolytopePoints> points_;
  std::array<Face, kMaxPolytopeFaces> faces_;
  std::array<std::array<std::uint32_t, 2>, 3 * kMaxPolytopeFaces> outline_;
  std::size_t pointCount_ = 0, faceCount_ = 0;
  bool isSound_ = false;
};

/// Of two points the one farther from a plane through `from`.
Vec3 farther(const Vec3& one, const Vec3& other, const Vec3& from, const Vec3& normal) {
  return std::abs(normal.dot(one - from)) < std::abs(normal.dot(other - from)) ? other : one;
}

/// The search for the normal that sees the least overlap.
class DepthSearch {
 public:
  DepthSearch(const Core& a, const Core& b) : a_(a), b_(b), tolerances_(a, b) {}

  SeparatingAxis find() {
    ExpandingPolytope polytope(firstCorners(), tolerances_.gapRounding);
    Vec3 normal = Vec3::UnitY();
    while (polytope.isSound() && !polytope.isFull()) {
      if (best_.separation >= -tolerances_.touching) break;  // no other way out is shorter by more than that
      const ExpandingPolytope::Face& face = polytope.nearest();
      if (face.offset >= -best_.separation - kProvenRatio * std::abs(best_.separation) - tolerances_.gapRounding) break;
      normal = face.normal;
      const Vec3 point = difference(normal);
      if (point.dot(normal) - face.offset <= kCoarseRatio * (std::abs(face.offset) + tolerances_.size))
        tryFrom({-point.dot(normal), normal});
      if (!polytope.expand(point)) break;
    }
    if (climbCount_ == 0) best_ = climbedSupportGap({0, normal}, a_, b_);  // A - B is flat to rounding
    return best_;
  }

 private:
  Vec3 difference(const Vec3& direction) const { return a_.supportPoint(direction) - b_.supportPoint(-direction); }

  std::array<Vec3, 4> firstCorners() {
    Vec3 across = a_.rimRadius() > 0 ? a_.axis() : b_.axis();
    const Vec3 first = difference(across), second = difference(-across);
    across = (second - first).unitOrthogonal();
    const Vec3 third = farther(difference(across), difference(-across), first, across);
    across = (second - first).cross(third - first).normalized();
    return {first, second, third, farther(difference(across), difference(-across), first, across)};
  }

  /// Climbs from a face's normal if that may lead to a better maximum than those known. A normal that sees more than
  /// the best one, because its climb stopped too early, always does.
  void tryFrom(const SeparatingAxis& start) {
    if (climbCount_ + 2 > climbed_.size()) return;
    if (start.separation <= best_.separation + tolerances_.gapRounding) {
      const double depth = std::abs(best_.separation) + kShallowRatio * tolerances_.size;
      if (start.separation < best_.separation - kPromisingRatio * depth) return;
      for (std::size_t i = 0; i < climbCount_; ++i)
        if (climbed_[i].dot(start.normal) > kOtherCosine) return;
    }
    const SeparatingAxis top = climbedSupportGap(start, a_, b_);
    climbed_[climbCount_++] = start.normal, climbed_[climbCount_++] = top.normal;
    if (top.separation > best_.separation) best_ = top;
  }

  const Core &a_, &b_;
  ConvexTolerances tolerances_;
  SeparatingAxis best_;
  std::array<Vec3, 2 * kMaxClimbs> climbed_;  // unit normals at the start and the end of each climb
  std::size_t climbCount_ = 0;
};

}  // namespace

SeparatingAxis deepestAxis(const Core& a, const Core& b) {
  return DepthSearch(a, b).find();
}

}  // namespace cradle
