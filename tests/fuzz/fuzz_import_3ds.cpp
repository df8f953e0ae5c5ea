// Bytes as a 3ds file, parsed here instead of in a child: what our own look at the chunks lets through must not make
// the importer crash or fill memory.

#include "imported_objects.h"
#include "mesh/assemble_model.h"
#include "mesh/solid.h"

// The importer leaks when it gives up: the leak sanitizer asks this function.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp";
}

namespace cradle {
namespace {

void check(std::vector<ImportedObject> objects) {
  checkObjects(objects);
  for (ImportedObject& object : objects) {
    const TriangleMesh solid = assembleModel(object.name, std::move(object.pieces), ModelParts::solidAlone).model.solid;
    for (const Triangle& triangle : solid.triangles)
      for (const std::uint32_t vertex : triangle) HOLDS(vertex < solid.vertices.size());
    if (!solid.triangles.empty()) checkSolid(solid);
  }
}

}  // namespace
}  // namespace cradle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  static const ScratchFile file("mesh.3ds");
  file.write(textOf(data, size));
  acceptOrRefuse([] { check(parseObjects(file.path())); });
  return 0;
}
