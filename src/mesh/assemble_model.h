#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/load_mesh.h"
#include "mesh/smooth_normals.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// Triangles of one material, as a file gives them, already in the frame of the file.
struct MeshPiece {
  std::vector<Vec3> corners;         // m, finite, three a triangle
  std::vector<Vec3f> normals;        // one a corner, of any length; zero, or all left out: to be computed
  std::vector<Smoothing> smoothing;  // one a triangle
  std::uint64_t degenerate = 0;      // triangles with two equal corners, left out already
  int material = 0;                  // pieces of one number become one range
  ModelMaterial look;
  std::vector<Vec2f> textureCoordinates = {};  // as DrawnMesh has them, one a corner; or none
  std::string textureFault = {};               // why the texture of its material is left out; empty if it is not
};

/// Whether a triangle has two equal corners: it is no part of a surface.
inline bool isDegenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a == b || b == c || c == a;
}

/// Joins the pieces of an object: drops degenerate triangles, shares corners with equal position, normal and texture
/// coordinates, orders by material, and welds the solid; `notes` says what was mended. The result's solid is
/// weld(drawn.vertices, drawn.triangles). If the solid alone is wanted, nothing is drawn. O(n).
LoadedModel assembleModel(const std::string& name, std::vector<MeshPiece> pieces, ModelParts parts);

/// Several objects as one model, in their order.
LoadedModel joinModels(const std::string& name, const std::vector<LoadedModel>& objects);

}  // namespace cradle
