// The depth of the points of a straight line under the surface is a concave function along the line as long as the
// solid is convex there. Its greatest value is found by tangent planes (J. E. Kelley, "The cutting-plane method for
// solving convex programs", 1960). It lies where two planes, with unit normals n1 and n2, meet in an edge above the
// line. The mean m of n1 and n2 that is perpendicular to the line is perpendicular to the edge, too, and leads straight
// from the line to the edge: their distance is the depth under the planes divided by |m|.

#include "collision/mesh_overlap.h"

#include <array>
#include <cmath>

namespace cradle {
namespace {

// A tenth or ten times as much of any of these ratios changes no test.
constexpr double kEntryRatio = 1e-12;    // of the piece: an exit as near to its beginning is the entry itself
constexpr double kOnSheetRatio = 1e-14;  // of a sheet's size, 90 unit roundoffs: the piece begins on a triangle's back
constexpr double kThroughEdgeRatio = 1e-11;  // of an edge: a line as near to it goes through it
constexpr double kDepthErrorRatio = 1e-9;    // of the depth: planes that bound it as closely give the depth itself
constexpr int kMaxFacesAroundVertex = 16;    // that a line passes by; half or twice as many change no test
// Length of the mean of two unit normals: faces back to back, within 0.002 rad, leave no way out between them.
constexpr double kMinMeanLength = 1e-3;
constexpr std::size_t kMaxTangentPlanes = 12;  // with more, the depth under the first of them is taken

/// Visits triangles for the place at which a segment first leaves the solid.
struct ExitVisit {
  const MeshSurface& surface;
  const Segment& segment;
  Vec3 entry = Vec3::Zero();  // unit, of a sheet: outwards where the segment goes in
  double part = 2;            // 0..1; 2: nowhere
  Vec3 normal = Vec3::Zero();

  void visit(std::uint32_t at) {
    const Bvh::Node& node = surface.tree.nodes[at];
    if (!meets(node)) return;
    if (node.isLeaf()) return tryFace(node.triangle);
    visit(at + 1);
    visit(node.second);
  }

  bool meets(const Bvh::Node& node) const {
    double enter = 0, leave = std::min(part, 1.0);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double from = segment.from[axis] - node.center[axis], along = segment.along[axis];
      if (along == 0 && std::abs(from) > node.halfSize[axis]) return false;
      if (along == 0) continue;
      enter = std::max(enter, (-std::copysign(node.halfSize[axis], along) - from) / along);
      leave = std::min(leave, (std::copysign(node.halfSize[axis], along) - from) / along);
    }
    return enter <= leave + kEntryRatio;
  }

  void tryFace(std::uint32_t face) {
    const FlatTriangle triangle = triangleOf(surface, face);
    const double slope = triangle.normal.dot(segment.along);
    if (!(slope > 0)) return;
    const double height = triangle.heightOf(segment.from), found = -height / slope;
    if (found <= kEntryRatio || found > 1 || found >= part || !triangle.isAbove(segment.at(found))) return;
    if (triangle.normal.dot(entry) < 0 && std::abs(height) <= kOnSheetRatio * surface.size) return;
    part = found, normal = triangle.normal;
  }
};

/// Depth under a plane along the piece: depth + slope * (part - at).
struct DepthPlane {
  double at, depth, slope;
  Vec3 normal;

  double depthAt(double part) const { return depth + slope * (part - at); }
};

/// The least depth under several planes, an upper bound on the depth under the surface, and its greatest value.
class DepthBound {
 public:
  void add(const DepthPlane& plane) { planes_[count_++] = plane; }
  bool isFull() const { return count_ == kMaxTangentPlanes; }

  double depthAt(double part) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count_; ++i) least = std::min(least, planes_[i].depthAt(part));
    return least;
  }

  /// Among the ends of [0, end] and where a rising plane meets a falling one.
  void findTop(double end) {
    part = 0, depth = depthAt(0), rising = falling = nullptr;
    keepIfHigher(end, nullptr, nullptr);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t j = 0; j < count_; ++j) {
        const DepthPlane &up = planes_[i], &down = planes_[j];
        if (!(up.slope >= 0 && down.slope <= 0 && up.slope > down.slope)) continue;
        const double meet = (down.depthAt(0) - up.depthAt(0)) / (up.slope - down.slope);
        // Where a third plane is lower, it is not these two that bound the depth.
        const bool areLowest = depthAt(meet) >= up.depthAt(meet) * (1 - kDepthErrorRatio);
        if (meet > 0 && meet < end && areLowest) keepIfHigher(meet, &up, &down);
      }
  }

  double part = 0, depth = 0;
  const DepthPlane *rising = nullptr, *falling = nullptr;  // null at an end

 private:
  void keepIfHigher(double at, const DepthPlane* up, const DepthPlane* down) {
    const double found = depthAt(at);
    if (found > depth) part = at, depth = found, rising = up, falling = down;
  }

  std::array<DepthPlane, kMaxTangentPlanes> planes_;
  std::size_t count_ = 0;
};

DepthPlane planeAt(const MeshSurface& solid, const Segment& piece, double part) {
  const SignedHeight found = heightOver(solid, piece.at(part));
  const double sign = solid.isSheet ? -1 : 1;  // heights over a sheet are those over either side
  return {part, -sign * found.height, -sign * found.normal.dot(piece.along), sign * found.normal};
}

EdgeDepth depthBetween(const DepthBound& top, const Segment& piece, const Vec3& fallback) {
  const double rise = top.rising->slope, fall = -top.falling->slope;
  const Vec3 mean = (fall * top.rising->normal + rise * top.falling->normal) / (rise + fall);
  const double length = mean.norm();
  if (length < kMinMeanLength) return {top.depth, fallback, piece.at(top.part), false};
  EdgeDepth result{top.depth / length, mean / length, piece.at(top.part), false};
  // From there along the edge to the point that is straight below the other edge.
  const DepthPlane& steeper = rise > fall ? *top.rising : *top.falling;
  if (steeper.slope != 0)
    result.deepest += (result.depth * steeper.normal.dot(result.normal) - top.depth) / steeper.slope * piece.along;
  return result;
}

/// Whether a line that goes through a face of a sheet, to rounding at an edge of it, comes back at once over that edge:
/// it touches a crease there.
bool goesBackAtOnce(const MeshSurface& sheet, const Segment& line, std::uint32_t face) {
  for (int walked = 0; walked < kMaxFacesAroundVertex; ++walked) {
    const MeshSurface::Face& here = sheet.faces[face];
    const MeshSurface::Edge* crossed = nullptr;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& from = sheet.vertices[here.vertices[i]];
      const Vec3 along = sheet.vertices[here.vertices[(i + 1) % 3]] - from, outwards = along.cross(here.normal);
      const double near = kThroughEdgeRatio * along.squaredNorm();  // both sides times the edge's length
      if (std::abs(outwards.dot(line.from - from)) <= near && outwards.dot(line.along) > 0)
        crossed = &sheet.edges[here.edges[i]];
    }
    if (!crossed || crossed->isBorder) return false;
    face = crossed->faces[crossed->faces[0] == face ? 1 : 0];
    if (sheet.faces[face].normal.dot(line.along) >= 0) return true;
  }
  return false;
}

}  // namespace

EdgeDepth depthOfEdge(const MeshSurface& solid, const Segment& edge, double part, std::uint32_t face) {
  const Vec3& entry = solid.faces[face].normal;
  const bool goesOn = entry.dot(edge.along) < 0;
  const Segment piece{edge.at(part), (goesOn ? 1 - part : -part) * edge.along};
  if (solid.isSheet && goesBackAtOnce(solid, piece, face)) return {0, entry, piece.from, false};
  ExitVisit exit{solid, piece, solid.isSheet ? entry : Vec3(Vec3::Zero())};
  exit.visit(0);
  const bool leaves = exit.part <= 1;
  const double end = leaves ? exit.part : 1;

  DepthBound bound;
  const DepthPlane last =
      leaves ? DepthPlane{end, 0, -exit.normal.dot(piece.along), exit.normal} : planeAt(solid, piece, 1);
  bound.add({0, 0, -entry.dot(piece.along), entry});
  bound.add(last);
  for (bound.findTop(end); !bound.isFull(); bound.findTop(end)) {
    const DepthPlane tangent = planeAt(solid, piece, bound.part);
    if (tangent.depth >= bound.depth * (1 - kDepthErrorRatio)) break;
    bound.add(tangent);
  }
  if (bound.depth <= 0) return {0, entry, piece.from, false};
  if (!bound.rising) return {bound.depth, last.normal, piece.at(bound.part), !leaves};
  return depthBetween(bound, piece, last.normal);
}

}  // namespace cradle
