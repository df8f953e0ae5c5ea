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

  void vertexOverFace(Partner partner, std::uint32_t vertex, std::uint32_t face) {
    const MeshSurface &own = pair.surface(partner), &other = pair.surface(otherThan(partner));
    const FlatTriangle triangle = triangleOf(other, face);
    const Vec3& corner = own.vertices[vertex];
    const Vec3 seen = pair.seenFromOther(partner, corner);
    const double height = triangle.heightOf(seen);
    if (!counts(height) || !triangle.isAbove(seen, kBeyondEnd)) return;
    const Vec3 ahead = -pair.turnedToOther(otherThan(partner), triangle.normal);
    if (!isInNormalCone(own, vertex, ahead, margin)) return;
    if (partner == Partner::a)
      add({0, vertex, face}, {corner + height / 2 * ahead, ahead, height, 0, kFlat});
    else
      add({1, face, vertex}, {seen - height / 2 * triangle.normal, triangle.normal, height, kFlat, 0});
  }

  void edgeOverEdge(std::uint32_t indexA, std::uint32_t indexB) {
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

void appendContacts(const MeshPair& pair, FeatureNeighbourList& near, double margin,
                    std::vector<ContactPoint>& contacts) {
  const MeshGap gap = gapBetween(pair, near, margin);
  if (!(gap.separation <= margin)) return;
  const std::size_t first = contacts.size();
  const double size = std::min(pair.a.size, pair.b.size), rounding = MeshTolerances(size).rounding;
  double least = std::numeric_limits<double>::infinity();
  if (gap.separation > -kDeepRatio * size) {
    ContactVisit visit{pair, margin, std::max(0.0, -gap.separation) + rounding};
    near.visitNear(pair, visit);
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
