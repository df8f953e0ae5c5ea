#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace cradle {

/// A picture that lies on a surface, as the bytes of its PNG or JPEG file.
struct Texture {
  std::string name;   // of its file
  std::string bytes;  // damaged, perhaps, if they come from a trajectory
};

/// Those who draw it share it.
using SharedTexture = std::shared_ptr<const Texture>;

constexpr int kMaxTextureSide = 8192;  // pixels

/// sRGB, 8 bits a channel, rows from the top, no padding.
struct TexturePixels {
  int width = 0, height = 0;      // pixels
  std::vector<std::uint8_t> rgb;  // width * height * 3
};

/// Whether bytes begin as those of a PNG file do, or of a JPEG file.
bool isPng(const std::string& bytes);
bool isJpeg(const std::string& bytes);

/// Why bytes are no PNG or JPEG file of at most kMaxTextureSide pixels a side, as the end of a sentence; empty if they
/// are one. Decodes them in the process that calls: damaged ones may crash it, or fill its memory.
std::string textureFault(const std::string& bytes);

/// A scene's file, decoded once as a trial. Throws Error(mesh) if it is missing or no such picture.
SharedTexture readTexture(const std::string& path);

/// Transparency is left out. A child process decodes, with limits of memory and time. Throws Error(usage): what came
/// from a file has been decoded before, so that the trajectory is damaged.
TexturePixels decodeTexture(const Texture& texture);

}  // namespace cradle
