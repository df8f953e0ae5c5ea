#include "mesh/load_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "core/error.h"
#include "mesh/assemble_model.h"
#include "mesh/import_mesh.h"
#include "mesh/solid.h"
#include "mesh/turn_parts.h"

namespace cradle {
namespace {

std::vector<std::string> namesOf(const std::vector<LoadedModel>& objects) {
  std::vector<std::string> names;
  for (const LoadedModel& object : objects) names.push_back("\"" + object.model.name + "\"");
  return names;
}

/// The objects of a file as they are wound there.
std::vector<LoadedModel> readObjects(const std::string& path, double scale, ModelParts parts) {
  std::vector<LoadedModel> objects;
  for (ImportedObject& imported : importObjects(path, scale)) {
    LoadedModel loaded = assembleModel(imported.name, std::move(imported.pieces), parts);
    if (!loaded.model.solid.triangles.empty()) objects.push_back(std::move(loaded));
  }
  if (objects.empty())
    throw Error(ErrorKind::mesh, path, "has no triangles; a body needs a surface (points and lines have none)");
  return objects;
}

/// All objects as one model. Which way a part must face depends on those around it, of other objects too; objects that
/// do not make a closed surface together may still be closed each.
LoadedModel joinOutwards(const std::string& name, std::vector<LoadedModel> objects) {
  LoadedModel joined = joinModels(name, objects);
  if (hasMatchingEdges(joined.model.solid)) {
    turnPartsOutwards(joined);
    return joined;
  }
  for (LoadedModel& object : objects) turnPartsOutwards(object);
  return joinModels(name, objects);
}

}  // namespace

std::vector<LoadedModel> loadObjects(const std::string& path, double scale, ModelParts parts) {
  std::vector<LoadedModel> objects = readObjects(path, scale, parts);
  for (LoadedModel& object : objects) turnPartsOutwards(object);
  return objects;
}

LoadedModel loadModel(const MeshReference& reference) {
  std::vector<LoadedModel> objects = readObjects(reference.path, reference.scale, ModelParts::solidAndDrawn);
  if (reference.object.empty() && objects.size() > 1)
    return joinOutwards(std::filesystem::path(reference.path).stem().string(), std::move(objects));
  if (reference.object.empty()) {
    turnPartsOutwards(objects.front());
    return std::move(objects.front());
  }
  for (LoadedModel& object : objects)
    if (object.model.name == reference.object) {
      turnPartsOutwards(object);
      return std::move(object);
    }
  throw Error(ErrorKind::mesh, reference.path,
              fmt::format("has no object \"{}\"; it has {}", reference.object, fmt::join(namesOf(objects), ", ")));
}

}  // namespace cradle
