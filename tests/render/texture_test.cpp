// Textures lie where the coordinates of a mesh say.

#include <gtest/gtest.h>

#include <cmath>

#include "image/png.h"
#include "math/rotation.h"
#include "mesh/load_mesh.h"
#include "render/appearance.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kSide = 240;  // pixels, of pictures

/// Quarters: red, green above blue, yellow.
SharedTexture quarters() {
  Image image(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const bool isRight = x >= 32, isLow = y >= 32;
      image.at(x, y)[0] = isRight == isLow ? 255 : 0;
      image.at(x, y)[1] = isRight ? 255 : 0;
      image.at(x, y)[2] = !isRight && isLow ? 255 : 0;
    }
  const std::vector<std::uint8_t> bytes = encodePng(image);
  return std::make_shared<const Texture>(Texture{"quarters.png", {bytes.begin(), bytes.end()}});
}

/// A square of 1 m that faces +z, with the texture once across its left half, and again across its right one.
Scene squareScene(const SharedTexture& ofFile) {
  Model square;
  square.name = "square";
  square.drawn.vertices = {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}};
  square.drawn.normals.assign(4, Vec3f::UnitZ());
  square.drawn.textureCoordinates = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
  square.drawn.triangles = {{0, 1, 2}, {0, 2, 3}};
  square.drawn.materials = {{"paper", Vec3f::Ones(), 0, 2, ofFile}};
  square.solid = weld(square.drawn.vertices, square.drawn.triangles);
  Scene scene = emptyScene();
  scene.models = {square};
  addBody(scene, ModelShape{0}, {Quat::Identity(), Vec3::Zero()}, Motion::fixed);
  scene.camera = cameraAt({0, 0, 3}, Vec3::Zero(), 2 * std::atan(0.5 / 3));  // the square fills the picture
  return scene;
}

/// "red", "green", "blue", "yellow" or "other": which channels are bright beside the others.
std::string colorAt(const Image& image, double u, double v) {
  const auto* color = image.at(static_cast<int>(u * kSide), static_cast<int>((1 - v) * kSide));
  const int most = std::max({color[0], color[1], color[2]});
  const auto isBright = [&](int channel) { return 2 * color[channel] > most; };
  if (isBright(0) && isBright(1) && !isBright(2)) return "yellow";
  if (isBright(0) + isBright(1) + isBright(2) != 1) return "other";
  return isBright(0) ? "red" : isBright(1) ? "green" : "blue";
}

void expectQuarters(const Scene& scene) {
  const Image image = drawStart(scene, kSide, kSide);
  for (const double left : {0.0, 0.5}) {
    EXPECT_EQ(colorAt(image, left + 0.125, 0.75), "red");
    EXPECT_EQ(colorAt(image, left + 0.375, 0.75), "green");
    EXPECT_EQ(colorAt(image, left + 0.125, 0.25), "blue");
    EXPECT_EQ(colorAt(image, left + 0.375, 0.25), "yellow");
  }
}

TEST(DrawnTexture, LiesWhereTheCoordinatesSayAndRepeats) {
  expectQuarters(squareScene(quarters()));
}

TEST(DrawnTexture, OfAMaterialOfTheSceneComesFirst) {
  Scene scene = squareScene(nullptr);
  scene.materials[0].texture = quarters();
  expectQuarters(scene);
}

TEST(DrawnTexture, OfTheFileGivesWayToAColourOrAPattern) {
  Scene scene = squareScene(quarters());
  scene.materials[0].baseColor = Vec3f(0, 1, 0);
  const Image image = drawStart(scene, kSide, kSide);
  for (const double u : {0.125, 0.375}) EXPECT_EQ(colorAt(image, u, 0.25), "green");
  Material striped;
  striped.pattern = Pattern::stripes;
  EXPECT_EQ(textureOf(striped, quarters()), nullptr);
}

// The colour that a material names is a factor: of red, green, blue and yellow it leaves what has red.
TEST(DrawnTexture, IsMultipliedWithTheColourOfItsMaterial) {
  Scene scene = squareScene(nullptr);
  scene.materials[0].texture = quarters();
  scene.materials[0].baseColor = Vec3f(1, 0, 0);
  const Image image = drawStart(scene, kSide, kSide);
  const auto redOf = [&](double u, double v) {
    return int{image.at(static_cast<int>(u * kSide), static_cast<int>((1 - v) * kSide))[0]};
  };
  EXPECT_GT(redOf(0.125, 0.75), 3 * redOf(0.375, 0.75));  // red, green
  EXPECT_GT(redOf(0.375, 0.25), 3 * redOf(0.125, 0.25));  // yellow, blue
}

// Two bodies of one mesh with two textures are two calls of drawing.
TEST(DrawnTexture, IsThatOfEachBody) {
  Scene scene = squareScene(nullptr);
  scene.materials[0].texture = quarters();
  Material plain = scene.materials[0];
  plain.texture = nullptr;
  plain.baseColor = Vec3f(0, 0, 1);
  scene.materials.push_back(plain);
  scene.bodies[0].worldFromBody.translation = Vec3(-0.5, 0, 0);
  addBody(scene, ModelShape{0}, {Quat::Identity(), Vec3(0.5, 0, 0)}, Motion::fixed).material = 1;
  const Image image = drawStart(scene, kSide, kSide);  // of each square the half beside the middle
  EXPECT_EQ(colorAt(image, 0.125, 0.75), "red");
  EXPECT_EQ(colorAt(image, 0.375, 0.25), "yellow");
  EXPECT_EQ(colorAt(image, 0.625, 0.75), "blue");
  EXPECT_EQ(colorAt(image, 0.875, 0.25), "blue");
}

// Mirrors show the mean of light: of four quarters with red, green, blue, and red with green.
TEST(DrawnTexture, IsItsMeanColourInSmall) {
  const Scene scene = squareScene(quarters());
  const Appearance appearance = makeAppearance(scene, viewOfStart(scene, kSide, kSide), 1);
  const Surface small = inSmall(appearance.bodies.at(0).parts.at(0).surface, appearance);
  EXPECT_LT((small.color - Vec3f(0.5f, 0.5f, 0.25f)).norm(), 1e-6f);
  EXPECT_EQ(small.texture, -1);
}

/// How many areas that hang together are less than half as bright as the edge of the picture.
int countDarkAreas(const Image& image) {
  const int limit = image.at(kSide / 8, kSide / 2)[1] / 2;
  std::vector<bool> isDark(kSide * kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) isDark[static_cast<std::size_t>(kSide * y + x)] = image.at(x, y)[1] < limit;
  int count = 0;
  std::vector<int> left;
  for (int first = 0; first < kSide * kSide; ++first) {
    if (isDark[static_cast<std::size_t>(first)]) ++count, left.push_back(first);
    while (!left.empty()) {
      const int pixel = left.back(), x = pixel % kSide;
      left.pop_back();
      if (!isDark[static_cast<std::size_t>(pixel)]) continue;
      isDark[static_cast<std::size_t>(pixel)] = false;
      if (x > 0) left.push_back(pixel - 1);
      if (x + 1 < kSide) left.push_back(pixel + 1);
      if (pixel >= kSide) left.push_back(pixel - kSide);
      if (pixel + kSide < kSide * kSide) left.push_back(pixel + kSide);
    }
  }
  return count;
}

TEST(DrawnTexture, ShowsThePipsOfEachFaceOfTheDie) {
  Scene scene = emptyScene();
  scene.models = {loadModel({CRADLE_SOURCE_DIR "/assets/die.3ds", "", 50}).model};  // 1 m
  Body& die = addBody(scene, ModelShape{0}, {Quat::Identity(), Vec3::Zero()}, Motion::fixed);
  scene.lights[0].direction = Vec3(0, 0, -1);
  scene.camera = cameraAt({0, 0, 4.5}, Vec3::Zero(), 2 * std::atan(0.5 / 4));  // the face at 4 m fills the picture
  const std::vector<Vec3> faces = {Vec3::UnitX(),  Vec3::UnitY(),  Vec3::UnitZ(),
                                   -Vec3::UnitZ(), -Vec3::UnitY(), -Vec3::UnitX()};
  for (int value = 1; value <= 6; ++value) {
    die.worldFromBody.rotation = rotationBetween(faces[static_cast<std::size_t>(value - 1)], Vec3::UnitZ());
    EXPECT_EQ(countDarkAreas(drawStart(scene, kSide, kSide)), value);
  }
}

}  // namespace
}  // namespace cradle
