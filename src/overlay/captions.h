#pragma once

#include <string>

#include "image/image.h"
#include "overlay/label_places.h"
#include "overlay/lens.h"
#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Draws the captions of a scene that are shown at a frame's time on its finished picture: those of bodies beside them,
/// with a line to the centre of mass, and not on `panels` at the upper edge if that can be; others one above the other
/// at the bottom, in the order of the file.
void drawCaptions(const Scene& scene, const Frame& frame, const Lens& lens, const std::vector<PicturePart>& panels,
                  Image& image);

/// A strip with a line of text, to stand above a picture.
Image drawHeading(const std::string& text, int width, int height);

/// The picture that a film begins with.
Image drawTitleCard(const TitleCard& card, int width, int height);

}  // namespace cradle
