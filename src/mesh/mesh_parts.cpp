#include "mesh/mesh_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "mesh/mass_properties.h"
#include "mesh/part_relation.h"

namespace cradle {
namespace {

// Volume over surface times size: below this a part is a sheet, and its volume is rounding.
constexpr double kSheetVolume = 1e-12;
// Triangles that are looked at to find which parts are near each other, and tests of one against another that tell how
// those lie to each other: a second or two.
constexpr std::size_t kMaxWork = 10'000'000, kMaxTests = 100'000'000;

/// Sets that are joined in pairs (R. E. Tarjan, "Efficiency of a good but not linear set union algorithm", J. ACM
/// 22(2), 1975, with path halving).
class DisjointTriangles {
 public:
  explicit DisjointTriangles(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t triangle) {
    while (parent_[triangle] != triangle) triangle = parent_[triangle] = parent_[parent_[triangle]];
    return triangle;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t rootA = find(a), rootB = find(b);
    parent_[std::max(rootA, rootB)] = std::min(rootA, rootB);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

DisjointTriangles joinedByEdges(const TriangleMesh& mesh) {
  struct Side {
    std::uint32_t low, high, triangle;
    bool operator<(const Side& other) const {
      return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle);
    }
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = mesh.triangles[t][i], to = mesh.triangles[t][(i + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), t});
    }
  std::sort(sides.begin(), sides.end());
  DisjointTriangles sets(mesh.triangles.size());
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
    if (sides[i].low == sides[i + 1].low && sides[i].high == sides[i + 1].high)
      sets.join(sides[i].triangle, sides[i + 1].triangle);
  return sets;
}

/// Bounds and volume of a part whose triangles are known.
void measure(const TriangleMesh& mesh, MeshPart& part) {
  TriangleMesh alone;  // far from the other parts, its volume keeps its digits
  double area = 0;     // m^2
  for (const std::uint32_t t : part.triangles) {
    const auto first = static_cast<std::uint32_t>(alone.vertices.size());
    for (const std::uint32_t corner : mesh.triangles[t]) {
      alone.vertices.push_back(mesh.vertices[corner]);
      part.bounds.extend(mesh.vertices[corner]);
    }
    alone.triangles.push_back({first, first + 1, first + 2});
    area += (alone.vertices[first + 1] - alone.vertices[first])
                .cross(alone.vertices[first + 2] - alone.vertices[first])
                .norm() /
            2;
  }
  const double volume = signedVolume(alone);
  part.volume = std::abs(volume) > kSheetVolume * area * part.bounds.diagonal().norm() ? volume : 0;
}

/// Parts inside which each part lies.
using Containers = std::vector<std::vector<std::size_t>>;

/// Calls meet(a, b) for pairs of parts that are not flat and whose bounds overlap, until it is false; a < b. Bounds are
/// swept along x. False if that was given up: a file of thousands of parts around each other would take hours.
template <class Meet>
bool forEachNearPair(const std::vector<MeshPart>& parts, const Meet& meet) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].volume != 0) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(parts[a].bounds.min().x(), a) < std::pair(parts[b].bounds.min().x(), b);
  });
  std::size_t work = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const MeshPart &one = parts[order[i]], &other = parts[order[j]];
      if (other.bounds.min().x() > one.bounds.max().x()) break;
      const bool isNear = one.bounds.intersects(other.bounds);
      work += 1 + (isNear ? one.triangles.size() + other.triangles.size() : 0);
      if (work > kMaxWork) return false;
      if (isNear && !meet(std::min(order[i], order[j]), std::max(order[i], order[j]))) return false;
    }
  return true;
}

Containers findContainers(const TriangleMesh& mesh, PartReport& report) {
  Containers containers(report.parts.size());
  std::size_t testsLeft = kMaxTests;
  const bool isWhole = forEachNearPair(report.parts, [&](std::size_t a, std::size_t b) {
    const PartEncounter encounter = relate(mesh, report.parts[a], report.parts[b], testsLeft);
    if (encounter.relation == PartRelation::firstInside) containers[a].push_back(b);
    if (encounter.relation == PartRelation::secondInside) containers[b].push_back(a);
    if (encounter.relation == PartRelation::crossing)
      report.overlaps.push_back(fmt::format("{} and {} overlap at ({:.6g}, {:.6g}, {:.6g})", describePart(report, a),
                                            describePart(report, b), encounter.place.x(), encounter.place.y(),
                                            encounter.place.z()));
    return encounter.relation != PartRelation::unknown;
  });
  if (!isWhole)
    report.overlaps.push_back(
        fmt::format("its {} parts lie around each other, too many or of too many triangles to see which overlap",
                    report.parts.size()));
  return containers;
}

/// Decides from the outermost parts inwards which way each must face. Around a part, the surface winds as often as the
/// parts that contain it face outwards, less those that face inwards: 0 in the open or in a cavity, 1 in a solid.
void findInsideOut(const Containers& containers, PartReport& report) {
  std::vector<std::size_t> order(report.parts.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto depth = [&](std::size_t part) { return containers[part].size(); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth(a) < depth(b); });
  std::vector<int> way(report.parts.size());  // 1: outwards
  std::vector<char> isTurned(report.parts.size(), 0);
  for (const std::size_t part : order) {
    if (report.parts[part].volume == 0) continue;
    way[part] = report.parts[part].volume > 0 ? 1 : -1;
    int winding = 0;
    std::size_t around = part;  // the innermost container
    for (const std::size_t container : containers[part]) {
      winding += way[container];
      if (around == part || depth(container) > depth(around)) around = container;
    }
    // A mesh inside-out as a whole has cavities that face outwards.
    const bool turns = winding <= 0 ? way[part] < 0 : way[part] > 0 && isTurned[around] != 0;
    if (turns) way[part] = -way[part], isTurned[part] = 1, report.insideOut.push_back(part);
    if (winding > 0 && way[part] > 0)
      report.overlaps.push_back(fmt::format("{} lies inside {}; as a cavity its faces would have to face inwards",
                                            describePart(report, part), describePart(report, around)));
  }
  std::sort(report.insideOut.begin(), report.insideOut.end());
}

}  // namespace

std::vector<MeshPart> partsOf(const TriangleMesh& mesh) {
  DisjointTriangles sets = joinedByEdges(mesh);
  std::vector<MeshPart> parts;
  std::vector<std::size_t> partOfRoot(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t root = sets.find(t);  // the set's least triangle, which comes first
    if (root == t) partOfRoot[t] = parts.size(), parts.emplace_back();
    parts[partOfRoot[root]].triangles.push_back(t);
  }
  for (MeshPart& part : parts) measure(mesh, part);
  return parts;
}

PartReport examineParts(const TriangleMesh& mesh) {
  PartReport report{partsOf(mesh), {}, {}};
  findInsideOut(findContainers(mesh, report), report);
  return report;
}

std::string describePart(const PartReport& report, std::size_t part) {
  const MeshPart& found = report.parts[part];
  const Vec3 center = found.bounds.center();
  return fmt::format("part {} of {} ({} triangles around ({:.6g}, {:.6g}, {:.6g}))", part + 1, report.parts.size(),
                     found.triangles.size(), center.x(), center.y(), center.z());
}

}  // namespace cradle
