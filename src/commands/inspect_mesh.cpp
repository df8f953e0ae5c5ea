#include "commands/inspect_mesh.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "core/console.h"
#include "core/error.h"
#include "core/printable.h"
#include "mesh/convex_hull.h"
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
  std::optional<MassProperties> ofSolid, ofHull;  // density 1; none if it is no solid, or flat
  MassProperties ofShell;                         // 1 kg/m^2
  std::string shape;
  Vec3 size;  // m, of the bounding box along the file's axes
};

std::optional<MassProperties> ofHull(const TriangleMesh& mesh) {
  try {
    return computeMassProperties(trianglesOf(convexHullOf(mesh.vertices)), 1);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mesh) throw;
    return std::nullopt;
  }
}

Inspection inspect(const LoadedModel& loaded) {
  const TriangleMesh& mesh = loaded.model.solid;
  Inspection inspection{loaded, checkSolid(mesh), {}, ofHull(mesh), computeShellProperties(mesh, 1, 1),
                        "mesh", Vec3::Zero()};
  Bounds bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  if (!bounds.isEmpty()) inspection.size = bounds.sizes();
  if (!inspection.report.isSolid) return inspection;
  inspection.ofSolid = computeMassProperties(mesh, 1);
  inspection.shape = shapeName(recogniseShape(mesh));
  return inspection;
}

nlohmann::ordered_json jsonOf(const Vec3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

/// `extent` is the name of what the mass is at density 1.
nlohmann::ordered_json jsonOf(const MassProperties& properties, const char* extent) {
  const Mat3& inertia = properties.inertiaTensor;
  return {{extent, properties.mass},
          {"centerOfMass", jsonOf(properties.centerOfMass)},
          {"inertiaTensor", {jsonOf(inertia.row(0)), jsonOf(inertia.row(1)), jsonOf(inertia.row(2))}}};
}

nlohmann::ordered_json jsonOf(const Inspection& inspection) {
  const Model& model = inspection.loaded.model;
  nlohmann::ordered_json object{{"name", model.name},
                                {"vertices", model.solid.vertices.size()},
                                {"triangles", model.solid.triangles.size()},
                                {"solid", inspection.report.isSolid},
                                {"problems", inspection.report.problems}};
  if (inspection.ofSolid) object.update(jsonOf(*inspection.ofSolid, "volume"));
  object["shape"] = inspection.shape;
  object["size"] = jsonOf(inspection.size);
  return object;
}

/// What the object weighs by the other values of `massFrom`.
nlohmann::ordered_json otherMassesOf(const Inspection& inspection) {
  nlohmann::ordered_json object{{"name", inspection.loaded.model.name}};
  if (inspection.ofHull) object["hull"] = jsonOf(*inspection.ofHull, "volume");
  object["shell"] = jsonOf(inspection.ofShell, "area");
  return object;
}

void printText(const Inspection& inspection) {
  const Model& model = inspection.loaded.model;
  const auto triple = [](const Vec3& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z()); };
  show("{}: {} vertices, {} triangles, {}, {}\n", printableLine(model.name), model.solid.vertices.size(),
       model.solid.triangles.size(), inspection.report.isSolid ? "solid" : "not a solid", inspection.shape);
  show("  size            {}\n", triple(inspection.size));
  if (inspection.ofSolid) {
    show("  volume          {:.9g}\n", inspection.ofSolid->mass);
    show("  center of mass  {}\n", triple(inspection.ofSolid->centerOfMass));
    for (int row = 0; row < 3; ++row)
      show("  {}  {}\n", row == 0 ? "inertia tensor" : "              ",
           triple(inspection.ofSolid->inertiaTensor.row(row)));
  }
  if (const auto& hull = inspection.ofHull)
    show("  as hull         volume {:.9g}{}, center of mass {}\n", hull->mass,
         inspection.ofSolid ? fmt::format(" ({:+.3g} %)", 100 * (hull->mass / inspection.ofSolid->mass - 1)) : "",
         triple(hull->centerOfMass));
  show("  as shell        area {:.9g}, center of mass {}\n", inspection.ofShell.mass,
       triple(inspection.ofShell.centerOfMass));
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
  nlohmann::ordered_json list = nlohmann::ordered_json::array(), masses = list;
  for (const LoadedModel& object : objects) {
    const Inspection inspection = inspect(object);
    if (!asJson) {
      printText(inspection);
      continue;
    }
    list.push_back(jsonOf(inspection));
    masses.push_back(otherMassesOf(inspection));
  }
  if (asJson)
    show("{}\n", nlohmann::ordered_json{{"objects", list}, {"massFrom", masses}}.dump(
                     1, ' ', true, nlohmann::json::error_handler_t::replace));
}

}  // namespace cradle
