#pragma once

#include <optional>
#include <string>

namespace cradle {

/// What the command line says about a comparison; empty: the defaults of image/compare_images.h.
struct CompareOptions {
  double tolerance = 0;                          // of trajectories
  std::optional<std::string> visible, striking;  // "LEVEL:PERCENT"
  std::optional<std::string> report;             // page to write, of pictures
  std::optional<std::string> junit;              // report to write, for continuous integration
  bool asJson = false;
};

/// `cradle compare EXPECTED ACTUAL`: two images, two folders of images, or two trajectories. Prints what was found to
/// stdout, in words, with how new pictures are accepted, or as JSON; throws Error(different) if they differ.
void compareResults(const std::string& expected, const std::string& actual, const CompareOptions& options);

}  // namespace cradle
