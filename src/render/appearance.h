#pragma once

#include <optional>
#include <vector>

#include "render/framing.h"
#include "scene/scene.h"

namespace cradle {

/// How a surface reflects light.
struct Surface {
  Vec3f color = Vec3f::Constant(0.434f);  // linear, 0..1
  float metallic = 0;                     // 0..1
  float roughness = 0.5f;                 // 0..1
  Pattern pattern = Pattern::none;
  Vec3f patternColor = Vec3f::Zero();  // linear, 0..1
  float patternCell = 0;               // m, of a stripe or square
  int texture = -1;                    // index into Appearance::textures, times `color`; -1: none
  bool operator==(const Surface&) const = default;
};

/// Some triangles of a mesh with one surface, in a body's frame.
struct BodyPart {
  int mesh = 0;  // index into Appearance::meshes
  std::uint32_t firstTriangle = 0, triangleCount = 0;
  Surface surface = {};
};

/// A sphere that a body is, or that recognition found it to be.
struct BodySphere {
  Vec3 center;  // m, body's frame
  double radius;
};

/// The shape of a contact shadow, numbered as in contact_shadow.frag.
enum class ContactShadowShape { box = 0, ellipsoid = 1, cylinder = 2 };

/// What stands for a body, or a part of it, where it darkens what is near it.
struct BodySolid {
  Bounds box;  // body's frame
  ContactShadowShape kind = ContactShadowShape::ellipsoid;
  Surface surface = {};
};

struct BodyAppearance {
  std::vector<BodyPart> parts;  // none for planes, spheres and cylinders
  Bounds local;                 // body's frame; empty for planes
  std::optional<BodySphere> sphere;
  std::optional<Cylinder> cylinder;
  Surface surface = {};  // of sphere or cylinder
  std::vector<BodySolid> solids;
  bool isDrawnAsSphere =
      false;  // exactly round; else the sphere stands for a mesh in mirrors and contact shadows alone
};

/// A texture as it is drawn.
struct DrawnTexture {
  TexturePixels pixels;
  Vec3f mean;  // linear, 0..1
};

/// An endless plane, drawn as ground.
struct Ground {
  int body = 0;                 // index into Scene::bodies
  Vec3 normal = Vec3::UnitY();  // unit, world, upwards
  Vec3 point = Vec3::Zero();    // m, world
  Vec3f lightColor, darkColor;  // of the squares; linear
  Vec3f lineShade;              // share of its colour in lines each tenth of a square, each, each ten squares
  double squareSize = 1;        // m, a power of ten
};

/// What arrows of one kind are drawn with.
struct ArrowLook {
  int headMesh = 0;    // index into Appearance::meshes; makeArrowHead says how it lies
  double longest = 0;  // m: of the longest arrow, to which heads and shafts are in proportion
};

/// What bodies look like, the same in every frame.
struct Appearance {
  std::vector<DrawnMesh> meshes;
  std::vector<DrawnTexture> textures;
  std::vector<bool> meshIsClosed;  // then its inside is never seen
  std::vector<BodyAppearance> bodies;
  std::optional<Ground> ground;
  int wallMesh = 0;  // a thin plate as wide as the scene, its upper face through the origin: other planes
  ArrowLook pushArrow, motorArrow;
};

/// `pixelsPerMetre` at the distance of the scene decides how finely round things are divided.
Appearance makeAppearance(const Scene& scene, const View& view, double pixelsPerMetre);

/// Of a scene's material; where it names no colour, that of a model's file (sRGB) stands. Its texture is left out.
Surface surfaceOf(const Material& material, const std::optional<Vec3f>& fileColor);

/// The texture of a scene's material; where that names neither a colour nor a pattern, that of a model's file stands.
SharedTexture textureOf(const Material& material, const SharedTexture& ofFile);

/// The surface as it is seen in small mirrors: a pattern, or a texture, by its mean colour.
Surface inSmall(const Surface& surface, const Appearance& appearance);

/// Linear colour of an sRGB one, channels 0..1.
Vec3f linearFromSrgb(const Vec3f& color);

}  // namespace cradle
