#include "commands/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <vector>

#include "commands/comparison_texts.h"
#include "core/console.h"
#include "core/error.h"
#include "core/output_path.h"
#include "core/part_file.h"
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

/// A slip of the command line does not cost a file of another kind.
void requirePlace(const std::optional<std::string>& path, bool (*isOurs)(const std::string& path), const char* kind) {
  if (!path) return;
  requireWritableFile(*path);
  std::error_code failed;
  const auto size = fs::file_size(*path, failed);
  if (failed || size == 0 || isOurs(*path)) return;
  throw Error(ErrorKind::output, *path,
              fmt::format("is there, and is no {}: it is not replaced; give another name", kind));
}

PictureComparison comparePictures(std::vector<ComparedPicture> pictures, const CompareOptions& options) {
  PictureComparison found{std::move(pictures), parseLimits(options)};
  for (ComparedPicture& picture : found.pictures) comparePair(picture, found.limits);
  return found;
}

TrajectoryComparison compareTrajectoryFiles(const std::string& expected, const std::string& actual,
                                            const CompareOptions& options) {
  if (options.report) throw Error(ErrorKind::usage, "--report", "shows pictures; these are trajectories");
  if (!(options.tolerance >= 0 && std::isfinite(options.tolerance)))
    throw Error(ErrorKind::usage, "--tolerance", fmt::format("found {}; allowed are numbers >= 0", options.tolerance));
  return compareTrajectories(TrajectoryReader(expected), TrajectoryReader(actual), options.tolerance);
}

ComparedResults compareAny(const std::string& expected, const std::string& actual, const CompareOptions& options) {
  for (const std::string& path : {expected, actual}) requireFileOrFolder(path, ErrorKind::usage);
  if (fs::is_directory(expected) != fs::is_directory(actual))
    throw Error(ErrorKind::usage, actual, "a folder can only be compared with a folder");
  if (fs::is_directory(expected)) return {expected, actual, comparePictures(pairPictures(expected, actual), options)};
  if (isDatabaseFile(expected) || isDatabaseFile(actual))
    return {expected, actual, compareTrajectoryFiles(expected, actual, options)};
  const std::string name = fs::path(actual).filename().string();
  return {expected, actual, comparePictures({{name, expected, actual, {}}}, options)};
}

}  // namespace

void compareResults(const std::string& expected, const std::string& actual, const CompareOptions& options) {
  if (options.report && options.junit &&
      fs::path(*options.report).lexically_normal() == fs::path(*options.junit).lexically_normal())
    throw Error(ErrorKind::usage, "--junit", "is the file of --report, too; give another name");
  requirePlace(options.report, isComparisonReport, "report of pictures");
  requirePlace(options.junit, isJunitReport, "report of a comparison");
  const ComparedResults results = compareAny(expected, actual, options);
  if (options.report) {
    const auto& found = std::get<PictureComparison>(results.found);
    writeComparisonReport(found.pictures, found.limits, *options.report);
  }
  if (options.junit) writeWholeFile(*options.junit, junitOf(results));
  if (options.asJson) {
    showText(stdout, jsonOf(results));
  } else {
    showText(stdout, describe(results));
    if (options.report) show("{} shows them\n", printableLine(*options.report));
    if (results.passes()) show("the same\n");
  }
  if (!results.passes()) throw Error(ErrorKind::different, "", fmt::format("{} differs from {}", actual, expected));
}

}  // namespace cradle
