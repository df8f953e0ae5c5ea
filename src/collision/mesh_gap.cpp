#include "collision/mesh_gap.h"

#include <optional>

#include "collision/mesh_overlap.h"

namespace cradle {
namespace {

// Of the size: nearest points at a smaller distance tell their direction to no better than 1e-6 rad (rounding, 1e-15 of
// the size, over the distance); the normals of the features take its place.
constexpr double kDirectionRatio = 1e-9;
// Of the size: reach of the first search for nearest features, and the growth for the next ones. They decide the cost
// alone.
constexpr double kFirstSearchReach = 1e-4;
constexpr double kSearchReachGrowth = 16;
// Of the length of another way out: a way that is as short has barely been passed, and is the right one.
constexpr double kBarelyPassedRatio = 0.01;
// Of the size: reach of a search at least, so that a gap of rounding is found where none at all is asked for.
constexpr double kMinReachRatio = 1e-10;

using Feature = MeshPoint::Feature;

/// A point on a feature, in A's frame.
struct Witness {
  Feature feature = Feature::none;
  std::uint32_t index = 0;
  Vec3 point = Vec3::Zero();  // m
};

/// Outward normal (unit) of a feature, in its own frame.
const Vec3& normalAt(const MeshSurface& surface, const Witness& witness) {
  if (witness.feature == Feature::face) return surface.faces[witness.index].normal;
  if (witness.feature == Feature::edge) return surface.edges[witness.index].normal;
  return surface.vertexNormals[witness.index];
}

/// Visits pairs of triangles for the nearest features of two surfaces. It ends where an edge goes through a triangle.
struct GapVisit {
  const MeshPair& pair;
  double distance2;  // m^2: of the nearest features so far, or the square of the reach
  Witness onA = {}, onB = {};
  bool intersect = false;

  double reach() const { return intersect ? -1 : distance2; }

  void operator()(std::uint32_t indexA, std::uint32_t indexB) {
    const MeshSurface::Face &faceA = pair.a.faces[indexA], &faceB = pair.b.faces[indexB];
    const FlatTriangle a = triangleOf(pair.a, indexA), b = pair.triangleOfB(indexB);
    const CornerHeights ofA = heightsOver(b, a), ofB = heightsOver(a, b);
    const double least = std::max(leastDistance(ofA), leastDistance(ofB));
    if (least * least > distance2) return;
    const auto stop = [&](std::size_t, double) { intersect = true; };
    forEachPiercing(faceA, a, ofA, b, stop);
    forEachPiercing(faceB, b, ofB, a, stop);
    if (intersect) return;
    for (std::size_t i = 0; i < 3; ++i) {
      if (faceA.ownsVertex[i] && ofA[i] * ofA[i] < distance2 && b.isAbove(cornerOf(a, i)))
        keep({Feature::vertex, faceA.vertices[i], cornerOf(a, i)},
             {Feature::face, indexB, cornerOf(a, i) - ofA[i] * b.normal});
      if (faceB.ownsVertex[i] && ofB[i] * ofB[i] < distance2 && a.isAbove(cornerOf(b, i)))
        keep({Feature::face, indexA, cornerOf(b, i) - ofB[i] * a.normal},
             {Feature::vertex, faceB.vertices[i], cornerOf(b, i)});
    }
    tryEdges(faceA, faceB);
  }

  void tryEdges(const MeshSurface::Face& faceA, const MeshSurface::Face& faceB) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        if (!faceA.ownsEdge[i] || !faceB.ownsEdge[j]) continue;
        const Segment a = segmentOf(pair.a, faceA.edges[i]), b = pair.segmentOfB(faceB.edges[j]);
        const SegmentParts parts = nearestParts(a, b);
        const Vec3 onA = a.at(parts.a), onB = b.at(parts.b);
        if ((onA - onB).squaredNorm() >= distance2) continue;
        keep(onEdge(pair.a, faceA.edges[i], parts.a, onA), onEdge(pair.b, faceB.edges[j], parts.b, onB));
      }
  }

  static Witness onEdge(const MeshSurface& surface, std::uint32_t edge, double part, const Vec3& point) {
    if (part > 0 && part < 1) return {Feature::edge, edge, point};
    return {Feature::vertex, surface.edges[edge].vertices[part > 0 ? 1 : 0], point};
  }

  void keep(const Witness& a, const Witness& b) {
    distance2 = (a.point - b.point).squaredNorm();
    onA = a, onB = b;
  }
};

/// Visits pairs of triangles that intersect, for the edge that is deepest inside the other solid or beyond a sheet.
struct OverlapVisit {
  const MeshPair& pair;
  double rounding2;  // m^2
  MeshGap deepest;
  MeshGap leaving = {0, {}, {}, Vec3::Zero()};     // a sheet, straight ...
  MeshGap pastBorder = {0, {}, {}, Vec3::Zero()};  // ... or past its border

  double reach() const { return rounding2; }

  void operator()(std::uint32_t indexA, std::uint32_t indexB) {
    const MeshSurface::Face &faceA = pair.a.faces[indexA], &faceB = pair.b.faces[indexB];
    const FlatTriangle a = triangleOf(pair.a, indexA), b = pair.triangleOfB(indexB);
    const CornerHeights ofA = heightsOver(b, a), ofB = heightsOver(a, b);
    forEachPiercing(faceA, a, ofA, b, [&](std::size_t i, double) {
      const Segment edge = segmentOf(pair.a, faceA.edges[i]);
      const Segment seen{pair.placedBack(edge.from), pair.turnedBack(edge.along)};
      const Vec3 inner = pair.a.inner ? pair.placedBack(*pair.a.inner) : seen.at(0.5);
      const EdgeDepth found = depthOf(seen, inner, pair.b, indexB);
      const Vec3 normal = pair.turned(found.normal), point = pair.placed(found.deepest);
      keep({-found.depth, point, point + found.depth * normal, -normal}, pair.a.edges[faceA.edges[i]], pair.b.isSheet);
    });
    forEachPiercing(faceB, b, ofB, a, [&](std::size_t i, double) {
      const Segment edge = pair.segmentOfB(faceB.edges[i]);
      const Vec3 inner = pair.b.inner ? pair.placed(*pair.b.inner) : edge.at(0.5);
      const EdgeDepth found = depthOf(edge, inner, pair.a, indexA);
      keep({-found.depth, found.deepest + found.depth * found.normal, found.deepest, found.normal},
           pair.b.edges[faceB.edges[i]], pair.a.isSheet);
    });
  }

  /// The depth of an edge that goes through a face. Out of a sheet there are two ways: towards the side on which the
  /// solid's inner point is (if none is known, most of the edge), or towards the other side. The latter is taken if it
  /// is much shorter: over a steep crease, much of a solid is behind the planes of faces that it barely touches.
  static EdgeDepth depthOf(const Segment& edge, const Vec3& inner, const MeshSurface& other, std::uint32_t face) {
    const double part = partAt(edge, face, other);
    if (!other.isSheet) return depthOfEdge(other, edge, part, face);
    const auto triangles = static_cast<std::uint32_t>(other.faces.size() / 2);
    const std::uint32_t back = face < triangles ? face + triangles : face - triangles;
    const bool isInFront = triangleOf(other, face).heightOf(inner) >= 0;
    const EdgeDepth towards = depthOfEdge(other, edge, part, isInFront ? face : back);
    const EdgeDepth away = depthOfEdge(other, edge, part, isInFront ? back : face);
    return away.depth < kBarelyPassedRatio * towards.depth ? away : towards;
  }

  /// The deepest of all; of a sheet whose border is barely inside the solid, the way past that border.
  MeshGap wayOut() const {
    if (leaving.normal == Vec3::Zero()) return deepest;
    if (pastBorder.normal != Vec3::Zero() && pastBorder.separation > kBarelyPassedRatio * leaving.separation)
      return pastBorder;
    return deepest.separation < leaving.separation ? deepest : leaving;
  }

  /// The part (0..1) of an edge at which it goes through a face.
  static double partAt(const Segment& edge, std::uint32_t face, const MeshSurface& surface) {
    const FlatTriangle triangle = triangleOf(surface, face);
    const double slope = triangle.normal.dot(edge.along);
    return slope != 0 ? std::clamp(-triangle.heightOf(edge.from) / slope, 0.0, 1.0) : 0;
  }

  static void keepDeeper(const MeshGap& found, MeshGap& kept) {
    if (found.separation < kept.separation || kept.normal == Vec3::Zero()) kept = found;
  }

  void keep(const MeshGap& found, const MeshSurface::Edge& edge, bool isPastSheet) {
    keepDeeper(found, isPastSheet ? leaving : deepest);
    if (edge.isBorder) keepDeeper(found, pastBorder);
  }
};

/// The gap of two surfaces that do not intersect, from their nearest points.
MeshGap gapOf(const MeshPair& pair, const GapVisit& nearest) {
  const Witness &onA = nearest.onA, &onB = nearest.onB;
  const Vec3 between = onB.point - onA.point;
  const auto facing = [](const MeshSurface& surface, const Vec3& outward, const Vec3& way) {
    return surface.isSheet && outward.dot(way) < 0 ? Vec3(-outward) : outward;
  };
  const Vec3 outOfA = facing(pair.a, normalAt(pair.a, onA), between),
             outOfB = facing(pair.b, pair.turned(normalAt(pair.b, onB)), -between);
  const double distance = std::sqrt(nearest.distance2);
  const bool aIsInside = between.dot(outOfB) > 0 && !pair.b.isSheet,
             bIsInside = between.dot(outOfA) < 0 && !pair.a.isSheet;
  const double sign = aIsInside || bIsInside ? -1 : 1;
  const Vec3 apart = aIsInside ? Vec3(-outOfB) : bIsInside ? outOfA : Vec3((outOfA - outOfB).normalized());
  MeshGap gap{sign * distance, onA.point, onB.point, apart};
  if (onA.feature == Feature::face) {
    gap.normal = outOfA;
  } else if (onB.feature == Feature::face) {
    gap.normal = -outOfB;
  } else if (distance > kDirectionRatio * std::min(pair.a.size, pair.b.size)) {
    gap.normal = sign / distance * between;
  } else if (onA.feature == Feature::edge && onB.feature == Feature::edge) {
    const Vec3 across = segmentOf(pair.a, onA.index).along.cross(pair.segmentOfB(onB.index).along).normalized();
    gap.normal = across.dot(apart) < 0 ? Vec3(-across) : across;
  }
  return gap;
}

/// Puts a connected part of one mesh that is wholly inside the other solid into `gap`, if it is deeper than that.
void keepPartsInside(const MeshPair& pair, MeshGap& gap) {
  for (const std::uint32_t vertex : pair.a.parts) {
    const Vec3 &point = pair.a.vertices[vertex], seen = pair.placedBack(point);
    if (squaredDistance(pair.b.tree.nodes[0], seen) > 0) continue;
    const SignedHeight found = heightOver(pair.b, seen);
    if (found.height < std::min(0.0, gap.separation))
      gap = {found.height, point, pair.placed(found.nearest), -pair.turned(found.normal)};
  }
  for (const std::uint32_t vertex : pair.b.parts) {
    const Vec3 point = pair.placed(pair.b.vertices[vertex]);
    if (squaredDistance(pair.a.tree.nodes[0], point) > 0) continue;
    const SignedHeight found = heightOver(pair.a, point);
    if (found.height < std::min(0.0, gap.separation)) gap = {found.height, found.nearest, point, found.normal};
  }
}

/// The nearest features within `enough` (m). Short reaches come first: most solids of a query are near, and the cost of
/// a search grows with its reach.
GapVisit searchNearest(const MeshPair& pair, const BvhPair& trees, double enough) {
  double reach = kFirstSearchReach * std::min(pair.a.size, pair.b.size);
  while (true) {
    const double bound = std::min(reach, enough);
    GapVisit visit{pair, bound * bound};
    trees.visitNear(visit);
    if (visit.intersect || visit.onA.feature != Feature::none || bound >= enough) return visit;
    reach *= kSearchReachGrowth;
  }
}

}  // namespace

MeshGap gapBetween(const MeshPair& pair, double enough) {
  const BvhPair trees(pair.a.tree, pair.b.tree, pair.aFromB);
  const double size = std::min(pair.a.size, pair.b.size);
  const GapVisit nearest = searchNearest(pair, trees, std::max(enough, kMinReachRatio * size));
  if (nearest.intersect) {
    OverlapVisit overlap{pair, kMinReachRatio * size * kMinReachRatio * size, {}};
    overlap.deepest.separation = 0;
    trees.visitNear(overlap);
    return overlap.wayOut();
  }
  MeshGap gap;
  const bool isNear = nearest.onA.feature != Feature::none;
  if (isNear) gap = gapOf(pair, nearest);
  // Where nothing is near, or a part other than the nearest one may be inside.
  if (!isNear || pair.a.parts.size() + pair.b.parts.size() > 2) keepPartsInside(pair, gap);
  return gap;
}

}  // namespace cradle
