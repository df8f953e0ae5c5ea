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
// Of a side: triangles reach beyond their sides by 90 unit roundoffs where edges go through them, so that none slips
// through between two of them, whose sides are rounded each for itself.
constexpr double kSideOverlap = 1e-14;

using Feature = MeshPoint::Feature;

/// A point on a feature, in A's frame.
struct Witness {
  Feature feature = Feature::none;
  std::uint32_t index = 0;
  Vec3 point = Vec3::Zero();  // m

  std::pair<Feature, std::uint32_t> key() const { return {feature, index}; }
};

/// Outward normal (unit) of a feature, in its own frame.
const Vec3& normalAt(const MeshSurface& surface, const Witness& witness) {
  if (witness.feature == Feature::face) return surface.faces[witness.index].normal;
  if (witness.feature == Feature::edge) return surface.edges[witness.index].normal;
  return surface.vertexNormals[witness.index];
}

/// Where an edge goes through a face.
struct Crossing {
  double part;   // 0..1 of the edge
  double depth;  // m: of its deeper end beneath the plane of the face
};

/// Of an edge of the partner's surface and a face of the other one; none: it does not go through.
std::optional<Crossing> crossingOf(const MeshPair& pair, Partner partner, std::uint32_t edge, std::uint32_t face) {
  const MeshSurface& own = pair.surface(partner);
  const FlatTriangle triangle = triangleOf(pair.surface(otherThan(partner)), face);
  const auto& [first, last] = own.edges[edge].vertices;
  const Vec3 from = pair.seenFromOther(partner, own.vertices[first]),
             to = pair.seenFromOther(partner, own.vertices[last]);
  const double one = triangle.heightOf(from), other = triangle.heightOf(to);
  if ((one < 0) == (other < 0)) return {};
  const double part = one / (one - other);
  if (!triangle.isAbove(from + part * (to - from), kSideOverlap)) return {};
  return Crossing{part, -std::min(one, other)};
}

/// Finds the nearest features of two surfaces that do not intersect, of equally near ones those of the lowest numbers.
struct NearestFeatures {
  const MeshPair& pair;
  double distance2;  // m^2: of the nearest features so far, or the square of the reach
  Witness onA = {}, onB = {};

  double reach() const { return distance2; }
  bool areFound() const { return onA.feature != Feature::none; }

  void vertexOverFace(Partner partner, std::uint32_t vertex, std::uint32_t face) {
    const Vec3& corner = pair.surface(partner).vertices[vertex];
    const Vec3 seen = pair.seenFromOther(partner, corner);
    const FlatTriangle triangle = triangleOf(pair.surface(otherThan(partner)), face);
    const double height = triangle.heightOf(seen);
    if (height * height > distance2 || !triangle.isAbove(seen)) return;
    if (partner == Partner::a)
      keep({Feature::vertex, vertex, corner}, {Feature::face, face, corner - height * pair.turned(triangle.normal)});
    else
      keep({Feature::face, face, seen - height * triangle.normal}, {Feature::vertex, vertex, seen});
  }

  void edgeOverEdge(std::uint32_t edgeA, std::uint32_t edgeB) {
    const Segment a = segmentOf(pair.a, edgeA), b = pair.segmentOfB(edgeB);
    const SegmentParts parts = nearestParts(a, b);
    const Vec3 pointA = a.at(parts.a), pointB = b.at(parts.b);
    if ((pointA - pointB).squaredNorm() > distance2) return;
    keep(onEdge(pair.a, edgeA, parts.a, pointA), onEdge(pair.b, edgeB, parts.b, pointB));
  }

  static Witness onEdge(const MeshSurface& surface, std::uint32_t edge, double part, const Vec3& point) {
    if (part > 0 && part < 1) return {Feature::edge, edge, point};
    return {Feature::vertex, surface.edges[edge].vertices[part > 0 ? 1 : 0], point};
  }

  void keep(const Witness& a, const Witness& b) {
    const double found = (a.point - b.point).squaredNorm();
    const bool isFirst = onA.feature == Feature::none || std::pair(a.key(), b.key()) < std::pair(onA.key(), onB.key());
    if (found > distance2 || (found == distance2 && !isFirst)) return;
    distance2 = found;
    onA = a, onB = b;
  }
};

/// An overlap at an edge that goes through a face.
struct EdgeOverlap {
  MeshGap gap = {0, {}, {}, Vec3::Zero()};
  std::array<std::uint32_t, 3> key = {};  // whether the edge is B's; edge; face

  bool isFound() const { return gap.normal != Vec3::Zero(); }
};

/// Finds the edge that is deepest inside the other solid or beyond a sheet, of those that go through its surface; of
/// equally deep ones that of the lowest number. Edges at which their surface goes straight on are looked at where those
/// of its outline get out by a shorter way than that through the face that they came in by: as a cube exactly above
/// another one, whose outlines lie in each other's sides.
struct OverlapVisit {
  const MeshPair& pair;
  bool isOfOutline = true;
  double beneath = 0;  // m: of the outline, deepest beneath a face that it goes through
  double least = 0;    // m: edges that go straight on count if they are deeper beneath a face
  EdgeOverlap deepest = {};
  EdgeOverlap leaving = {};     // a sheet, straight ...
  EdgeOverlap pastBorder = {};  // ... or past its border

  void edgeThroughFace(Partner partner, std::uint32_t index, std::uint32_t face) {
    const MeshSurface &own = pair.surface(partner), &other = pair.surface(otherThan(partner));
    const auto crossing = crossingOf(pair, partner, index, face);
    if (!crossing || (!isOfOutline && crossing->depth <= least)) return;
    if (isOfOutline) beneath = std::max(beneath, crossing->depth);
    const Segment edge = segmentOf(own, index);
    const Vec3 from = pair.seenFromOther(partner, edge.from);
    const Segment seen{from, pair.turnedToOther(partner, edge.along)};
    const Vec3 inner = own.inner ? pair.seenFromOther(partner, *own.inner) : seen.at(0.5);
    const EdgeDepth found = depthOf(seen, crossing->part, inner, other, face);
    EdgeOverlap overlap{{-found.depth, found.deepest + found.depth * found.normal, found.deepest, found.normal},
                        {partner == Partner::a ? 0u : 1u, index, face}};
    if (partner == Partner::a) {
      const Vec3 normal = pair.turned(found.normal), point = pair.placed(found.deepest);
      overlap.gap = {-found.depth, point, point + found.depth * normal, -normal};
    }
    keep(overlap, own.edges[index], other.isSheet);
  }

  /// The depth of an edge that goes through a face. Out of a sheet there are two ways: towards the side on which the
  /// solid's inner point is (if none is known, most of the edge), or towards the other side. The latter is taken if it
  /// is much shorter: over a steep crease, much of a solid is behind the planes of faces that it barely touches.
  static EdgeDepth depthOf(const Segment& edge, double part, const Vec3& inner, const MeshSurface& other,
                           std::uint32_t face) {
    if (!other.isSheet) return depthOfEdge(other, edge, part, face);
    const auto triangles = static_cast<std::uint32_t>(other.faces.size() / 2);
    const std::uint32_t back = face < triangles ? face + triangles : face - triangles;
    const bool isInFront = triangleOf(other, face).heightOf(inner) >= 0;
    const EdgeDepth towards = depthOfEdge(other, edge, part, isInFront ? face : back);
    const EdgeDepth away = depthOfEdge(other, edge, part, isInFront ? back : face);
    return away.depth < kBarelyPassedRatio * towards.depth ? away : towards;
  }

  bool isFound() const { return deepest.isFound() || leaving.isFound(); }

  /// Whether no way out of the outline is shorter than that by which it came in. If one is, all further visits are of
  /// edges at which surfaces go straight on.
  bool isOutlineEnough() {
    isOfOutline = false;
    least = -std::min(deepest.gap.separation, leaving.gap.separation);
    return beneath <= (1 + kBarelyPassedRatio) * least;
  }

  /// The deepest of all; of a sheet whose border is barely inside the solid, the way past that border.
  MeshGap wayOut() const {
    if (!leaving.isFound()) return deepest.gap;
    if (pastBorder.isFound() && pastBorder.gap.separation > kBarelyPassedRatio * leaving.gap.separation)
      return pastBorder.gap;
    return deepest.gap.separation < leaving.gap.separation ? deepest.gap : leaving.gap;
  }

  static void keepDeeper(const EdgeOverlap& found, EdgeOverlap& kept) {
    const auto depth = [](const EdgeOverlap& overlap) { return std::pair(overlap.gap.separation, overlap.key); };
    if (!kept.isFound() || depth(found) < depth(kept)) kept = found;
  }

  void keep(const EdgeOverlap& found, const MeshSurface::Edge& edge, bool isPastSheet) {
    keepDeeper(found, isPastSheet ? leaving : deepest);
    if (edge.isBorder) keepDeeper(found, pastBorder);
  }
};

/// The gap of two surfaces that do not intersect, from their nearest points.
MeshGap gapOf(const MeshPair& pair, const NearestFeatures& nearest) {
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
NearestFeatures searchNearest(const MeshPair& pair, FeatureNeighbourList& near, double enough) {
  double reach = kFirstSearchReach * std::min(pair.a.size, pair.b.size);
  while (true) {
    const double bound = std::min(reach, enough);
    NearestFeatures nearest{pair, bound * bound};
    near.visitNear(pair, nearest);
    if (nearest.areFound() || bound >= enough) return nearest;
    reach *= kSearchReachGrowth;
  }
}

}  // namespace

MeshGap gapBetween(const MeshPair& pair, FeatureNeighbourList& near, double enough) {
  OverlapVisit overlap{pair};
  near.visitCrossings(pair, FeatureNeighbourList::Edges::bent, overlap);
  if (overlap.isFound()) {
    if (!overlap.isOutlineEnough()) near.visitCrossings(pair, FeatureNeighbourList::Edges::straight, overlap);
    return overlap.wayOut();
  }
  const double size = std::min(pair.a.size, pair.b.size);
  const NearestFeatures nearest = searchNearest(pair, near, std::max(enough, kMinReachRatio * size));
  MeshGap gap;
  if (nearest.areFound()) gap = gapOf(pair, nearest);
  // Where nothing is near, or a part other than the nearest one may be inside.
  if (!nearest.areFound() || pair.a.parts.size() + pair.b.parts.size() > 2) keepPartsInside(pair, gap);
  return gap;
}

}  // namespace cradle
