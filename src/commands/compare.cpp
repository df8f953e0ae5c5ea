#include "commands/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/error.h"
#include "image/compare_images.h"
#include "image/png.h"
#include "trajectory/compare_trajectories.h"
#include "trajectory/export.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

/// Names of the PNG files of a folder, sorted.
std::vector<std::string> pictureNames(const std::string& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".png") names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

bool compareImageFiles(const std::string& expected, const std::string& actual) {
  const ImageComparison comparison = compareImages(readPng(expected), readPng(actual));
  if (!comparison.isSame) fmt::print("{}: {}\n", actual, comparison.sentence);
  return comparison.passes;
}

bool compareFolders(const std::string& expected, const std::string& actual) {
  const std::vector<std::string> names = pictureNames(expected), others = pictureNames(actual);
  if (names.empty()) throw Error(ErrorKind::usage, expected, "has no PNG files to compare with");
  long different = 0;
  for (const std::string& name : names) {
    if (!std::binary_search(others.begin(), others.end(), name)) {
      fmt::print("{}: missing\n", (fs::path(actual) / name).string());
      ++different;
    } else if (!compareImageFiles((fs::path(expected) / name).string(), (fs::path(actual) / name).string())) {
      ++different;
    }
  }
  for (const std::string& name : others) {
    if (std::binary_search(names.begin(), names.end(), name)) continue;
    fmt::print("{}: not expected\n", (fs::path(actual) / name).string());
    ++different;
  }
  fmt::print("{} of {} pictures differ\n", different, names.size());
  return different == 0;
}

bool compareTrajectoryFiles(const std::string& expected, const std::string& actual, double tolerance) {
  if (!(tolerance >= 0))
    throw Error(ErrorKind::usage, "--tolerance", fmt::format("found {}; allowed are numbers >= 0", tolerance));
  const TrajectoryComparison comparison =
      compareTrajectories(TrajectoryReader(expected), TrajectoryReader(actual), tolerance);
  fmt::print("{}\n", comparison.describe());
  return comparison.equal;
}

bool compareAny(const std::string& expected, const std::string& actual, double tolerance) {
  for (const std::string& path : {expected, actual})
    if (!fs::exists(path)) throw Error(ErrorKind::usage, path, "does not exist");
  if (fs::is_directory(expected) != fs::is_directory(actual))
    throw Error(ErrorKind::usage, actual, "a folder can only be compared with a folder");
  if (fs::is_directory(expected)) return compareFolders(expected, actual);
  if (isTrajectoryFile(expected) && isTrajectoryFile(actual))
    return compareTrajectoryFiles(expected, actual, tolerance);
  return compareImageFiles(expected, actual);
}

}  // namespace

void compareResults(const std::string& expected, const std::string& actual, double tolerance) {
  if (!compareAny(expected, actual, tolerance))
    throw Error(ErrorKind::different, "", fmt::format("{} differs from {}", actual, expected));
  fmt::print("the same\n");
}

void exportTrajectory(const std::string& trajectory, const std::string& output) {
  if (fs::path(output).extension() != ".csv")
    throw Error(ErrorKind::usage, output, "cannot tell the format from the name; allowed is FILE.csv");
  exportCsv(TrajectoryReader(trajectory), output);
}

}  // namespace cradle
