#include "render/render_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/camera.h"

namespace cradle {
namespace {

/// Colours of the surroundings; linear.
struct Palette {
  Vec3f zenith, horizon, nadir;  // nadir is seen only where there is no ground
  Vec3f sky, bounce;             // on a white surface that faces up and down; over ground, its light is added to bounce
};

// A clear day that is pale enough behind a figure in print, and a studio without ground that grows darker upwards; then
// both at night, for slides with a dark background: bodies stay as bright by the key light.
const Palette kDay{{0.090f, 0.205f, 0.450f},
                   {0.540f, 0.650f, 0.790f},
                   {0.540f, 0.650f, 0.790f},
                   {0.185f, 0.222f, 0.285f},
                   {0.000f, 0.000f, 0.000f}};
const Palette kStudio{{0.190f, 0.235f, 0.310f},
                      {0.620f, 0.640f, 0.670f},
                      {0.240f, 0.245f, 0.255f},
                      {0.260f, 0.280f, 0.310f},
                      {0.160f, 0.160f, 0.165f}};
const Palette kNight{{0.022f, 0.032f, 0.055f},
                     {0.050f, 0.061f, 0.085f},
                     {0.050f, 0.061f, 0.085f},
                     {0.135f, 0.160f, 0.210f},
                     {0.030f, 0.034f, 0.042f}};
const Palette kDarkStudio{{0.020f, 0.026f, 0.040f},
                          {0.055f, 0.063f, 0.080f},
                          {0.016f, 0.018f, 0.022f},
                          {0.120f, 0.135f, 0.165f},
                          {0.045f, 0.047f, 0.052f}};

const Vec3f kKeyTint(1.10f, 1.02f, 0.91f);     // of a white lamp of the scene: warmer than the sky, as the sun is
constexpr float kBounceFromGround = 0.42f;     // shadows and distance take the rest
constexpr float kSkySlope = 0.30f;             // how much brighter it is towards the key light than on average
constexpr double kNearShare = 0.02;            // of the distance of the nearest thing
constexpr double kNearestShare = 0.02;         // of the scene's size: nearer things do not count
constexpr double kFadeDistance = 9;            // in sizes of the scene
constexpr double kContactShadowMargin = 0.15;  // of the scene's size
constexpr double kShadowTexel = 1.0 / 800;     // of the height of the picture where what is shown is
constexpr double kShadowDepth = 16;  // of the shadow map's width: what stands high above still throws a shadow

Lighting makeLighting(const Scene& scene, const std::optional<Ground>& ground) {
  const bool isDark = scene.look == Look::dark;
  const Palette& palette = ground ? (isDark ? kNight : kDay) : (isDark ? kDarkStudio : kStudio);
  Lighting lighting{{}, palette.zenith, palette.horizon, palette.nadir, palette.sky, palette.bounce, Vec3f::Zero()};
  for (const Light& light : scene.lights) {
    const float strength = static_cast<float>(light.intensity / std::numbers::pi);
    lighting.lamps.push_back({-light.direction, strength * kKeyTint.cwiseProduct(linearFromSrgb(light.color))});
  }
  const auto& key = lighting.lamps.at(0);
  lighting.skySlope = kSkySlope * Vec3(key.towards.x(), 0, key.towards.z()).cast<float>();
  if (ground) {
    const float facing = static_cast<float>(std::max(ground->normal.dot(key.towards), 0.0));
    const Vec3f received = facing * key.radiance + lighting.sky;
    lighting.bounce += kBounceFromGround * ground->lightColor.cwiseProduct(received);
  }
  return lighting;
}

Bounds inAxes(const Bounds& bounds, const Mat3& axes, const Vec3& origin) {
  Bounds turned;
  for (int corner = 0; corner < 8; ++corner)
    turned.extend(axes.transpose() * (bounds.corner(static_cast<Bounds::CornerType>(corner)) - origin));
  return turned;
}

Eigen::Vector4f joined(const Vec3& vector, double last) {
  return {static_cast<float>(vector.x()), static_cast<float>(vector.y()), static_cast<float>(vector.z()),
          static_cast<float>(last)};
}

/// Square, so that edges are equally soft both ways, around the setup's origin.
ShadowView makeShadowView(const Vec3& towardsLight, double heightOfPicture) {
  ShadowView view;
  view.axes = cameraAxes(towardsLight, Vec3::Zero());
  view.viewer = joined(towardsLight, 0);
  const auto half = Eigen::Vector2d::Constant(kShadowMapSize * kShadowTexel * heightOfPicture / 2);
  view.home = Box2(-half, half);
  return view;
}

/// The part of its plane that a map covers.
Box2 placed(const Box2& home, const MapPlace& place) {
  const Eigen::Vector2d sizes = std::ldexp(1.0, place.level) * home.sizes();
  const Eigen::Vector2d moved(place.quarters[0], place.quarters[1]);
  const Eigen::Vector2d center = home.center() + sizes.cwiseProduct(moved) / 4;
  return {center - sizes / 2, center + sizes / 2};
}

void placeShadows(const FrameLayout& layout, ShadowView& view) {
  const Box2 seen = placed(view.home, layout.shadows);
  view.deep = depthOfMap(view, layout.shadows);
  const double half = seen.sizes().x() / 2, deep = view.deep / 2;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Identity();
  clip.topLeftCorner<3, 3>() = Vec3(1 / half, 1 / half, -1 / deep).asDiagonal() * view.axes.transpose();
  clip.topRightCorner<3, 1>() = Vec3(-seen.center().x() / half, -seen.center().y() / half, layout.depth / 2.0);
  const Eigen::Affine3d texture = Eigen::Translation3d(0.5, 0.5, 0.5) * Eigen::Scaling(0.5);
  view.clipFromWorld = clip.cast<float>();
  view.textureFromWorld = (texture.matrix() * clip).cast<float>();
  view.texel = 2 * half / kShadowMapSize;
}

/// Around what is shown and its shadow, and the middle of the picture.
ShadedRegion makeShadedRegion(const Ground& ground, const RenderSetup& setup, const Bounds& bounds,
                              double heightOfPicture) {
  const Vec3& towardsLight = setup.lighting.lamps[0].towards;
  ShadedRegion region;
  const Vec3 along = std::abs(ground.normal.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitZ();
  region.axisU = (along - along.dot(ground.normal) * ground.normal).normalized();
  region.axisV = ground.normal.cross(region.axisU);
  Mat3 axes;
  axes << region.axisU, region.axisV, ground.normal;
  const Bounds shown = inAxes(bounds, axes, setup.origin);
  const Vec3 light = axes.transpose() * towardsLight;
  const double height = ground.normal.dot(ground.point - setup.origin);
  Bounds shaded = shown;
  for (int corner = 0; corner < 8 && light.z() > kLowestLight; ++corner) {
    const Vec3 point = shown.corner(static_cast<Bounds::CornerType>(corner));
    shaded.extend(Vec3(point - (point.z() - height) / light.z() * light));
  }
  const Vec3 seen = Vec3::Constant(heightOfPicture / 2);
  shaded.extend(shown.center() - seen), shaded.extend(shown.center() + seen);
  region.margin = kContactShadowMargin * setup.size;
  const Eigen::Vector2d around = Eigen::Vector2d::Constant(region.margin);
  region.home = Box2(shaded.min().head<2>() - around, shaded.max().head<2>() + around);
  return region;
}

void placeGround(const MapPlace& place, ShadedRegion& region) {
  const Box2 shaded = placed(region.home, place);
  region.firstU = shaded.min().x();
  region.firstV = shaded.min().y();
  region.sizeU = shaded.sizes().x();
  region.sizeV = shaded.sizes().y();
}

/// Position of the setup's origin within the pattern of squares along `axis`: repeats after ten squares.
float phaseAlong(const Vec3& axis, const RenderSetup& setup) {
  return static_cast<float>(std::fmod(axis.dot(setup.origin) / setup.ground->squareSize, 10));
}

void setRays(const RenderSetup& setup, const ShaderProgram& program) {
  const Mat3 axes = cameraAxes(setup.camera);
  const double tangent = std::tan(setup.camera.verticalFieldOfView / 2);
  const double pixel = 2 * tangent / setup.height;
  const Vec3 column = pixel * axes.col(0), row = pixel * axes.col(1);
  const Vec3 corner = -axes.col(2) - setup.width / 2.0 * column - setup.height / 2.0 * row;
  program.set("cornerRay", Vec3f(corner.cast<float>()));
  program.set("columnRay", Vec3f(column.cast<float>()));
  program.set("rowRay", Vec3f(row.cast<float>()));
  program.set("pixelSize", static_cast<float>(pixel));
}

void setLighting(const Lighting& lighting, const ShaderProgram& program) {
  program.set("lightDirection", Vec3f(lighting.lamps[0].towards.cast<float>()));
  program.set("lightRadiance", lighting.lamps[0].radiance);
  program.set("zenithColor", lighting.zenith);
  program.set("horizonColor", lighting.horizon);
  program.set("nadirColor", lighting.nadir);
  program.set("skyIrradiance", lighting.sky);
  program.set("bounceIrradiance", lighting.bounce);
  program.set("skySlope", lighting.skySlope);
  for (std::size_t i = 0; i + 1 < lighting.lamps.size(); ++i) {
    const auto& lamp = lighting.lamps[i + 1];
    program.set(fmt::format("fillDirection[{}]", i).c_str(), Vec3f(lamp.towards.cast<float>()));
    program.set(fmt::format("fillRadiance[{}]", i).c_str(), lamp.radiance);
  }
}

void setGround(const RenderSetup& setup, const ShaderProgram& program) {
  if (!setup.ground) return;
  const Ground& ground = *setup.ground;
  const ShadedRegion& region = setup.shaded;
  program.set("groundPlane", joined(ground.normal, ground.normal.dot(ground.point - setup.origin)));
  program.set("groundAxisU", Vec3f(region.axisU.cast<float>()));
  program.set("groundAxisV", Vec3f(region.axisV.cast<float>()));
  program.set("gridPhaseU", phaseAlong(region.axisU, setup));
  program.set("gridPhaseV", phaseAlong(region.axisV, setup));
  program.set("squaresPerMetre", static_cast<float>(1 / ground.squareSize));
  program.set("lightSquare", ground.lightColor);
  program.set("darkSquare", ground.darkColor);
  program.set("lineShade", ground.lineShade);
  program.set("fadeDistance", static_cast<float>(setup.fadeDistance));
}

void setGroundMap(const RenderSetup& setup, const ShaderProgram& program) {
  if (!setup.ground) return;
  const Ground& ground = *setup.ground;
  const ShadedRegion& region = setup.shaded;
  program.set("contactShadowFromWorldU", joined(region.axisU / region.sizeU, -region.firstU / region.sizeU));
  program.set("contactShadowFromWorldV", joined(region.axisV / region.sizeV, -region.firstV / region.sizeV));
  const Vec3 foot = ground.normal * ground.normal.dot(ground.point - setup.origin);
  const Vec3 corner = foot + region.firstU * region.axisU + region.firstV * region.axisV;
  program.set("mapOrigin", Vec3f(corner.cast<float>()));
  program.set("mapU", Vec3f((region.sizeU * region.axisU).cast<float>()));
  program.set("mapV", Vec3f((region.sizeV * region.axisV).cast<float>()));
}

/// How high a picture is at the distance of what is shown, of the camera named that is farthest from it; m.
double heightOfPicture(const View& view, const Vec3& middle) {
  const auto height = [&](const Camera& camera) {
    return 2 * std::tan(camera.verticalFieldOfView / 2) * (camera.position - middle).norm();
  };
  double greatest = height(view.camera);
  for (const Camera& camera : view.keys) greatest = std::max(greatest, height(camera));
  return greatest;
}

/// The same in all frames, so that the ground does not change where a camera comes near.
double farthestTarget(const View& view) {
  double farthest = (view.camera.position - view.camera.target).norm();
  for (const Camera& camera : view.keys) farthest = std::max(farthest, (camera.position - camera.target).norm());
  return farthest;
}

bool haveTextures(const Scene& scene) {
  const auto has = [](const auto& material) { return material.texture != nullptr; };
  return std::any_of(scene.materials.begin(), scene.materials.end(), has) ||
         std::any_of(scene.models.begin(), scene.models.end(), [&](const Model& model) {
           return std::any_of(model.drawn.materials.begin(), model.drawn.materials.end(), has);
         });
}

}  // namespace

double pixelAngle(const RenderSetup& setup) {
  return 2 * std::tan(setup.camera.verticalFieldOfView / 2) / setup.height;
}

double depthOfMap(const ShadowView& view, const MapPlace& place) {
  return kShadowDepth * std::ldexp(view.home.sizes().x(), place.level);
}

double nearPlaneFor(double nearest, const RenderSetup& setup) {
  return kNearShare * std::max(nearest, kNearestShare * setup.size);
}

void layOut(const Camera& camera, const FrameLayout& layout, RenderSetup& setup) {
  setup.camera = camera;
  setup.layout = layout;
  setup.clipFromWorld = clipFromWorld(camera, setup.origin, setup.width, setup.height, layout.nearPlane);
  placeShadows(layout, setup.shadow);
  if (setup.ground) placeGround(layout.ground, setup.shaded);
}

RenderSetup makeRenderSetup(const Scene& scene, const View& view, const std::optional<Ground>& ground, int width,
                            int height) {
  const Bounds bounds = view.bounds.isEmpty() ? Bounds(-Vec3::Ones(), Vec3::Ones()) : view.bounds;
  RenderSetup setup;
  setup.width = width;
  setup.height = height;
  setup.size = view.size();
  setup.origin = bounds.center();
  setup.lighting = makeLighting(scene, ground);
  setup.hasPatterns = std::any_of(scene.materials.begin(), scene.materials.end(),
                                  [](const Material& material) { return material.pattern != Pattern::none; });
  setup.hasTextures = haveTextures(scene);
  const double seen = heightOfPicture(view, setup.origin);
  setup.shadow = makeShadowView(setup.lighting.lamps[0].towards, seen);
  setup.ground = ground;
  if (ground) setup.shaded = makeShadedRegion(*ground, setup, bounds, seen);
  setup.fadeDistance = kFadeDistance * std::max(setup.size, farthestTarget(view) / 3);
  layOut(view.camera, {nearPlaneFor(0, setup), {}, {}, 0}, setup);
  return setup;
}

std::string shaderDefinitions(const RenderSetup& setup) {
  return fmt::format("#define HAS_GROUND {}\n#define FILL_LIGHTS {}\n#define PATTERNS {}\n#define TEXTURES {}\n",
                     setup.ground ? 1 : 0, setup.lighting.lamps.size() - 1, setup.hasPatterns ? 1 : 0,
                     setup.hasTextures ? 1 : 0);
}

void setCamera(const RenderSetup& setup, const ShaderProgram& program) {
  program.use();
  program.set("clipFromWorld", setup.clipFromWorld);
  program.set("eye", setup.relative(setup.camera.position));
  program.set("viewer", joined(setup.camera.position - setup.origin, 1));
  setRays(setup, program);
}

void setMaps(const RenderSetup& setup, const ShaderProgram& program) {
  program.use();
  setGroundMap(setup, program);
  program.set("shadowFromWorld", setup.shadow.textureFromWorld);
  program.set("shadowTexel", static_cast<float>(setup.shadow.texel));
}

void setUniforms(const RenderSetup& setup, const ShaderProgram& program) {
  setCamera(setup, program);
  setLighting(setup.lighting, program);
  setGround(setup, program);
  setMaps(setup, program);
  program.set("shadowSize", static_cast<float>(kShadowMapSize));
  program.set("shadowDeep", static_cast<float>(setup.shadow.deep / setup.shadow.texel));
  program.set("shadowMap", static_cast<int>(kShadowUnit));
  program.set("shadowBlocks", static_cast<int>(kBlockUnit));
  program.set("contactShadowMap", static_cast<int>(kContactShadowUnit));
  program.set("occluderTexels", static_cast<int>(kOccluderUnit));
  program.set("nearOccluderTexels", static_cast<int>(kNearOccluderUnit));
  program.set("colorMap", static_cast<int>(kColorUnit));
}

}  // namespace cradle
