#pragma once

#include <string>
#include <vector>

#include "mesh/import_mesh.h"

namespace cradle {

/// Objects as the process that parsed their file sends them to the one that asked.
std::string bytesOf(const std::vector<ImportedObject>& objects);

/// Back. The process may have sent anything: sizes are checked before memory is taken, numbers must be finite. Throws
/// Error(mesh) naming `path`.
std::vector<ImportedObject> objectsFromBytes(const std::string& bytes, const std::string& path);

}  // namespace cradle
