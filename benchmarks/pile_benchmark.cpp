// Bodies dropped into a tray, ours beside Bullet and ODE in one run: CPU time a step of 1/60 s, the deepest overlap
// (found from the poses alone, each step), and when all lie still. Usage: benchmark_pile BODIES KIND SECONDS
// (pile_scene.h names the kinds); benchmark_pile ours BODIES KIND SECONDS: without others; benchmark_pile sizes: 5000
// bodies beside 1000, from several starts; benchmark_pile threads BODIES: two threads beside two runs at once; without
// arguments spheres and boxes, sizes and threads, one after the other.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>
#include <thread>

#include "ode_pile.h"
#include "pile_worlds.h"

namespace cradle {
namespace {

constexpr int kFallingSteps = 90;

double secondsOf(clockid_t clock) {
  timespec time;
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Figures {
  double falling = 0, settling = 0, all = 0;                 // ms a step: the first, those until all lie still, all
  double deepestFalling = 0, deepest = 0, deepestAtEnd = 0;  // mm: in the first steps, after them, at the end
  double restTime = -1;                                      // s; -1: never
};

template <class World>
Figures measure(const PileScene& scene, World& world, int steps) {
  Figures figures;
  int settlingSteps = 0;
  for (int step = 0; step < steps; ++step) {
    const double before = secondsOf(CLOCK_PROCESS_CPUTIME_ID);
    world.advance();
    const double cost = 1e3 * (secondsOf(CLOCK_PROCESS_CPUTIME_ID) - before);
    figures.all += cost / steps;
    if (step < kFallingSteps)
      figures.falling += cost / kFallingSteps;
    else if (figures.restTime < 0)
      figures.settling += cost, ++settlingSteps;
    if (figures.restTime < 0 && world.isAtRest()) figures.restTime = (step + 1) * kSoftTimeStep;
    figures.deepestAtEnd = 1e3 * deepestOverlap(scene, world.poses());
    double& deepest = step < kFallingSteps ? figures.deepestFalling : figures.deepest;
    deepest = std::max(deepest, figures.deepestAtEnd);
  }
  if (settlingSteps > 0) figures.settling /= settlingSteps;
  return figures;
}

void print(const std::string& who, const Figures& figures, const Figures& bullet) {
  fmt::print(
      "  {:<7} falling {:6.3f} ms ({:.2f} of Bullet's), then until rest {:6.3f} ms, all {:6.3f} ms ({:.2f} of "
      "Bullet's)\n"
      "          deepest falling {:5.1f} mm, later {:5.1f} mm, at the end {:4.1f} mm; rest at {:.2f} s\n",
      who, figures.falling, figures.falling / bullet.falling, figures.settling, figures.all, figures.all / bullet.all,
      figures.deepestFalling, figures.deepest, figures.deepestAtEnd, figures.restTime);
}

void compare(int bodies, const std::string& kind, int steps) {
  const PileScene scene = makePileScene(bodies, kind);
  OurPile ours(scene, 1);
  BulletPile bullet(scene);
  const Figures our = measure(scene, ours, steps), theirs = measure(scene, bullet, steps);
  fmt::print("Bullet {} with {} precision\n", btGetVersion(), sizeof(btScalar) == 8 ? "double" : "single");
  fmt::print("{} {}, {} steps, one thread\n", bodies, kind, steps);
  print("cradle", our, theirs);
  print("Bullet", theirs, theirs);
  if (kind == "hulls") return;  // ODE has none that fall on each other
  OdePile ode(scene);
  print("ODE", measure(scene, ode, steps), theirs);
}

/// Ours alone.
void measureOurs(int bodies, const std::string& kind, int steps) {
  const PileScene scene = makePileScene(bodies, kind);
  OurPile ours(scene, 1);
  const Figures figures = measure(scene, ours, steps);
  print("cradle", figures, figures);
}

/// CPU time of 5000 bodies in parts of that of 1000. Few and many take turns, so that what else the machine does falls
/// on both.
double ratioOfSizes(const std::string& kind, unsigned start) {
  constexpr int kTurns = 60, kSteps = 5;
  OurPile few(makePileScene(1000, kind, start), 1), many(makePileScene(5000, kind, start), 1);
  const auto cpuOf = [](OurPile& world) {
    const double start = secondsOf(CLOCK_PROCESS_CPUTIME_ID);
    for (int step = 0; step < kSteps; ++step) world.advance();
    return secondsOf(CLOCK_PROCESS_CPUTIME_ID) - start;
  };
  double ofFew = 0, ofMany = 0;
  for (int turn = 0; turn < kTurns; ++turn) ofFew += cpuOf(few), ofMany += cpuOf(many);
  return ofMany / ofFew;
}

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// When the last bodies of a heap lie still is chance: several starts.
void compareSizes(const std::string& kind) {
  std::vector<double> ratios;
  for (const unsigned start : {1U, 2U, 3U, 4U, 5U}) ratios.push_back(ratioOfSizes(kind, start));
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  fmt::print("300 steps of 5000 {}: {:.1f} times the CPU time of 1000, the median of {} starts ({:.1f} to {:.1f})\n",
             kind, medianOf(ratios), ratios.size(), *least, *most);
}

/// One and two threads and two runs at once take turns, a few steps each, so that what else the machine does falls on
/// all alike.
void compareThreads(int bodies, const std::string& kind) {
  constexpr int kTurns = 40, kSteps = 4;
  const PileScene scene = makePileScene(bodies, kind);
  OurPile single(scene, 1), twin(scene, 2), left(scene, 1), right(scene, 1);
  const auto wallOf = [](const auto& work) {
    const double start = secondsOf(CLOCK_MONOTONIC);
    work();
    return secondsOf(CLOCK_MONOTONIC) - start;
  };
  const auto advance = [](OurPile& world) {
    for (int step = 0; step < kSteps; ++step) world.advance();
  };
  std::vector<double> byThreads, byRuns;
  for (int turn = 0; turn < kTurns; ++turn) {
    const double one = wallOf([&] { advance(single); }), two = wallOf([&] { advance(twin); });
    const double both = wallOf([&] {
      std::thread other([&] { advance(left); });
      advance(right);
      other.join();
    });
    byThreads.push_back(one / two), byRuns.push_back(2 * one / both);
  }
  const double threads = medianOf(byThreads), runs = medianOf(byRuns);
  fmt::print("{} {}: two threads {:.2f} times as fast as one, two runs at once {:.2f} times; {:.2f} of it\n", bodies,
             kind, threads, runs, threads / runs);
}

}  // namespace
}  // namespace cradle

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool all = arguments.empty();
  const std::vector<std::string> common{"spheres", "boxes", "turned"};
  const auto stepsOf = [](const std::string& seconds) { return static_cast<int>(60 * std::stod(seconds)); };
  if (all) {
    for (const std::string& kind : common) cradle::compare(1000, kind, 600);
  }
  if (all || arguments[0] == "sizes")
    for (const std::string& kind : common) cradle::compareSizes(kind);
  if (all || arguments[0] == "threads")
    for (const std::string& kind : common)
      cradle::compareThreads(arguments.size() > 1 ? std::stoi(arguments[1]) : 5000, kind);
  if (arguments.size() == 4) cradle::measureOurs(std::stoi(arguments[1]), arguments[2], stepsOf(arguments[3]));
  if (arguments.size() == 3) cradle::compare(std::stoi(arguments[0]), arguments[1], stepsOf(arguments[2]));
}
