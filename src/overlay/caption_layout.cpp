#include "overlay/caption_layout.h"

#include <algorithm>
#include <iterator>
#include <sstream>

namespace cradle {
namespace {

// Of the picture's height.
constexpr double kCaptionText = 0.042, kLabelText = 0.032, kTitleText = 0.085, kSubtitleText = 0.045;
constexpr double kSmallestText = 0.028;                   // as that of plots: readable from a height of 360 pixels on
constexpr double kCaptionFromEdge = 0.035;                // of captions and cards
constexpr double kLabelAside = 0.05, kLabelAbove = 0.11;  // of a body's centre
constexpr double kLabelGap = 0.006;                       // between labels
constexpr double kCaptionGap = 0.5;                       // between captions, in em

LabelRoom roomOf(int width, int height) {
  const double edge = kCaptionFromEdge * height;
  return {{edge, edge, width - edge, height - edge}};
}

/// The height that the captions at the bottom take, with the gaps above them.
double heightAtBottom(const std::vector<ShownCaption>& captions, double em, int width, int height) {
  double sum = 0;
  for (const ShownCaption& shown : captions)
    if (!shown.isLabel())
      sum += textPanel(shown.caption->text, em, width, height).height + kCaptionGap * crispTextSize(em).em;
  return sum;
}

std::vector<TextPanel> labelPanels(const std::vector<ShownCaption>& captions, double em, int width, int height) {
  std::vector<TextPanel> panels;
  for (const ShownCaption& shown : captions)
    if (shown.isLabel()) panels.push_back(textPanel(shown.caption->text, em, width, height));
  return panels;
}

std::vector<Label> labelsOf(const std::vector<TextPanel>& panels) {
  std::vector<Label> labels;
  for (const TextPanel& panel : panels) labels.push_back({{}, panel.width, panel.height});
  return labels;
}

/// The height that rows of all labels take.
double heightOfRows(const std::vector<CaptionExtent>& captions, int width, int height) {
  std::vector<Label> labels;
  for (const CaptionExtent& extent : captions)
    if (extent.isLabel) labels.push_back({{}, extent.width, extent.height});
  return labels.empty() ? 0 : putInRows(roomOf(width, height), kLabelGap * height, labels);
}

std::vector<CaptionExtent> leastExtents(const std::vector<ShownCaption>& captions, int width, int height) {
  std::vector<CaptionExtent> extents;
  for (const ShownCaption& shown : captions) extents.push_back(leastExtent(*shown.caption, width, height));
  return extents;
}

/// Beside its body. At the edges of the room it is moved, not turned over, so that it does not jump.
void putBeside(const PicturePoint& place, const LabelRoom& room, int height, Label& label) {
  label.place = place;
  label.left = std::max(room.left, std::min(place.x + kLabelAside * height, room.right - label.width));
  label.top = std::max(room.top, std::min(place.y - kLabelAbove * height, room.bottom) - label.height);
}

/// Labels of the bodies that are seen, in text of one size; nothing if they do not fit without lying on each other.
std::optional<std::vector<PlacedPanel>> stackedLabels(const std::vector<ShownCaption>& captions, double em,
                                                      const LabelRoom& room, int width, int height) {
  std::vector<ShownCaption> seen;
  std::copy_if(captions.begin(), captions.end(), std::back_inserter(seen),
               [](const ShownCaption& shown) { return shown.isLabel() && shown.place; });
  const std::vector<TextPanel> panels = labelPanels(seen, em, width, height);
  std::vector<Label> labels = labelsOf(panels);
  for (std::size_t i = 0; i < seen.size(); ++i) putBeside(*seen[i].place, room, height, labels[i]);
  if (!stackLabels(room, kLabelGap * height, labels)) return std::nullopt;
  std::vector<PlacedPanel> placed;
  for (std::size_t i = 0; i < seen.size(); ++i)
    placed.push_back({panels[i], labels[i].left + labels[i].width / 2, labels[i].top, seen[i].place});
  return placed;
}

/// Rows have places for labels of bodies that are not seen, too: no label moves when another appears.
std::vector<PlacedPanel> labelsInRows(const std::vector<ShownCaption>& captions, const LabelRoom& room, int width,
                                      int height) {
  const std::vector<TextPanel> panels = labelPanels(captions, kSmallestText * height, width, height);
  std::vector<Label> labels = labelsOf(panels);
  putInRows(room, kLabelGap * height, labels);
  std::vector<PlacedPanel> placed;
  std::size_t next = 0;
  for (const ShownCaption& shown : captions) {
    if (!shown.isLabel()) continue;
    const std::size_t i = next++;
    if (shown.place) placed.push_back({panels[i], labels[i].left + labels[i].width / 2, labels[i].top, shown.place});
  }
  return placed;
}

/// In the largest text that lets all be apart.
std::vector<PlacedPanel> placedLabels(const std::vector<ShownCaption>& captions, LabelRoom room, int width,
                                      int height) {
  std::optional<std::vector<PlacedPanel>> placed;
  const auto fits = [&](double em) {
    placed = stackedLabels(captions, em, room, width, height);
    return placed.has_value();
  };
  const auto place = [&] { fits(fittingEm(kLabelText * height, kSmallestText * height, fits)); };
  place();
  if (!placed && !room.panels.empty()) room.panels.clear(), place();
  return placed ? *placed : labelsInRows(captions, room, width, height);
}

CardLayout cardOfSize(const TitleCard& card, double shrink, int width, int height) {
  CardLayout layout;
  const auto sizeOf = [&](double text) { return crispTextSize(std::max(shrink * text, kSmallestText) * height); };
  const double widest = widestText(width, height);
  layout.titleSize = sizeOf(kTitleText), layout.subtitleSize = sizeOf(kSubtitleText);
  layout.title = wrappedText(card.title, layout.titleSize, widest);
  layout.subtitle = wrappedText(card.subtitle, layout.subtitleSize, widest);
  layout.height = kWordLine * (layout.titleSize.em * static_cast<double>(layout.title.size()) +
                               layout.subtitleSize.em * static_cast<double>(layout.subtitle.size()));
  layout.fits = layout.height <= (1 - 2 * kCaptionFromEdge) * height;
  return layout;
}

/// Whether no word of a text is wider than a line.
bool hasWholeWords(const std::string& text, const TextSize& size, double width) {
  std::istringstream words(text);
  return std::all_of(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>(),
                     [&](const std::string& word) { return textWidth(word, size) <= width; });
}

}  // namespace

std::vector<PlacedPanel> layOutCaptions(const std::vector<ShownCaption>& captions,
                                        const std::vector<PicturePart>& panels, int width, int height) {
  LabelRoom room = roomOf(width, height);
  room.panels = panels;
  const double forLabels = heightOfRows(leastExtents(captions, width, height), width, height);
  const double em = fittingEm(kCaptionText * height, kSmallestText * height, [&](double tried) {
    const double gap = forLabels > 0 ? 0 : kCaptionGap * crispTextSize(tried).em;
    return heightAtBottom(captions, tried, width, height) - gap + forLabels <= room.bottom - room.top;
  });
  std::vector<PlacedPanel> placed;
  for (auto shown = captions.rbegin(); shown != captions.rend(); ++shown) {
    if (shown->isLabel()) continue;
    const TextPanel panel = textPanel(shown->caption->text, em, width, height);
    placed.push_back({panel, width / 2.0, room.bottom - panel.height, std::nullopt});
    room.bottom = placed.back().top - kCaptionGap * panel.size.em;
  }
  const std::vector<PlacedPanel> labels = placedLabels(captions, room, width, height);
  placed.insert(placed.end(), labels.begin(), labels.end());
  return placed;
}

CaptionExtent leastExtent(const Caption& caption, int width, int height) {
  const TextPanel panel = textPanel(caption.text, kSmallestText * height, width, height);
  return {caption.body != kWorld, panel.width, panel.height};
}

double neededHeight(const std::vector<CaptionExtent>& captions, int width, int height) {
  const LabelRoom room = roomOf(width, height);
  const double gap = kCaptionGap * crispTextSize(kSmallestText * height).em,
               rows = heightOfRows(captions, width, height);
  double needed = rows > 0 ? rows : -gap;
  for (const CaptionExtent& extent : captions)
    if (!extent.isLabel) needed += extent.height + gap;
  return needed / (room.bottom - room.top);
}

CardLayout layOutCard(const TitleCard& card, int width, int height) {
  constexpr double kMinShrinkRatio = kSmallestText / kTitleText;
  const double widest = widestText(width, height);
  CardLayout layout;
  for (const bool breaksWords : {false, true}) {
    const double shrink = fittingEm(1, kMinShrinkRatio, [&](double tried) {
      const CardLayout sized = cardOfSize(card, tried, width, height);
      return sized.fits && (breaksWords || (hasWholeWords(card.title, sized.titleSize, widest) &&
                                            hasWholeWords(card.subtitle, sized.subtitleSize, widest)));
    });
    layout = cardOfSize(card, shrink, width, height);
    if (layout.fits && shrink > kMinShrinkRatio) break;
  }
  return layout;
}

}  // namespace cradle
