#include "commands/inspect_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

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

/// Vertices of an object by their numbers, those nearest to a place alone, if there is one.
class VertexList {
 public:
  explicit VertexList(const std::vector<double>& near) {
    if (near.size() == 3) near_ = Vec3(near[0], near[1], near[2]);
  }

  void print(const Model& model) const {
    for (const std::size_t number : numbersOf(model.solid.vertices)) {
      const Vec3& vertex = model.solid.vertices[number];
      const std::string away = near_ ? fmt::format("  {:.6g} away", (vertex - *near_).norm()) : "";
      show("  vertex {:<8} {} {} {}{}\n", number, vertex.x(), vertex.y(), vertex.z(), away);
    }
  }

  nlohmann::ordered_json jsonOf(const Model& model) const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const std::size_t number : numbersOf(model.solid.vertices))
      list.push_back({{"vertex", number}, {"point", cradle::jsonOf(model.solid.vertices[number])}});
    return list;
  }

 private:
  std::vector<std::size_t> numbersOf(const std::vector<Vec3>& vertices) const {
    constexpr std::size_t kNearest = 10;  // as many as may be meant
    std::vector<std::size_t> numbers(vertices.size());
    std::iota(numbers.begin(), numbers.end(), 0U);
    if (!near_) return numbers;
    const auto distance = [&](std::size_t number) { return (vertices[number] - *near_).squaredNorm(); };
    std::stable_sort(numbers.begin(), numbers.end(),
                     [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    numbers.resize(std::min(numbers.size(), kNearest));
    return numbers;
  }

  std::optional<Vec3> near_;
};

void requireSensible(const InspectOptions& options) {
  if (!kScales.holds(options.scale))
    throw Error(ErrorKind::usage, "--scale",
                fmt::format("found {}; allowed are numbers > 0, from {:g} to {:g}", options.scale, kScales.least,
                            kScales.most));
  const bool isFinite =
      std::all_of(options.near.begin(), options.near.end(), [](double x) { return std::isfinite(x); });
  if (!options.near.empty() && (options.near.size() != 3 || !isFinite))
    throw Error(ErrorKind::usage, "--near", "allowed is X,Y,Z: three numbers, in m after --scale");
  if (!options.near.empty() && !options.listsVertices) throw Error(ErrorKind::usage, "--near", "goes with --vertices");
}

/// All objects of a file as one body, as scenes have it that name none of several.
LoadedModel wholeFile(const std::string& path, double scale) {
  MeshReference reference;
  reference.path = path;
  reference.scale = scale;
  return loadModel(reference);
}

}  // namespace

void inspectMesh(const std::string& path, const InspectOptions& options) {
  requireSensible(options);
  const std::vector<LoadedModel> objects = loadObjects(path, options.scale, ModelParts::solidAlone);
  const VertexList vertexList(options.near);
  nlohmann::ordered_json list = nlohmann::ordered_json::array(), masses = list, vertices = list;
  for (const LoadedModel& object : objects) {
    const Inspection inspection = inspect(object);
    if (!options.asJson) {
      printText(inspection);
      if (options.listsVertices) vertexList.print(object.model);
      continue;
    }
    list.push_back(jsonOf(inspection));
    masses.push_back(otherMassesOf(inspection));
    if (options.listsVertices)
      vertices.push_back({{"name", object.model.name}, {"list", vertexList.jsonOf(object.model)}});
  }
  if (options.listsVertices && objects.size() > 1) {
    const LoadedModel whole = wholeFile(path, options.scale);
    if (options.asJson) {
      vertices.push_back({{"name", nullptr}, {"list", vertexList.jsonOf(whole.model)}});
    } else {
      show("all objects as one body: {} vertices\n", whole.model.solid.vertices.size());
      vertexList.print(whole.model);
    }
  }
  if (!options.asJson) return;
  nlohmann::ordered_json all{{"objects", list}, {"massFrom", masses}};
  if (options.listsVertices) all["vertices"] = vertices;
  show("{}\n", all.dump(1, ' ', true, nlohmann::json::error_handler_t::replace));
}

}  // namespace cradle
