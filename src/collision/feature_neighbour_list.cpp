#include "collision/feature_neighbour_list.h"

#include "collision/normal_cone.h"

namespace cradle {
namespace {

// The reach of a list, in times that of the search that it is made for, and beyond it, of the length of edges: they
// decide the cost alone.
constexpr double kCover = 2;
constexpr double kCoverRatio = 1e-3;
// A new list reaches at least so many times as far as the one before: searches of short and long reach take turns.
constexpr double kCoverDecay = 0.9;

/// Distance (m) of boxes around some points of both surfaces, along the axes of A's frame.
template <std::size_t A, std::size_t B>
double distanceOfBoxes(const std::array<Vec3, A>& a, const std::array<Vec3, B>& b) {
  Bounds boxA, boxB;
  for (const Vec3& point : a) boxA.extend(point);
  for (const Vec3& point : b) boxB.extend(point);
  return (boxA.min() - boxB.max()).cwiseMax(boxB.min() - boxA.max()).cwiseMax(0.0).norm();
}

}  // namespace

/// Collects features of pairs of triangles with lower bounds of their distances.
struct FeatureNeighbourList::Collect {
  const MeshPair& pair;
  double cover;  // m
  FeatureNeighbourList& list;
  double tilt = cover / pair.b.tree.nodes[0].halfSize.norm();  // rad: by which the list's poses differ at most

  double reach() const { return cover * cover; }

  void operator()(std::uint32_t onA, std::uint32_t onB) {
    OfTriangles<Collect>{pair, *this}(onA, onB);
    const MeshSurface::Face &faceA = pair.a.faces[onA], &faceB = pair.b.faces[onB];
    for (std::size_t i = 0; i < 3; ++i) {
      if (faceA.ownsEdge[i]) edgeThroughFace(Partner::a, faceA.edges[i], onB);
      if (faceB.ownsEdge[i]) edgeThroughFace(Partner::b, faceB.edges[i], onA);
    }
  }

  void vertexOverFace(Partner partner, std::uint32_t vertex, std::uint32_t face) {
    const MeshSurface &own = pair.surface(partner), &other = pair.surface(otherThan(partner));
    const FlatTriangle triangle = triangleOf(other, face);
    const Vec3 point = pair.seenFromOther(partner, own.vertices[vertex]);
    const double distance = std::max(std::abs(triangle.heightOf(point)),
                                     distanceOfBoxes<1, 3>({point}, {triangle.a, triangle.b, triangle.c}));
    if (distance > cover) return;
    const Vec3 ahead = pair.turnedToOther(otherThan(partner), triangle.normal);
    if (mayBeInNormalCone(own, vertex, ahead, tilt) || mayBeInNormalCone(own, vertex, -ahead, tilt))
      add(list.near_, distance, partner, vertex, face);
  }

  void edgeOverEdge(std::uint32_t edgeA, std::uint32_t edgeB) {
    const Segment a = segmentOf(pair.a, edgeA), b = pair.segmentOfB(edgeB);
    const SegmentParts parts = nearestParts(a, b);
    const double distance = (a.at(parts.a) - b.at(parts.b)).norm();
    if (distance <= cover) list.near_.push_back({distance, edgeA, edgeB, Kind::edges});
  }

  void edgeThroughFace(Partner partner, std::uint32_t edge, std::uint32_t face) {
    const Segment own = segmentOf(pair.surface(partner), edge);
    const FlatTriangle triangle = triangleOf(pair.surface(otherThan(partner)), face);
    const Vec3 from = pair.seenFromOther(partner, own.from), to = pair.seenFromOther(partner, own.at(1));
    const double one = triangle.heightOf(from), other = triangle.heightOf(to);
    const double overPlane = std::max({0.0, std::min(one, other), -std::max(one, other)});
    const double distance =
        std::max(overPlane, distanceOfBoxes<2, 3>({from, to}, {triangle.a, triangle.b, triangle.c}));
    if (distance <= cover)
      add(list.crossings_[pair.surface(partner).edges[edge].isBent ? 0 : 1], distance, partner, edge, face);
  }

  static void add(std::vector<Near>& to, double distance, Partner partner, std::uint32_t own, std::uint32_t other) {
    if (partner == Partner::a)
      to.push_back({distance, own, other, Kind::vertexOfA});
    else
      to.push_back({distance, other, own, Kind::vertexOfB});
  }
};

/// How far (m) any point of B can have moved as seen from A since the list was made, and what rounding adds.
double FeatureNeighbourList::movedSince(const MeshPair& pair) const {
  const Bvh::Node& all = pair.b.tree.nodes[0];
  const double shift = (pair.aFromB * all.center - aFromB_ * all.center).norm();
  // A rotation by an angle t moves by up to 2 sin(t / 2) of the distance; unit quaternions differ by 2 sin(t / 4) then.
  const Eigen::Vector4d now = pair.aFromB.rotation.coeffs(), then = aFromB_.rotation.coeffs();
  const double turn = 2 * std::min((now - then).norm(), (now + then).norm());
  return shift + turn * all.halfSize.norm() + MeshTolerances(std::max(pair.a.size, pair.b.size)).rounding;
}

/// Makes a new list where the one that is there does not cover a reach (m) any more. How far (m) any point has moved
/// since it was made.
double FeatureNeighbourList::moveTo(const MeshPair& pair, double reach) {
  const double moved = movedSince(pair);
  if (reach + moved <= cover_) return moved;
  renew(pair, reach);
  return movedSince(pair);
}

void FeatureNeighbourList::renew(const MeshPair& pair, double reach) {
  cover_ = std::max(kCover * reach + kCoverRatio * lengthOf(pair), kCoverDecay * cover_);
  aFromB_ = pair.aFromB;
  near_.clear();
  for (std::vector<Near>& crossings : crossings_) crossings.clear();
  Collect collect{pair, cover_, *this};
  BvhPair(pair.a.tree, pair.b.tree, pair.aFromB).visitNear(collect);
  const auto isNearer = [](const Near& left, const Near& right) { return left.distance < right.distance; };
  std::sort(near_.begin(), near_.end(), isNearer);
  for (std::vector<Near>& crossings : crossings_) std::sort(crossings.begin(), crossings.end(), isNearer);
}

}  // namespace cradle
