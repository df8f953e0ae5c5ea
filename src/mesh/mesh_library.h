#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mesh/import_mesh.h"
#include "mesh/load_mesh.h"

namespace cradle {

/// The mesh files of a scene. Each is parsed once, whatever the scales and objects that are asked for, and again only
/// where all of them are too large to be kept; a file that could not be read is not tried again.
class MeshLibrary {
 public:
  MeshLibrary();
  ~MeshLibrary();
  MeshLibrary(const MeshLibrary&) = delete;
  MeshLibrary& operator=(const MeshLibrary&) = delete;

  /// Throws as loadModel does, and Error(mesh) if the files so far have taken longer than so many should.
  LoadedModel load(const MeshReference& reference);

 private:
  struct File;
  std::vector<ImportedObject> parse(const std::string& path);

  std::map<std::string, std::unique_ptr<File>> files_;  // by path
  std::size_t kept_ = 0;                                // bytes of triangles
  double secondsUsed_ = 0, secondsAllowed_;             // s, of computing
};

}  // namespace cradle
