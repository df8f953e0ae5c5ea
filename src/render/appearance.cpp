#include "render/appearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mesh/recognise_shape.h"
#include "mesh/solid.h"
#include "render/arrows.h"
#include "render/body_place.h"
#include "render/motor_arrows.h"

namespace cradle {
namespace {

constexpr double kPatternCells = 6;     // stripes, or squares, across a body
constexpr double kVisibleFacet = 0.25;  // pixels by which a chord may miss the circle before its corner shows
constexpr double kNearer = 1.2;         // things come so much nearer than the middle of the scene

// The ground when its material names no colour: light stone, or slate; squares that differ just so that a mirror shows
// them; lines that are darker than stone and lighter than slate.
const Vec3f kStone(0.350f, 0.343f, 0.329f), kSlate(0.042f, 0.046f, 0.054f);
constexpr float kLightSquare = 0.76f;  // of the colour that the scene names: a stage for what stands on it
constexpr float kDarkSquare = 0.92f;   // of the light one
const Vec3f kLinesOnStone(0.80f, 0.64f, 0.42f), kLinesOnSlate(1.25f, 1.75f, 3.0f);
constexpr double kFullBox = 0.8;         // of a bounding box: from there on, it is darkened by as a box
constexpr double kMinFull = 0.05;        // below, what is in it darkens nothing
constexpr double kWallThickness = 0.01;  // of its width
constexpr double kFewestSquares = 2.5;   // across the scene

/// Facets around a circle of `radius` pixels: a chord of angle 2 a misses it by radius a^2 / 2.
int facetsFor(double radius) {
  for (const int facets : {8, 16, 32, 64, 128})
    if (radius * std::pow(std::numbers::pi / facets, 2) / 2 < kVisibleFacet) return facets;
  return 256;
}

bool isDrawnAsMesh(const Shape& shape) {
  return std::holds_alternative<Box>(shape) || std::holds_alternative<Capsule>(shape) ||
         std::holds_alternative<ModelShape>(shape);
}

/// Share of its bounding box that a closed part of a mesh fills.
double fullness(const DrawnMesh& mesh, const BodyPart& part, const Bounds& box) {
  double volume = 0;  // signed tetrahedra from the box's centre
  const Vec3 center = box.center();
  for (std::uint32_t i = part.firstTriangle; i < part.firstTriangle + part.triangleCount; ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    volume += (mesh.vertices[a] - center).dot((mesh.vertices[b] - center).cross(mesh.vertices[c] - center)) / 6;
  }
  return std::abs(volume) / std::max(box.volume(), 1e-300);
}

BodySolid solidOf(const DrawnMesh& mesh, const BodyPart& part) {
  BodySolid solid;
  solid.surface = part.surface;
  for (std::uint32_t i = part.firstTriangle; i < part.firstTriangle + part.triangleCount; ++i)
    for (const std::uint32_t vertex : mesh.triangles[i]) solid.box.extend(mesh.vertices[vertex]);
  if (fullness(mesh, part, solid.box) > kFullBox) solid.kind = ContactShadowShape::box;
  return solid;
}

DrawnTexture drawnTexture(const Texture& texture) {
  DrawnTexture drawn{decodeTexture(texture), Vec3f::Zero()};
  std::array<float, 256> linear{};
  for (int level = 0; level < 256; ++level)
    linear[static_cast<std::size_t>(level)] = linearFromSrgb(Vec3f::Constant(static_cast<float>(level) / 255)).x();
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < drawn.pixels.rgb.size(); ++i)
    sum[static_cast<Eigen::Index>(i % 3)] += static_cast<double>(linear[drawn.pixels.rgb[i]]);
  drawn.mean = (3 * sum / static_cast<double>(drawn.pixels.rgb.size())).cast<float>();
  return drawn;
}

/// Fills the catalogue of meshes, one entry for all bodies that share a shape.
class Catalogue {
 public:
  Catalogue(const Scene& scene, double pixelsPerMetre) : scene_(scene), pixelsPerMetre_(pixelsPerMetre) {}

  std::vector<BodyPart> partsOf(const Body& body) {
    const Material& material = scene_.materials.at(static_cast<std::size_t>(body.material));
    if (!isDrawnAsMesh(body.shape)) return {};
    if (const auto* model = std::get_if<ModelShape>(&body.shape)) return partsOfModel(*model, material);
    const int mesh = meshOf(body.shape);
    return {{mesh, 0, triangleCount(mesh), surfaceOf(material, {})}};
  }

  int meshOf(const Shape& shape);
  std::vector<BodySolid> solidsOf(const Body& body, const BodySolid& whole, const std::vector<BodyPart>& parts) const;
  void moveTo(Appearance& appearance);

 private:
  struct Key {
    std::size_t kind;  // index into Shape
    Vec3 numbers;      // what tells shapes of a kind apart
    bool operator==(const Key& other) const { return kind == other.kind && numbers == other.numbers; }
  };

  std::uint32_t triangleCount(int mesh) const {
    return static_cast<std::uint32_t>(meshes_.at(static_cast<std::size_t>(mesh)).triangles.size());
  }
  int facets(double radius) const { return facetsFor(radius * pixelsPerMetre_ * kNearer); }
  Key keyOf(const Shape& shape) const;
  DrawnMesh tessellateShape(const Shape& shape) const;
  std::vector<BodyPart> partsOfModel(const ModelShape& shape, const Material& material);
  int indexOf(const SharedTexture& texture);  // into Appearance::textures; -1 of none

  const Scene& scene_;
  double pixelsPerMetre_;
  std::vector<Key> keys_;
  std::vector<DrawnMesh> meshes_;
  std::vector<SharedTexture> textures_;
};

Catalogue::Key Catalogue::keyOf(const Shape& shape) const {
  Key key{shape.index(), Vec3::Zero()};
  if (const auto* box = std::get_if<Box>(&shape)) key.numbers = box->size;
  if (const auto* capsule = std::get_if<Capsule>(&shape)) key.numbers = {capsule->radius, capsule->length, 0};
  if (const auto* model = std::get_if<ModelShape>(&shape)) key.numbers.x() = model->model;
  return key;
}

DrawnMesh Catalogue::tessellateShape(const Shape& shape) const {
  if (const auto* box = std::get_if<Box>(&shape)) return tessellate(*box);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return tessellate(*capsule, facets(capsule->radius));
  return scene_.models.at(static_cast<std::size_t>(std::get<ModelShape>(shape).model)).drawn;
}

int Catalogue::meshOf(const Shape& shape) {
  const Key key = keyOf(shape);
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  if (found != keys_.end()) return static_cast<int>(found - keys_.begin());
  keys_.push_back(key);
  meshes_.push_back(tessellateShape(shape));
  return static_cast<int>(keys_.size()) - 1;
}

/// Of a model, its parts but those that are mostly air, like rails around a room; else the whole.
std::vector<BodySolid> Catalogue::solidsOf(const Body& body, const BodySolid& whole,
                                           const std::vector<BodyPart>& parts) const {
  if (!std::holds_alternative<ModelShape>(body.shape)) return {whole};
  std::vector<BodySolid> solids;
  for (const BodyPart& part : parts) {
    const DrawnMesh& mesh = meshes_[static_cast<std::size_t>(part.mesh)];
    const BodySolid solid = solidOf(mesh, part);
    if (fullness(mesh, part, solid.box) > kMinFull) solids.push_back(solid);
  }
  return solids;
}

void Catalogue::moveTo(Appearance& appearance) {
  for (const Key& key : keys_) {
    const bool isModel = key.kind == Shape(ModelShape{}).index();
    const auto model = static_cast<std::size_t>(isModel ? key.numbers.x() : 0);
    appearance.meshIsClosed.push_back(!isModel || checkSolid(scene_.models[model].solid).isClosed);
  }
  appearance.meshes = std::move(meshes_);
  for (const SharedTexture& texture : textures_) appearance.textures.push_back(drawnTexture(*texture));
}

std::vector<BodyPart> Catalogue::partsOfModel(const ModelShape& shape, const Material& material) {
  const int mesh = meshOf(shape);
  const auto& ranges = meshes_[static_cast<std::size_t>(mesh)].materials;
  std::vector<BodyPart> parts;
  for (const ModelMaterial& range : ranges) {
    parts.push_back({mesh, range.firstTriangle, range.triangleCount, surfaceOf(material, range.baseColor)});
    parts.back().surface.texture = indexOf(textureOf(material, range.texture));
  }
  if (ranges.empty() || material.baseColor || material.texture) {
    parts = {{mesh, 0, triangleCount(mesh), surfaceOf(material, {})}};
    parts.back().surface.texture = indexOf(material.texture);
  }
  return parts;
}

int Catalogue::indexOf(const SharedTexture& texture) {
  if (!texture) return -1;
  const auto index = std::find(textures_.begin(), textures_.end(), texture) - textures_.begin();
  if (index == std::ssize(textures_)) textures_.push_back(texture);
  return static_cast<int>(index);
}

/// The sphere that each model is, if it is one.
std::vector<std::optional<BodySphere>> findSpheres(const std::vector<Model>& models) {
  std::vector<std::optional<BodySphere>> spheres;
  for (const Model& model : models) {
    spheres.emplace_back();
    if (!checkSolid(model.solid).isClosed) continue;
    const auto primitive = recogniseShape(model.solid).primitive;
    const Sphere* sphere = primitive ? std::get_if<Sphere>(&primitive->shape) : nullptr;
    if (sphere != nullptr) spheres.back() = BodySphere{primitive->bodyFromShape.translation, sphere->radius};
  }
  return spheres;
}

BodyAppearance lookOf(const Scene& scene, const Body& body, const std::vector<std::optional<BodySphere>>& sphereOfModel,
                      Catalogue& catalogue) {
  BodyAppearance look;
  look.local = localBounds(scene, body);
  look.parts = catalogue.partsOf(body);
  look.surface = surfaceOf(scene.materials.at(static_cast<std::size_t>(body.material)), {});
  if (const auto* sphere = std::get_if<Sphere>(&body.shape)) {
    look.sphere = BodySphere{Vec3::Zero(), sphere->radius};
    look.isDrawnAsSphere = true;
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&body.shape)) look.cylinder = *cylinder;
  if (const auto* model = std::get_if<ModelShape>(&body.shape)) {
    look.sphere = sphereOfModel.at(static_cast<std::size_t>(model->model));
    look.surface = look.parts.at(0).surface;
  }
  const float cell = look.local.isEmpty() ? 0 : static_cast<float>(look.local.sizes().maxCoeff() / kPatternCells);
  look.surface.patternCell = cell;
  for (BodyPart& part : look.parts) part.surface.patternCell = cell;
  const ContactShadowShape kind = look.cylinder                             ? ContactShadowShape::cylinder
                                  : std::holds_alternative<Box>(body.shape) ? ContactShadowShape::box
                                                                            : ContactShadowShape::ellipsoid;
  if (!look.local.isEmpty()) look.solids = catalogue.solidsOf(body, {look.local, kind, look.surface}, look.parts);
  return look;
}

Ground makeGround(const Scene& scene, int body, double size) {
  const Body& plane = scene.bodies[static_cast<std::size_t>(body)];
  const auto& color = scene.materials.at(static_cast<std::size_t>(plane.material)).baseColor;
  Ground ground;
  ground.body = body;
  ground.normal = plane.worldFromBody.rotation * std::get<Plane>(plane.shape).normal;
  ground.point = plane.worldFromBody.translation;
  const bool isDark = scene.look == Look::dark;
  ground.lightColor = color ? Vec3f(kLightSquare * linearFromSrgb(*color)) : isDark ? kSlate : kStone;
  ground.lineShade = isDark ? kLinesOnSlate : kLinesOnStone;
  ground.darkColor = kDarkSquare * ground.lightColor;
  ground.squareSize = std::pow(10.0, std::floor(std::log10(size / kFewestSquares)));
  return ground;
}

/// The plane that is nearest to level, if one is a floor rather than a wall.
std::optional<Ground> findGround(const Scene& scene, double size) {
  std::optional<Ground> ground;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Plane* plane = std::get_if<Plane>(&scene.bodies[i].shape);
    if (plane == nullptr) continue;
    const Vec3 normal = scene.bodies[i].worldFromBody.rotation * plane->normal;
    if (isFloor(normal) && (!ground || normal.y() > ground->normal.y()))
      ground = makeGround(scene, static_cast<int>(i), size);
  }
  return ground;
}

DrawnMesh makeWall(double size) {
  const double thickness = kWallThickness * size;
  DrawnMesh wall = tessellate(Box{{size, thickness, size}});
  for (Vec3& vertex : wall.vertices) vertex.y() -= thickness / 2;
  return wall;
}

ArrowLook addArrow(double longest, Appearance& appearance) {
  appearance.meshes.push_back(makeArrowHead(longest));
  appearance.meshIsClosed.push_back(true);
  return {static_cast<int>(appearance.meshes.size()) - 1, longest};
}

}  // namespace

Surface surfaceOf(const Material& material, const std::optional<Vec3f>& fileColor) {
  const Vec3f usual = material.texture ? Vec3f(Vec3f::Ones()) : fileColor.value_or(Vec3f::Constant(0.69f));
  const Vec3f color = material.baseColor.value_or(usual);
  return {linearFromSrgb(color), static_cast<float>(material.metallic), static_cast<float>(material.roughness),
          material.pattern,      linearFromSrgb(material.patternColor), 0};
}

SharedTexture textureOf(const Material& material, const SharedTexture& ofFile) {
  if (material.texture) return material.texture;
  return material.baseColor || material.pattern != Pattern::none ? nullptr : ofFile;
}

Surface inSmall(const Surface& surface, const Appearance& appearance) {
  Vec3f mean = surface.color;
  if (surface.pattern != Pattern::none) mean = (surface.color + surface.patternColor) / 2;
  if (surface.texture >= 0)
    mean = mean.cwiseProduct(appearance.textures[static_cast<std::size_t>(surface.texture)].mean);
  return {mean, surface.metallic, surface.roughness};
}

Vec3f linearFromSrgb(const Vec3f& color) {
  return color.unaryExpr([](float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); });
}

Appearance makeAppearance(const Scene& scene, const View& view, double pixelsPerMetre) {
  Appearance appearance;
  Catalogue catalogue(scene, pixelsPerMetre);
  const auto sphereOfModel = findSpheres(scene.models);
  for (const Body& body : scene.bodies) appearance.bodies.push_back(lookOf(scene, body, sphereOfModel, catalogue));
  const double size = view.size();
  appearance.ground = findGround(scene, size);
  catalogue.moveTo(appearance);
  appearance.wallMesh = static_cast<int>(appearance.meshes.size());
  appearance.meshes.push_back(makeWall(size));
  appearance.meshIsClosed.push_back(true);
  appearance.pushArrow = addArrow(view.longestArrow, appearance);
  std::vector<Bounds> localBounds;
  for (const BodyAppearance& body : appearance.bodies) localBounds.push_back(body.local);
  if (const double longest = longestMotorArrow(scene, localBounds); longest > 0)
    appearance.motorArrow = addArrow(longest, appearance);
  return appearance;
}

}  // namespace cradle
