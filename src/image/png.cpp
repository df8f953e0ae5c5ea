// The only unit that sees stb. stb's own deflate is slow and weak; libdeflate at level 1 with one fixed filter (1, the
// difference to the left) takes a seventh of the time and leaves smaller files. stb's functions that write files do not
// check what the system answers, so it writes to memory here.

#include "image/png.h"

#include <libdeflate.h>

#include <array>
#include <cstring>
#include <memory>
#include <new>

#include "core/error.h"
#include "core/part_file.h"

namespace {

constexpr int kCompressionLevel = 1;  // higher levels cost more time than rendering and save few bytes
constexpr int kFilterSub = 1;         // PNG's filter type 1: difference to the pixel on the left

/// stb's large buffers, kept by each thread from picture to picture: fresh memory costs a page fault every 4 KiB, a
/// quarter of the time. Four are in use at once at the most: rows, a line, compressed rows and the file.
class KeptBuffers {
 public:
  unsigned char* take(std::size_t size) {
    Buffer* best = nullptr;
    for (Buffer& buffer : buffers_)
      if (!buffer.isTaken && (best == nullptr || isBetter(buffer, *best, size))) best = &buffer;
    if (best == nullptr) return nullptr;
    if (best->size < size) {
      best->bytes.reset(new (std::nothrow) unsigned char[size]);
      best->size = best->bytes ? size : 0;
    }
    if (!best->bytes) return nullptr;
    best->isTaken = true;
    return best->bytes.get();
  }
  void giveBack(const void* bytes) {
    for (Buffer& buffer : buffers_)
      if (buffer.bytes.get() == bytes) buffer.isTaken = false;
  }

 private:
  struct Buffer {
    std::unique_ptr<unsigned char[]> bytes;
    std::size_t size = 0;
    bool isTaken = false;
  };
  /// The smallest that is large enough, or else the largest.
  static bool isBetter(const Buffer& buffer, const Buffer& best, std::size_t size) {
    return best.size < size ? buffer.size > best.size : buffer.size >= size && buffer.size < best.size;
  }
  std::array<Buffer, 4> buffers_;
};

KeptBuffers& keptBuffers() {
  static thread_local KeptBuffers buffers;
  return buffers;
}

unsigned char* compressZlib(unsigned char* data, int size, int* compressedSize, int /*quality*/) {
  *compressedSize = 0;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(kCompressionLevel), libdeflate_free_compressor);
  if (!compressor) return nullptr;
  const std::size_t count = static_cast<std::size_t>(size);
  const std::size_t bound = libdeflate_zlib_compress_bound(compressor.get(), count);
  unsigned char* compressed = keptBuffers().take(bound);  // stb gives it back
  if (compressed == nullptr) return nullptr;
  *compressedSize = static_cast<int>(libdeflate_zlib_compress(compressor.get(), data, count, compressed, bound));
  return compressed;
}

unsigned int crc32(unsigned char* data, int size) {
  return libdeflate_crc32(0, data, static_cast<std::size_t>(size));
}

}  // namespace

#define STBIW_ZLIB_COMPRESS compressZlib
#define STBIW_CRC32 crc32
#define STBIW_MALLOC(size) keptBuffers().take(size)
#define STBIW_REALLOC(bytes, size) nullptr  // only stb's own deflate would
#define STBIW_FREE(bytes) keptBuffers().giveBack(bytes)
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace cradle {
namespace {

// stb keeps its filter in a variable; set once before main, so that threads may encode at the same time.
[[maybe_unused]] const int chosenFilter = stbi_write_force_png_filter = kFilterSub;

void takeBytes(void* context, void* data, int size) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  auto& target = *static_cast<std::vector<std::uint8_t>*>(context);
  target.assign(bytes, bytes + size);
}

}  // namespace

std::vector<std::uint8_t> encodePng(const Image& image) {
  CRADLE_CHECK(image.width > 0 && image.height > 0);
  std::vector<std::uint8_t> bytes;
  if (stbi_write_png_to_func(takeBytes, &bytes, image.width, image.height, 3, image.pixels.data(), 0) == 0)
    throw Error(ErrorKind::limit, "", "not enough memory to compress a picture");
  return bytes;
}

void writePng(const Image& image, const std::string& path) {
  PartFile file(path);
  const std::vector<std::uint8_t> bytes = encodePng(image);
  file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  file.complete();
}

}  // namespace cradle
