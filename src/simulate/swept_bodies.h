#pragma once

#include <vector>

#include "dynamics/integrators/step.h"
#include "math/types.h"

namespace cradle {

/// What the bodies of an island sweep within a window of time: for each a box around the places of its centre of mass,
/// by the interpolants of the steps.
class SweptBodies {
 public:
  /// The window is [from, to] (s), and the bodies are in `state` at its start.
  void begin(double from, double to, const VectorX& state);

  /// To be told each step that reaches into the window, and the state after its events.
  void add(const Step& step, const VectorX& after);

  /// m, by moving body. An interpolant of which a part s of a step is used is off its chord by at most s^2 / 8 of the
  /// bound on its second derivative.
  const std::vector<Bounds>& centers() const { return centers_; }

 private:
  double from_ = 0, to_ = 0;  // s
  std::vector<Bounds> centers_;
};

}  // namespace cradle
