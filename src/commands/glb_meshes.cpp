#include "commands/glb_meshes.h"

#include <fmt/format.h>

#include <span>

#include "mesh/solid.h"

namespace cradle {
namespace {

struct NamedMesh {
  std::string name;
  DrawnMesh drawn;
};

struct MeshOfShape {
  const Scene& scene;

  NamedMesh operator()(const Sphere& sphere) const { return {"sphere", tessellate(sphere)}; }
  NamedMesh operator()(const Box& box) const { return {"box", tessellate(box)}; }
  NamedMesh operator()(const Cylinder& cylinder) const { return {"cylinder", tessellate(cylinder)}; }
  NamedMesh operator()(const Capsule& capsule) const { return {"capsule", tessellate(capsule)}; }
  NamedMesh operator()(const Plane&) const { return {}; }
  NamedMesh operator()(const ModelShape& shape) const {
    const Model& model = scene.models.at(static_cast<std::size_t>(shape.model));
    return {model.name, model.drawn};
  }
};

}  // namespace

GlbMeshes::Geometry GlbMeshes::addGeometry(const std::string& name, const DrawnMesh& drawn) {
  Geometry geometry{name, file_.addVectors(drawn.vertices.size(), 3), file_.addVectors(drawn.normals.size(), 3)};
  for (std::size_t i = 0; i < drawn.vertices.size(); ++i) {
    file_.set(geometry.positions, i, drawn.vertices[i]);
    file_.set(geometry.normals, i, drawn.normals[i]);
  }
  const std::vector<Vec2f>& coordinates = drawn.textureCoordinates;
  if (!coordinates.empty()) geometry.coordinates = file_.addVectors(coordinates.size(), 2);
  for (std::size_t i = 0; i < coordinates.size(); ++i)
    file_.set(geometry.coordinates, i, Vec2f(coordinates[i].x(), 1 - coordinates[i].y()));  // from above, there
  const std::span<const Triangle> triangles(drawn.triangles);
  for (const ModelMaterial& range : drawn.materials)
    if (range.triangleCount > 0)
      geometry.ranges.push_back({range.name, range.baseColor, range.texture,
                                 file_.addIndices(triangles.subspan(range.firstTriangle, range.triangleCount))});
  if (drawn.materials.empty()) geometry.ranges.push_back({"", {}, {}, file_.addIndices(triangles)});
  return geometry;
}

GlbMeshes::Geometry GlbMeshes::addShape(const Shape& shape) {
  const NamedMesh mesh = std::visit(MeshOfShape{scene_}, shape);
  Geometry geometry = addGeometry(mesh.name, mesh.drawn);
  if (const auto* model = std::get_if<ModelShape>(&shape))
    geometry.isClosed = checkSolid(scene_.models[static_cast<std::size_t>(model->model)].solid).isClosed;
  return geometry;
}

int GlbMeshes::ofBody(std::size_t number) {
  const Body& body = scene_.bodies.at(number);
  const BodyRecord& record = header_.bodies.at(number);
  const auto [found, isNew] = geometries_.try_emplace(fmt::format("{} {}", record.mesh, record.shape));
  Geometry& geometry = found->second;
  if (isNew) geometry = addShape(body.shape);

  const Material& material = scene_.materials.at(static_cast<std::size_t>(body.material));
  std::vector<GlbPrimitive> primitives;
  for (const Geometry::Range& range : geometry.ranges) {
    const bool isFiles = !material.baseColor && !material.texture && !range.materialName.empty();
    const SharedTexture texture = textureOf(material, range.fileTexture);
    const int look = file_.addMaterial(isFiles ? range.materialName : material.name,
                                       surfaceOf(material, range.fileColor), texture, !geometry.isClosed);
    primitives.push_back(
        {geometry.positions, geometry.normals, range.indices, look, texture ? geometry.coordinates : -1});
  }
  return file_.addMesh(geometry.name, primitives);
}

int GlbMeshes::add(const std::string& name, const DrawnMesh& drawn, const std::string& material,
                   const Surface& surface) {
  const Geometry geometry = addGeometry(name, drawn);
  const int look = file_.addMaterial(material, surface, nullptr, false);
  return file_.addMesh(name, {{geometry.positions, geometry.normals, geometry.ranges.at(0).indices, look}});
}

}  // namespace cradle
