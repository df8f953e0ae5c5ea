#include "render/light_maps.h"

#include <GL/glew.h>

#include <algorithm>

namespace cradle {

namespace {

PixelRectangle aroundAll(const SeenItems& seen) {
  PixelRectangle all{};
  for (const auto* items : {&seen.meshes, &seen.spheres, &seen.cylinders, &seen.tubes})
    for (const PixelRectangle& one : *items) all = joined(all, one);
  return all;
}

}  // namespace

LightMaps::LightMaps(const ShaderSource& source, const RenderSetup& setup)
    : surfaceDepth_(source, "surface.vert", "depth.frag"),
      sphereDepth_(source, "sphere.vert", "depth.frag"),
      cylinderDepth_(source, "cylinder.vert", "depth.frag"),
      tubeDepth_(source, "tube.vert", "depth.frag"),
      leastDepth_(source, "sky.vert", "shadow_blocks.frag"),
      contactShadow_(source, "contact_shadow.vert", "contact_shadow.frag"),
      shadowMap_(MapTarget::Kind::depth, kShadowMapSize),
      blocks_(MapTarget::Kind::leastDepth, kShadowMapSize / kShadowBlock),
      contactShadowMap_(MapTarget::Kind::share, kContactShadowMapSize),
      triangle_({0, 0, 0}, 1, {0, 1, 2}) {
  for (const ShaderProgram* program : {&leastDepth_, &contactShadow_}) setUniforms(setup, *program);
  for (const ShaderProgram* program : {&surfaceDepth_, &sphereDepth_, &cylinderDepth_, &tubeDepth_}) {
    program->use();
    program->set("viewer", setup.shadow.viewer);
    program->set("pixelSize", 0.0f);
  }
  move(setup);
}

void LightMaps::move(const RenderSetup& setup) const {
  setMaps(setup, contactShadow_);
  for (const ShaderProgram* program : {&surfaceDepth_, &sphereDepth_, &cylinderDepth_, &tubeDepth_}) {
    program->use();
    program->set("clipFromWorld", setup.shadow.clipFromWorld);
  }
}

void LightMaps::drawShadows(const ItemDrawer& items, const PixelRectangle& changed) {
  const PixelRectangle now = aroundAll(items.inShadowMap());
  const PixelRectangle shadows = common(changed, joined(occupied_, now));
  occupied_ = now;
  if (shadows.isEmpty()) return;
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_CLAMP);  // what stands outside the view still throws its shadow into it
  shadowMap_.begin(shadows);
  surfaceDepth_.use();
  const SeenItems& seen = items.inShadowMap();
  items.drawMeshes(seen, shadows);
  sphereDepth_.use();
  items.drawSpheres(seen, shadows);
  cylinderDepth_.use();
  items.drawCylinders(seen, shadows);
  tubeDepth_.use();
  items.drawTubes(seen, shadows);
  glDisable(GL_DEPTH_CLAMP);
  shadowMap_.end();
  drawBlocks(shadows);
}

void LightMaps::drawBlocks(const PixelRectangle& shadows) const {
  const auto after = [](int texel) { return (texel + kShadowBlock - 1) / kShadowBlock; };
  blocks_.begin({shadows.left / kShadowBlock, shadows.bottom / kShadowBlock, after(shadows.right), after(shadows.top)});
  glDisable(GL_DEPTH_TEST);
  shadowMap_.bindTexture(kShadowUnit);
  leastDepth_.use();
  triangle_.draw();
  blocks_.end();
}

void LightMaps::drawContactShadows(const ItemDrawer& items) const {
  contactShadowMap_.begin(contactShadowMap_.inside());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE_MINUS_DST_COLOR, GL_ONE);  // what two things leave open is the product of what each does
  contactShadow_.use();
  items.drawContactShadows();
  glDisable(GL_BLEND);
  contactShadowMap_.end();
}

void LightMaps::bindTextures() const {
  shadowMap_.bindTexture(kShadowUnit);
  blocks_.bindTexture(kBlockUnit);
  contactShadowMap_.bindTexture(kContactShadowUnit);
}

}  // namespace cradle
