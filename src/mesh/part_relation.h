#pragma once

#include "mesh/mesh_parts.h"

namespace cradle {

/// How the solids that two closed surfaces bound lie to each other, whichever way the surfaces face.
enum class PartRelation { apart, firstInside, secondInside, crossing };

/// The relation of two parts of a mesh, and a point (m) of both if they cross. Neither part is flat.
struct PartEncounter {
  PartRelation relation = PartRelation::apart;
  Vec3 place = Vec3::Zero();
};
PartEncounter relate(const TriangleMesh& mesh, const MeshPart& first, const MeshPart& second);

}  // namespace cradle
