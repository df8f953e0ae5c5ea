#include "overlay/text_panel.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr double kWidestText = 0.86;     // of the picture's width
constexpr double kTextFromSides = 0.05;  // of the picture's height, with the panel around the text
constexpr double kWordsPadding = 0.5;    // em
const Ink kWordsGround{{18, 22, 30}, 0.82}, kWordsInk{{255, 255, 255}, 1};

double paddingOf(const TextSize& size) {
  return std::round(kWordsPadding * size.em);
}

}  // namespace

double widestText(int pictureWidth, int pictureHeight) {
  return std::max(1.0, std::min(kWidestText * pictureWidth, pictureWidth - 2 * kTextFromSides * pictureHeight));
}

TextPanel textPanel(const std::string& text, double em, int pictureWidth, int pictureHeight) {
  TextPanel panel;
  panel.size = crispTextSize(em);
  panel.lines = wrappedText(text, panel.size, widestText(pictureWidth, pictureHeight));
  for (const std::string& line : panel.lines) panel.width = std::max(panel.width, textWidth(line, panel.size));
  panel.width += 2 * paddingOf(panel.size);
  panel.height = 2 * paddingOf(panel.size) + panel.size.ascent +
                 kWordLine * panel.size.em * (static_cast<double>(panel.lines.size()) - 1);
  return panel;
}

void drawTextPanel(Canvas& canvas, const TextPanel& panel, double middle, double top) {
  const double padding = paddingOf(panel.size), half = panel.width / 2;
  canvas.rectangle({std::round(middle - half), std::round(top)},
                   {std::round(middle + half), std::round(top + panel.height)}, padding, kWordsGround);
  double baseline = top + padding + panel.size.ascent;
  for (const std::string& line : panel.lines) {
    drawText(canvas, line, panel.size, {middle - textWidth(line, panel.size) / 2, baseline}, kWordsInk);
    baseline += kWordLine * panel.size.em;
  }
}

}  // namespace cradle
