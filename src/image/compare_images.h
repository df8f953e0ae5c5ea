#pragma once

#include <string>

#include "image/image.h"

namespace cradle {

/// How two pictures differ, and whether that passes as rounding: pixels with a channel off by more than 2 are at most
/// max(0.005 %, 4 pixels), by more than 32 at most max(0.001 %, 1 pixel).
struct ImageComparison {
  bool isSame = false;        // every byte equal
  bool passes = false;        // equal, or within the limits above
  long differingPixels = 0;   // any channel off
  long visiblePixels = 0;     // a channel off by more than 2
  long strikingPixels = 0;    // a channel off by more than 32
  int largestDifference = 0;  // of any channel, 0..255
  std::string sentence;       // for the user
};

ImageComparison compareImages(const Image& expected, const Image& actual);

}  // namespace cradle
