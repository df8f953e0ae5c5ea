#pragma once

#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace cradle {

/// The axis of a mesh file that points up; it becomes Y. Left to its format: z of 3ds, y of others.
enum class UpAxis { ofFormat, x, y, z };

/// A mesh file as a scene names it.
struct MeshReference {
  std::string path;    // as the program opens it
  std::string object;  // name of one object of the file; empty: all objects are one body
  double scale = 1;    // file's units to metres, > 0
  UpAxis upAxis = UpAxis::ofFormat;
  bool fillsHoles = false;  // small ones, of what needs a volume
  bool isTextured = false;  // texture coordinates are wanted, whether or not materials of the file have textures
};

/// A model with what had to be mended on the way.
struct LoadedModel {
  Model model;
  std::vector<std::string> notes;  // "42 degenerate triangles dropped", "was inside-out: turned"
};

/// Which halves of a model are wanted: pictures cost about as much again as the solid.
enum class ModelParts { solidAlone, solidAndDrawn };

/// All objects of a mesh file (.3ds, .obj, .ply, .stl, .gltf, .glb ...; Z-up files of 3ds come out Y up), node
/// transforms applied in double, `scale` applied, small holes filled. Throws Error(mesh) if the file is missing,
/// unreadable, over the size caps, has no triangles, non-finite vertices or indices out of range.
std::vector<LoadedModel> loadObjects(const std::string& path, double scale,
                                     ModelParts parts = ModelParts::solidAndDrawn);

/// The object that `reference` names, its axis up, or all objects of the file joined into one model. Throws as
/// loadObjects does, and Error(mesh) naming the objects there are if the named one does not exist.
LoadedModel loadModel(const MeshReference& reference);

}  // namespace cradle
