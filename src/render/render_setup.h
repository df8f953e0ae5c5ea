#pragma once

#include <array>
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

using Box2 = Eigen::AlignedBox2d;

/// Where a map is: its home, or beside it by whole quarters of its size, and perhaps larger; so that its texels stay
/// where they are in the world as long as it does.
struct MapPlace {
  int level = 0;                     // 2^level times as large as at home
  std::array<int, 2> quarters = {};  // of its size then, from home
  bool operator==(const MapPlace&) const = default;
};

/// What follows from where things are in a frame.
struct FrameLayout {
  double nearPlane = 0;  // m, before the camera
  MapPlace shadows, ground;
  int depth = 0;  // of the shadow map from home, in quarters of its depth towards the light
  bool operator==(const FrameLayout&) const = default;
};

/// Where the shadow map looks: along the light, at what throws shadows into the picture.
struct ShadowView {
  Box2 home;  // m, along `axes` from the setup's origin
  Mat3 axes;  // right, up, towards the light
  Eigen::Matrix4f clipFromWorld, textureFromWorld;
  Eigen::Vector4f viewer;  // the light's direction, as sphere.vert takes it
  double texel = 0;        // m
  double deep = 0;         // m, from the least to the greatest depth
};

/// The part of the ground on which shadows and contact shadows fall.
struct ShadedRegion {
  Box2 home;                                            // m, as below
  Vec3 axisU, axisV;                                    // unit, in the ground
  double firstU = 0, firstV = 0, sizeU = 1, sizeV = 1;  // m, along the axes, from the setup's origin
  double margin = 0;                                    // m: farther from a thing, it darkens nothing
};

/// Camera, lights, maps and ground of a picture: all that it is drawn with, apart from its items. World coordinates for
/// OpenGL are relative to `origin`. All but camera and layout, and what follows from them, stays the same from frame to
/// frame.
struct RenderSetup {
  int width = 0, height = 0;
  bool hasPatterns = false;  // of materials
  bool hasTextures = false;  // of materials, or of models
  Camera camera;
  FrameLayout layout;
  double size = 1;  // m: View::size()
  Vec3 origin;      // m, world
  Eigen::Matrix4f clipFromWorld;
  Lighting lighting;
  ShadowView shadow;
  std::optional<Ground> ground;
  ShadedRegion shaded;
  double fadeDistance = 1;  // m

  Vec3f relative(const Vec3& point) const { return (point - origin).cast<float>(); }
};

constexpr int kShadowMapSize = 2048;
constexpr int kShadowBlock = 8;  // texels of the shadow map a side; the map of blocks has the least depth of each
constexpr int kContactShadowMapSize = 256;
constexpr double kLowestLight = 0.05;  // sine of the height below which the ground has no shadows

/// Texture units that the shaders' samplers are bound to.
enum TextureUnit { kShadowUnit = 0, kBlockUnit, kContactShadowUnit, kOccluderUnit, kNearOccluderUnit, kColorUnit };

RenderSetup makeRenderSetup(const Scene& scene, const View& view, const std::optional<Ground>& ground, int width,
                            int height);

/// Size of a pixel at distance 1, in the middle of the picture.
double pixelAngle(const RenderSetup& setup);

/// Turns the setup to another camera, and its maps to other places.
void layOut(const Camera& camera, const FrameLayout& layout, RenderSetup& setup);

/// From the least to the greatest depth of the shadow map; m.
double depthOfMap(const ShadowView& view, const MapPlace& place);

/// Distance of the near plane from the camera where nothing is nearer than `nearest`; m.
double nearPlaneFor(double nearest, const RenderSetup& setup);

/// What the shaders need to know of the setup before they are compiled.
std::string shaderDefinitions(const RenderSetup& setup);

/// Gives a program all the uniforms of the setup.
void setUniforms(const RenderSetup& setup, const ShaderProgram& program);

/// Gives it those that change with the camera and the near plane.
void setCamera(const RenderSetup& setup, const ShaderProgram& program);

/// Gives it those that change with the places of the maps.
void setMaps(const RenderSetup& setup, const ShaderProgram& program);

}  // namespace cradle
