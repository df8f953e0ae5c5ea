#include "player/packed_numbers.h"

#include <libdeflate.h>

#include <memory>
#include <new>

#include "core/error.h"
#include "core/markup.h"

namespace cradle {

std::string packed(std::span<const std::uint8_t> bytes) {
  constexpr int kLevel = 6;  // libdeflate's own choice between time and size
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(kLevel), libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::vector<std::uint8_t> zipped(libdeflate_gzip_compress_bound(compressor.get(), bytes.size()));
  zipped.resize(libdeflate_gzip_compress(compressor.get(), bytes.data(), bytes.size(), zipped.data(), zipped.size()));
  CRADLE_CHECK(!zipped.empty());
  return base64(zipped);
}

}  // namespace cradle
