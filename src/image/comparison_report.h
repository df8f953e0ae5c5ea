#pragma once

#include <string>
#include <vector>

#include "image/compare_images.h"

namespace cradle {

/// A picture that was compared: both files, or an empty path where one is missing.
struct ComparedPicture {
  std::string name, expectedPath, actualPath;
  ImageComparison comparison;  // of both; does not pass where one is missing
};

/// Writes a page that needs nothing else: which pictures fail, with figures, and those that differ most with the
/// expected picture, the actual one and the difference amplified, to swap in place. Same pictures, same bytes. Throws
/// Error(output) if it cannot be written; then nothing is left behind.
void writeComparisonReport(const std::vector<ComparedPicture>& pictures, const ImageLimits& limits,
                           const std::string& path);

/// Whether the file at `path` is such a page.
bool isComparisonReport(const std::string& path);

}  // namespace cradle
