#pragma once

#include <optional>
#include <string>
#include <variant>

#include "mesh/primitives.h"

namespace cradle {

/// A primitive somewhere in a body's frame.
struct PlacedPrimitive {
  std::variant<Sphere, Box, Cylinder, Capsule> shape;
  RigidTransform bodyFromShape;
};

/// What a closed mesh is, for collision: a primitive, else convex or not.
struct RecognisedShape {
  std::optional<PlacedPrimitive> primitive;
  bool isConvex = false;  // true for primitives
};

/// Tries box (8 vertices, 6 planes, edges orthogonal to 1e-6), sphere (equidistant vertices, to 1e-6 or the decimals of
/// the file; 200 faces at least, midpoints within 1 % of the radius), cylinder, capsule, convex, in this order.
RecognisedShape recogniseShape(const TriangleMesh& mesh);

/// "box", "sphere", "cylinder", "capsule", "convex" or "mesh".
std::string shapeName(const RecognisedShape& shape);

}  // namespace cradle
