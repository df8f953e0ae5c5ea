// What the child that parses a mesh may send: objects that are accepted come back as they were when they are sent
// again.

#include "imported_objects.h"
#include "mesh/imported_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  acceptOrRefuse([&] {
    const std::vector<ImportedObject> objects = objectsFromBytes(textOf(data, size), "mesh.3ds");
    checkObjects(objects);
    const std::string again = bytesOf(objects);
    HOLDS(bytesOf(objectsFromBytes(again, "mesh.3ds")) == again);
  });
  return 0;
}
