#pragma once

#include <string>
#include <vector>

#include "image/font.h"

namespace cradle {

constexpr double kWordLine = 1.35;  // of words on pictures, in em

/// Lines of words on a dark ground.
struct TextPanel {
  std::vector<std::string> lines;
  TextSize size;
  double width = 0, height = 0;  // pixels
};

/// The panel of a text in letters of `em` pixels, wrapped where it would be wider than a picture of that size allows.
TextPanel textPanel(const std::string& text, double em, int pictureWidth, int pictureHeight);

/// Draws it around the middle of its width, from `top` down (pixels).
void drawTextPanel(Canvas& canvas, const TextPanel& panel, double middle, double top);

/// How wide words may be on a picture (pixels).
double widestText(int pictureWidth, int pictureHeight);

/// The largest em (pixels) from `wanted` down to `least` with which words fit; `least` if none does. `fits` is asked
/// from the largest on.
template <class Fits>
double fittingEm(double wanted, double least, const Fits& fits) {
  constexpr double kSmaller = 0.95;  // of an em, of the next one that is tried
  for (double em = wanted; em > least; em *= kSmaller)
    if (fits(em)) return em;
  return least;
}

}  // namespace cradle
