#pragma once

#include "mesh/mesh_parts.h"

namespace cradle {

/// How the solids that two closed surfaces bound lie to each other, whichever way the surfaces face.
enum class PartRelation { apart, firstInside, secondInside, crossing, unknown };

/// The relation of two parts of a mesh, and a point (m) of both if they cross. Neither part is flat. It costs up to the
/// product of their triangles; `testsLeft` is how many of one against the other may still be tested, here and by calls
/// to come: the relation is unknown where there are none left.
struct PartEncounter {
  PartRelation relation = PartRelation::apart;
  Vec3 place = Vec3::Zero();
};
PartEncounter relate(const TriangleMesh& mesh, const MeshPart& first, const MeshPart& second, std::size_t& testsLeft);

}  // namespace cradle
