#pragma once

#include <string>
#include <vector>

#include "mesh/assemble_model.h"

namespace cradle {

/// An object of a mesh file.
struct ImportedObject {
  std::string name;
  std::vector<MeshPiece> pieces;
};

/// Whether a path has the name of a 3ds file, whose objects come out Y up.
bool isNamed3ds(const std::string& path);

/// The objects of a mesh file in its own units, in the order in which they first appear; see loadObjects. A child
/// process parses the file, with limits of memory and time: what comes back are triangles. Files that it names in turn
/// are read only below its folder. Throws Error(mesh).
std::vector<ImportedObject> importObjects(const std::string& path);

/// What the child does, in the process that calls: a damaged file may crash it, or fill its memory. Throws Error(mesh).
std::vector<ImportedObject> parseObjects(const std::string& path);

}  // namespace cradle
