#include "commands/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <vector>

#include "core/console.h"
#include "core/error.h"
#include "core/output_path.h"
#include "core/printable.h"
#include "core/read_file.h"
#include "image/comparison_report.h"
#include "image/png.h"
#include "trajectory/compare_trajectories.h"
#include "trajectory/trajectory_file.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

/// Names of the PNG files of a folder, sorted.
std::vector<std::string> pictureNames(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed))
    if (entry->path().extension() == ".png") names.push_back(entry->path().filename().string());
  if (failed) throw Error(ErrorKind::usage, folder, "cannot be read: " + failed.message());
  std::sort(names.begin(), names.end());
  return names;
}

/// "LEVEL:PERCENT". Nothing passes beyond what is written: no pixels are allowed in addition in small pictures.
DifferenceLimit parseLimit(const std::string& text, const char* option) {
  const char *begin = text.data(), *end = begin + text.size();
  DifferenceLimit limit{0, 0, 0};
  double percent = -1;
  const auto level = std::from_chars(begin, end, limit.level);
  if (level.ec == std::errc() && level.ptr != end && *level.ptr == ':') {
    const auto share = std::from_chars(level.ptr + 1, end, percent);
    if (share.ec != std::errc() || share.ptr != end) percent = -1;
  }
  if (!(percent >= 0 && percent <= 100) || limit.level < 0 || limit.level > 255)
    throw Error(ErrorKind::usage, option,
                fmt::format("found \"{}\"; allowed is LEVEL:PERCENT, as 2:0.005: the largest difference of a channel "
                            "that does not count, 0 to 255, and the pixels in percent that may differ by more",
                            text));
  limit.share = percent / 100;
  return limit;
}

ImageLimits parseLimits(const CompareOptions& options) {
  ImageLimits limits;
  if (options.visible) limits.visible = parseLimit(*options.visible, "--visible");
  if (options.striking) limits.striking = parseLimit(*options.striking, "--striking");
  return limits;
}

/// Pictures of the expected folder, or else of the actual one, by name.
std::vector<ComparedPicture> pairPictures(const std::string& expected, const std::string& actual) {
  const std::vector<std::string> names = pictureNames(expected), others = pictureNames(actual);
  if (names.empty()) throw Error(ErrorKind::usage, expected, "has no PNG files to compare with");
  std::vector<std::string> all;
  std::set_union(names.begin(), names.end(), others.begin(), others.end(), std::back_inserter(all));
  std::vector<ComparedPicture> pairs;
  for (const std::string& name : all) {
    ComparedPicture pair{name, {}, {}, {}};
    if (std::binary_search(names.begin(), names.end(), name)) pair.expectedPath = (fs::path(expected) / name).string();
    if (std::binary_search(others.begin(), others.end(), name)) pair.actualPath = (fs::path(actual) / name).string();
    pairs.push_back(pair);
  }
  return pairs;
}

/// Pictures of two sizes are told apart by their headers; of others only a row is held at a time.
ImageComparison compareFiles(const std::string& expected, const std::string& actual, const ImageLimits& limits) {
  PngRows a(expected), b(actual);
  if (const auto different = compareSizes(a.size(), b.size())) return *different;
  RowComparison rows(a.size(), limits);
  for (int y = 0; y < a.size().height; ++y) {
    const std::uint8_t *rowOfA = a.next(), *rowOfB = b.next();
    rows.add(rowOfA, rowOfB);
  }
  return rows.result();
}

void comparePair(ComparedPicture& pair, const ImageLimits& limits) {
  if (pair.actualPath.empty())
    pair.comparison.sentence = "missing";
  else if (pair.expectedPath.empty())
    pair.comparison.sentence = "not expected";
  else
    pair.comparison = compareFiles(pair.expectedPath, pair.actualPath, limits);
}

/// As one word for a shell, whatever is in it.
std::string quotedForShell(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

void printAcceptance(const std::vector<ComparedPicture>& pictures, const std::string& expected) {
  show("To accept what you have looked at and found right:\n");
  for (const ComparedPicture& picture : pictures) {
    if (picture.comparison.passes) continue;
    if (picture.actualPath.empty())
      show("  rm {}\n", quotedForShell(picture.expectedPath));
    else
      show("  cp {} {}\n", quotedForShell(picture.actualPath),
           quotedForShell(picture.expectedPath.empty() ? expected : picture.expectedPath));
  }
}

/// A slip of the command line does not cost a file of another kind.
void requireReportPlace(const std::string& path) {
  requireWritableFile(path);
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed || size == 0 || isComparisonReport(path)) return;
  throw Error(ErrorKind::output, path, "is there, and is no report of pictures: it is not replaced; give another name");
}

/// All pictures of both, compared; the outcome is printed, and shown in the report if one is asked for.
bool comparePictures(std::vector<ComparedPicture> pictures, const std::string& expected,
                     const CompareOptions& options) {
  const ImageLimits limits = parseLimits(options);
  if (options.report) requireReportPlace(*options.report);
  long different = 0;
  for (ComparedPicture& picture : pictures) {
    comparePair(picture, limits);
    if (!picture.comparison.isSame)
      show("{}: {}\n", printableLine(picture.actualPath.empty() ? picture.name : picture.actualPath),
           picture.comparison.sentence);
    different += !picture.comparison.passes;
  }
  show("{} of {} pictures differ\n", different, pictures.size());
  if (options.report) {
    writeComparisonReport(pictures, limits, *options.report);
    show("{}\n", printableLine(*options.report));
  }
  if (different > 0) printAcceptance(pictures, expected);
  return different == 0;
}

bool compareTrajectoryFiles(const std::string& expected, const std::string& actual, double tolerance) {
  if (!(tolerance >= 0))
    throw Error(ErrorKind::usage, "--tolerance", fmt::format("found {}; allowed are numbers >= 0", tolerance));
  const TrajectoryComparison comparison =
      compareTrajectories(TrajectoryReader(expected), TrajectoryReader(actual), tolerance);
  show("{}\n", comparison.describe());
  return comparison.equal;
}

bool compareAny(const std::string& expected, const std::string& actual, const CompareOptions& options) {
  for (const std::string& path : {expected, actual}) requireFileOrFolder(path, ErrorKind::usage);
  if (fs::is_directory(expected) != fs::is_directory(actual))
    throw Error(ErrorKind::usage, actual, "a folder can only be compared with a folder");
  if (fs::is_directory(expected)) return comparePictures(pairPictures(expected, actual), expected, options);
  if (isDatabaseFile(expected) || isDatabaseFile(actual)) {
    if (options.report) throw Error(ErrorKind::usage, "--report", "shows pictures; these are trajectories");
    return compareTrajectoryFiles(expected, actual, options.tolerance);
  }
  const std::string name = fs::path(actual).filename().string();
  return comparePictures({{name, expected, actual, {}}}, expected, options);
}

}  // namespace

void compareResults(const std::string& expected, const std::string& actual, const CompareOptions& options) {
  if (!compareAny(expected, actual, options))
    throw Error(ErrorKind::different, "", fmt::format("{} differs from {}", actual, expected));
  show("the same\n");
}

}  // namespace cradle
