#pragma once

#include <optional>
#include <vector>

#include "overlay/label_places.h"
#include "overlay/text_panel.h"
#include "scene/scene.h"

namespace cradle {

/// A caption on a picture.
struct ShownCaption {
  const Caption* caption = nullptr;
  std::optional<PicturePoint>
      place;  // of the centre of mass of its body; nothing if that is not seen, or there is none

  bool isLabel() const { return caption->body != kWorld; }
};

/// A caption's panel, where it is drawn (pixels).
struct PlacedPanel {
  TextPanel panel;
  double middle = 0, top = 0;         // of its width; its upper edge
  std::optional<PicturePoint> place;  // of a body, to which a line goes
};

/// The panels of captions, in their order but for those of bodies that are not seen: those of bodies beside them and
/// apart from each other, and below `panels` at the upper edge if that can be; others one above the other at the
/// bottom. Text is as large as lets all be in the picture.
std::vector<PlacedPanel> layOutCaptions(const std::vector<ShownCaption>& captions,
                                        const std::vector<PicturePart>& panels, int width, int height);

/// The size of a caption's panel with the smallest text (pixels).
struct CaptionExtent {
  bool isLabel = false;
  double width = 0, height = 0;
};
CaptionExtent leastExtent(const Caption& caption, int width, int height);

/// The height that captions need at the least, in their order and wherever bodies are, in terms of the height that
/// there is: they fit if it is 1 or less.
double neededHeight(const std::vector<CaptionExtent>& captions, int width, int height);

/// The lines of a title card.
struct CardLayout {
  TextSize titleSize, subtitleSize;
  std::vector<std::string> title, subtitle;
  double height = 0;  // of all lines (pixels)
  bool fits = false;  // into the picture
};

/// Text is as large as lets all lines be in the picture, without breaking words if that can be.
CardLayout layOutCard(const TitleCard& card, int width, int height);

}  // namespace cradle
