#pragma once

#include <array>

#include "render/draw_list.h"
#include "render/gpu_mesh.h"
#include "render/render_setup.h"

namespace cradle {

/// Instances of the same triangles, drawn with one call.
struct Batch {
  int mesh = 0;  // index into Appearance::meshes, or into kOutlines for what is round
  std::uint32_t firstTriangle = 0, triangleCount = 0;
  std::size_t firstInstance = 0, instanceCount = 0;
  int texture = -1;  // index into Appearance::textures; -1: none
};

/// Corners around the outlines that spheres and the ends of cylinders are drawn with, coarse to fine.
constexpr std::array<int, 5> kOutlines = {8, 16, 32, 64, 128};

/// A draw list as OpenGL takes it: numbers relative to the setup's origin.
struct PackedDrawList {
  std::vector<Instance> meshInstances, wallInstances, sphereInstances, cylinderInstances, tubeInstances,
      contactShadowInstances;
  std::vector<Batch> meshBatches, sphereBatches, cylinderBatches;
  std::vector<std::size_t> sphereItems, cylinderItems;  // indices into the draw list, of each instance
  std::vector<float> occluders;                         // sixteen each, as numbersOf gives them
  std::vector<float> nearOccluders;                     // indices
};

/// Half edges of the square of ground that an item may darken, and how far the darkening goes beyond the item (m); none
/// if it is too far above the ground. Needs a ground.
struct DarkenedSquare {
  double halfU, halfV, reach;
};
std::optional<DarkenedSquare> darkenedSquare(const ContactShadowItem& item, const RenderSetup& setup);

/// Whether a sphere of that surface shows the shadows in the ground that it mirrors.
bool mirrorsShadows(const Surface& surface);

/// What OpenGL is told of one item.
Instance instanceOf(const MeshItem& item, const RenderSetup& setup);
Instance instanceOf(const TubeItem& item, const RenderSetup& setup);
Instance instanceOf(const SphereItem& item, const RenderSetup& setup);
Instance instanceOf(const CylinderItem& item, const RenderSetup& setup);
Instance instanceOf(const ContactShadowItem& item, const DarkenedSquare& square, const RenderSetup& setup);
/// How finely it is drawn: an index into kOutlines.
std::size_t outlineLevel(const SphereItem& item, const RenderSetup& setup);
std::size_t outlineLevel(const CylinderItem& item, const RenderSetup& setup);

/// Centre, radius, colour, metallic of a sphere or box; half edges, 1 for a box; turn as a quaternion, w last.
std::array<float, 16> numbersOf(const OccluderItem& item, const RenderSetup& setup);

/// The numbers of an instance that say where its near occluders stand in their list, and how many there are.
constexpr std::array<std::size_t, 2> kNearOccluderNumbers = {20, 21};

/// Whether OpenGL, which computes in single precision, draws two items alike, apart from the occluders near them.
bool isSame(const MeshItem& a, const MeshItem& b, const RenderSetup& setup);
bool isSame(const SphereItem& a, const SphereItem& b, const RenderSetup& setup);
bool isSame(const CylinderItem& a, const CylinderItem& b, const RenderSetup& setup);
bool isSame(const TubeItem& a, const TubeItem& b, const RenderSetup& setup);
bool isSame(const OccluderItem& a, const OccluderItem& b, const RenderSetup& setup);

/// Needs a ground.
bool isSame(const ContactShadowItem& a, const ContactShadowItem& b, const RenderSetup& setup);

PackedDrawList pack(const DrawList& list, const RenderSetup& setup);

}  // namespace cradle
