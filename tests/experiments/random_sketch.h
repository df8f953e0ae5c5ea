#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "experiments/scene_sketch.h"

namespace cradle {

/// Families of random scenes that start where laws of contact degenerate.
enum class SketchFamily {
  touch,      // bodies in touch, or nearly: gaps of 0 to 1e-3 of their size
  pinned,     // joints to the world or to each other at the places of contact
  squeezed,   // light bodies between a floor, or a wall, and heavy ones
  symmetric,  // arrangements that are their own image in the mirror x = 0
  threshold,  // slopes at the limits of sticking, tipping and rolling: the motion is known
  led         // linkages with stops and motors, and driven bodies that carry, tow, strike and shake
};
constexpr std::array<std::string_view, 6> kSketchFamilyNames{"touch",     "pinned",    "squeezed",
                                                             "symmetric", "threshold", "led"};

/// The scene of a family with a number; the same for the same number, whatever was asked for before.
SceneSketch randomSketch(SketchFamily family, unsigned number);

}  // namespace cradle
