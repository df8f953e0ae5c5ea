#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace cradle {

/// The numbers of a pass, or of what goes with one: so many a pixel, row by row from above.
struct PassArray {
  std::string name;
  int channels = 1;
  std::variant<std::vector<float>, std::vector<std::uint16_t>, std::vector<std::uint8_t>> numbers;
};

/// The bytes of a NumPy file of format version 1.0 (numpy.lib.format): shape (height, width), or (height, width,
/// channels), in C order; float32, uint16 or uint8, little-endian.
std::string npyBytes(const PassArray& pass, int width, int height);

/// The bytes of an OpenEXR file with a layer for each pass: channels NAME.V of one, else NAME.X, NAME.Y, NAME.Z; 32-bit
/// floats, and whole numbers as 32-bit unsigned ones. Compressed without loss.
std::string exrBytes(const std::vector<PassArray>& passes, int width, int height);

}  // namespace cradle
