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
  std::vector<float> balls;      // eight a ball: centre, radius, colour, metallic
  std::vector<float> nearBalls;  // indices
};

PackedDrawList pack(const DrawList& list, const Stage& stage);

}  // namespace cradle
