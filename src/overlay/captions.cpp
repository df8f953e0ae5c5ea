#include "overlay/captions.h"

#include <algorithm>
#include <vector>

#include "overlay/caption_layout.h"
#include "render/body_place.h"

namespace cradle {
namespace {

// Of the picture's height.
constexpr double kLineWidth = 0.004, kEndRadius = 0.008;
constexpr double kHeadingText = 0.45;    // of the strip's height
constexpr double kWidestHeading = 0.86;  // of the strip's width
const Ink kCardGround{{18, 22, 30}, 1}, kTitle{{255, 255, 255}, 1}, kSubtitle{{176, 184, 196}, 1},
    kLeader{{18, 22, 30}, 0.9}, kLeaderEnd{{255, 255, 255}, 1};

bool isIn(const PicturePoint& place, const Lens& lens) {
  return place.x >= 0 && place.y >= 0 && place.x <= lens.width && place.y <= lens.height;
}

std::vector<ShownCaption> shownCaptions(const Scene& scene, const Frame& frame, const Lens& lens) {
  std::vector<ShownCaption> shown;
  std::vector<RigidTransform> places;
  for (const Caption& caption : scene.captions) {
    if (frame.time < caption.from || frame.time >= caption.to) continue;
    shown.push_back({&caption, std::nullopt});
    if (caption.body == kWorld) continue;
    if (places.empty()) places = placeBodies(scene, frame);
    const auto body = static_cast<std::size_t>(caption.body);
    const auto place = lens.see(places[body] * scene.bodies[body].massProperties.centerOfMass);
    if (place && isIn(*place, lens)) shown.back().place = place;
  }
  return shown;
}

/// From a body to the nearest place of its label.
void drawLeader(const PlacedPanel& label, int height, Canvas& canvas) {
  const double half = label.panel.width / 2 - label.panel.size.em;  // to where the panel's corners are not round
  const PicturePoint end{
      std::clamp(label.place->x, label.middle - std::max(half, 0.0), label.middle + std::max(half, 0.0)),
      std::clamp(label.place->y, label.top, label.top + label.panel.height)};
  const double width = kLineWidth * height;
  canvas.line({{*label.place, width, 1}, {end, width, 1}}, kLeader);
  canvas.disc(*label.place, kEndRadius * height, kLeader);
  canvas.disc(*label.place, 0.6 * kEndRadius * height, kLeaderEnd);
}

void fill(const Ink& ink, Canvas& canvas) {
  canvas.rectangle({-1, -1}, {canvas.width() + 1.0, canvas.height() + 1.0}, 0, ink);
}

}  // namespace

void drawCaptions(const Scene& scene, const Frame& frame, const Lens& lens, const std::vector<PicturePart>& upperPanels,
                  Image& image) {
  Canvas canvas(image);
  const std::vector<PlacedPanel> panels =
      layOutCaptions(shownCaptions(scene, frame, lens), upperPanels, lens.width, lens.height);
  for (const PlacedPanel& panel : panels)
    if (panel.place) drawLeader(panel, lens.height, canvas);
  for (const PlacedPanel& panel : panels) drawTextPanel(canvas, panel.panel, panel.middle, panel.top);
}

Image drawHeading(const std::string& text, int width, int height) {
  Image image(width, height);
  Canvas canvas(image);
  fill(kCardGround, canvas);
  const TextSize size = crispTextSize(kHeadingText * height);
  const std::string line = fittedText(text, size, kWidestHeading * width);
  drawText(canvas, line, size, {(width - textWidth(line, size)) / 2, (height + size.ascent) / 2}, kTitle);
  return image;
}

Image drawTitleCard(const TitleCard& card, int width, int height) {
  Image image(width, height);
  Canvas canvas(image);
  fill(kCardGround, canvas);
  const CardLayout layout = layOutCard(card, width, height);
  double baseline = (height - layout.height) / 2 + layout.titleSize.em;
  const auto write = [&](const std::vector<std::string>& lines, const TextSize& size, const Ink& ink) {
    for (const std::string& line : lines) {
      drawText(canvas, line, size, {(width - textWidth(line, size)) / 2, baseline}, ink);
      baseline += kWordLine * size.em;
    }
  };
  write(layout.title, layout.titleSize, kTitle);
  write(layout.subtitle, layout.subtitleSize, kSubtitle);
  return image;
}

}  // namespace cradle
