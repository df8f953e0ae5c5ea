// Milliseconds a picture takes, by pass: the median of several, of a swinging cradle at 1280x720 (or as told:
// benchmark_frame WIDTH HEIGHT). Writes the last picture to the file named by a third argument.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "image/png.h"
#include "render/demo_scenes.h"
#include "render/renderer.h"

namespace cradle {
namespace {

constexpr int kPictures = 30;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + kPictures / 2, values.end());
  return values[kPictures / 2];
}

void run(int width, int height, const char* path) {
  const Scene scene = makeCradleScene();
  Frame frame = startFrame(scene);
  Framing framing(scene, width, height);
  framing.add(frame);
  Renderer renderer(scene, framing.view(), width, height);
  renderer.measurePasses(true);
  std::vector<RenderTimes> times;
  Image image = renderer.render(frame);  // compiles shaders
  const double start = static_cast<double>(std::clock());
  for (int i = 0; i < kPictures; ++i) {
    frame.states[0].position.x() += 1e-4;
    image = renderer.render(frame);
    times.push_back(renderer.times());
  }
  const double cpu = (static_cast<double>(std::clock()) - start) / CLOCKS_PER_SEC / kPictures;

  double total = 0;
  const auto print = [&](const char* pass, double RenderTimes::*member) {
    std::vector<double> values;
    for (const RenderTimes& one : times) values.push_back(1e3 * (one.*member));
    fmt::print("{:<10} {:7.2f} ms\n", pass, median(values));
    total += median(values);
  };
  fmt::print("{}x{}, {} pictures, medians\n", width, height, kPictures);
  print("draw list", &RenderTimes::drawList);
  print("maps", &RenderTimes::maps);
  print("main", &RenderTimes::main);
  print("resolve", &RenderTimes::resolve);
  print("read back", &RenderTimes::readBack);
  fmt::print("{:<10} {:7.2f} ms; {:.2f} ms of CPU time\n", "together", total, 1e3 * cpu);
  if (path != nullptr) writePng(image, path);
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  const int width = count > 2 ? std::atoi(arguments[1]) : 1280, height = count > 2 ? std::atoi(arguments[2]) : 720;
  cradle::run(width, height, count > 3 ? arguments[3] : nullptr);
}
