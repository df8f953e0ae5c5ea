// S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree", 1996, for polytopes: normals of faces, and products of those edges
// that form a face of the Minkowski difference. Each edge is an arc between two face normals on the Gauss map (D.
// Gregorius, "The Separating Axis Test between Convex Polyhedra", GDC 2013); instead of testing all pairs of arcs, the
// farthest vertex of B is followed along each arc of A: where it changes, the arc crosses one of B's. The crossings are
// found each once, and their number is about that of the edges. Normals that see one of B's points deeper than the best
// gap found so far are passed over.

#include "collision/separating_axis.h"

#include <algorithm>
#include <array>
#include <memory_resource>

namespace cradle {
namespace {

constexpr double kGapRounding = 1e-13;  // of the size
constexpr double kNoAxisSine = 1e-7;    // edges at a smaller angle give no axis: faces and other edges cover them

/// Seen from B's frame.
class AxisSearch {
 public:
  /// `a` has faces.
  AxisSearch(const Core& a, const Core& b)
      : coreA_(a), coreB_(b), a_(*a.collider().polytope), b_(*b.collider().polytope), heights_(&pool_) {}

  SeparatingAxes find() {
    const Vec3 towards = coreB_.placed(b_.vertices[0]) - coreA_.placed(a_.vertices[0]);
    lookAtFacesOfA(coreB_.supportPoint(-towards));
    lookAtFacesOfB(coreA_.supportPoint(towards));
    for (const Polytope::Edge& edge : a_.edges) {
      // The normals between two that see a point of B below the edge see it no higher.
      const double seen = std::max(heights_[edge.left], heights_[edge.right]);
      if (seen >= 0 || seen > best_) followArc(edge);
    }
    return axes_;
  }

 private:
  /// No normal sees a larger gap than to one of B's points: most faces need no more. `onB` (m) is one that is near.
  void lookAtFacesOfA(const Vec3& onB) {
    heights_.reserve(a_.faces.size());
    std::size_t vertex = 0;
    for (const Polytope::Face& face : a_.faces) {
      const Vec3 normal = coreA_.turned(face.normal), onFace = coreA_.placed(face.offset * face.normal);
      heights_.push_back(normal.dot(onB - onFace));
      if (heights_.back() <= best_) continue;
      vertex = supportVertex(b_, coreB_.turnedBack(-normal), vertex);
      keep(axes_.faceOfA, normal.dot(coreB_.placed(b_.vertices[vertex]) - onFace), normal);
    }
  }

  void lookAtFacesOfB(const Vec3& onA) {
    std::size_t vertex = 0;
    for (const Polytope::Face& face : b_.faces) {
      const Vec3 normal = coreB_.turned(face.normal), onFace = coreB_.placed(face.offset * face.normal);
      if (normal.dot(onA - onFace) < best_ - rounding_) continue;  // one that sees as much is told too
      vertex = supportVertex(a_, coreA_.turnedBack(-normal), vertex);
      keep(axes_.faceOfB, normal.dot(coreA_.placed(a_.vertices[vertex]) - onFace), -normal);
    }
  }

  void keep(SeparatingAxis& best, double separation, const Vec3& normal) {
    if (separation > best.separation) best = {separation, normal};
    best_ = std::max(best_, separation);
  }

  /// The vertex of B that is farthest along -n, while n goes from the normal of the edge's left face to that of the
  /// right one, n = from + t along.
  void followArc(const Polytope::Edge& edge) {
    const Vec3 left = coreA_.turned(a_.faces[edge.left].normal), right = coreA_.turned(a_.faces[edge.right].normal);
    const Vec3 from = coreB_.turnedBack(left), along = coreB_.turnedBack(right - left);
    std::size_t vertex = lastStart_ = supportVertex(b_, -from, lastStart_);
    for (double t = 0; t < 1;) {
      double crossing = 1;
      std::size_t next = vertex;
      for (std::size_t i = b_.firstNeighbor[vertex]; i < b_.firstNeighbor[vertex + 1]; ++i) {
        const Vec3 side = b_.vertices[b_.neighbors[i]] - b_.vertices[vertex];
        const double rate = side.dot(along);
        if (rate >= 0) continue;
        const double at = std::max(t, side.dot(from) / -rate);
        if (at < crossing) crossing = at, next = b_.neighbors[i];
      }
      if (next == vertex) return;
      lookAtEdges(edge, vertex, next, left + crossing * (right - left));
      vertex = next, t = crossing;
    }
  }

  void lookAtEdges(const Polytope::Edge& edge, std::size_t fromB, std::size_t toB, const Vec3& near) {
    const Vec3 alongA = coreA_.turned(a_.vertices[edge.to] - a_.vertices[edge.from]);
    const Vec3 alongB = coreB_.turned(b_.vertices[toB] - b_.vertices[fromB]);
    Vec3 normal = alongA.cross(alongB);
    const double length = normal.norm();
    if (length <= kNoAxisSine * alongA.norm() * alongB.norm()) return;
    normal /= normal.dot(near) < 0 ? -length : length;
    const Vec3 between = coreB_.placed(b_.vertices[fromB]) - coreA_.placed(a_.vertices[edge.from]);
    keep(axes_.edges, normal.dot(between), normal);
  }

  const Core &coreA_, &coreB_;
  const Polytope &a_, &b_;
  SeparatingAxes axes_;
  std::array<std::byte, 2048> memory_;  // enough for 256 faces: no allocation
  std::pmr::monotonic_buffer_resource pool_{memory_.data(), memory_.size()};
  std::pmr::vector<double> heights_;                        // m: of a point of B over each face of A
  double best_ = -std::numeric_limits<double>::infinity();  // m: largest gap found
  double rounding_ = kGapRounding * std::min(coreA_.collider().boundingRadius, coreB_.collider().boundingRadius);  // m
  std::size_t lastStart_ = 0;  // vertex of B where the last arc began
};

}  // namespace

SeparatingAxes separatingAxes(const Core& a, const Core& b) {
  if (!a.collider().polytope->faces.empty()) return AxisSearch(a, b).find();
  SeparatingAxes axes = AxisSearch(b, a).find();
  std::swap(axes.faceOfA, axes.faceOfB);
  for (SeparatingAxis* axis : {&axes.faceOfA, &axes.faceOfB, &axes.edges}) axis->normal = -axis->normal;
  return axes;
}

}  // namespace cradle
