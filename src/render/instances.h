#pragma once

#include <array>

#include "render/draw_list.h"
#include "render/gpu_mesh.h"
#include "render/stage.h"

namespace cradle {

/// Instances of the same triangles, drawn with one call.
struct Batch {
  int mesh = 0;  // index into Appearance::meshes, or into kOutlines for what is round
  std::uint32_t firstTriangle = 0, triangleCount = 0;
  std::size_t firstInstance = 0, instanceCount = 0;
};

/// Corners around the outlines that spheres and the ends of cylinders are drawn with, coarse to fine.
constexpr std::array<int, 5> kOutlines = {8, 16, 32, 64, 128};

/// A draw list as OpenGL takes it: numbers relative to the stage's origin.
struct PackedDrawList {
  std::vector<Instance> meshInstances, wallInstances, sphereInstances, cylinderInstances, tubeInstances,
      contactInstances;
  std::vector<Batch> meshBatches, sphereBatches, cylinderBatches;
  std::vector<std::size_t> sphereItems, cylinderItems;  // indices into the draw list, of each instance
  std::vector<float> neighbours;                        // sixteen each, as numbersOf gives them
  std::vector<float> nearBalls;                         // indices
};

/// Half edges of the square of ground that an item may darken, and how far the darkening goes beyond the item (m); none
/// if it is too far above the ground. Needs a ground.
struct DarkenedSquare {
  double halfU, halfV, reach;
};
std::optional<DarkenedSquare> darkenedSquare(const ContactItem& item, const Stage& stage);

/// Whether a ball of that surface shows the shadows in the ground that it mirrors.
bool mirrorsShadows(const Surface& surface);

/// What OpenGL is told of one item.
Instance instanceOf(const MeshItem& item, const Stage& stage);
Instance instanceOf(const TubeItem& item, const Stage& stage);
Instance instanceOf(const SphereItem& item, const Stage& stage);
Instance instanceOf(const CylinderItem& item, const Stage& stage);
Instance instanceOf(const ContactItem& item, const DarkenedSquare& square, const Stage& stage);
/// How finely it is drawn: an index into kOutlines.
std::size_t outlineLevel(const SphereItem& item, const Stage& stage);
std::size_t outlineLevel(const CylinderItem& item, const Stage& stage);

/// Centre, radius, colour, metallic of a ball or box; half edges, 1 for a box; turn as a quaternion, w last.
std::array<float, 16> numbersOf(const NeighbourItem& item, const Stage& stage);

/// The numbers of an instance that say where its near balls stand in their list, and how many they are.
constexpr std::array<std::size_t, 2> kNearBallNumbers = {20, 21};

PackedDrawList pack(const DrawList& list, const Stage& stage);

}  // namespace cradle
