#pragma once

#include <string>

namespace cradle {

/// `cradle inspect MESH [--json] [--scale S]`: what a mesh file's objects are as bodies of density 1. Prints to stdout.
void inspectMesh(const std::string& path, double scale, bool asJson);

}  // namespace cradle
