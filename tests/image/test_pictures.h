#pragma once

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "image/image.h"

namespace cradle {

/// A picture in which no two neighbouring bytes and no two rows are alike; `seed` tells pictures apart.
inline Image makeTestPicture(int width, int height, unsigned seed) {
  Image image(width, height);
  unsigned state = seed + 1;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    state = state * 1664525u + 1013904223u;
    image.pixels[i] = static_cast<std::uint8_t>((i / 7) + (state >> 28));
  }
  return image;
}

inline std::vector<std::uint8_t> readBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace cradle
