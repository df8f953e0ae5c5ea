#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/experiment.h"

// Heaps are chaotic: a mirror image of one, or the same one with its bodies in another order, comes to rest otherwise.
// Over many heaps nothing must be left of either: no side and no number is preferred.

namespace cradle {
namespace {

constexpr int kBoxes = 64, kHeaps = 12;

enum class HeapTwin { same, mirrored, renumbered };

/// What is seen of a heap at its end.
struct HeapFigures {
  double height = 0, width = 0;  // m: mean height of the centres; root of their mean square distance from the middle
  double lean = 0;               // m: mean of x, mirrored back
};

/// Boxes turned at random that fall on top of each other, between 0.1 and 2 m over a plane.
HeapFigures heapOf(unsigned seed, HeapTwin twin) {
  std::mt19937 generator(seed);
  const double sense = twin == HeapTwin::mirrored ? -1 : 1;
  std::vector<std::string> boxes;
  const auto number = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(generator()) / static_cast<double>(std::mt19937::max());
  };
  for (int i = 0; i < kBoxes; ++i) {
    const double x = number(-0.15, 0.15), z = number(-0.15, 0.15);
    const Vec3 axis = Vec3(number(-1, 1), number(-1, 1), number(-1, 1)).normalized();
    const double half = number(0, 1.5);
    // A mirror image across x turns the other way about y and z.
    const Vec3 part = std::sin(half) * Vec3(axis.x(), sense * axis.y(), sense * axis.z());
    boxes.push_back(fmt::format(R"({{"name": "b{}", "shape": {{"box": {{"size": [0.12, 0.08, 0.1]}}}}, "material": "m",
        "position": [{}, {}, {}], "orientation": {{"w": {}, "x": {}, "y": {}, "z": {}}}}})",
                                i, sense * x, 0.1 + 0.15 * i, z, std::cos(half), part.x(), part.y(), part.z()));
  }
  if (twin == HeapTwin::renumbered) std::reverse(boxes.begin(), boxes.end());
  const Trajectory run = simulate(sceneWith(fmt::format(
      R"("duration": 2.5, "accuracy": "visual", "output": {{"framesPerSecond": 1}}, "materials": {{"m": {{"restitution": 0.1,
      "staticFriction": 0.5, "dynamicFriction": 0.4}}}}, "bodies": [{{"name": "floor", "shape": {{"plane": {{}}}},
      "motion": "static", "material": "m"}}, {}])",
      fmt::join(boxes, ", "))));
  HeapFigures figures;
  for (const BodyState& state : run.frames.back().states) {
    figures.height += state.position.y() / kBoxes;
    figures.width += (state.position.x() * state.position.x() + state.position.z() * state.position.z()) / kBoxes;
    figures.lean += sense * state.position.x() / kBoxes;
  }
  figures.width = std::sqrt(figures.width);
  return figures;
}

/// Of the differences between heaps and their twins: mean, and its standard error.
struct MeanDifference {
  double mean = 0, error = 0;
};

template <class Figure>
MeanDifference meanDifference(const std::vector<HeapFigures>& heaps, const std::vector<HeapFigures>& twins,
                              const Figure& figure) {
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < kHeaps; ++i) {
    const double difference = figure(twins[i]) - figure(heaps[i]);
    sum += difference, squares += difference * difference;
  }
  const double mean = sum / kHeaps;
  return {mean, std::sqrt((squares / kHeaps - mean * mean) / (kHeaps - 1))};
}

std::vector<HeapFigures> heapsOf(HeapTwin twin) {
  std::vector<HeapFigures> heaps;
  for (unsigned seed = 0; seed < kHeaps; ++seed) heaps.push_back(heapOf(seed, twin));
  return heaps;
}

// Means of twelve differences lie within four of their standard errors (once in 500 times they would not, Student's t
// of 11; the seeds are fixed). A preferred side of a third of what single heaps differ by is more.
TEST(HeapStatistics, OfMirrorImagesAndOfAnotherOrderAreTheSame) {
  const std::vector<HeapFigures> heaps = heapsOf(HeapTwin::same);
  for (const HeapTwin twin : {HeapTwin::mirrored, HeapTwin::renumbered}) {
    SCOPED_TRACE(twin == HeapTwin::mirrored ? "mirrored" : "renumbered");
    const std::vector<HeapFigures> twins = heapsOf(twin);
    for (const auto& difference : {meanDifference(heaps, twins, [](const HeapFigures& heap) { return heap.height; }),
                                   meanDifference(heaps, twins, [](const HeapFigures& heap) { return heap.width; }),
                                   meanDifference(heaps, twins, [](const HeapFigures& heap) { return heap.lean; })}) {
      EXPECT_GT(difference.error, 1e-6) << "twins that are not chaotic tell nothing";
      EXPECT_LT(std::abs(difference.mean), 4 * difference.error);
    }
  }
}

}  // namespace
}  // namespace cradle
