#include "render/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/camera.h"

namespace cradle {
namespace {

// Skies: a hazy day over ground; without ground, a studio that grows darker upwards. Linear.
const Vec3f kDayZenith(0.150f, 0.250f, 0.410f), kDayHorizon(0.600f, 0.690f, 0.770f);
const Vec3f kStudioZenith(0.130f, 0.165f, 0.225f), kStudioHorizon(0.640f, 0.670f, 0.700f),
    kStudioNadir(0.230f, 0.235f, 0.245f);
constexpr float kSkyOnGround = 0.62f;      // of the mean of zenith and horizon
constexpr float kBounceFromGround = 0.5f;  // shadows and distance take the rest
constexpr float kMeanSquare = 0.71f;       // of light and dark squares, in terms of the light one
constexpr double kNearShare = 0.02;        // of the camera's distance to what is shown
constexpr double kFadeDistance = 9;        // in sizes of the scene
constexpr double kContactMargin = 0.15;    // of the scene's size
constexpr double kLowestLight = 0.05;      // sine of the height below which the ground has no shadows
constexpr double kShadowMargin = 0.03;     // of the scene's size: links and soft edges

Lighting makeLighting(const Scene& scene, const std::optional<Ground>& ground) {
  Lighting lighting;
  for (const Light& light : scene.lights) {
    const float strength = static_cast<float>(light.intensity / std::numbers::pi);
    lighting.lamps.push_back({-light.direction, strength * linearFromSrgb(light.color)});
  }
  lighting.zenith = ground ? kDayZenith : kStudioZenith;
  lighting.horizon = ground ? kDayHorizon : kStudioHorizon;
  lighting.nadir = ground ? kDayHorizon : kStudioNadir;
  lighting.sky = kSkyOnGround * (lighting.zenith + lighting.horizon) / 2;
  lighting.bounce = kSkyOnGround * lighting.nadir;
  if (ground) {
    const auto& key = lighting.lamps.at(0);
    const float facing = static_cast<float>(std::max(ground->normal.dot(key.towards), 0.0));
    const Vec3f received = facing * key.radiance + lighting.sky;
    lighting.bounce = kBounceFromGround * kMeanSquare * ground->lightColor.cwiseProduct(received);
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

ShadowView makeShadowView(const Vec3& towardsLight, const Bounds& bounds, const Vec3& origin) {
  const Mat3 axes = cameraAxes(towardsLight, Vec3::Zero());
  const Bounds seen = inAxes(bounds, axes, origin);
  const double margin = kShadowMargin * seen.diagonal().norm();
  // Square, so that edges are equally soft both ways.
  const double half = std::max(seen.sizes().x(), seen.sizes().y()) / 2 + margin;
  const double deep = seen.sizes().z() / 2 + margin;
  const Vec3 center = seen.center();
  Eigen::Matrix4d clip = Eigen::Matrix4d::Identity();
  clip.topLeftCorner<3, 3>() = Vec3(1 / half, 1 / half, -1 / deep).asDiagonal() * axes.transpose();
  clip.topRightCorner<3, 1>() = Vec3(-center.x() / half, -center.y() / half, center.z() / deep);
  Eigen::Matrix4d texture = Eigen::Matrix4d::Identity();
  texture.topLeftCorner<3, 3>() *= 0.5;
  texture.topRightCorner<3, 1>().setConstant(0.5);
  return {clip.cast<float>(), (texture * clip).cast<float>(), joined(towardsLight, 0), 2 * half / kShadowMapSize};
}

/// Around all that the film shows, and its shadow.
ShadedRegion makeShadedRegion(const Ground& ground, const Vec3& towardsLight, const Bounds& bounds,
                              const Vec3& origin) {
  ShadedRegion region;
  const Vec3 along = std::abs(ground.normal.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitZ();
  region.axisU = (along - along.dot(ground.normal) * ground.normal).normalized();
  region.axisV = ground.normal.cross(region.axisU);
  Mat3 axes;
  axes << region.axisU, region.axisV, ground.normal;
  const Bounds shown = inAxes(bounds, axes, origin);
  const Vec3 light = axes.transpose() * towardsLight;
  const double height = ground.normal.dot(ground.point - origin);
  Bounds shaded = shown;
  for (int corner = 0; corner < 8 && light.z() > kLowestLight; ++corner) {
    const Vec3 point = shown.corner(static_cast<Bounds::CornerType>(corner));
    shaded.extend(Vec3(point - (point.z() - height) / light.z() * light));
  }
  region.margin = kContactMargin * shown.diagonal().norm();
  region.firstU = shaded.min().x() - region.margin;
  region.firstV = shaded.min().y() - region.margin;
  region.sizeU = shaded.sizes().x() + 2 * region.margin;
  region.sizeV = shaded.sizes().y() + 2 * region.margin;
  return region;
}

/// Position of the stage's origin within the pattern of squares along `axis`: repeats after two squares.
float phaseAlong(const Vec3& axis, const Stage& stage) {
  return static_cast<float>(std::fmod(axis.dot(stage.origin) / stage.ground->squareSize, 2));
}

void setRays(const Stage& stage, const ShaderProgram& program) {
  const Mat3 axes = cameraAxes(stage.camera);
  const double tangent = std::tan(stage.camera.verticalFieldOfView / 2);
  const double pixel = 2 * tangent / stage.height;
  const Vec3 column = pixel * axes.col(0), row = pixel * axes.col(1);
  const Vec3 corner = -axes.col(2) - stage.width / 2.0 * column - stage.height / 2.0 * row;
  program.set("cornerRay", Vec3f(corner.cast<float>()));
  program.set("columnRay", Vec3f(column.cast<float>()));
  program.set("rowRay", Vec3f(row.cast<float>()));
}

void setLighting(const Lighting& lighting, const ShaderProgram& program) {
  program.set("lightDirection", Vec3f(lighting.lamps[0].towards.cast<float>()));
  program.set("lightRadiance", lighting.lamps[0].radiance);
  program.set("zenithColor", lighting.zenith);
  program.set("horizonColor", lighting.horizon);
  program.set("nadirColor", lighting.nadir);
  program.set("skyIrradiance", lighting.sky);
  program.set("bounceIrradiance", lighting.bounce);
  for (std::size_t i = 0; i + 1 < lighting.lamps.size(); ++i) {
    const auto& lamp = lighting.lamps[i + 1];
    program.set(fmt::format("fillDirection[{}]", i).c_str(), Vec3f(lamp.towards.cast<float>()));
    program.set(fmt::format("fillRadiance[{}]", i).c_str(), lamp.radiance);
  }
}

void setGround(const Stage& stage, const ShaderProgram& program) {
  if (!stage.ground) return;
  const Ground& ground = *stage.ground;
  const ShadedRegion& region = stage.shaded;
  program.set("groundPlane", joined(ground.normal, ground.normal.dot(ground.point - stage.origin)));
  program.set("groundAxisU", Vec3f(region.axisU.cast<float>()));
  program.set("groundAxisV", Vec3f(region.axisV.cast<float>()));
  program.set("checkPhaseU", phaseAlong(region.axisU, stage));
  program.set("checkPhaseV", phaseAlong(region.axisV, stage));
  program.set("checksPerMetre", static_cast<float>(1 / ground.squareSize));
  program.set("lightCheck", ground.lightColor);
  program.set("darkCheck", ground.darkColor);
  program.set("fadeDistance", static_cast<float>(stage.fadeDistance));
  program.set("contactFromWorldU", joined(region.axisU / region.sizeU, -region.firstU / region.sizeU));
  program.set("contactFromWorldV", joined(region.axisV / region.sizeV, -region.firstV / region.sizeV));
  const Vec3 foot = ground.normal * ground.normal.dot(ground.point - stage.origin);
  const Vec3 corner = foot + region.firstU * region.axisU + region.firstV * region.axisV;
  program.set("mapOrigin", Vec3f(corner.cast<float>()));
  program.set("mapU", Vec3f((region.sizeU * region.axisU).cast<float>()));
  program.set("mapV", Vec3f((region.sizeV * region.axisV).cast<float>()));
}

double sizeOf(const Stage& stage) {
  return stage.bounds.diagonal().norm();
}

/// The same in all frames, so that the ground does not change where a camera comes near.
double farthestTarget(const View& view) {
  double farthest = (view.camera.position - view.camera.target).norm();
  for (const Camera& camera : view.cameras) farthest = std::max(farthest, (camera.position - camera.target).norm());
  return farthest;
}

}  // namespace

void aimCamera(const Camera& camera, Stage& stage) {
  stage.camera = camera;
  const double nearest = std::max(stage.bounds.exteriorDistance(camera.position), kNearShare * sizeOf(stage));
  stage.clipFromWorld = clipFromWorld(camera, stage.origin, stage.width, stage.height, kNearShare * nearest);
}

Stage makeStage(const Scene& scene, const View& view, const std::optional<Ground>& ground, int width, int height) {
  const Bounds bounds = view.bounds.isEmpty() ? Bounds(-Vec3::Ones(), Vec3::Ones()) : view.bounds;
  Stage stage;
  stage.width = width;
  stage.height = height;
  stage.bounds = bounds;
  stage.origin = bounds.center();
  aimCamera(view.camera, stage);
  stage.lighting = makeLighting(scene, ground);
  stage.shadow = makeShadowView(stage.lighting.lamps[0].towards, bounds, stage.origin);
  stage.ground = ground;
  if (ground) stage.shaded = makeShadedRegion(*ground, stage.lighting.lamps[0].towards, bounds, stage.origin);
  stage.fadeDistance = kFadeDistance * std::max(sizeOf(stage), farthestTarget(view) / 3);
  return stage;
}

std::string shaderDefinitions(const Stage& stage) {
  return fmt::format("#define HAS_GROUND {}\n#define FILL_LIGHTS {}\n", stage.ground ? 1 : 0,
                     stage.lighting.lamps.size() - 1);
}

void setCamera(const Stage& stage, const ShaderProgram& program) {
  program.use();
  program.set("clipFromWorld", stage.clipFromWorld);
  program.set("eye", stage.relative(stage.camera.position));
  program.set("viewer", joined(stage.camera.position - stage.origin, 1));
  setRays(stage, program);
}

void setStage(const Stage& stage, const ShaderProgram& program) {
  setCamera(stage, program);
  setLighting(stage.lighting, program);
  setGround(stage, program);
  program.set("shadowFromWorld", stage.shadow.textureFromWorld);
  program.set("shadowSize", static_cast<float>(kShadowMapSize));
  program.set("shadowTexel", static_cast<float>(stage.shadow.texel));
  program.set("shadowMap", static_cast<int>(kShadowUnit));
  program.set("contactMap", static_cast<int>(kContactUnit));
  program.set("ballTexels", static_cast<int>(kBallUnit));
  program.set("nearBallTexels", static_cast<int>(kNearBallUnit));
}

}  // namespace cradle
