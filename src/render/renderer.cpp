#include "render/renderer.h"

#include <GL/glew.h>

#include <array>
#include <chrono>
#include <cmath>

#include "core/error.h"
#include "render/draw_list.h"
#include "render/gpu_mesh.h"
#include "render/instances.h"
#include "render/offscreen_context.h"
#include "render/render_targets.h"
#include "render/shader_program.h"
#include "render/stage.h"

namespace cradle {
namespace {

constexpr int kSegmentsPerTurn = 20;  // of a coil: its chords miss the circle by 1 % of its radius
constexpr int kRopeSegments = 64;
constexpr int kSegmentsAround = 10;  // of a wire

using Clock = std::chrono::steady_clock;

double pixelsPerMetre(const View& view, int height) {
  const Vec3 center = view.bounds.isEmpty() ? view.camera.target : Vec3(view.bounds.center());
  const double distance = (view.camera.position - center).norm();
  return height / (2 * std::max(distance, 1e-9) * std::tan(view.camera.verticalFieldOfView / 2));
}

void appendCorner(const Vec3& corner, float w, std::vector<float>& vertices) {
  for (const double number : corner) vertices.push_back(static_cast<float>(number));
  vertices.push_back(w);
}

/// Corners of the part of the ground with shadows, counter-clockwise from above, relative to the stage's origin.
std::array<Vec3, 4> shadedCorners(const Stage& stage) {
  const ShadedRegion& region = stage.shaded;
  const Vec3 foot = stage.ground->normal * stage.ground->normal.dot(stage.ground->point - stage.origin);
  const Vec3 corner = foot + region.firstU * region.axisU + region.firstV * region.axisV;
  const Vec3 u = region.sizeU * region.axisU, v = region.sizeV * region.axisV;
  return {corner, corner + u, corner + u + v, corner + v};
}

GpuMesh makeNearGround(const Stage& stage) {
  std::vector<float> vertices;
  for (const Vec3& corner : shadedCorners(stage)) appendCorner(corner, 1, vertices);
  return {vertices, 4, {0, 1, 2, 0, 2, 3}};
}

/// What lies around the near ground: from each of its edges to corners infinitely far.
GpuMesh makeFarGround(const Stage& stage) {
  const auto corners = shadedCorners(stage);
  const Vec3 middle = (corners[0] + corners[2]) / 2;
  std::vector<float> vertices;
  for (const Vec3& corner : corners) appendCorner(corner, 1, vertices);
  for (const Vec3& corner : corners) appendCorner((corner - middle).normalized(), 0, vertices);
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t next = (i + 1) % 4;
    indices.insert(indices.end(), {i, i + 4, next + 4, i, next + 4, next});
  }
  return {vertices, 4, indices};
}

}  // namespace

/// The shaders of all stages.
struct Renderer::Programs {
  Programs(const ShaderSource& source, const Stage& stage)
      : surface(source, "surface.vert", "surface.frag"),
        ball(source, "ball.vert", "ball.frag"),
        cylinder(source, "cylinder.vert", "cylinder.frag"),
        tube(source, "tube.vert", "surface.frag"),
        surfaceDepth(source, "surface.vert", "depth.frag"),
        ballDepth(source, "ball.vert", "depth.frag"),
        cylinderDepth(source, "cylinder.vert", "depth.frag"),
        tubeDepth(source, "tube.vert", "depth.frag"),
        ground(source, "ground.vert", "ground.frag"),
        groundFar(source, "ground.vert", "ground_far.frag"),
        contact(source, "contact.vert", "contact.frag"),
        sky(source, "sky.vert", "sky.frag") {
    for (const ShaderProgram* program : {&surface, &ball, &cylinder, &tube, &ground, &groundFar, &contact, &sky})
      setStage(stage, *program);
    for (const ShaderProgram* program : {&surfaceDepth, &ballDepth, &cylinderDepth, &tubeDepth}) {
      program->use();
      program->set("clipFromWorld", stage.shadow.clipFromWorld);
      program->set("viewer", stage.shadow.viewer);
    }
  }

  ShaderProgram surface, ball, cylinder, tube;
  ShaderProgram surfaceDepth, ballDepth, cylinderDepth, tubeDepth;  // the same for the shadow map
  ShaderProgram ground, groundFar, contact, sky;
};

/// All that lives on the side of OpenGL; the context goes last.
struct Renderer::Resources {
  Resources(const Scene& scene, const View& view, int width, int height, const std::string& shaderFolder);

  OffscreenContext context;
  struct SizeCheck {
    SizeCheck(int width, int height) { requirePictureSize(width, height); }
  } sizeCheck;  // before any memory is asked for
  Appearance appearance;
  Stage stage;
  Programs programs;
  PictureTarget picture;
  MapTarget shadowMap, contactMap;
  InstanceBuffer meshInstances, wallInstances, sphereInstances, cylinderInstances, tubeInstances, contactInstances;
  NumberTexture balls, nearBalls;
  std::vector<GpuMesh> meshes, halfBalls, halfCylinders;
  GpuMesh coilMesh, ropeMesh, triangle, square;
  std::optional<GpuMesh> nearGround, farGround;
  PackedDrawList packed;
  Clock::time_point stageStart;
};

Renderer::Resources::Resources(const Scene& scene, const View& view, int width, int height,
                               const std::string& shaderFolder)
    : sizeCheck(width, height),
      appearance(makeAppearance(scene, view, pixelsPerMetre(view, height))),
      stage(makeStage(scene, view, appearance.ground, width, height)),
      programs({shaderFolder, shaderDefinitions(stage)}, stage),
      picture(width, height),
      shadowMap(MapTarget::Kind::depth, kShadowMapSize),
      contactMap(MapTarget::Kind::share, kContactMapSize),
      balls(4),
      nearBalls(1),
      coilMesh(makeTube(kMostCoilTurns * kSegmentsPerTurn, kSegmentsAround)),
      ropeMesh(makeTube(kRopeSegments, kSegmentsAround)),
      triangle({0, 0, 0}, 1, {0, 1, 2}),
      square({-1, -1, 1, -1, 1, 1, -1, 1}, 2, {0, 1, 2, 0, 2, 3}) {
  for (const DrawnMesh& mesh : appearance.meshes) meshes.emplace_back(mesh);
  for (const int outline : kOutlines) {
    halfBalls.push_back(makeHalfBall(outline));
    halfCylinders.push_back(makeHalfCylinder(outline));
  }
  if (!stage.ground) return;
  nearGround.emplace(makeNearGround(stage));
  farGround.emplace(makeFarGround(stage));
}

Renderer::Renderer(const Scene& scene, const View& view, int width, int height, const std::string& shaderFolder)
    : scene_(scene), view_(view), resources_(std::make_unique<Resources>(scene, view, width, height, shaderFolder)) {}

Renderer::~Renderer() {
  resources_->context.makeCurrent();
}

Image Renderer::render(const Frame& frame) {
  Resources& r = *resources_;
  r.context.makeCurrent();
  times_ = {};
  r.stageStart = Clock::now();
  r.packed = pack(makeDrawList(scene_, r.appearance, view_, frame), r.stage);
  finishStage(times_.drawList);

  r.meshInstances.upload(r.packed.meshInstances);
  r.wallInstances.upload(r.packed.wallInstances);
  r.sphereInstances.upload(r.packed.sphereInstances);
  r.cylinderInstances.upload(r.packed.cylinderInstances);
  r.tubeInstances.upload(r.packed.tubeInstances);
  r.contactInstances.upload(r.packed.contactInstances);
  r.balls.upload(r.packed.balls);
  r.nearBalls.upload(r.packed.nearBalls);
  drawMaps();
  finishStage(times_.maps);

  drawPicture();
  finishStage(times_.main);
  r.picture.resolve();
  finishStage(times_.resolve);
  Image image = r.picture.read();
  finishStage(times_.readBack);
  return image;
}

void Renderer::finishStage(double& seconds) {
  if (measuring_) glFinish();
  const auto now = Clock::now();
  seconds = std::chrono::duration<double>(now - resources_->stageStart).count();
  resources_->stageStart = now;
}

void Renderer::drawMaps() {
  const Resources& r = *resources_;
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_CLAMP);  // what stands outside the view still throws its shadow into it
  r.shadowMap.begin();
  r.programs.surfaceDepth.use();
  drawMeshes();
  r.programs.ballDepth.use();
  drawSpheres();
  r.programs.cylinderDepth.use();
  drawCylinders();
  r.programs.tubeDepth.use();
  drawTubes();
  glDisable(GL_DEPTH_CLAMP);
  r.shadowMap.end();

  r.contactMap.begin();
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE_MINUS_DST_COLOR, GL_ONE);  // what two things leave open is the product of what each does
  r.programs.contact.use();
  const std::size_t contacts = r.packed.contactInstances.size();
  if (contacts > 0) r.square.draw(0, 2, r.contactInstances, 0, contacts);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  r.contactMap.end();
}

void Renderer::drawPicture() {
  const Resources& r = *resources_;
  r.shadowMap.bindTexture(kShadowUnit);
  r.contactMap.bindTexture(kContactUnit);
  r.balls.bindTexture(kBallUnit);
  r.nearBalls.bindTexture(kNearBallUnit);
  r.picture.begin();
  r.programs.ball.use();
  drawSpheres();
  r.programs.cylinder.use();
  drawCylinders();
  r.programs.surface.use();
  drawMeshes();
  if (!r.packed.wallInstances.empty()) {
    const GpuMesh& wall = r.meshes[static_cast<std::size_t>(r.appearance.wallMesh)];
    wall.draw(0, wall.triangleCount(), r.wallInstances, 0, r.packed.wallInstances.size());
  }
  r.programs.tube.use();
  drawTubes();
  // Last what fills the picture: hidden pixels are not computed.
  if (r.nearGround) {
    glEnable(GL_CULL_FACE);  // from below, the ground is not there
    r.programs.ground.use();
    r.nearGround->draw();
    r.programs.groundFar.use();
    r.farGround->draw();
    glDisable(GL_CULL_FACE);
  }
  r.programs.sky.use();
  r.triangle.draw();
}

void Renderer::drawMeshes() const {
  const Resources& r = *resources_;
  for (const Batch& batch : r.packed.meshBatches) {
    const auto mesh = static_cast<std::size_t>(batch.mesh);
    if (r.appearance.meshIsClosed[mesh]) glEnable(GL_CULL_FACE);
    r.meshes[mesh].draw(batch.firstTriangle, batch.triangleCount, r.meshInstances, batch.firstInstance,
                        batch.instanceCount);
    glDisable(GL_CULL_FACE);
  }
}

void Renderer::drawSpheres() const {
  const Resources& r = *resources_;
  for (const Batch& batch : r.packed.sphereBatches) {
    const GpuMesh& mesh = r.halfBalls[static_cast<std::size_t>(batch.mesh)];
    mesh.draw(0, mesh.triangleCount(), r.sphereInstances, batch.firstInstance, batch.instanceCount);
  }
}

void Renderer::drawCylinders() const {
  const Resources& r = *resources_;
  for (const Batch& batch : r.packed.cylinderBatches) {
    const GpuMesh& mesh = r.halfCylinders[static_cast<std::size_t>(batch.mesh)];
    mesh.draw(0, mesh.triangleCount(), r.cylinderInstances, batch.firstInstance, batch.instanceCount);
  }
}

void Renderer::drawTubes() const {
  const Resources& r = *resources_;
  // Springs stand before ropes in the list.
  std::size_t coils = 0;
  while (coils < r.packed.tubeInstances.size() && r.packed.tubeInstances[coils][11] > 0) ++coils;
  const std::size_t ropes = r.packed.tubeInstances.size() - coils;
  if (coils > 0) r.coilMesh.draw(0, r.coilMesh.triangleCount(), r.tubeInstances, 0, coils);
  if (ropes > 0) r.ropeMesh.draw(0, r.ropeMesh.triangleCount(), r.tubeInstances, coils, ropes);
}

}  // namespace cradle
