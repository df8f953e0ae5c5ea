// The only unit that sees stb_image, which decodes both formats, from memory, the same on every machine. libpng and
// libjpeg-turbo were considered: they would be two, and what they are better at, to survive damaged files, is the child
// process's part.

#include "mesh/texture.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <new>

#include "core/error.h"
#include "core/read_file.h"
#include "mesh/confined_child.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_NO_THREAD_LOCALS
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace cradle {
namespace {

constexpr std::uint64_t kMaxTextureBytes = 128 << 20;  // of a file
constexpr std::uint64_t kDecodingMemory = 2ULL << 30;  // bytes: the largest picture took 1 GB with its answer
constexpr std::uint64_t kDecodingSeconds = 20;         // s, of computing
constexpr int kChannels = 3;

const stbi_uc* encoded(const std::string& bytes) {
  return reinterpret_cast<const stbi_uc*>(bytes.data());
}

/// The end of a sentence, after stb_image has failed.
std::string undecoded() {
  const std::string reason = stbi_failure_reason();
  return fmt::format("cannot be decoded ({})",
                     reason == "outofmem" ? "the memory for such a file is too little" : reason);
}

/// Throws std::runtime_error with the end of a sentence, in the process that calls.
TexturePixels pixelsOf(const std::string& bytes) {
  if (!isPng(bytes) && !isJpeg(bytes)) throw std::runtime_error("is neither a PNG nor a JPEG file");
  const int size = static_cast<int>(bytes.size());
  TexturePixels pixels;
  int channels = 0;
  if (stbi_info_from_memory(encoded(bytes), size, &pixels.width, &pixels.height, &channels) == 0)
    throw std::runtime_error(undecoded());
  if (pixels.width > kMaxTextureSide || pixels.height > kMaxTextureSide)
    throw std::runtime_error(fmt::format("is {}x{} pixels, and at most {} a side are allowed", pixels.width,
                                         pixels.height, kMaxTextureSide));
  const std::unique_ptr<stbi_uc, void (*)(void*)> rows(
      stbi_load_from_memory(encoded(bytes), size, &pixels.width, &pixels.height, &channels, kChannels),
      stbi_image_free);
  if (!rows) throw std::runtime_error(undecoded());
  const auto count =
      std::size_t{kChannels} * static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height);
  pixels.rgb.assign(rows.get(), rows.get() + count);
  return pixels;
}

ChildAnswer answerOfDecoder(const std::function<std::string()>& work) {
  return answerOfChild(work, {kDecodingMemory, kDecodingMemory, kDecodingSeconds});
}

}  // namespace

bool isPng(const std::string& bytes) {
  return bytes.starts_with("\x89PNG\r\n\x1a\n");
}

bool isJpeg(const std::string& bytes) {
  return bytes.starts_with("\xff\xd8\xff");
}

std::string textureFault(const std::string& bytes) {
  try {
    pixelsOf(bytes);
  } catch (const std::runtime_error& fault) {
    return fault.what();
  }
  return "";
}

SharedTexture readTexture(const std::string& path) {
  Texture texture{path, readFile(path, kMaxTextureBytes, ErrorKind::mesh)};
  const ChildAnswer answer = answerOfDecoder([&] { return textureFault(texture.bytes); });
  const std::string fault = answer.failure.empty() ? answer.bytes : "cannot be decoded: it " + answer.failure;
  if (!fault.empty())
    throw Error(ErrorKind::mesh, path, fmt::format("{}; save the picture again as PNG or JPEG", fault));
  return std::make_shared<const Texture>(std::move(texture));
}

TexturePixels decodeTexture(const Texture& texture) {
  const auto work = [&] {
    const TexturePixels decoded = pixelsOf(texture.bytes);
    std::string bytes(2 * sizeof(int) + decoded.rgb.size(), '\0');
    std::memcpy(bytes.data(), &decoded.width, sizeof(int));
    std::memcpy(bytes.data() + sizeof(int), &decoded.height, sizeof(int));
    std::memcpy(bytes.data() + 2 * sizeof(int), decoded.rgb.data(), decoded.rgb.size());
    return bytes;
  };
  const ChildAnswer answer = answerOfDecoder(work);
  TexturePixels pixels;
  if (answer.bytes.size() >= 2 * sizeof(int)) {
    std::memcpy(&pixels.width, answer.bytes.data(), sizeof(int));
    std::memcpy(&pixels.height, answer.bytes.data() + sizeof(int), sizeof(int));
    pixels.rgb.assign(answer.bytes.begin() + 2 * sizeof(int), answer.bytes.end());
  }
  const auto isSide = [](int side) { return side > 0 && side <= kMaxTextureSide; };
  const bool isWhole = isSide(pixels.width) && isSide(pixels.height) &&
                       pixels.rgb.size() == std::size_t{kChannels} * static_cast<std::size_t>(pixels.width) *
                                                static_cast<std::size_t>(pixels.height);
  if (!answer.failure.empty() || !isWhole)
    throw Error(
        ErrorKind::usage, texture.name,
        fmt::format("is a damaged texture of the trajectory: {}; make the trajectory again with `cradle simulate`",
                    answer.failure.empty() ? "it has too few pixels" : "it " + answer.failure));
  return pixels;
}

}  // namespace cradle
