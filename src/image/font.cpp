// The only unit that sees stb_truetype. Its rasteriser computes the area of each pixel that a glyph covers exactly, and
// without hinting, so that a text looks the same on every machine. FreeType was considered: it would add a library for
// hinting alone, and stb is there for PNG files anyway.

#include "image/font.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/error.h"

#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_truetype.h>
#pragma GCC diagnostic pop

extern "C" const unsigned char cradleFont[];  // DejaVuSans.ttf

namespace cradle {
namespace {

// DejaVu Sans, in em.
constexpr double kSmallLetters = 1120.0 / 2048, kCapitals = 1493.0 / 2048, kDescent = 483.0 / 2048;
constexpr std::uint32_t kReplacement = 0xFFFD;  // of bytes that are no UTF-8
constexpr std::uint32_t kFirstPrinted = 0x20;   // the space; what is before it are control characters

const stbtt_fontinfo& font() {
  static const stbtt_fontinfo info = [] {
    stbtt_fontinfo made;
    CRADLE_CHECK(stbtt_InitFont(&made, cradleFont, 0));
    return made;
  }();
  return info;
}

/// The next character of a text, whose bytes it passes.
std::uint32_t nextCharacter(const std::string& text, std::size_t& next) {
  const auto first = static_cast<std::uint8_t>(text[next++]);
  const int more = first < 0x80 ? 0 : first >= 0xF0 && first < 0xF8 ? 3 : first >= 0xE0 ? 2 : first >= 0xC2 ? 1 : -1;
  if (more < 0 || first >= 0xF8) return kReplacement;
  std::uint32_t character = more == 0 ? first : first & (0x3Fu >> more);
  for (int i = 0; i < more; ++i) {
    if (next >= text.size() || (static_cast<std::uint8_t>(text[next]) & 0xC0) != 0x80) return kReplacement;
    character = character << 6 | (static_cast<std::uint8_t>(text[next++]) & 0x3Fu);
  }
  return character;
}

/// Calls take(glyph, x) for each glyph with its distance from the start in pixels; returns where the text ends.
template <typename Take>
double layOut(const std::string& text, float scale, const Take& take) {
  double x = 0;
  int before = 0;
  for (std::size_t next = 0; next < text.size();) {
    const int glyph = stbtt_FindGlyphIndex(&font(), static_cast<int>(nextCharacter(text, next)));
    if (before != 0) x += scale * static_cast<float>(stbtt_GetGlyphKernAdvance(&font(), before, glyph));
    take(glyph, x);
    int advance = 0, bearing = 0;
    stbtt_GetGlyphHMetrics(&font(), glyph, &advance, &bearing);
    x += scale * static_cast<float>(advance);
    before = glyph;
  }
  return x;
}

float scaleOf(const TextSize& size) {
  return stbtt_ScaleForMappingEmToPixels(&font(), static_cast<float>(size.em));
}

/// Adds a word to lines, broken where it is wider than a line; a line holds a character at least.
void addWord(const std::string& word, const TextSize& size, double width, std::vector<std::string>& lines) {
  if (!lines.empty() && textWidth(lines.back() + " " + word, size) <= width) {
    lines.back() += " " + word;
    return;
  }
  lines.emplace_back();
  for (std::size_t begin = 0, end = 0; begin < word.size(); begin = end) {
    nextCharacter(word, end);
    const std::string character = word.substr(begin, end - begin);
    if (!lines.back().empty() && textWidth(lines.back() + character, size) > width) lines.emplace_back();
    lines.back() += character;
  }
}

}  // namespace

TextSize crispTextSize(double em) {
  const double crisp = std::max(std::round(kSmallLetters * em), 1.0) / kSmallLetters;
  return {crisp, kCapitals * crisp, kDescent * crisp};
}

double textWidth(const std::string& text, const TextSize& size) {
  return layOut(text, scaleOf(size), [](int, double) {});
}

std::optional<char32_t> lackedCharacter(const std::string& text) {
  for (std::size_t next = 0; next < text.size();) {
    const std::uint32_t character = nextCharacter(text, next);
    if (character >= kFirstPrinted && stbtt_FindGlyphIndex(&font(), static_cast<int>(character)) == 0)
      return static_cast<char32_t>(character);
  }
  return std::nullopt;
}

std::vector<std::string> wrappedText(std::string text, const TextSize& size, double width) {
  const auto isControl = [](unsigned char byte) { return byte < kFirstPrinted; };
  std::replace_if(text.begin(), text.end(), isControl, ' ');
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    if (end > begin) addWord(text.substr(begin, end - begin), size, width, lines);
    begin = end + 1;
  }
  return lines;
}

std::string fittedText(const std::string& text, const TextSize& size, double width) {
  if (textWidth(text, size) <= width) return text;
  std::string start = text;
  while (!start.empty() && textWidth(start + "...", size) > width) {
    while ((static_cast<std::uint8_t>(start.back()) & 0xC0) == 0x80 && start.size() > 1) start.pop_back();
    start.pop_back();  // with the first byte, the whole character
  }
  return start + "...";
}

void drawText(Canvas& canvas, const std::string& text, const TextSize& size, const PicturePoint& start,
              const Ink& ink) {
  const float scale = scaleOf(size);
  const int baseline = static_cast<int>(std::round(start.y));
  std::vector<unsigned char> bitmap;
  layOut(text, scale, [&](int glyph, double offset) {
    const double x = start.x + offset;
    const int column = static_cast<int>(std::floor(x));
    const auto shift = static_cast<float>(x - column);
    int left = 0, top = 0, right = 0, bottom = 0;
    stbtt_GetGlyphBitmapBoxSubpixel(&font(), glyph, scale, scale, shift, 0, &left, &top, &right, &bottom);
    const int width = right - left, height = bottom - top;
    if (width <= 0 || height <= 0) return;
    bitmap.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    stbtt_MakeGlyphBitmapSubpixel(&font(), bitmap.data(), width, height, width, scale, scale, shift, 0, glyph);
    for (int i = 0; i < width * height; ++i)
      canvas.blend(column + left + i % width, baseline + top + i / width, bitmap[static_cast<std::size_t>(i)] / 255.0,
                   ink);
  });
}

}  // namespace cradle
