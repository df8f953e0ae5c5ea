#pragma once

#include <optional>
#include <string>
#include <vector>

#include "image/canvas.h"

namespace cradle {

/// Height of a line of text in pixels, and of its parts; all 0 or above.
struct TextSize {
  double em = 0;
  double ascent = 0, descent = 0;  // from the baseline, of capitals and of what hangs below it
};

/// The size near `em` (pixels) at which small letters end on the edge of a pixel, so that text is crisp.
TextSize crispTextSize(double em);

/// How far a text in UTF-8 reaches to the right, in pixels. The font is DejaVu Sans, which is part of the program; what
/// it lacks shows as a box.
double textWidth(const std::string& text, const TextSize& size);

/// The first character of a text in UTF-8 that the font lacks; nothing if it has all. Control characters are no
/// characters of a text: what shows it takes them as spaces.
std::optional<char32_t> lackedCharacter(const std::string& text);

/// The words of a text in lines that are at most `width` pixels wide; a word that is wider is broken. Control
/// characters are spaces.
std::vector<std::string> wrappedText(std::string text, const TextSize& size, double width);

/// The text if it is at most `width` pixels wide, else as much of its beginning as fits with three points after it.
std::string fittedText(const std::string& text, const TextSize& size, double width);

/// Draws a text with the left end of its baseline at `start`; the baseline goes to the nearest edge of pixels.
void drawText(Canvas& canvas, const std::string& text, const TextSize& size, const PicturePoint& start, const Ink& ink);

}  // namespace cradle
