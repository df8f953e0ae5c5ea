// The first byte names a format, the rest are a file of it: whatever the importer does in its child, the program gets
// finite triangles or an Error.

#include <array>

#include "imported_objects.h"

namespace {
constexpr std::array kFormats{"obj", "ply", "stl", "gltf", "glb", "off", "dae", "3ds", "x", "ac", "lwo", "raw"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  if (size == 0) return 0;
  static const std::array files = [] {
    std::array<std::unique_ptr<ScratchFile>, kFormats.size()> made;
    for (std::size_t i = 0; i < made.size(); ++i)
      made[i] = std::make_unique<ScratchFile>(std::string("mesh.") + kFormats[i]);
    return made;
  }();
  const ScratchFile& file = *files[data[0] % kFormats.size()];
  file.write(textOf(data + 1, size - 1));
  acceptOrRefuse([&] { checkObjects(importObjects(file.path())); });
  return 0;
}
