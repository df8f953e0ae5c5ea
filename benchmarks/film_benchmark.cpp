// benchmark_film SCENE [WIDTH HEIGHT]: what `cradle video SCENE` costs beside drawing its pictures and encoding them
// alone, one after the other in a run of their own (CPU time, all threads and ffmpeg), and how much of its CPU time
// goes on at once: the elapsed time, which means something where nothing else runs, and the least that it can be on two
// cores, from what must go on in the drawing thread. Medians of runs in turns. Films go to the folder for temporary
// files.

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "commands/film.h"
#include "commands/trajectory_source.h"
#include "core/error.h"
#include "core/interruption.h"
#include "film/film_view.h"
#include "image/video.h"
#include "render/renderer.h"

namespace cradle {
namespace {

constexpr int kRuns = 3;

double secondsOf(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double cpuSeconds(int whose) {
  rusage usage{};
  getrusage(whose, &usage);
  return secondsOf(usage);
}

struct Job {
  std::string scene, film;
  int width, height;  // pixels
};

struct Cost {
  double drawing = 0, encoding = 0;  // s of CPU time, alone
  double drawingThread = 0;          // s of `drawing` in the thread that gives OpenGL its orders
  double film = 0;                   // s of CPU time of all that `video` does
  double elapsed = 0;                // s, of `video`
};

using Parts = std::array<double, 3>;  // s of CPU time: drawing, the share of its own thread in it, encoding

/// Draws each picture and then hands it to ffmpeg.
Parts drawAndEncode(const Job& job) {
  TrajectorySource source(job.scene, true);
  source.simulate();
  const View view = viewOf(source, job.width, job.height);
  Renderer renderer(source.scene(), view, job.width, job.height);
  VideoEncoder encoder(job.film, {job.width, job.height, source.scene().output.framesPerSecond});
  FilmCamera camera = cameraOf(source, view);
  double drawing = 0, drawingThread = 0, handing = 0;
  for (long number = 0; number < source.pictureCount(); ++number) {
    const Frame frame = source.reader().readFrame(number);
    const double start = cpuSeconds(RUSAGE_SELF), threadStart = cpuSeconds(RUSAGE_THREAD);
    const Image picture = renderer.render(frame, camera.at(frame));
    const double drawn = cpuSeconds(RUSAGE_SELF);
    drawingThread += cpuSeconds(RUSAGE_THREAD) - threadStart;
    encoder.add(picture);
    drawing += drawn - start;
    handing += cpuSeconds(RUSAGE_SELF) - drawn;
  }
  encoder.finish();
  return {drawing, drawingThread, handing + cpuSeconds(RUSAGE_CHILDREN)};
}

/// Runs `work` in a process of its own, which OpenGL's threads do not outlive; its CPU time, with that of its children.
template <typename Work>
double cpuSecondsApart(const Work& work) {
  const pid_t process = fork();
  if (process == 0) {
    try {
      work();
      _exit(0);
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
      _exit(1);
    }
  }
  int status = 0;
  rusage usage{};
  if (wait4(process, &status, 0, &usage) != process || status != 0)
    throw Error(ErrorKind::limit, "benchmark_film", "a run failed");
  return secondsOf(usage);
}

Cost measure(const Job& job) {
  Cost cost;
  std::array<int, 2> ends;
  if (pipe(ends.data()) != 0) throw Error(ErrorKind::limit, "benchmark_film", "no pipe");
  cpuSecondsApart([&] {
    const Parts parts = drawAndEncode(job);
    if (write(ends[1], parts.data(), sizeof(parts)) != static_cast<ssize_t>(sizeof(parts))) _exit(1);
  });
  Parts parts{};
  if (read(ends[0], parts.data(), sizeof(parts)) != static_cast<ssize_t>(sizeof(parts)))
    throw Error(ErrorKind::limit, "benchmark_film", "no figures");
  close(ends[0]), close(ends[1]);
  const auto start = std::chrono::steady_clock::now();
  cost.film = cpuSecondsApart([&] {
    PictureOptions options;
    options.size = fmt::format("{}x{}", job.width, job.height);
    makeFilm(job.scene, job.film, options, true);
  });
  cost.elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::filesystem::remove(job.film);
  cost.drawing = parts[0];
  cost.drawingThread = parts[1];
  cost.encoding = parts[2];
  return cost;
}

/// Of the film's CPU time: on two cores, with OpenGL's other threads on both, if no thread ever waits for nothing.
double leastElapsed(const Cost& cost) {
  return std::max(0.5, (cost.drawingThread + (cost.drawing - cost.drawingThread) / 2) / cost.film);
}

double median(std::vector<Cost> costs, double (*of)(const Cost&)) {
  std::sort(costs.begin(), costs.end(), [&](const Cost& a, const Cost& b) { return of(a) < of(b); });
  return of(costs[costs.size() / 2]);
}

void run(const Job& job) {
  noteInterruptions();
  std::vector<Cost> costs;
  for (int i = 0; i < kRuns; ++i) costs.push_back(measure(job));
  fmt::print("{} at {}x{}, medians of {} runs\n", job.scene, job.width, job.height, kRuns);
  fmt::print("  drawing alone    {:7.2f} s of CPU time, {:.2f} s in its own thread\n",
             median(costs, [](const Cost& c) { return c.drawing; }),
             median(costs, [](const Cost& c) { return c.drawingThread; }));
  fmt::print("  encoding alone   {:7.2f} s\n", median(costs, [](const Cost& c) { return c.encoding; }));
  fmt::print("  cradle video     {:7.2f} s, {:.3f} of both\n", median(costs, [](const Cost& c) { return c.film; }),
             median(costs, [](const Cost& c) { return c.film / (c.drawing + c.encoding); }));
  fmt::print("  elapsed          {:7.2f} s, {:.2f} of its CPU time\n",
             median(costs, [](const Cost& c) { return c.elapsed; }),
             median(costs, [](const Cost& c) { return c.elapsed / c.film; }));
  fmt::print("  least elapsed    {:7.2f} of its CPU time on two cores\n", median(costs, leastElapsed));
}

}  // namespace
}  // namespace cradle

int main(int count, char** arguments) {
  if (count != 2 && count != 4) {
    fmt::print(stderr, "usage: benchmark_film SCENE [WIDTH HEIGHT]\n");
    return 2;
  }
  const int width = count > 3 ? std::atoi(arguments[2]) : 1280, height = count > 3 ? std::atoi(arguments[3]) : 720;
  const auto folder = std::filesystem::temp_directory_path();
  cradle::run({arguments[1], (folder / fmt::format("benchmark-film-{}.mp4", getpid())).string(), width, height});
}
