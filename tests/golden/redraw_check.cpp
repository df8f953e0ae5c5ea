// redraw_check TRAJECTORY FOLDER FRAME...: draws four frames from each FRAME on, once as changes of the picture before,
// once whole. Exit 1, and a line for each, if a picture's bytes differ; else one line with the share that was drawn.
// The whole picture of each FRAME is written to FOLDER/frame_000000.png, ..., as `cradle render` names them: one
// process draws all of a scene's pictures in a third of the time of a process for each.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "commands/trajectory_source.h"
#include "film/film_view.h"
#include "image/png.h"
#include "overlay/captions.h"
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

bool check(const std::string& trajectory, const std::filesystem::path& folder, const std::vector<long>& frames) {
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
      const Image picture = whole.render(frame, camera.at(frame));
      if (number == first) {
        Image captioned = picture;
        drawCaptions(source.scene(), frame, {camera.at(frame), kWidth, kHeight}, {}, captioned);
        writePng(captioned, (folder / fmt::format("frame_{:06}.png", number)).string());
      }
      const long different = differingPixels(changed, picture);
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
  for (int i = 3; i < count; ++i) frames.push_back(std::atol(arguments[i]));
  return cradle::check(arguments[1], arguments[2], frames) ? 0 : 1;
}
