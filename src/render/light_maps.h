#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/item_drawer.h"
#include "render/render_targets.h"
#include "render/shader_program.h"
#include "render/stage.h"

namespace cradle {

/// What the shaders look up light in: the shadow map with the least depths of its blocks, and how much of the sky
/// bodies hide from the ground. Needs a current context.
class LightMaps {
 public:
  LightMaps(const ShaderSource& source, const Stage& stage);

  /// For maps that have moved.
  void move(const Stage& stage) const;

  /// Draws the part `shadows` (texels) of the shadow map anew, as far as anything stands or stood there.
  void drawShadows(const ItemDrawer& items, const PixelRectangle& shadows);

  /// Draws the map of contacts anew. Its texels before and after, by row: where they are the same, the ground is.
  struct Contacts {
    std::vector<std::uint8_t> before, now;  // kContactMapSize squared, or none while none was drawn
  };
  const Contacts& drawContacts(const ItemDrawer& items);

  /// Lets the shaders of a picture look them up.
  void bindTextures() const;

 private:
  void drawBlocks(const PixelRectangle& shadows) const;

  ShaderProgram surfaceDepth_, ballDepth_, cylinderDepth_, tubeDepth_;
  ShaderProgram leastDepth_, contact_;
  MapTarget shadowMap_, blocks_, contactMap_;
  GpuMesh triangle_;
  Contacts contacts_;
  PixelRectangle occupied_;  // texels of the shadow map: beyond, it is clear
};

}  // namespace cradle
