#pragma once

#include "fuzz_target.h"
#include "mesh/import_mesh.h"

namespace cradle {

/// What the rest of the program believes of the objects of a mesh file.
inline void checkObjects(const std::vector<ImportedObject>& objects) {
  for (const ImportedObject& object : objects)
    for (const MeshPiece& piece : object.pieces) {
      HOLDS(piece.corners.size() == 3 * piece.smoothing.size());
      HOLDS(piece.normals.empty() || piece.normals.size() == piece.corners.size());
      for (const Vec3& corner : piece.corners) HOLDS(corner.allFinite());
      HOLDS(piece.look.baseColor.allFinite());
    }
}

}  // namespace cradle
