#pragma once

#include <optional>

#include "mesh/ray_cast.h"
#include "scene/scene_draft.h"

namespace cradle {

// Points of bodies that are given by a pixel of a picture: what a user sees there.

constexpr std::size_t kMaxPicks = 1000;  // links, or pushes: each looks at all bodies and their triangles

/// `{"frame": 0, "pixel": [640, 360]}`: what a pixel of a picture shows, in place of a point. Nothing, and a fault, if
/// it is none.
std::optional<PixelPick> parsePick(const Field& field, FaultList& faults);

/// The ray of a pixel's centre in a picture of the scene's size; world. Nothing, and a fault, if it is outside of the
/// picture, or the camera of that frame is not known before the run.
std::optional<Ray> rayOf(const PixelPick& pick, const Scene& scene, FaultList& faults);

/// The body that a ray (world) first meets at the start of the scene, and where; m, its frame. Nothing if it meets
/// none. Models are there. O(bodies), and O(triangles) of models.
std::optional<Anchor> firstMet(const Ray& ray, const Scene& scene);

/// Where a pick shows a body at the start of the scene; m, its frame. Nothing, and a fault, if it does not. Models are
/// there.
std::optional<Vec3> pickedPoint(const PixelPick& pick, int body, const Scene& scene, FaultList& faults);

}  // namespace cradle
