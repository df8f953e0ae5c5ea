#pragma once

#include "render/item_drawer.h"
#include "render/render_setup.h"
#include "render/render_targets.h"
#include "render/shader_program.h"

namespace cradle {

/// What the shaders look up light in: the shadow map with the least depths of its blocks, and how much of the sky
/// bodies hide from the ground. Needs a current context.
class LightMaps {
 public:
  LightMaps(const ShaderSource& source, const RenderSetup& setup);

  /// For maps that have moved.
  void move(const RenderSetup& setup) const;

  /// Draws the part `shadows` (texels) of the shadow map anew, as far as anything stands or stood there.
  void drawShadows(const ItemDrawer& items, const PixelRectangle& shadows);

  /// Draws the map of contact shadows anew.
  void drawContactShadows(const ItemDrawer& items) const;

  /// Lets the shaders of a picture look them up.
  void bindTextures() const;

 private:
  void drawBlocks(const PixelRectangle& shadows) const;

  ShaderProgram surfaceDepth_, sphereDepth_, cylinderDepth_, tubeDepth_;
  ShaderProgram leastDepth_, contactShadow_;
  MapTarget shadowMap_, blocks_, contactShadowMap_;
  GpuMesh triangle_;
  PixelRectangle occupied_;  // texels of the shadow map: beyond, it is clear
};

}  // namespace cradle
