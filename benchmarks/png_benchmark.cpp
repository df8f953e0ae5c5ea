// The same picture through Cradle's PNG writer, through libdeflate alone (level 1, on rows that are filtered already),
// and through stb_image_write as it comes, CPU time of one thread. Repeated in turns:
//     benchmark_png --benchmark_repetitions=20 --benchmark_enable_random_interleaving=true

#include <benchmark/benchmark.h>
#include <libdeflate.h>

#include <cmath>
#include <memory>
#include <vector>

#include "image/png.h"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace {

/// Like a rendered picture: a sky, a ground of squares, a shaded ball with some noise.
cradle::Image makePicture(int width, int height) {
  cradle::Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double depth = std::max(2.0 * y / height - 0.6, 0.02);
      const bool isLight =
          static_cast<int>(std::floor((x - width / 2) / (60 * depth)) + std::floor(8 / depth)) % 2 == 0;
      double grey = y < height * 0.3 ? 150 + 60.0 * y / height : isLight ? 205 : 140;
      const double dx = (x - width / 2) / (0.2 * height), dy = (y - height / 2) / (0.2 * height);
      if (dx * dx + dy * dy < 1) grey = 120 + 100 * std::sqrt(1 - dx * dx - dy * dy);
      const int noise = (x * 7 + y * 13) % 2;
      for (int channel = 0; channel < 3; ++channel)
        image.at(x, y)[channel] = static_cast<std::uint8_t>(grey + noise + 8 * channel);
    }
  }
  return image;
}

void cradlePng(benchmark::State& state) {
  const cradle::Image image = makePicture(1280, 720);
  std::size_t bytes = 0;
  for (auto _ : state) bytes = cradle::encodePng(image).size();
  state.counters["bytes"] = static_cast<double>(bytes);
}

/// Rows as a PNG file holds them: filter type 1, then the differences to the pixel on the left.
std::vector<std::uint8_t> filteredRows(const cradle::Image& image) {
  std::vector<std::uint8_t> rows;
  for (int y = 0; y < image.height; ++y) {
    rows.push_back(1);
    for (int x = 0; x < image.width; ++x)
      for (int channel = 0; channel < 3; ++channel) {
        const int left = x > 0 ? image.at(x - 1, y)[channel] : 0;
        rows.push_back(static_cast<std::uint8_t>(image.at(x, y)[channel] - left));
      }
  }
  return rows;
}

void libdeflateAlone(benchmark::State& state) {
  const std::vector<std::uint8_t> rows = filteredRows(makePicture(1280, 720));
  std::size_t bytes = 0;
  for (auto _ : state) {
    const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
        libdeflate_alloc_compressor(1), libdeflate_free_compressor);
    std::vector<std::uint8_t> compressed(libdeflate_zlib_compress_bound(compressor.get(), rows.size()));
    bytes = libdeflate_zlib_compress(compressor.get(), rows.data(), rows.size(), compressed.data(), compressed.size());
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}

void stbPng(benchmark::State& state) {
  const cradle::Image image = makePicture(1280, 720);
  int bytes = 0;
  const auto count = [](void* context, void*, int size) { *static_cast<int*>(context) = size; };
  for (auto _ : state) stbi_write_png_to_func(count, &bytes, image.width, image.height, 3, image.pixels.data(), 0);
  state.counters["bytes"] = bytes;
}

BENCHMARK(cradlePng)->Unit(benchmark::kMillisecond);
BENCHMARK(libdeflateAlone)->Unit(benchmark::kMillisecond);
BENCHMARK(stbPng)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
