// Qhull (C. B. Barber, D. P. Dobkin, H. Huhdanpaa, "The Quickhull algorithm for convex hulls", ACM TOMS 22, 1996) finds
// the triangles; faces are put together here, since numbers in a mesh file are mostly floats, and Qhull merges only
// what is flat to rounding.

#include "mesh/convex_hull.h"

#include <libqhull_r/libqhull_r.h>
#include <libqhull_r/poly_r.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/error.h"

namespace cradle {
namespace {

constexpr double kFlatRatio = 1e-6;  // of the size: to this a file's single precision keeps four corners in a plane

using Corners = std::array<std::size_t, 3>;

/// Qhull's memory.
class Quickhull {
 public:
  explicit Quickhull(std::vector<Vec3>& points) {
    qh_zero(&qh_, nullptr);
    // Triangulated output, no text.
    failed_ = qh_new_qhull(&qh_, 3, static_cast<int>(points.size()), points[0].data(), 0,
                           const_cast<char*>("qhull Qt Pp"), nullptr, nullptr) != 0;
  }
  Quickhull(const Quickhull&) = delete;
  Quickhull& operator=(const Quickhull&) = delete;
  ~Quickhull() {
    qh_freeqhull(&qh_, !qh_ALL);
    int pieces = 0, bytes = 0;
    qh_memfreeshort(&qh_, &pieces, &bytes);
  }

  bool failed() const { return failed_; }

  /// Indices into the points, counter-clockwise seen from outside.
  std::vector<Corners> triangles() {
    std::vector<Corners> found;
    qhT* qh = &qh_;  // the macros' name
    facetT* facet;
    FORALLfacets {
      Corners corners;
      std::size_t count = 0;
      vertexT *vertex, **vertexp;
      FOREACHvertex_(facet->vertices) if (count < 3) corners[count++] =
          static_cast<std::size_t>(qh_pointid(qh, vertex->point));
      if (facet->toporient != qh_ORIENTclock) std::swap(corners[0], corners[1]);
      found.push_back(corners);
    }
    return found;
  }

 private:
  qhT qh_;
  bool failed_ = false;
};

double sizeOf(const std::vector<Vec3>& points) {
  Bounds bounds;
  for (const Vec3& point : points) bounds.extend(point);
  return bounds.isEmpty() ? 0 : bounds.diagonal().norm();
}

/// Whether all points lie within `limit` of a plane: the one of the farthest two and what is farthest from their line.
bool isFlat(const std::vector<Vec3>& points, double limit) {
  if (points.size() < 4) return true;
  const auto farthest = [&](const auto& distance) {
    return *std::max_element(points.begin(), points.end(),
                             [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
  };
  const Vec3 from = points[0], to = farthest([&](const Vec3&p) { return (p - from).norm(); });
  const Vec3 along = (to - from).normalized();
  const Vec3 aside = farthest([&](const Vec3& p) { return along.cross(p - from).norm(); }) - from;
  if (along.cross(aside).norm() <= limit) return true;
  const Vec3 normal = along.cross(aside).normalized();
  return std::all_of(points.begin(), points.end(),
                     [&](const Vec3& p) { return std::abs(normal.dot(p - from)) <= limit; });
}

/// Puts triangles together to flat faces, the largest triangle first.
class FaceMerger {
 public:
  FaceMerger(const std::vector<Vec3>& points, const std::vector<Corners>& triangles, double limit)
      : points_(points), triangles_(triangles), limit_(limit), face_(triangles.size(), kNone) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (std::size_t c = 0; c < 3; ++c) owner_[{triangles[t][c], triangles[t][(c + 1) % 3]}] = t;
  }

  /// Loops of points.
  std::vector<std::vector<std::size_t>> faces() {
    std::vector<std::size_t> order(triangles_.size());
    for (std::size_t t = 0; t < order.size(); ++t) order[t] = t;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return areaVector(a).norm() > areaVector(b).norm(); });
    std::vector<std::vector<std::size_t>> loops;
    for (const std::size_t seed : order)
      if (face_[seed] == kNone) loops.push_back(boundary(grow(seed, loops.size())));
    return loops;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  Vec3 areaVector(std::size_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return (points_[b] - points_[a]).cross(points_[c] - points_[a]);
  }

  std::size_t across(std::size_t triangle, std::size_t side) const {
    return owner_.at({triangles_[triangle][(side + 1) % 3], triangles_[triangle][side]});
  }

  /// Gives a face to the seed and all that is in its plane and hangs together: these.
  std::vector<std::size_t> grow(std::size_t seed, std::size_t face) {
    const Vec3 normal = areaVector(seed).normalized(), origin = points_[triangles_[seed][0]];
    const auto isInPlane = [&](std::size_t corner) { return std::abs(normal.dot(points_[corner] - origin)) <= limit_; };
    std::vector<std::size_t> reached{seed};
    face_[seed] = face;
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (std::size_t side = 0; side < 3; ++side) {
        const std::size_t next = across(reached[i], side);
        if (face_[next] != kNone || areaVector(next).dot(normal) < 0) continue;
        if (!std::all_of(triangles_[next].begin(), triangles_[next].end(), isInPlane)) continue;
        face_[next] = face;
        reached.push_back(next);
      }
    return reached;
  }

  /// Once around the triangles of a face.
  std::vector<std::size_t> boundary(const std::vector<std::size_t>& triangles) const {
    std::map<std::size_t, std::size_t> next;  // corner after corner
    for (const std::size_t t : triangles)
      for (std::size_t side = 0; side < 3; ++side)
        if (face_[across(t, side)] != face_[t]) next[triangles_[t][side]] = triangles_[t][(side + 1) % 3];
    std::vector<std::size_t> loop;
    CRADLE_CHECK(next.size() >= 3);
    for (std::size_t corner = next.begin()->first; loop.size() < next.size(); corner = next.at(corner))
      loop.push_back(corner);
    return loop;
  }

  const std::vector<Vec3>& points_;
  const std::vector<Corners>& triangles_;
  double limit_;
  std::vector<std::size_t> face_;                                     // of each triangle
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> owner_;  // triangle of each directed side
};

/// A corner at which only two faces meet lies on the line between its neighbours.
ConvexHull withoutStraightCorners(const std::vector<Vec3>& points, std::vector<std::vector<std::size_t>> loops) {
  std::vector<std::size_t> meeting(points.size(), 0), index(points.size(), 0);
  for (const auto& loop : loops)
    for (const std::size_t corner : loop) ++meeting[corner];
  ConvexHull hull;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (meeting[i] >= 3) {
      index[i] = hull.vertices.size();
      hull.vertices.push_back(points[i]);
    }
  for (auto& loop : loops) {
    std::erase_if(loop, [&](std::size_t corner) { return meeting[corner] < 3; });
    if (loop.size() < 3) continue;
    for (std::size_t& corner : loop) corner = index[corner];
    hull.faces.push_back(loop);
  }
  return hull;
}

}  // namespace

TriangleMesh trianglesOf(const ConvexHull& hull) {
  TriangleMesh mesh{hull.vertices, {}};
  for (const std::vector<std::size_t>& face : hull.faces)
    for (std::size_t i = 2; i < face.size(); ++i)
      mesh.triangles.push_back({static_cast<std::uint32_t>(face[0]), static_cast<std::uint32_t>(face[i - 1]),
                                static_cast<std::uint32_t>(face[i])});
  return mesh;
}

ConvexHull convexHullOf(const std::vector<Vec3>& points) {
  const double limit = kFlatRatio * sizeOf(points);
  const auto fail = [] {
    throw Error(ErrorKind::mesh, "", "its points lie in a plane: they have no convex hull with a volume");
  };
  if (isFlat(points, limit)) fail();
  std::vector<Vec3> copy = points;
  Quickhull quickhull(copy);
  if (quickhull.failed()) fail();
  const std::vector<Corners> triangles = quickhull.triangles();
  return withoutStraightCorners(points, FaceMerger(points, triangles, limit).faces());
}

}  // namespace cradle
