#pragma once

#include <string>
#include <variant>
#include <vector>

#include "image/comparison_report.h"
#include "trajectory/compare_trajectories.h"

namespace cradle {

/// Pictures of a folder, or one, against those expected.
struct PictureComparison {
  std::vector<ComparedPicture> pictures;
  ImageLimits limits;

  bool passes() const;
};

/// Two results of which one is expected to be as the other.
struct ComparedResults {
  std::string expected, actual;  // paths
  std::variant<PictureComparison, TrajectoryComparison> found;

  bool passes() const;
};

/// A few lines on what differs, and how it is accepted, for a person; each ends with a newline.
std::string describe(const ComparedResults& results);

/// All that was found, as a JSON object.
std::string jsonOf(const ComparedResults& results);

/// The same as a report in the format of JUnit, which services of continuous integration show: a test case for each
/// picture, or one for a trajectory.
std::string junitOf(const ComparedResults& results);

/// Whether the file at `path` is such a report.
bool isJunitReport(const std::string& path);

}  // namespace cradle
