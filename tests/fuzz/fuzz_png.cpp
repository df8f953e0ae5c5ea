// Bytes as a PNG file, as they are and with their checksums put right: without that, hardly any gets past those.

#include <zlib.h>

#include "fuzz_target.h"
#include "image/png.h"

namespace cradle {
namespace {

constexpr std::size_t kSignature = 8, kAround = 12;  // bytes: before the chunks; of a chunk around its data

std::uint32_t numberAt(const std::string& bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return number;
}

std::string withChecksums(std::string bytes) {
  for (std::size_t at = kSignature; at + kAround <= bytes.size();) {
    const std::size_t length = numberAt(bytes, at);
    if (length > bytes.size() - at - kAround) break;
    const auto* begin = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    const auto checksum = static_cast<std::uint32_t>(crc32(0, begin, static_cast<uInt>(length + 4)));
    at += length + kAround;
    for (std::size_t i = 0; i < 4; ++i) bytes[at - 1 - i] = static_cast<char>(checksum >> 8 * i);
  }
  return bytes;
}

void read(const ScratchFile& file, const std::string& bytes) {
  file.write(bytes);
  acceptOrRefuse([&] {
    const PictureSize size = readPngSize(file.path());
    HOLDS(size.width >= 1 && size.width <= 16384 && size.height >= 1 && size.height <= 16384);
    constexpr int kMaxPixels = 1 << 16;  // larger ones take the time of many
    if (size.width > kMaxPixels / size.height) return;
    const Image image = readPng(file.path());
    HOLDS(image.width == size.width && image.height == size.height);
    HOLDS(image.pixels.size() == std::size_t{3} * static_cast<std::size_t>(image.width * image.height));
  });
}

}  // namespace
}  // namespace cradle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  static const ScratchFile file("picture.png");
  const std::string bytes = textOf(data, size), mended = withChecksums(bytes);
  read(file, bytes);
  if (mended != bytes) read(file, mended);
  return 0;
}
