#include "die.h"

#include <cmath>

namespace cradle::assets {
namespace {

constexpr double kEdge = 0.02;  // m
constexpr int kColumns = 3, kRows = 2;
constexpr int kFacePixels = 128;                      // a side
constexpr double kPipRadius = 0.1, kPipPlace = 0.26;  // of a face's side; how far from its middle
constexpr double kBorder = 0.02;                      // of a face's side
constexpr int kSamples = 4;                           // of a pixel, a side
const Vec3 kIvory(238, 231, 214), kEdgeShade(206, 196, 174), kInk(38, 36, 44);  // sRGB

/// Whether the face of that value has a pip in a column and row, each -1, 0 or 1.
bool hasPip(int value, int column, int row) {
  if (column == 0 && row == 0) return value % 2 == 1;
  if (column == row) return value > 1;
  if (column == -row) return value > 3;
  return row == 0 && value == 6;
}

/// The colour at a place of a face, 0..1 each way.
const Vec3& colorAt(int value, double x, double y) {
  for (int column = -1; column <= 1; ++column)
    for (int row = -1; row <= 1; ++row)
      if (hasPip(value, column, row) &&
          std::hypot(x - 0.5 - kPipPlace * column, y - 0.5 - kPipPlace * row) < kPipRadius)
        return kInk;
  return std::min(std::min(x, y), 1 - std::max(x, y)) < kBorder ? kEdgeShade : kIvory;
}

}  // namespace

Surface die() {
  Surface surface{"Die", 0, {}, {}};
  const std::array<Vec3, 6> normals = {Vec3::UnitX(),  Vec3::UnitY(),  Vec3::UnitZ(),
                                       -Vec3::UnitZ(), -Vec3::UnitY(), -Vec3::UnitX()};
  for (int face = 0; face < 6; ++face) {
    const Vec3& normal = normals[static_cast<std::size_t>(face)];
    const Vec3 right(normal.z(), normal.x(), normal.y()), up = normal.cross(right);
    const Vec2f lowerLeft(static_cast<float>(face % kColumns) / kColumns,
                          static_cast<float>(kRows - 1 - face / kColumns) / kRows);
    std::array<std::size_t, 4> corners{};
    for (std::size_t i = 0; i < 4; ++i) {
      const bool isRight = i == 1 || i == 2, isUp = i > 1;
      corners[i] = surface.add(kEdge / 2 * (normal + (isRight ? right : -right) + (isUp ? up : -up)));
      surface.coordinates.push_back(lowerLeft + Vec2f(isRight ? 1.0f / kColumns : 0, isUp ? 1.0f / kRows : 0));
    }
    surface.addQuad(corners[0], corners[1], corners[2], corners[3], kSharp);
  }
  return surface;
}

Image diePicture() {
  Image image(kColumns * kFacePixels, kRows * kFacePixels);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const int value = 1 + x / kFacePixels + kColumns * (y / kFacePixels);
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < kSamples * kSamples; ++i)
        sum += colorAt(value, (x % kFacePixels + (i % kSamples + 0.5) / kSamples) / kFacePixels,
                       (y % kFacePixels + (0.5 + i / kSamples) / kSamples) / kFacePixels);
      for (int channel = 0; channel < 3; ++channel)
        image.at(x, y)[channel] = static_cast<std::uint8_t>(std::lround(sum[channel] / (kSamples * kSamples)));
    }
  return image;
}

}  // namespace cradle::assets
