#pragma once

#include "collision/mesh_pair.h"

namespace cradle {

/// Pairs of features of two surfaces that are near each other, kept from one search to the next: a neighbour list
/// (L. Verlet, Phys. Rev. 159, 1967, p. 98). It reaches farther than was asked, and serves until the surfaces have
/// moved by as much: bodies move little between searches, and most of a search is the descent of both trees. What is
/// visited beyond the reach of a search depends on those before it; the result of a visit must not.
class FeatureNeighbourList {
 public:
  /// Edges at which a surface bends, or goes straight on.
  enum class Edges : std::uint8_t { bent, straight };

  /// Calls visit.edgeThroughFace(partner, edge, face) for all such edges of the surface of a partner that go through a
  /// face of the other one, and more. The surfaces are those of all calls.
  template <class Visit>
  void visitCrossings(const MeshPair& pair, Edges edges, Visit& visit);

  /// Calls visit.vertexOverFace(partner, vertex, face), for vertices of the surface of a partner, and
  /// visit.edgeOverEdge(edgeOfA, edgeOfB) for the features that are nearest to each other of all around them, at a
  /// distance of at most the square root of visit.reach() (m^2), and more; about the nearest first. The reach may
  /// shrink on the way. Edges at which a surface goes straight on are left out.
  template <class Visit>
  void visitNear(const MeshPair& pair, Visit& visit);

 private:
  enum class Kind : std::uint8_t { vertexOfA, vertexOfB, edges };
  struct Near {
    double distance;  // m, a lower bound
    std::uint32_t featureA, featureB;
    Kind kind;  // of crossings: whose edge
  };
  struct Collect;
  template <class Visit>
  struct OfTriangles;

  /// m: the mean length of the edges of the finer surface. With the reach over it, the features near each other grow.
  static double lengthOf(const MeshPair& pair) { return std::min(pair.a.edgeLength, pair.b.edgeLength); }

  // Of that length: searches with a longer reach descend the trees, as most of their features are visited once.
  static constexpr double kMaxReachRatio = 0.5;

  double movedSince(const MeshPair& pair) const;
  double moveTo(const MeshPair& pair, double reach);
  void renew(const MeshPair& pair, double reach);

  std::vector<Near> near_;                      // nearer ones first
  std::array<std::vector<Near>, 2> crossings_;  // by Edges
  double cover_ = -1;                           // m: all pairs as near as that at the pose of the list are in it
  RigidTransform aFromB_;                       // then
};

template <class Visit>
void FeatureNeighbourList::visitCrossings(const MeshPair& pair, Edges edges, Visit& visit) {
  const double moved = moveTo(pair, 0);
  for (const Near& near : crossings_[static_cast<std::size_t>(edges)]) {
    if (near.distance > moved) return;
    if (near.kind == Kind::vertexOfA)
      visit.edgeThroughFace(Partner::a, near.featureA, near.featureB);
    else
      visit.edgeThroughFace(Partner::b, near.featureB, near.featureA);
  }
}

/// Visits the features that pairs of triangles own.
template <class Visit>
struct FeatureNeighbourList::OfTriangles {
  const MeshPair& pair;
  Visit& visit;

  double reach() const { return visit.reach(); }

  void operator()(std::uint32_t onA, std::uint32_t onB) const {
    const MeshSurface::Face &faceA = pair.a.faces[onA], &faceB = pair.b.faces[onB];
    const double least = leastDistance(triangleOf(pair.a, onA), pair.triangleOfB(onB));
    if (least * least > reach()) return;
    for (std::size_t i = 0; i < 3; ++i) {
      if (faceA.ownsVertex[i]) visit.vertexOverFace(Partner::a, faceA.vertices[i], onB);
      if (faceB.ownsVertex[i]) visit.vertexOverFace(Partner::b, faceB.vertices[i], onA);
    }
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (isBent(pair.a, faceA, i) && isBent(pair.b, faceB, j)) visit.edgeOverEdge(faceA.edges[i], faceB.edges[j]);
  }

  static bool isBent(const MeshSurface& surface, const MeshSurface::Face& face, std::size_t side) {
    return face.ownsEdge[side] && surface.edges[face.edges[side]].isBent;
  }
};

template <class Visit>
void FeatureNeighbourList::visitNear(const MeshPair& pair, Visit& visit) {
  const double reach = std::sqrt(visit.reach());
  if (reach > kMaxReachRatio * lengthOf(pair)) {
    OfTriangles<Visit> ofTriangles{pair, visit};
    return BvhPair(pair.a.tree, pair.b.tree, pair.aFromB).visitNear(ofTriangles);
  }
  const double moved = moveTo(pair, reach);
  for (const Near& near : near_) {
    const double least = std::max(0.0, near.distance - moved);
    if (least * least > visit.reach()) return;
    if (near.kind == Kind::vertexOfA)
      visit.vertexOverFace(Partner::a, near.featureA, near.featureB);
    else if (near.kind == Kind::vertexOfB)
      visit.vertexOverFace(Partner::b, near.featureB, near.featureA);
    else
      visit.edgeOverEdge(near.featureA, near.featureB);
  }
}

}  // namespace cradle
