#pragma once

#include <cstdint>
#include <memory>
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

class PngReading;

/// The rows of the picture that readPng would read, one after the other, in the memory of one row. An interlaced
/// picture, whose rows come all together, is held whole, and refused above 64 million pixels.
class PngRows {
 public:
  /// Throws as readPngSize does.
  explicit PngRows(const std::string& path);
  ~PngRows();
  PngRows(const PngRows&) = delete;
  PngRows& operator=(const PngRows&) = delete;

  PictureSize size() const { return size_; }
  /// The next row, valid until the call after: red, green, blue of each pixel. With the last one, all that comes behind
  /// it has been read too. Throws Error(usage) if the file is damaged.
  const std::uint8_t* next();

 private:
  std::unique_ptr<PngReading> reading_;
  PictureSize size_;
  std::vector<std::uint8_t> row_;
  Image interlaced_;
  int count_ = 0;  // of rows that were read
};

/// Of the picture that readPng would read; its rows are not unpacked. Throws as readPng does, but for what is wrong in
/// them.
PictureSize readPngSize(const std::string& path);

}  // namespace cradle
