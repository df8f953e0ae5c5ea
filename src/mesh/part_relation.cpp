// Two closed surfaces cross if one has points inside of the other, and points outside. Edges that pierce triangles are
// cut there; the middles of the pieces are inside or outside by the number of crossings of a ray (the parity rule; see
// J. O'Rourke, "Computational Geometry in C", 1998, 7.5). Pieces that lie on the other surface tell nothing: of boxes
// with flush sides, no more may be found, so that sides in one plane that face the same way count as inside, too. What
// is as near to the other surface as coordinates are exact is on it.

#include "mesh/part_relation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace cradle {
namespace {

constexpr double kTouching = 1e-6;  // of the smaller part's diagonal: as near, surfaces touch
constexpr double kSinglePrecision =
    1.2e-7;                               // of coordinates: two roundings of single precision, in which files hold them
constexpr double kOnBorder = 1e-9;        // of a triangle or an edge: a crossing as near to its border is on it
constexpr std::size_t kTestsPerCut = 50;  // a cut that is kept takes the memory, and later the time, of that many tests
constexpr std::size_t kMaxSamples = 64;   // points of a part: if none is clear of the other, the surfaces coincide

struct TriangleCorners {
  Vec3 a, b, c;

  Vec3 normal() const { return (b - a).cross(c - a); }
  Vec3 middle() const { return (a + b + c) / 3; }
  const Vec3& at(std::size_t corner) const { return corner == 0 ? a : corner == 1 ? b : c; }
};

TriangleCorners cornersOf(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& [i, j, k] = mesh.triangles[triangle];
  return {mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]};
}

Bounds boundsOf(const TriangleCorners& corners) {
  Bounds bounds(corners.a);
  return bounds.extend(corners.b).extend(corners.c);
}

/// Where along `from` + t `along` a triangle is met, and whether that is clear of its border (T. Moeller, B. Trumbore,
/// "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2(1), 1997).
struct Crossing {
  double t = 0;
  bool isClear = true;
};
std::optional<Crossing> crossingOf(const Vec3& from, const Vec3& along, const TriangleCorners& triangle) {
  const Vec3 alongB = triangle.b - triangle.a, alongC = triangle.c - triangle.a, lever = along.cross(alongC);
  const double determinant = alongB.dot(lever);
  if (std::abs(determinant) <= kOnBorder * kOnBorder * alongB.norm() * lever.norm()) return std::nullopt;  // parallel
  const Vec3 fromA = from - triangle.a, turned = fromA.cross(alongB);
  const double u = fromA.dot(lever) / determinant, v = along.dot(turned) / determinant;
  const double least = std::min({u, v, 1 - u - v});
  if (!(least >= -kOnBorder)) return std::nullopt;
  return Crossing{alongC.dot(turned) / determinant, least > kOnBorder};
}

/// Square of the distance (m^2) of a point from a triangle.
double squaredDistance(const Vec3& point, const TriangleCorners& triangle) {
  const Vec3 normal = triangle.normal();
  const double square = normal.squaredNorm();
  double nearest = HUGE_VAL;
  bool isAbove = square > 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from = triangle.at(i), along = triangle.at((i + 1) % 3) - from, toPoint = point - from;
    isAbove = isAbove && normal.cross(along).dot(toPoint) >= 0;
    const double length2 = along.squaredNorm();
    const double part = length2 > 0 ? std::clamp(toPoint.dot(along) / length2, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (toPoint - part * along).squaredNorm());
  }
  const double height = normal.dot(point - triangle.a);
  return isAbove ? height * height / square : nearest;
}

/// Whether two triangles in one plane have a common area, more than `tolerance` (m) across: no side of either parts
/// them.
bool haveCommonArea(const TriangleCorners& p, const TriangleCorners& q, double tolerance) {
  for (const auto& [one, other] : {std::pair(&p, &q), std::pair(&q, &p)})
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 from = one->at(i), inward = one->normal().cross(one->at((i + 1) % 3) - from).stableNormalized();
      double farthest = -HUGE_VAL;
      for (std::size_t j = 0; j < 3; ++j) farthest = std::max(farthest, inward.dot(other->at(j) - from));
      if (farthest <= tolerance) return false;
    }
  return true;
}

bool areInOnePlane(const TriangleCorners& p, const TriangleCorners& q, double tolerance) {
  const Vec3 normal = p.normal().stableNormalized();
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(normal.dot(q.at(i) - p.a)) > tolerance) return false;
  return true;
}

/// What is known of the points of a part against another part.
struct Sides {
  std::optional<Vec3> inside, outside;
};

using EdgeCuts = std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<double>>;  // by the edge's vertices

class Encounter {
 public:
  Encounter(const TriangleMesh& mesh, const MeshPart& first, const MeshPart& second, std::size_t& testsLeft)
      : mesh_(mesh), first_(first), second_(second), testsLeft_(testsLeft) {
    double largest = 0;
    for (const MeshPart* part : {&first, &second})
      largest = std::max({largest, part->bounds.min().cwiseAbs().maxCoeff(), part->bounds.max().cwiseAbs().maxCoeff()});
    const double size = std::min(first.bounds.diagonal().norm(), second.bounds.diagonal().norm());
    tolerance_ = std::max(kTouching * size, kSinglePrecision * largest);
  }

  PartEncounter relation() {
    if (!first_.bounds.intersects(second_.bounds)) return {};
    cutEdges();
    judgeCuts(firstCuts_, second_, firstSides_);
    judgeCuts(secondCuts_, first_, secondSides_);
    sample(first_, second_, firstSides_);
    sample(second_, first_, secondSides_);
    if (testsLeft_ == 0) return {PartRelation::unknown};
    const std::optional<Vec3> place = firstSides_.inside    ? firstSides_.inside
                                      : secondSides_.inside ? secondSides_.inside
                                                            : flush_;
    if (!place) return {};
    if (!firstSides_.outside) return {PartRelation::firstInside, *place};
    if (!secondSides_.outside) return {PartRelation::secondInside, *place};
    return {PartRelation::crossing, *place};
  }

 private:
  /// Triangles of a part that reach the bounds of the other, by their least x.
  struct Reaching {
    std::uint32_t triangle;
    TriangleCorners corners;
    Bounds bounds;
  };
  std::vector<Reaching> reaching(const MeshPart& part, const MeshPart& other) const {
    std::vector<Reaching> found;
    for (const std::uint32_t triangle : part.triangles) {
      const TriangleCorners corners = cornersOf(mesh_, triangle);
      const Bounds bounds = boundsOf(corners);
      if (bounds.intersects(other.bounds)) found.push_back({triangle, corners, bounds});
    }
    std::sort(found.begin(), found.end(), [](const Reaching& left, const Reaching& right) {
      return std::pair(left.bounds.min().x(), left.triangle) < std::pair(right.bounds.min().x(), right.triangle);
    });
    return found;
  }

  /// False where no tests are left.
  bool spend(std::size_t tests) const {
    testsLeft_ -= std::min(tests, testsLeft_);
    return testsLeft_ > 0;
  }

  /// Finds where edges of either pierce triangles of the other, and sides that are flush.
  void cutEdges() {
    const std::vector<Reaching> firsts = reaching(first_, second_), seconds = reaching(second_, first_);
    double longest = 0;  // m, along x
    for (const Reaching& second : seconds) longest = std::max(longest, second.bounds.sizes().x());
    for (const Reaching& first : firsts) {
      const double from = first.bounds.min().x() - longest - tolerance_, to = first.bounds.max().x() + tolerance_;
      auto second = std::lower_bound(seconds.begin(), seconds.end(), from,
                                     [](const Reaching& item, double x) { return item.bounds.min().x() < x; });
      for (; second != seconds.end() && second->bounds.min().x() <= to && spend(1); ++second)
        if (first.bounds.squaredExteriorDistance(second->bounds) <= tolerance_ * tolerance_) meet(first, *second);
    }
  }

  void meet(const Reaching& first, const Reaching& second) {
    cut(first.triangle, second.corners, firstCuts_);
    cut(second.triangle, first.corners, secondCuts_);
    if (flush_ || !areInOnePlane(first.corners, second.corners, tolerance_) ||
        !areInOnePlane(second.corners, first.corners, tolerance_))
      return;
    const double sameWay = first.corners.normal().dot(second.corners.normal()) * first_.volume * second_.volume;
    if (sameWay > 0 && haveCommonArea(first.corners, second.corners, tolerance_))
      flush_ = first.bounds.intersection(second.bounds).center();
  }

  void cut(std::uint32_t edges, const TriangleCorners& triangle, EdgeCuts& cuts) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = mesh_.triangles[edges][i], to = mesh_.triangles[edges][(i + 1) % 3];
      if (from > to) continue;  // its other triangle has it the other way round
      const Vec3 along = mesh_.vertices[to] - mesh_.vertices[from];
      const auto crossing = crossingOf(mesh_.vertices[from], along, triangle);
      if (crossing && crossing->t >= -kOnBorder && crossing->t <= 1 + kOnBorder && spend(kTestsPerCut))
        cuts[{from, to}].push_back(std::clamp(crossing->t, 0.0, 1.0));
    }
  }

  void judgeCuts(EdgeCuts& cuts, const MeshPart& other, Sides& sides) const {
    for (auto& [edge, places] : cuts) {
      if (sides.inside && sides.outside) return;
      const Vec3 from = mesh_.vertices[edge.first], along = mesh_.vertices[edge.second] - from;
      const double length = along.norm();
      places.push_back(0), places.push_back(1);
      std::sort(places.begin(), places.end());
      for (std::size_t i = 0; i + 1 < places.size(); ++i)
        if ((places[i + 1] - places[i]) * length > tolerance_)
          judge(from + (places[i] + places[i + 1]) / 2 * along, other, sides);
    }
  }

  /// TriangleCorners and middles of triangles, until one is clear of the other part.
  void sample(const MeshPart& part, const MeshPart& other, Sides& sides) const {
    const std::size_t stride = std::max<std::size_t>(1, part.triangles.size() / (kMaxSamples / 2));
    for (std::size_t i = 0; i < part.triangles.size(); i += stride) {
      const TriangleCorners corners = cornersOf(mesh_, part.triangles[i]);
      for (const Vec3& point : {corners.a, corners.middle()}) {
        if (sides.inside || sides.outside) return;
        judge(point, other, sides);
      }
    }
  }

  void judge(const Vec3& point, const MeshPart& other, Sides& sides) const {
    if (other.bounds.squaredExteriorDistance(point) > tolerance_ * tolerance_) {
      sides.outside = point;
      return;
    }
    if (!spend(other.triangles.size())) return;
    for (const std::uint32_t triangle : other.triangles) {
      const TriangleCorners corners = cornersOf(mesh_, triangle);
      if (boundsOf(corners).squaredExteriorDistance(point) <= tolerance_ * tolerance_ &&
          squaredDistance(point, corners) <= tolerance_ * tolerance_)
        return;
    }
    (isInside(point, other) ? sides.inside : sides.outside) = point;
  }

  bool isInside(const Vec3& point, const MeshPart& other) const {
    // Directions without any symmetry; the next if a ray of one meets an edge.
    const std::array<Vec3, 3> directions{Vec3(0.43612, 0.72137, 0.53819), Vec3(-0.61933, 0.31417, 0.71953),
                                         Vec3(0.19391, -0.83711, 0.51147)};
    bool isInside = false;
    for (const Vec3& direction : directions) {
      bool isClear = true;
      isInside = false;
      for (const std::uint32_t triangle : other.triangles) {
        const auto crossing = crossingOf(point, direction, cornersOf(mesh_, triangle));
        if (!crossing || crossing->t < 0) continue;
        isInside = !isInside;
        isClear = isClear && crossing->isClear;
      }
      if (isClear) break;
    }
    return isInside;
  }

  const TriangleMesh& mesh_;
  const MeshPart &first_, &second_;
  std::size_t& testsLeft_;
  double tolerance_ = 0;  // m
  EdgeCuts firstCuts_, secondCuts_;
  Sides firstSides_, secondSides_;
  std::optional<Vec3> flush_;  // a point between sides in one plane that face the same way
};

}  // namespace

PartEncounter relate(const TriangleMesh& mesh, const MeshPart& first, const MeshPart& second, std::size_t& testsLeft) {
  return Encounter(mesh, first, second, testsLeft).relation();
}

}  // namespace cradle
