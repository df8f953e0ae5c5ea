#pragma once

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

  /// Draws the map of contacts anew.
  void drawContacts(const ItemDrawer& items) const;

  /// Lets the shaders of a picture look them up.
  void bindTextures() const;

 private:
  void drawBlocks(const PixelRectangle& shadows) const;

  ShaderProgram surfaceDepth_, ballDepth_, cylinderDepth_, tubeDepth_;
  ShaderProgram leastDepth_, contact_;
  MapTarget shadowMap_, blocks_, contactMap_;
  GpuMesh triangle_;
  PixelRectangle occupied_;  // texels of the shadow map: beyond, it is clear
};

}  // namespace cradle
