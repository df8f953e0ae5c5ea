// The separating axes of two polytopes (S. Gottschalk, M. C. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996) are the normals
// of their faces, and the cross products of those pairs of edges that form a face of the Minkowski difference. On the
// Gauss map an edge is the arc between the normals of its two faces, and a pair of edges forms a face where the arc of
// one crosses that of the other (D. Gregorius, "The Separating Axis Test between Convex Polyhedra", GDC 2013). Not all
// pairs of arcs are tested: along each arc of A the support vertex of B is followed, and where it changes, the arc
// crosses one of B's. Each crossing is found once; there are about as many as edges. A normal for which one point of B
// is deeper than the best gap found so far is passed over.

#include "collision/separating_axis.h"

#include <algorithm>
#include <array>
#include <memory_resource>

#include "collision/convex_tolerances.h"

namespace cradle {
namespace {

/// The search for the best axes of each kind; directions are followed in B's frame.
class AxisSearch {
 public:
  /// `a` has faces. `near` leads from A to B, where they are next to each other; axes that see no more than `known` (m)
  /// need not be found.
  AxisSearch(const Core& a, const Core& b, const Vec3& near, double known)
      : coreA_(a),
        coreB_(b),
        a_(*a.collider().polytope),
        b_(*b.collider().polytope),
        near_(near),
        heights_(&pool_),
        best_(known) {}

  SeparatingAxes find() {
    tryFacesOfA(coreB_.supportPoint(-near_));
    tryFacesOfB(coreA_.supportPoint(near_));
    for (const Polytope::Edge& edge : a_.edges) {
      // A point of B below both faces of the edge is at least as deep for all normals on the arc between them.
      const double seen = std::max(heights_[edge.left], heights_[edge.right]);
      if (seen >= 0 || seen > best_) followArc(edge);
    }
    return axes_;
  }

 private:
  /// The gap that a face's normal sees is at most the height of any point of B over the face: most faces are excluded
  /// by that of `onB` (m), a point of B near A.
  void tryFacesOfA(const Vec3& onB) {
    heights_.reserve(a_.faces.size());
    const Vec3 inA = coreA_.placedBack(onB);
    std::size_t vertex = 0;
    for (const Polytope::Face& face : a_.faces) {
      heights_.push_back(face.normal.dot(inA) - face.offset);
      if (heights_.back() <= best_) continue;
      const Vec3 normal = coreA_.turned(face.normal), onFace = coreA_.placed(face.offset * face.normal);
      vertex = supportVertex(b_, coreB_.turnedBack(-normal), vertex);
      keep(axes_.faceOfA, normal.dot(coreB_.placed(b_.vertices[vertex]) - onFace), normal);
    }
  }

  void tryFacesOfB(const Vec3& onA) {
    const Vec3 inB = coreB_.placedBack(onA);
    std::size_t vertex = 0;
    for (const Polytope::Face& face : b_.faces) {
      // Faces that see as much as one of A are kept too.
      if (face.normal.dot(inB) - face.offset < best_ - equalGaps_) continue;
      const Vec3 normal = coreB_.turned(face.normal), onFace = coreB_.placed(face.offset * face.normal);
      vertex = supportVertex(a_, coreA_.turnedBack(-normal), vertex);
      keep(axes_.faceOfB, normal.dot(coreA_.placed(a_.vertices[vertex]) - onFace), -normal);
    }
  }

  void keep(SeparatingAxis& best, double separation, const Vec3& normal) {
    if (separation > best.separation) best = {separation, normal};
    best_ = std::max(best_, separation);
  }

  /// Follows the support vertex of B along -n, while n goes from the normal of the edge's left face to that of the
  /// right one: n = from + t along, t from 0 to 1.
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
      tryEdges(edge, vertex, next, left + crossing * (right - left));
      vertex = next, t = crossing;
    }
  }

  /// Edges too nearly parallel for an axis are covered by the faces and the other edges at their ends.
  void tryEdges(const Polytope::Edge& edge, std::size_t fromB, std::size_t toB, const Vec3& near) {
    const Vec3 alongA = coreA_.turned(a_.vertices[edge.to] - a_.vertices[edge.from]);
    const Vec3 alongB = coreB_.turned(b_.vertices[toB] - b_.vertices[fromB]);
    Vec3 normal = alongA.cross(alongB);
    const double length = normal.norm();
    if (length <= ConvexTolerances::kParallelAngle * alongA.norm() * alongB.norm()) return;
    normal /= normal.dot(near) < 0 ? -length : length;
    const Vec3 between = coreB_.placed(b_.vertices[fromB]) - coreA_.placed(a_.vertices[edge.from]);
    keep(axes_.edges, normal.dot(between), normal);
  }

  const Core &coreA_, &coreB_;
  const Polytope &a_, &b_;
  const Vec3 near_;
  SeparatingAxes axes_;
  std::array<std::byte, 2048> memory_;  // enough for 256 faces: no allocation
  std::pmr::monotonic_buffer_resource pool_{memory_.data(), memory_.size()};
  std::pmr::vector<double> heights_;                               // m: of a point of B over each face of A
  double best_;                                                    // m: largest gap known
  double equalGaps_ = ConvexTolerances(coreA_, coreB_).equalGaps;  // m
  std::size_t lastStart_ = 0;                                      // vertex of B where the last arc began
};

SeparatingAxes axesFrom(const Core& a, const Core& b, const Vec3& near, double known) {
  if (!a.collider().polytope->faces.empty()) return AxisSearch(a, b, near, known).find();
  SeparatingAxes axes = AxisSearch(b, a, -near, known).find();
  std::swap(axes.faceOfA, axes.faceOfB);
  for (SeparatingAxis* axis : {&axes.faceOfA, &axes.faceOfB, &axes.edges}) axis->normal = -axis->normal;
  return axes;
}

}  // namespace

SeparatingAxes separatingAxes(const Core& a, const Core& b) {
  const Vec3 towards = b.placed(b.collider().polytope->vertices[0]) - a.placed(a.collider().polytope->vertices[0]);
  return axesFrom(a, b, towards, -std::numeric_limits<double>::infinity());
}

SeparatingAxes separatingAxes(const Core& a, const Core& b, const SeparatingAxis& known, double preference) {
  return axesFrom(a, b, known.normal, known.separation - preference);
}

}  // namespace cradle
