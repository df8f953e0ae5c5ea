#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "math/types.h"

namespace cradle::assets {

constexpr std::uint32_t kSharp = 0;  // smoothing group of faces that share no normals

/// A triangle with what a 3ds file says about it.
struct Face {
  std::array<std::uint16_t, 3> corners;    // counter-clockwise seen from outside
  std::uint32_t smoothingGroups = kSharp;  // bits; faces that share a bit are smooth where they meet
};

/// One closed object of one material.
struct Surface {
  std::string name;
  std::size_t material = 0;    // index into Model::materials
  std::vector<Vec3> vertices;  // m, y up
  std::vector<Face> faces;
  std::vector<Vec2f> coordinates = {};  // of each vertex on the texture of the material, from below; or none

  std::uint16_t add(const Vec3& vertex);
  void addTriangle(std::size_t a, std::size_t b, std::size_t c, std::uint32_t smoothingGroups);
  void addQuad(std::size_t a, std::size_t b, std::size_t c, std::size_t d, std::uint32_t smoothingGroups);
};

struct MaterialLook {
  std::string name;
  std::array<std::uint8_t, 3> diffuse;  // sRGB
  std::string texture = {};             // a file of this folder; or none
};

/// What one file holds.
struct Model {
  std::string fileName;
  std::vector<MaterialLook> materials;
  std::vector<Surface> objects;
};

/// A circle's place along a tube; u and v are orthogonal unit vectors, u x v points along the tube.
struct Section {
  Vec3 center, u, v;
  double radius;  // m
};

/// Adds a tube through `sections`, each a polygon of `sides` corners, smooth (group 1); with flat ends, or closed to a
/// ring.
void addTube(const std::vector<Section>& sections, std::size_t sides, bool isRing, Surface& surface);

/// Adds the prism over a plane strip between two closed outlines of equal length (counter-clockwise in x, z seen from
/// above, heights `bottom` to `top`): a plate with a hole.
struct Outline {
  std::vector<Eigen::Vector2d> points;  // m
  std::uint32_t wallSmoothing = kSharp;
};
void addPlateWithHole(const Outline& outer, const Outline& hole, double thickness, Surface& surface);

}  // namespace cradle::assets
