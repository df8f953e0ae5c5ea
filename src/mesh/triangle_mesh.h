#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "math/types.h"
#include "mesh/texture.h"

namespace cradle {

using Triangle = std::array<std::uint32_t, 3>;  // vertex indices, counter-clockwise seen from outside

/// Positions and triangles alone: what physics sees of a model. Vertices are distinct (welded where bit-equal).
struct TriangleMesh {
  std::vector<Vec3> vertices;  // m, body's frame
  std::vector<Triangle> triangles;
};

/// Colour and finish of some triangles of a model, as its file has them.
struct ModelMaterial {
  std::string name;
  Vec3f baseColor = Vec3f::Constant(0.69f);  // sRGB, 0..1
  std::uint32_t firstTriangle = 0;  // triangles [firstTriangle, firstTriangle + triangleCount) of the drawn mesh
  std::uint32_t triangleCount = 0;
  SharedTexture texture = {};  // in which baseColor is a factor; none: unset
};

/// What a picture shows of a model: a vertex per corner with its own normal, so that smoothing groups are kept.
struct DrawnMesh {
  std::vector<Vec3> vertices;                  // m, body's frame
  std::vector<Vec3f> normals;                  // unit, one per vertex
  std::vector<Vec2f> textureCoordinates = {};  // of each vertex, from the left and from below, 1 across; or none
  std::vector<Triangle> triangles;
  std::vector<ModelMaterial> materials;  // ranges cover all triangles, in order
};

/// One object of a mesh file (or a whole file as one body): the same surface twice, for physics and for pictures.
struct Model {
  std::string name;
  TriangleMesh solid;
  DrawnMesh drawn;
};

/// The index of the vertex that is nearest to a point, the first of several; at least one vertex.
std::size_t nearestVertex(const std::vector<Vec3>& vertices, const Vec3& point);

/// Joins vertices whose coordinates are bit-equal (-0 counts as 0), in order of first appearance, and drops triangles
/// that have two equal corners. O(n log n).
TriangleMesh weld(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

}  // namespace cradle
