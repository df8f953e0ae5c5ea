#include "render/renderer.h"

#include <GL/glew.h>

#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "render/changed_area.h"
#include "render/frame_layout.h"
#include "render/item_drawer.h"
#include "render/light_maps.h"
#include "render/offscreen_context.h"
#include "render/render_setup.h"
#include "render/render_targets.h"
#include "render/shader_program.h"

namespace cradle {
namespace {

using Clock = std::chrono::steady_clock;

double pixelsPerMetre(const Camera& camera, const Bounds& bounds, int height) {
  const Vec3 center = bounds.isEmpty() ? camera.target : Vec3(bounds.center());
  const double distance = (camera.position - center).norm();
  return height / (2 * std::max(distance, 1e-9) * std::tan(camera.verticalFieldOfView / 2));
}

/// Where the scene looks largest, of the cameras that it names.
double pixelsPerMetre(const View& view, int height) {
  double most = pixelsPerMetre(view.camera, view.bounds, height);
  for (const Camera& camera : view.keys) most = std::max(most, pixelsPerMetre(camera, view.bounds, height));
  return most;
}

void appendCorner(const Vec3& corner, float w, std::vector<float>& vertices) {
  for (const double number : corner) vertices.push_back(static_cast<float>(number));
  vertices.push_back(w);
}

/// Corners of the part of the ground with shadows, counter-clockwise from above, relative to the setup's origin.
std::array<Vec3, 4> shadedCorners(const RenderSetup& setup) {
  const ShadedRegion& region = setup.shaded;
  const Vec3 foot = setup.ground->normal * setup.ground->normal.dot(setup.ground->point - setup.origin);
  const Vec3 corner = foot + region.firstU * region.axisU + region.firstV * region.axisV;
  const Vec3 u = region.sizeU * region.axisU, v = region.sizeV * region.axisV;
  return {corner, corner + u, corner + u + v, corner + v};
}

GpuMesh makeNearGround(const RenderSetup& setup) {
  std::vector<float> vertices;
  for (const Vec3& corner : shadedCorners(setup)) appendCorner(corner, 1, vertices);
  return {vertices, 4, {0, 1, 2, 0, 2, 3}};
}

/// What lies around the near ground: from each of its edges to corners infinitely far.
GpuMesh makeFarGround(const RenderSetup& setup) {
  const auto corners = shadedCorners(setup);
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

std::vector<MeshBounds> boundsOfMeshes(const Appearance& appearance) {
  std::vector<MeshBounds> all;
  for (std::size_t i = 0; i < appearance.meshes.size(); ++i)
    all.push_back(boundsOf(appearance.meshes[i], appearance.meshIsClosed[i]));
  return all;
}

}  // namespace

/// The shaders of what the camera sees.
struct Renderer::Programs {
  Programs(const ShaderSource& source, const RenderSetup& setup)
      : surface(source, "surface.vert", "surface.frag"),
        sphere(source, "sphere.vert", "sphere.frag"),
        cylinder(source, "cylinder.vert", "cylinder.frag"),
        tube(source, "tube.vert", "surface.frag"),
        ground(source, "ground.vert", "ground.frag"),
        groundFar(source, "ground.vert", "ground_far.frag"),
        sky(source, "sky.vert", "sky.frag") {
    for (const ShaderProgram* program : all()) setUniforms(setup, *program);
  }

  std::array<const ShaderProgram*, 7> all() const {
    return {&surface, &sphere, &cylinder, &tube, &ground, &groundFar, &sky};
  }

  ShaderProgram surface, sphere, cylinder, tube, ground, groundFar, sky;
};

/// All that lives on the side of OpenGL, and the picture drawn last; the context goes last.
struct Renderer::Resources {
  Resources(const Scene& scene, const View& view, int width, int height, const std::string& shaderFolder);
  void layGround();

  OffscreenContext context;
  struct SizeCheck {
    SizeCheck(int width, int height) { requirePictureSize(width, height); }
  } sizeCheck;  // before any memory is asked for
  Appearance appearance;
  std::vector<MeshBounds> meshBounds;
  RenderSetup setup;
  Programs programs;
  LightMaps maps;
  PictureTarget picture;
  NumberTexture occluders, nearOccluders;
  ItemDrawer items;
  GpuMesh triangle;
  std::optional<GpuMesh> nearGround, farGround;
  std::optional<DrawList> drawn;  // what picture, maps and image show
  Image image;
  Clock::time_point passStart;
};

Renderer::Resources::Resources(const Scene& scene, const View& view, int width, int height,
                               const std::string& shaderFolder)
    : sizeCheck(width, height),
      appearance(makeAppearance(scene, view, pixelsPerMetre(view, height))),
      meshBounds(boundsOfMeshes(appearance)),
      setup(makeRenderSetup(scene, view, appearance.ground, width, height)),
      programs({shaderFolder, shaderDefinitions(setup)}, setup),
      maps({shaderFolder, shaderDefinitions(setup)}, setup),
      picture(width, height),
      occluders(4),
      nearOccluders(1),
      items(appearance, setup),
      triangle({0, 0, 0}, 1, {0, 1, 2}),
      image(width, height) {
  layGround();
}

void Renderer::Resources::layGround() {
  if (!setup.ground) return;
  nearGround.emplace(makeNearGround(setup));
  farGround.emplace(makeFarGround(setup));
}

Renderer::Renderer(const Scene& scene, const View& view, int width, int height, const std::string& shaderFolder)
    : scene_(scene), view_(view), resources_(std::make_unique<Resources>(scene, view, width, height, shaderFolder)) {}

Renderer::~Renderer() {
  resources_->context.makeCurrent();
}

void Renderer::forgetPicture() {
  resources_->drawn.reset();
}

Image Renderer::render(const Frame& frame, const Camera& camera) {
  Resources& r = *resources_;
  r.context.makeCurrent();
  times_ = {};
  r.passStart = Clock::now();
  DrawList list = makeDrawList(scene_, r.appearance, view_, {frame, camera.position});
  aim(camera, list);
  const ChangedArea changed = r.drawn ? changedArea(*r.drawn, list, r.setup, r.meshBounds) : wholePicture(r.setup);
  r.drawn.reset();  // until the picture is complete
  finishPass(times_.drawList);
  drawnShare_ = 0;
  // Maps too if nothing of them is seen yet: later pictures look things up there.
  if (!changed.picture.isEmpty() || changed.shadows || changed.contactShadowsChanged) draw(list, changed);
  r.drawn = std::move(list);
  return r.image;
}

/// From another place, or in other maps, everything is drawn anew.
void Renderer::aim(const Camera& camera, const DrawList& list) {
  Resources& r = *resources_;
  const FrameLayout layout = layoutOf(list, r.meshBounds, camera, r.setup);
  if (camera == r.setup.camera && layout == r.setup.layout) return;
  const FrameLayout& before = r.setup.layout;
  const bool movesMaps =
      layout.shadows != before.shadows || layout.ground != before.ground || layout.depth != before.depth;
  layOut(camera, layout, r.setup);
  for (const ShaderProgram* program : r.programs.all()) setCamera(r.setup, *program);
  if (movesMaps) moveMaps();
  r.drawn.reset();
}

void Renderer::moveMaps() {
  Resources& r = *resources_;
  for (const ShaderProgram* program : r.programs.all()) setMaps(r.setup, *program);
  r.maps.move(r.setup);
  r.layGround();
}

void Renderer::draw(const DrawList& list, const ChangedArea& changed) {
  Resources& r = *resources_;
  r.items.take(list, r.meshBounds);
  r.occluders.upload(r.items.packed().occluders);
  r.nearOccluders.upload(r.items.packed().nearOccluders);
  if (changed.shadows) r.maps.drawShadows(r.items, *changed.shadows);
  if (changed.contactShadowsChanged) r.maps.drawContactShadows(r.items);
  finishPass(times_.maps);
  const std::vector<PixelRectangle> areas = changed.picture.rectangles();
  // Mesa's software renderer lets samples up to half a pixel beyond an area through, and what is drawn there once more
  // takes the place of what is as far away and was drawn later: of areas that touch, one is resolved before the other
  // is drawn.
  for (const std::vector<PixelRectangle>& apart : groupsApart(areas)) {
    for (const PixelRectangle& area : apart) drawPicture(area);
    finishPass(times_.main);
    for (const PixelRectangle& area : apart) r.picture.resolve(area);
    finishPass(times_.resolve);
  }
  for (const PixelRectangle& area : areas) r.picture.read(area, r.image);
  finishPass(times_.readBack);
  const double pixels = static_cast<double>(r.image.width) * r.image.height;
  for (const PixelRectangle& area : areas) drawnShare_ += static_cast<double>(area.width()) * area.height() / pixels;
}

void Renderer::finishPass(double& seconds) {
  if (measuring_) glFinish();
  const auto now = Clock::now();
  seconds += std::chrono::duration<double>(now - resources_->passStart).count();
  resources_->passStart = now;
}

void Renderer::drawPicture(const PixelRectangle& area) {
  const Resources& r = *resources_;
  const SeenItems& seen = r.items.inPicture();
  r.maps.bindTextures();
  r.occluders.bindTexture(kOccluderUnit);
  r.nearOccluders.bindTexture(kNearOccluderUnit);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  r.picture.begin(area);
  r.programs.sphere.use();
  r.items.drawSpheres(seen, area);
  r.programs.surface.use();
  r.items.drawMeshes(seen, area);
  r.items.drawWalls();
  // Lines thinner than a pixel take fewer of its samples: blending would ask for an order.
  glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  r.programs.cylinder.use();
  r.items.drawCylinders(seen, area);
  glEnable(GL_CULL_FACE);
  r.programs.tube.use();
  r.items.drawTubes(seen, area);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  // Late what fills the picture: hidden pixels are not computed.
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
  r.picture.end();
}

}  // namespace cradle
