#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "image/image.h"

namespace cradle {

/// `image` as the bytes of a PNG file; same image, same bytes. Throws Error(limit) if memory runs out.
std::vector<std::uint8_t> encodePng(const Image& image);

/// Writes `image` to `path` by way of `path`.part, so that a file of that name is always whole. Throws Error(output) if
/// anything but a regular file is there, or the disk is full; then nothing is left behind.
void writePng(const Image& image, const std::string& path);

/// Reads any PNG; 16 bits, grey and palettes become 8-bit RGB, transparency is dropped. Throws Error(usage) if the file
/// is missing, no PNG, damaged (all checksums are held against it), or larger than 16384 pixels a side.
Image readPng(const std::string& path);

/// Of the picture that readPng would read; its rows are not unpacked. Throws as readPng does, but for what is wrong in
/// them.
PictureSize readPngSize(const std::string& path);

}  // namespace cradle
