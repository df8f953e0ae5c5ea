#include "commands/inspect_mesh.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/console.h"
#include "core/error.h"
#include "core/printable.h"
#include "mesh/load_mesh.h"
#include "mesh/mass_properties.h"
#include "mesh/recognise_shape.h"
#include "mesh/solid.h"
#include "scene/ranges.h"

namespace cradle {
namespace {

/// An object of a mesh file with all that is said about it.
struct Inspection {
  const LoadedModel& loaded;
  SolidReport report;
  MassProperties properties;  // density 1; zero if not solid
  std::string shape;
  Vec3 size;  // m, of the bounding box along the file's axes
};

Inspection inspect(const LoadedModel& loaded) {
  const TriangleMesh& mesh = loaded.model.solid;
  Inspection inspection{loaded, checkSolid(mesh), {}, "mesh", Vec3::Zero()};
  Bounds bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  if (!bounds.isEmpty()) inspection.size = bounds.sizes();
  if (!inspection.report.isSolid) return inspection;
  inspection.properties = computeMassProperties(mesh, 1);
  inspection.shape = shapeName(recogniseShape(mesh));
  return inspection;
}

nlohmann::ordered_json jsonOf(const Vec3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

nlohmann::ordered_json jsonOf(const Inspection& inspection) {
  const Model& model = inspection.loaded.model;
  nlohmann::ordered_json object{{"name", model.name},
                                {"vertices", model.solid.vertices.size()},
                                {"triangles", model.solid.triangles.size()},
                                {"solid", inspection.report.isSolid},
                                {"problems", inspection.report.problems}};
  if (inspection.report.isSolid) {
    const Mat3& inertia = inspection.properties.inertiaTensor;
    object["volume"] = inspection.properties.mass;
    object["centerOfMass"] = jsonOf(inspection.properties.centerOfMass);
    object["inertiaTensor"] = {jsonOf(inertia.row(0)), jsonOf(inertia.row(1)), jsonOf(inertia.row(2))};
  }
  object["shape"] = inspection.shape;
  object["size"] = jsonOf(inspection.size);
  return object;
}

void printText(const Inspection& inspection) {
  const Model& model = inspection.loaded.model;
  const auto triple = [](const Vec3& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z()); };
  show("{}: {} vertices, {} triangles, {}, {}\n", printableLine(model.name), model.solid.vertices.size(),
       model.solid.triangles.size(), inspection.report.isSolid ? "solid" : "not a solid", inspection.shape);
  show("  size            {}\n", triple(inspection.size));
  if (inspection.report.isSolid) {
    show("  volume          {:.9g}\n", inspection.properties.mass);
    show("  center of mass  {}\n", triple(inspection.properties.centerOfMass));
    for (int row = 0; row < 3; ++row)
      show("  {}  {}\n", row == 0 ? "inertia tensor" : "              ",
           triple(inspection.properties.inertiaTensor.row(row)));
  }
  for (const std::string& problem : inspection.report.problems) show("  problem: {}\n", printableLine(problem));
  for (const std::string& note : inspection.loaded.notes) show("  note: {}\n", printableLine(note));
}

}  // namespace

void inspectMesh(const std::string& path, double scale, bool asJson) {
  if (!kScales.holds(scale))
    throw Error(
        ErrorKind::usage, "--scale",
        fmt::format("found {}; allowed are numbers > 0, from {:g} to {:g}", scale, kScales.least, kScales.most));
  const std::vector<LoadedModel> objects = loadObjects(path, scale, ModelParts::solidAlone);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const LoadedModel& object : objects) {
    const Inspection inspection = inspect(object);
    if (asJson)
      list.push_back(jsonOf(inspection));
    else
      printText(inspection);
  }
  if (asJson)
    show("{}\n",
         nlohmann::ordered_json{{"objects", list}}.dump(1, ' ', true, nlohmann::json::error_handler_t::replace));
}

}  // namespace cradle
