#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "collision/collider.h"
#include "scene/scene.h"

namespace cradle {

/// The collider of a body that is no plane; none if it does not collide. `movingBody` is its index among those that
/// move, or kFixed. `collision: auto` of a mesh takes the primitive that it is recognised as, else its vertices.
std::optional<Collider> colliderOf(const Body& body, const Scene& scene, int movingBody);

/// Gives the colliders of bodies (indices into the scene's) the surfaces by which meshes touch: one a model, and those
/// of the polytopes that meet them. Nothing if there is no mesh, or nothing but planes for it to touch.
void addSurfaces(const Scene& scene, const std::vector<int>& bodies, std::vector<Collider>& colliders);

/// Whether contact of two colliders can be computed; `b` is null for a plane.
bool canSolveContact(const Collider& a, const Collider* b);

constexpr std::size_t kMaxFaultsCounted = 1000;  // a scene with as many is not searched to its end

/// Faults of pairs whose contact cannot be simulated yet, kMaxFaultsCounted at most. Two moving bodies are no fault:
/// they may stay apart.
std::vector<std::string> unsupportedContacts(const Scene& scene);

/// Pairs of scene bodies that joints join and none of these joints lets touch each other: the smaller index first.
/// Welds apart, which may keep any number of bodies from each other (WeldedBodies).
std::set<std::pair<int, int>> pairsKeptFromTouching(const Scene& scene);

/// Do two bodies have to be watched for contact? (One moves, both collide.)
bool mayTouch(const Body& a, const Body& b);

}  // namespace cradle
