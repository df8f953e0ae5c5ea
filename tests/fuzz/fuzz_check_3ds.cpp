// Bytes as the chunks of a 3ds file: a mesh that is accepted has one entry a face, and materials that are there.

#include "fuzz_target.h"
#include "mesh/check_3ds.h"

namespace cradle {
namespace {

void check(const Summary3ds& summary, std::size_t size) {
  for (const Mesh3ds& mesh : summary.meshes) {
    HOLDS(mesh.smoothingGroups.size() <= size && mesh.materialOf.size() <= size && mesh.name.size() <= size);
    HOLDS(mesh.smoothingGroups.empty() || mesh.smoothingGroups.size() == mesh.materialOf.size());
    for (const std::uint16_t material : mesh.materialOf)
      HOLDS(material == kNoMaterial || material < mesh.materials.size());
  }
}

}  // namespace
}  // namespace cradle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  acceptOrRefuse([&] { check(check3ds(textOf(data, size), "mesh.3ds"), size); });
  return 0;
}
