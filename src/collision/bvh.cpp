// C. Ericson, "Real-Time Collision Detection", 2005, chapter 6: top-down construction, object median split.

#include "collision/bvh.h"

#include <numeric>

namespace cradle {
namespace {

struct Builder {
  const TriangleMesh& mesh;
  std::vector<Vec3> middles;
  std::vector<std::uint32_t> order;
  Bvh tree;

  Bounds boundsOf(std::size_t from, std::size_t to) const {
    Bounds bounds;
    for (std::size_t i = from; i < to; ++i)
      for (const std::uint32_t corner : mesh.triangles[order[i]]) bounds.extend(mesh.vertices[corner]);
    return bounds;
  }

  /// Adds the subtree of order[from .. to).
  void add(std::size_t from, std::size_t to) {
    const Bounds bounds = boundsOf(from, to);
    const std::size_t node = tree.nodes.size();
    tree.nodes.push_back({bounds.center(), bounds.sizes() / 2, 0, order[from]});
    if (to - from == 1) return;
    Eigen::Index axis = 0;
    bounds.sizes().maxCoeff(&axis);
    // A total order: the result does not depend on how it is sorted.
    const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::sort(at(from), at(to), [&](std::uint32_t left, std::uint32_t right) {
      return std::pair(middles[left][axis], left) < std::pair(middles[right][axis], right);
    });
    const std::size_t middle = from + (to - from) / 2;
    add(from, middle);
    tree.nodes[node].second = static_cast<std::uint32_t>(tree.nodes.size());
    add(middle, to);
  }
};

}  // namespace

Bvh buildBvh(const TriangleMesh& mesh) {
  Builder builder{mesh, {}, std::vector<std::uint32_t>(mesh.triangles.size()), {}};
  for (const auto& [i, j, k] : mesh.triangles)
    builder.middles.push_back(mesh.vertices[i] + mesh.vertices[j] + mesh.vertices[k]);
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  builder.tree.nodes.reserve(2 * mesh.triangles.size());
  builder.add(0, mesh.triangles.size());
  return std::move(builder.tree);
}

}  // namespace cradle
