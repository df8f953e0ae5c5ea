#include "collision/mesh_contact.h"

#include "collision/contact_reduction.h"
#include "collision/mesh_gap.h"
#include "collision/normal_cone.h"

namespace cradle {
namespace {

// Of the size: of meshes in each other more deeply than that, features do not tell the way out, and the deepest place
// alone is a contact.
constexpr double kDeepRatio = 0.01;
// Sine: edges at a smaller angle have no sure crossing, and their ends touch faces instead. A tenth or ten times as
// much, also of the ratio above, changes no test.
constexpr double kParallelEdgeSine = 1e-6;

/// A contact with its features: contacts are sorted by these, so that their order does not depend on the search.
struct Candidate {
  std::array<std::uint32_t, 3> key;  // kind; feature of A, of B
  ContactPoint contact;
};

struct ContactVisit {
  const MeshPair& pair;
  double margin, depth;  // m: contacts have separations from -depth to margin
  std::vector<Candidate> found = {};

  double reach() const { return std::max(margin, depth) * std::max(margin, depth); }
  bool counts(double separation) const { return separation <= margin && separation >= -depth; }

  void operator()(std::uint32_t indexA, std::uint32_t indexB) {
    const MeshSurface::Face &faceA = pair.a.faces[indexA], &faceB = pair.b.faces[indexB];
    const FlatTriangle a = triangleOf(pair.a, indexA), b = pair.triangleOfB(indexB);
    const CornerHeights ofA = heightsOver(b, a), ofB = heightsOver(a, b);
    const double least = std::max(leastDistance(ofA), leastDistance(ofB));
    if (least * least > reach()) return;
    for (std::size_t i = 0; i < 3; ++i) {
      if (faceA.ownsVertex[i] && counts(ofA[i]) && b.isAbove(cornerOf(a, i), kBeyondEnd) &&
          isInNormalCone(pair.a, faceA.vertices[i], -b.normal, margin))
        add({0, faceA.vertices[i], indexB}, {cornerOf(a, i) - ofA[i] / 2 * b.normal, -b.normal, ofA[i], 0, kFlat});
      if (faceB.ownsVertex[i] && counts(ofB[i]) && a.isAbove(cornerOf(b, i), kBeyondEnd) &&
          isInNormalCone(pair.b, faceB.vertices[i], -pair.turnedBack(a.normal), margin))
        add({1, indexA, faceB.vertices[i]}, {cornerOf(b, i) - ofB[i] / 2 * a.normal, a.normal, ofB[i], kFlat, 0});
    }
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (faceA.ownsEdge[i] && faceB.ownsEdge[j]) tryEdges(faceA.edges[i], faceB.edges[j]);
  }

  void tryEdges(std::uint32_t indexA, std::uint32_t indexB) {
    const MeshSurface::Edge &edgeA = pair.a.edges[indexA], &edgeB = pair.b.edges[indexB];
    if (!edgeA.isConvex || !edgeB.isConvex) return;
    const Segment a = segmentOf(pair.a, indexA), b = pair.segmentOfB(indexB);
    Vec3 normal = a.along.cross(b.along);
    const Vec3 between = b.from - a.from;
    const double sine2 = normal.squaredNorm();
    if (!(sine2 > kParallelEdgeSine * kParallelEdgeSine * a.along.squaredNorm() * b.along.squaredNorm())) return;
    const double partA = between.cross(b.along).dot(normal) / sine2, partB = between.cross(a.along).dot(normal) / sine2;
    if (std::max(std::abs(partA - 0.5), std::abs(partB - 0.5)) > 0.5 + kBeyondEnd) return;
    const Vec3 outOfA = pair.a.isSheet ? Vec3(-pair.turned(edgeB.normal)) : edgeA.normal;
    normal /= outOfA.dot(normal) < 0 ? -std::sqrt(sine2) : std::sqrt(sine2);
    const double separation = between.dot(normal);
    if (!counts(separation) || !isInNormalCone(pair.a, edgeA, normal, margin) ||
        !isInNormalCone(pair.b, edgeB, -pair.turnedBack(normal), margin))
      return;
    add({2, indexA, indexB}, {a.at(partA) + separation / 2 * normal, normal, separation, kNotRound, kNotRound});
  }

  void add(const std::array<std::uint32_t, 3>& key, const ContactPoint& contact) { found.push_back({key, contact}); }
};

}  // namespace

void appendContacts(const MeshPair& pair, double margin, std::vector<ContactPoint>& contacts) {
  const MeshGap gap = gapBetween(pair, margin);
  if (!(gap.separation <= margin)) return;
  const std::size_t first = contacts.size();
  const double size = std::min(pair.a.size, pair.b.size), rounding = MeshTolerances(size).rounding;
  double least = std::numeric_limits<double>::infinity();
  if (gap.separation > -kDeepRatio * size) {
    ContactVisit visit{pair, margin, std::max(0.0, -gap.separation) + rounding};
    BvhPair(pair.a.tree, pair.b.tree, pair.aFromB).visitNear(visit);
    std::sort(visit.found.begin(), visit.found.end(),
              [](const Candidate& left, const Candidate& right) { return left.key < right.key; });
    for (const Candidate& candidate : visit.found) {
      contacts.push_back(candidate.contact);
      least = std::min(least, candidate.contact.separation);
    }
  }
  if (least > gap.separation + rounding)
    contacts.push_back({(gap.pointA + gap.pointB) / 2, gap.normal, gap.separation, kNotRound, kNotRound});
  reduceContacts(first, size, contacts);
}

}  // namespace cradle
