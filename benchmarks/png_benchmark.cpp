// The same picture through Cradle's PNG writer and through stb_image_write as it comes, CPU time of one thread.

#include <benchmark/benchmark.h>

#include <cmath>

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

void stbPng(benchmark::State& state) {
  const cradle::Image image = makePicture(1280, 720);
  int bytes = 0;
  const auto count = [](void* context, void*, int size) { *static_cast<int*>(context) = size; };
  for (auto _ : state) stbi_write_png_to_func(count, &bytes, image.width, image.height, 3, image.pixels.data(), 0);
  state.counters["bytes"] = bytes;
}

BENCHMARK(cradlePng)->Unit(benchmark::kMillisecond);
BENCHMARK(stbPng)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
