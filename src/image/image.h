#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cradle {

struct PictureSize {
  int width = 0, height = 0;  // pixels
  bool operator==(const PictureSize&) const = default;
};

/// A picture: sRGB, 8 bits a channel, rows from the top, no padding.
struct Image {
  int width = 0, height = 0;         // pixels
  std::vector<std::uint8_t> pixels;  // width * height * 3: red, green, blue

  Image() = default;
  Image(int imageWidth, int imageHeight);  // black; sizes >= 0

  /// First channel of the pixel in column `x`, row `y`, counted from the top left.
  const std::uint8_t* at(int x, int y) const { return pixels.data() + offset(x, y); }
  std::uint8_t* at(int x, int y) { return pixels.data() + offset(x, y); }
  bool operator==(const Image&) const = default;

 private:
  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

}  // namespace cradle
