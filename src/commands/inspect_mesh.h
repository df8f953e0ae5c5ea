#pragma once

#include <string>
#include <vector>

namespace cradle {

struct InspectOptions {
  double scale = 1;            // file's units to metres
  bool listsVertices = false;  // by the numbers that anchors of scenes have: {"vertex": n}
  std::vector<double> near;    // x, y, z, m: those nearest to it alone, the nearest first; or none
  bool asJson = false;
};

/// `cradle inspect MESH`: what a mesh file's objects are as bodies of density 1. Prints to stdout. Throws Error(usage)
/// for a scale, or a place, that cannot be, and what loading throws.
void inspectMesh(const std::string& path, const InspectOptions& options);

}  // namespace cradle
