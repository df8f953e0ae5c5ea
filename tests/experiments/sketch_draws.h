#pragma once

#include <cmath>
#include <initializer_list>

#include "collision/random_poses.h"
#include "experiments/scene_sketch.h"

namespace cradle {

/// Random parts of scenes. Half of what is drawn is where laws degenerate: dead, elastic, without friction, aligned.
class SketchDraws {
 public:
  explicit SketchDraws(unsigned seed) : random_(seed) {}

  double number(double from, double to) { return random_.number(from, to); }
  bool chance(double probability) { return number(0, 1) < probability; }
  int upTo(int count) { return static_cast<int>(number(0, count)); }
  double magnitude(double from, double to) { return std::pow(10, number(from, to)); }
  Vec3 vector(double reach) { return random_.vector(reach); }
  Vec3 direction() { return random_.direction(); }
  template <class Value>
  Value one(std::initializer_list<Value> values) {
    return values.begin()[upTo(static_cast<int>(values.size()))];
  }

  /// Of a size.
  double gap() { return one({0.0, 0.0, 1e-12, 1e-9, 1e-6, 1e-3}); }
  SketchMaterial material();
  /// Along the world's axes, on an edge or corner, or any.
  Quat orientation();
  /// About a level axis, by at most `most` (rad).
  Quat tilt(double most);
  /// Of any shape that moves, about as large as `scale` (m), of 0.01 to 100 kg.
  SketchBody body(double scale);

 private:
  RandomPoses random_;
};

constexpr int kMaxTrials = 50;  // places tried for a body that misses the others

/// Adds a body in touch with what is there; against a wall too, if there is one. False if none was found that touches.
bool addTouching(SceneSketch& sketch, SketchDraws& draws, double scale, bool isCentered);

/// A slope, and on it a body at the limit of sticking, tipping or rolling without slip.
void drawThreshold(SceneSketch& sketch, SketchDraws& draws);

/// A linkage, a machine, or a driven body with what it moves.
void drawLed(SceneSketch& sketch, SketchDraws& draws);

}  // namespace cradle
