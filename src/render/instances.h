#pragma once

#include "render/draw_list.h"
#include "render/gpu_mesh.h"
#include "render/stage.h"

namespace cradle {

/// Instances of the same triangles, drawn with one call.
struct Batch {
  int mesh = 0;
  std::uint32_t firstTriangle = 0, triangleCount = 0;
  std::size_t firstInstance = 0, instanceCount = 0;
};

/// A draw list as OpenGL takes it: numbers relative to the stage's origin.
struct PackedDrawList {
  std::vector<Instance> meshInstances, tubeInstances, contactInstances;
  std::vector<Batch> batches;
  std::vector<float> balls;      // eight a ball: centre, radius, colour, metallic
  std::vector<float> nearBalls;  // indices
};

PackedDrawList pack(const DrawList& list, const Stage& stage);

}  // namespace cradle
