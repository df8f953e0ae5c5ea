#include "overlay/captions.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/font.h"
#include "render/body_place.h"

namespace cradle {
namespace {

// Of the picture's height.
constexpr double kCaptionText = 0.042, kBodyText = 0.032, kTitleText = 0.085, kSubtitleText = 0.045;
constexpr double kHeadingText = 0.45;  // of the strip's height
constexpr double kCaptionFromEdge = 0.035, kLineWidth = 0.004, kEndRadius = 0.008;
constexpr double kLabelAside = 0.05, kLabelAbove = 0.11;  // of a body's centre
// Of the picture's width.
constexpr double kWidestCaption = 0.86;
// Of the text's height.
constexpr double kCaptionPadding = 0.5, kCaptionLine = 1.35;
const Ink kCaptionPanel{{18, 22, 30}, 0.82}, kCaptionWords{{255, 255, 255}, 1}, kLeader{{18, 22, 30}, 0.9},
    kCardGround{{18, 22, 30}, 1}, kSubtitle{{176, 184, 196}, 1};

/// Lines of words that are at most so wide (pixels); a word that is wider has a line of its own, and is cut.
std::vector<std::string> brokenText(std::string text, const TextSize& size, double width) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (word.empty()) continue;
    if (!lines.empty() && textWidth(lines.back() + " " + word, size) <= width)
      lines.back() += " " + word;
    else
      lines.push_back(fittedText(word, size, width));
  }
  return lines;
}

double widestOf(const std::vector<std::string>& lines, const TextSize& size) {
  double width = 0;
  for (const std::string& line : lines) width = std::max(width, textWidth(line, size));
  return width;
}

/// A panel with lines of text around the middle of its width, from `top` down; returns its lower edge (pixels).
double drawTextPanel(Canvas& canvas, const std::vector<std::string>& lines, const TextSize& size, double middle,
                     double top) {
  const double padding = std::round(kCaptionPadding * size.em), width = widestOf(lines, size);
  const double bottom =
      top + 2 * padding + size.ascent + kCaptionLine * size.em * static_cast<double>(lines.size() - 1);
  canvas.rectangle({std::round(middle - width / 2 - padding), std::round(top)},
                   {std::round(middle + width / 2 + padding), std::round(bottom)}, padding, kCaptionPanel);
  double baseline = top + padding + size.ascent;
  for (const std::string& line : lines) {
    drawText(canvas, line, size, {middle - textWidth(line, size) / 2, baseline}, kCaptionWords);
    baseline += kCaptionLine * size.em;
  }
  return bottom;
}

double panelHeight(std::size_t lines, const TextSize& size) {
  return 2 * std::round(kCaptionPadding * size.em) + size.ascent +
         kCaptionLine * size.em * static_cast<double>(lines - 1);
}

void drawBodyLabel(const std::string& text, const Vec3& centre, const Lens& lens, Canvas& canvas) {
  const auto place = lens.see(centre);
  if (!place || place->x < 0 || place->y < 0 || place->x > lens.width || place->y > lens.height) return;
  const TextSize size = crispTextSize(kBodyText * lens.height);
  const std::string line = fittedText(text, size, kWidestCaption * lens.width);
  const double half = textWidth(line, size) / 2 + std::round(kCaptionPadding * size.em), height = panelHeight(1, size);
  const double edge = kCaptionFromEdge * lens.height;
  // Moved, not turned over, at the edges of the picture, so that it does not jump.
  const double top = std::max(edge, place->y - kLabelAbove * lens.height - height);
  const double middle =
      std::max(half + edge, std::min(place->x + kLabelAside * lens.height + half, lens.width - half - edge));
  const PicturePoint end{std::clamp(place->x, middle - half + size.em, middle + half - size.em),
                         std::clamp(place->y, top, top + height)};
  const double width = kLineWidth * lens.height;
  canvas.line({{*place, width, 1}, {end, width, 1}}, kLeader);
  canvas.disc(*place, kEndRadius * lens.height, kLeader);
  canvas.disc(*place, 0.6 * kEndRadius * lens.height, kCaptionWords);
  drawTextPanel(canvas, {line}, size, middle, top);
}

}  // namespace

void drawCaptions(const Scene& scene, const Frame& frame, const Lens& lens, Image& image) {
  Canvas canvas(image);
  const TextSize size = crispTextSize(kCaptionText * lens.height);
  std::vector<std::vector<std::string>> panels;
  std::vector<RigidTransform> places;
  for (const Caption& caption : scene.captions) {
    if (frame.time < caption.from || frame.time >= caption.to) continue;
    if (caption.body == kWorld) {
      panels.push_back(brokenText(caption.text, size, kWidestCaption * lens.width));
      continue;
    }
    if (places.empty()) places = placeBodies(scene, frame);
    const auto body = static_cast<std::size_t>(caption.body);
    drawBodyLabel(caption.text, places[body] * scene.bodies[body].massProperties.centerOfMass, lens, canvas);
  }
  double bottom = (1 - kCaptionFromEdge) * lens.height;
  for (auto panel = panels.rbegin(); panel != panels.rend(); ++panel) {
    const double top = bottom - panelHeight(panel->size(), size);
    drawTextPanel(canvas, *panel, size, lens.width / 2.0, top);
    bottom = top - kCaptionPadding * size.em;
  }
}

Image drawHeading(const std::string& text, int width, int height) {
  Image image(width, height);
  Canvas canvas(image);
  canvas.rectangle({-1, -1}, {width + 1.0, height + 1.0}, 0, kCardGround);
  const TextSize size = crispTextSize(kHeadingText * height);
  const std::string line = fittedText(text, size, kWidestCaption * width);
  drawText(canvas, line, size, {(width - textWidth(line, size)) / 2, (height + size.ascent) / 2}, kCaptionWords);
  return image;
}

Image drawTitleCard(const TitleCard& card, int width, int height) {
  Image image(width, height);
  Canvas canvas(image);
  canvas.rectangle({-1, -1}, {width + 1.0, height + 1.0}, 0, kCardGround);
  const TextSize titleSize = crispTextSize(kTitleText * height), subtitleSize = crispTextSize(kSubtitleText * height);
  const auto titleLines = brokenText(card.title, titleSize, kWidestCaption * width);
  const auto subtitleLines = brokenText(card.subtitle, subtitleSize, kWidestCaption * width);
  const double titleHeight = kCaptionLine * titleSize.em * static_cast<double>(titleLines.size());
  const double subtitleHeight = kCaptionLine * subtitleSize.em * static_cast<double>(subtitleLines.size());
  double baseline = (height - titleHeight - subtitleHeight) / 2 + titleSize.em;
  const auto write = [&](const std::vector<std::string>& lines, const TextSize& size, const Ink& ink) {
    for (const std::string& line : lines) {
      drawText(canvas, line, size, {(width - textWidth(line, size)) / 2, baseline}, ink);
      baseline += kCaptionLine * size.em;
    }
  };
  write(titleLines, titleSize, kCaptionWords);
  write(subtitleLines, subtitleSize, kSubtitle);
  return image;
}

}  // namespace cradle
