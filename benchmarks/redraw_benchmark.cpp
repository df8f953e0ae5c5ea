// benchmark_redraw TRAJECTORY [WIDTH HEIGHT]: CPU time a picture, drawn as changes of the one before and drawn whole,
// in turns; medians over frames of the whole film, and their ratio.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include "commands/trajectory_source.h"
#include "film/film_view.h"
#include "render/renderer.h"

namespace cradle {
namespace {

constexpr long kRuns = 12, kFrames = 5;  // stretches of the film, and measured frames in each

double cpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

void run(const std::string& trajectory, int width, int height) {
  TrajectorySource source(trajectory, true);
  const TrajectoryReader& reader = source.reader();
  const View view = viewOf(source, width, height);
  Renderer changing(source.scene(), view, width, height), whole(source.scene(), view, width, height);
  FilmCamera camera = cameraOf(source, view);
  whole.render(reader.readFrame(0));  // compiles shaders
  std::vector<double> changedTimes, wholeTimes, shares;
  for (long run = 0; run < kRuns; ++run) {
    const long first = run * (reader.frameCount() - kFrames - 1) / kRuns;
    const Frame before = reader.readFrame(first);
    changing.render(before, camera.at(before));
    for (long number = first + 1; number <= first + kFrames; ++number) {
      const Frame frame = reader.readFrame(number);
      const Camera& seenFrom = camera.at(frame);
      const double start = cpuSeconds();
      changing.render(frame, seenFrom);
      const double middle = cpuSeconds();
      whole.forgetPicture();
      whole.render(frame, seenFrom);
      changedTimes.push_back(middle - start);
      wholeTimes.push_back(cpuSeconds() - middle);
      shares.push_back(changing.drawnShare());
    }
  }
  double changedSum = 0, wholeSum = 0;
  for (const double time : changedTimes) changedSum += time;
  for (const double time : wholeTimes) wholeSum += time;
  fmt::print("{} at {}x{}\n", trajectory, width, height);
  fmt::print("  drawn whole  {:8.2f} ms of CPU time a picture (median)\n", 1e3 * median(wholeTimes));
  fmt::print("  as changes   {:8.2f} ms, {:.1f} % of the picture\n", 1e3 * median(changedTimes), 100 * median(shares));
  fmt::print("  ratio        {:8.2f} of medians, {:.2f} of sums\n", median(wholeTimes) / median(changedTimes),
             wholeSum / changedSum);
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  if (count != 2 && count != 4) {
    fmt::print(stderr, "usage: benchmark_redraw TRAJECTORY [WIDTH HEIGHT]\n");
    return 2;
  }
  const int width = count > 3 ? std::atoi(arguments[2]) : 1280, height = count > 3 ? std::atoi(arguments[3]) : 720;
  cradle::run(arguments[1], width, height);
}
