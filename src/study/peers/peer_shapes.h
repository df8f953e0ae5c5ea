#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "scene/scene.h"

namespace cradle {

/// A shape that all engines know, and where it is in its body's frame.
struct PeerShape {
  std::variant<Sphere, Box, Cylinder, Capsule, Plane> shape;
  RigidTransform bodyFromShape;
};

/// A body's shape as `auto` takes it; nothing for bodies that touch nothing, and for meshes that are no primitive.
std::optional<PeerShape> peerShapeOf(const Body& body, const Scene& scene);

/// The first part of a scene that no other engine is given, in words; empty if there is none.
std::string missingInEveryPeer(const Scene& scene);

/// The first body that touches with a mesh that is no primitive, in words; empty if there is none.
std::string meshThatTouches(const Scene& scene);

/// Scene bodies A < B that do not touch each other: those of joints, unless these collide, and what welds make one.
std::set<std::pair<int, int>> joinedBodies(const Scene& scene);

/// What a body's model is, if it has one and does not ask to be a hull or a mesh.
RecognisedShape recogniseModel(const Body& body, const Scene& scene);

}  // namespace cradle
