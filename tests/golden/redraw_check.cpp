// redraw_check TRAJECTORY FRAME...: draws four frames from each FRAME on, once as changes of the picture before, once
// whole. Exit 1, and a line for each, if a picture's bytes differ; else one line with the share that was drawn.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "commands/film_view.h"
#include "render/renderer.h"

namespace cradle {
namespace {

constexpr int kWidth = 320, kHeight = 180, kFrames = 4;

long differingPixels(const Image& a, const Image& b) {
  long count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); i += 3)
    count += !std::equal(&a.pixels[i], &a.pixels[i] + 3, &b.pixels[i]);
  return count;
}

bool check(const std::string& trajectory, const std::vector<long>& frames) {
  TrajectorySource source(trajectory, true);
  const TrajectoryReader& reader = source.reader();
  const View view = viewOf(source, kWidth, kHeight);
  Renderer changing(source.scene(), view, kWidth, kHeight), whole(source.scene(), view, kWidth, kHeight);
  FilmCamera camera = cameraOf(source, view);
  bool same = true;
  double share = 0;
  long pictures = 0;
  for (const long first : frames)
    for (long number = first; number < std::min(first + kFrames, reader.frameCount()); ++number) {
      const Frame frame = reader.readFrame(number);
      const Image changed = changing.render(frame, camera.at(frame));
      whole.forgetPicture();
      const long different = differingPixels(changed, whole.render(frame, camera.at(frame)));
      if (different > 0) fmt::print("{}, frame {}: {} pixels differ\n", trajectory, number, different);
      same = same && different == 0;
      if (number > first) share += changing.drawnShare(), ++pictures;
    }
  if (same) fmt::print("{}: {:.1f} % drawn\n", trajectory, 100 * share / static_cast<double>(pictures));
  return same;
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  std::vector<long> frames;
  for (int i = 2; i < count; ++i) frames.push_back(std::atol(arguments[i]));
  return cradle::check(arguments[1], frames) ? 0 : 1;
}
