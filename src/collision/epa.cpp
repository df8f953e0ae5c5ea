// EPA: G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", GDC 2001: a
// polytope inside the difference A - B is expanded by support points where its surface is nearest to the origin. The
// distance of its nearest face bounds the depth from below, what the best normal sees bounds it from above. Round
// surfaces are not approached by ever more faces: from a face's normal the exact maximum near it is climbed to (see
// hill_climbing), and faces then only have to prove that no other one is better. The polytope need not hold the origin:
// distances of faces have signs, so that cores that only touch are no special case.

#include "collision/epa.h"

#include <array>

#include "collision/gjk.h"
#include "collision/hill_climbing.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxPoints = 128;
constexpr std::size_t kMaxFaces = 2 * kMaxPoints - 4;
constexpr std::size_t kMaxClimbs = 8;
constexpr double kProven = 1e-3;        // of the depth: faces so near to it leave no better way out
constexpr double kRounding = 1e-14;     // of the size
constexpr double kGrazing = 1e-12;      // of the size: cores as deep in each other only touch
constexpr double kPromising = 0.2;      // of the depth: normals that see an overlap larger by less are climbed from,
constexpr double kShallow = 0.002;      // of the size: as if it were no less deep,
constexpr double kCoarse = 0.05;        // of depth and size: faces farther inside the surface have another normal
constexpr double kOtherCosine = 0.995;  // if 0.1 rad from those climbed to or from

/// A convex polytope of triangles.
class ExpandingPolytope {
 public:
  struct Face {
    std::array<std::uint32_t, 3> corners;  // counter-clockwise seen from outside
    Vec3 normal;                           // unit, outwards
    double offset;                         // m, from the origin
  };

  /// A tetrahedron. The points must not lie in one plane.
  ExpandingPolytope(const std::array<Vec3, 4>& corners, double size) : rounding_(kRounding * size) {
    for (std::size_t i = 0; i < 4; ++i) points_[i] = corners[i];
    pointCount_ = 4;
    const Vec3 up = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const bool isAbove = up.dot(corners[3] - corners[0]) > 0;
    isSound_ = isAbove ? add(0, 2, 1) && add(0, 1, 3) && add(1, 2, 3) && add(2, 0, 3)
                       : add(0, 1, 2) && add(1, 0, 3) && add(2, 1, 3) && add(0, 2, 3);
  }

  bool isSound() const { return isSound_; }
  bool isFull() const { return pointCount_ == kMaxPoints; }

  const Face& nearest() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < faceCount_; ++i)
      if (faces_[i].offset < faces_[best].offset) best = i;
    return faces_[best];
  }

  /// Joins the edges around the faces that see a point to it. False if that is within rounding: nothing to gain.
  bool expand(const Vec3& point) {
    std::size_t rim = 0, kept = 0;
    const auto cross = [&](std::uint32_t from, std::uint32_t to) {
      for (std::size_t i = 0; i < rim; ++i)
        if (rim_[i][0] == to && rim_[i][1] == from) return void(rim_[i] = rim_[--rim]);
      rim_[rim++] = {from, to};
    };
    for (std::size_t i = 0; i < faceCount_; ++i) {
      const Face face = faces_[i];
      if (face.normal.dot(point) <= face.offset + rounding_)
        faces_[kept++] = face;
      else
        for (std::size_t k = 0; k < 3; ++k) cross(face.corners[k], face.corners[(k + 1) % 3]);
    }
    if (rim < 3) return false;
    faceCount_ = kept;
    const auto corner = static_cast<std::uint32_t>(pointCount_);
    points_[pointCount_++] = point;
    for (std::size_t i = 0; i < rim; ++i)
      if (!add(rim_[i][0], rim_[i][1], corner)) return false;
    return true;
  }

 private:
  bool add(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const Vec3 area = (points_[j] - points_[i]).cross(points_[k] - points_[i]);
    const double length = area.norm();
    if (!(length > 0) || faceCount_ == kMaxFaces) return false;
    const Vec3 normal = area / length;
    faces_[faceCount_++] = {{i, j, k}, normal, normal.dot(points_[i])};
    return true;
  }

  double rounding_;  // m
  std::array<Vec3, kMaxPoints> points_;
  std::array<Face, kMaxFaces> faces_;
  std::array<std::array<std::uint32_t, 2>, 3 * kMaxFaces> rim_;
  std::size_t pointCount_ = 0, faceCount_ = 0;
  bool isSound_ = false;
};

/// Of two points the one farther from a plane through `from`.
Vec3 farther(const Vec3& one, const Vec3& other, const Vec3& from, const Vec3& normal) {
  return std::abs(normal.dot(one - from)) < std::abs(normal.dot(other - from)) ? other : one;
}

class Search {
 public:
  Search(const Core& a, const Core& b)
      : a_(a), b_(b), size_(std::min(a.collider().boundingRadius, b.collider().boundingRadius)) {}

  SeparatingAxis find() {
    ExpandingPolytope hull(firstCorners(), size_);
    Vec3 normal = Vec3::UnitY();
    while (hull.isSound() && !hull.isFull()) {
      if (best_.separation >= -kGrazing * size_) break;  // no way out is shorter by more than that
      const ExpandingPolytope::Face& face = hull.nearest();
      if (face.offset >= -best_.separation - kProven * std::abs(best_.separation) - kRounding * size_) break;
      normal = face.normal;
      const Vec3 point = difference(normal);
      if (point.dot(normal) - face.offset <= kCoarse * (std::abs(face.offset) + size_))
        tryFrom({-point.dot(normal), normal});
      if (!hull.expand(point)) break;
    }
    if (climbCount_ == 0) best_ = climbedSupportGap({0, normal}, a_, b_);  // flat to rounding
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

  void tryFrom(const SeparatingAxis& start) {
    if (climbCount_ + 2 > climbed_.size()) return;
    if (start.separation <= best_.separation + kRounding * size_) {  // else a climb has stopped too early
      if (start.separation < best_.separation - kPromising * (std::abs(best_.separation) + kShallow * size_)) return;
      for (std::size_t i = 0; i < climbCount_; ++i)
        if (climbed_[i].dot(start.normal) > kOtherCosine) return;
    }
    const SeparatingAxis top = climbedSupportGap(start, a_, b_);
    climbed_[climbCount_++] = start.normal, climbed_[climbCount_++] = top.normal;
    if (top.separation > best_.separation) best_ = top;
  }

  const Core &a_, &b_;
  double size_;  // m
  SeparatingAxis best_;
  std::array<Vec3, 2 * kMaxClimbs> climbed_;  // from and to: unit normals
  std::size_t climbCount_ = 0;
};

}  // namespace

SeparatingAxis deepestAxis(const Core& a, const Core& b) {
  return Search(a, b).find();
}

}  // namespace cradle
