#pragma once

#include <optional>

#include "render/appearance.h"
#include "render/framing.h"
#include "render/shader_program.h"

namespace cradle {

/// Light from all around and from lamps. Colours are linear radiances; of lamps, what a white matt surface that faces
/// them sends out.
struct Lighting {
  struct Lamp {
    Vec3 towards;  // unit, to the lamp
    Vec3f radiance;
  };
  std::vector<Lamp> lamps;  // the first throws shadows
  Vec3f zenith, horizon, nadir;
  Vec3f sky, bounce;  // on a white surface that faces up and down
  Vec3f skySlope;     // relative change of both with the direction of the surface
};

/// Where the shadow map looks: along the light, at all that the film shows.
struct ShadowView {
  Eigen::Matrix4f clipFromWorld, textureFromWorld;
  Eigen::Vector4f viewer;  // the light's direction, as ball.vert takes it
  double texel = 0;        // m
  double deep = 0;         // m, from the least to the greatest depth
};

/// The part of the ground on which shadows fall and contacts are drawn.
struct ShadedRegion {
  Vec3 axisU, axisV;                                    // unit, in the ground
  double firstU = 0, firstV = 0, sizeU = 1, sizeV = 1;  // m, along the axes, from the stage's origin
  double margin = 0;                                    // m, from what is shown to the region's border
};

/// All that stays the same from frame to frame, but for a camera that moves. World coordinates for OpenGL are relative
/// to `origin`.
struct Stage {
  int width = 0, height = 0;
  Camera camera;
  Bounds bounds;  // m, world
  Vec3 origin;    // m, world
  Eigen::Matrix4f clipFromWorld;
  Lighting lighting;
  ShadowView shadow;
  std::optional<Ground> ground;
  ShadedRegion shaded;
  double fadeDistance = 1;  // m

  Vec3f relative(const Vec3& point) const { return (point - origin).cast<float>(); }
};

constexpr int kShadowMapSize = 1024;
constexpr int kShadowBlock = 8;  // texels of the shadow map a side; the map of blocks has the least depth of each
constexpr int kContactMapSize = 256;

/// Texture units that the shaders' samplers are bound to.
enum TextureUnit { kShadowUnit = 0, kBlockUnit, kContactUnit, kBallUnit, kNearBallUnit };

Stage makeStage(const Scene& scene, const View& view, const std::optional<Ground>& ground, int width, int height);

/// Size of a pixel at distance 1, in the middle of the picture.
double pixelAngle(const Stage& stage);

/// Turns the stage to another camera.
void aimCamera(const Camera& camera, Stage& stage);

/// What the shaders need to know of the stage before they are compiled.
std::string shaderDefinitions(const Stage& stage);

/// Gives a program all the uniforms of the stage.
void setStage(const Stage& stage, const ShaderProgram& program);

/// Gives it those that change with the camera.
void setCamera(const Stage& stage, const ShaderProgram& program);

}  // namespace cradle
