// Every triangle puts its three directed edges into a list; sorted, the two sides of an edge stand next to each other.

#include "mesh/solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "mesh/mass_properties.h"
#include "mesh/mesh_parts.h"

namespace cradle {
namespace {

// Volume over surface times size: below this a mesh is a sheet, and its volume is rounding.
constexpr double kFlat = 1e-12;

constexpr std::size_t kMaxTold = 10;  // pairs of parts that overlap

struct Edge {
  std::uint32_t low, high;  // vertices, low < high
  bool rises;               // whether the triangle runs from low to high
  bool operator<(const Edge& other) const {
    return std::tie(low, high, rises) < std::tie(other.low, other.high, other.rises);
  }
  bool joins(const Edge& other) const { return low == other.low && high == other.high; }
};

// How many edges have a fault, and the first of them.
struct Fault {
  std::size_t count = 0;
  std::optional<Edge> first;
  void add(const Edge& edge) {
    ++count;
    if (!first) first = edge;
  }
};

std::vector<Edge> sortedEdges(const TriangleMesh& mesh) {
  const auto forEachEdge = [&mesh](const auto& take) {
    for (const Triangle& triangle : mesh.triangles)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::uint32_t from = triangle[corner], to = triangle[(corner + 1) % 3];
        take(Edge{std::min(from, to), std::max(from, to), from < to});
      }
  };
  // Counted into their place by the lower vertex; the few that share it are sorted.
  std::vector<std::uint32_t> starts(mesh.vertices.size() + 1, 0);
  forEachEdge([&](const Edge& edge) { ++starts[edge.low + 1]; });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<Edge> edges(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  forEachEdge([&](const Edge& edge) { edges[next[edge.low]++] = edge; });
  for (std::size_t vertex = 0; vertex + 1 < starts.size(); ++vertex)
    std::sort(edges.begin() + starts[vertex], edges.begin() + starts[vertex + 1]);
  return edges;
}

std::string point(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::string describe(const Fault& fault, const TriangleMesh& mesh, const char* what, const char* hint) {
  return fmt::format("{} edge{} {}; the first runs from {} to {}; {}", fault.count, fault.count == 1 ? "" : "s", what,
                     point(mesh.vertices[fault.first->low]), point(mesh.vertices[fault.first->high]), hint);
}

void checkEdges(const TriangleMesh& mesh, std::vector<std::string>& problems) {
  const std::vector<Edge> edges = sortedEdges(mesh);
  Fault open, shared, twisted;
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].joins(edges[begin])) ++end;
    if (end - begin == 1)
      open.add(edges[begin]);
    else if (end - begin > 2)
      shared.add(edges[begin]);
    else if (edges[begin].rises == edges[begin + 1].rises)
      twisted.add(edges[begin]);
  }
  if (open.count > 0)
    problems.push_back(describe(open, mesh, "open (only one triangle has it)",
                                "a face is missing there, or vertices that should meet differ"));
  if (shared.count > 0)
    problems.push_back(describe(shared, mesh, "non-manifold (more than two triangles share it)",
                                "parts touch or cross there: remove inner faces, or use one object of the file"));
  if (twisted.count > 0)
    problems.push_back(describe(twisted, mesh, "between triangles that face opposite sides",
                                "make the face orientation consistent in the modelling program"));
}

// True if all vertices are finite and all indices in range; else says what is not.
bool checkNumbers(const TriangleMesh& mesh, std::vector<std::string>& problems) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite())
      problems.push_back(fmt::format("vertex {} is not finite: {}", v, point(mesh.vertices[v])));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t index : mesh.triangles[t])
      if (index >= mesh.vertices.size())
        problems.push_back(
            fmt::format("triangle {} names vertex {}, but there are only {}", t, index, mesh.vertices.size()));
  if (problems.size() > 1) problems = {problems.front(), fmt::format("and {} more like it", problems.size() - 1)};
  return problems.empty();
}

void checkVolume(const TriangleMesh& mesh, std::vector<std::string>& problems) {
  Bounds bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  double area = 0;  // m^2
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    area += (b - a).cross(c - a).norm() / 2;
  }
  const double volume = signedVolume(mesh);
  if (!std::isfinite(volume))
    problems.emplace_back("is too large: its volume overflows");
  else if (!(std::abs(volume) > kFlat * area * bounds.diagonal().norm()))
    problems.emplace_back("is flat: it encloses no volume");
  else if (volume < 0 && problems.empty())
    problems.push_back(fmt::format("is inside-out: its volume is {:.6g} m^3; turn its faces", volume));
}

void tellInsideOut(const PartReport& parts, std::vector<std::string>& problems) {
  for (const std::size_t part : parts.insideOut)
    problems.push_back(describePart(parts, part) + " is inside-out, and counts against the others; turn its faces");
}

void tellOverlaps(const PartReport& parts, std::vector<std::string>& problems) {
  if (parts.overlaps.empty()) return;
  const std::size_t told = std::min(parts.overlaps.size(), kMaxTold);
  problems.insert(problems.end(), parts.overlaps.begin(), parts.overlaps.begin() + static_cast<std::ptrdiff_t>(told));
  if (told < parts.overlaps.size())
    problems.push_back(fmt::format("and {} more pairs of parts overlap", parts.overlaps.size() - told));
  problems.emplace_back(
      "where parts overlap their volume counts twice: unite them in the modelling program, use one object of the file, "
      "make the body static, or give it `massFrom: hull`, or `mass` with `inertiaTensor`");
}

/// Parts that face different ways have no volume together that could be judged.
void checkClosed(const TriangleMesh& mesh, SolidReport& report) {
  const PartReport parts = examineParts(mesh);
  if (parts.parts.size() > 1 && !parts.insideOut.empty())
    tellInsideOut(parts, report.problems);
  else
    checkVolume(mesh, report.problems);
  report.isClosed = report.problems.empty();
  tellOverlaps(parts, report.problems);
}

}  // namespace

bool hasMatchingEdges(const TriangleMesh& mesh) {
  std::vector<std::string> problems;
  if (checkNumbers(mesh, problems)) checkEdges(mesh, problems);
  return problems.empty();
}

SolidReport checkSolid(const TriangleMesh& mesh) {
  SolidReport report;
  if (mesh.triangles.empty())
    report.problems.emplace_back("has no triangles");
  else if (checkNumbers(mesh, report.problems)) {
    checkEdges(mesh, report.problems);
    if (report.problems.empty())
      checkClosed(mesh, report);
    else
      checkVolume(mesh, report.problems);
  }
  report.isSolid = report.problems.empty();
  if (!report.isClosed)
    report.problems.emplace_back(
        "without a closed surface there is no volume, and so no mass: make the body static, or give it `massFrom: "
        "hull` "
        "or `massFrom: shell`, or `mass` with `inertiaTensor` and `collision: hull`");
  return report;
}

}  // namespace cradle
