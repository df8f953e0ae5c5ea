#include "commands/comparison_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/markup.h"
#include "core/printable.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxListed = 10;  // pictures of which a person is told
constexpr std::size_t kMaxNamed = 3;    // of them by name in a command
constexpr std::string_view kJunitHead =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"cradle compare\">";

bool fails(const ComparedPicture& picture) {
  return !picture.comparison.passes;
}
bool isMissing(const ComparedPicture& picture) {
  return picture.actualPath.empty();
}
bool isUnexpected(const ComparedPicture& picture) {
  return picture.expectedPath.empty();
}

/// As one word for a shell, whatever is in it.
std::string quotedForShell(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

/// How pictures that differ become the expected ones, and missing ones no longer are.
std::string acceptance(const PictureComparison& found, const ComparedResults& results) {
  std::vector<std::string> drawn, missing;
  for (const ComparedPicture& picture : found.pictures) {
    if (isMissing(picture))
      missing.push_back(quotedForShell(picture.expectedPath));
    else if (fails(picture))
      drawn.push_back(quotedForShell(picture.actualPath));
  }
  std::string text;
  if (drawn.size() > kMaxNamed) drawn = {quotedForShell(results.actual) + "/*.png"};
  if (!drawn.empty())
    text += fmt::format("To accept what you have looked at and found right:\n  cp -- {} {}\n", fmt::join(drawn, " "),
                        quotedForShell(results.expected));
  if (missing.size() > kMaxNamed)
    text +=
        fmt::format("Those that are missing are expected as long as they are in {}\n", printableLine(results.expected));
  else if (!missing.empty())
    text += fmt::format("To expect what is missing no longer:\n  rm -- {}\n", fmt::join(missing, " "));
  return text;
}

std::string describe(const PictureComparison& found, const ComparedResults& results) {
  std::string text;
  std::size_t listed = 0;
  const auto list = [&](const ComparedPicture& picture) {
    if (++listed <= kMaxListed)
      text += fmt::format("{}: {}\n", printableLine(picture.name), picture.comparison.sentence);
  };
  const auto missing = std::ranges::count_if(found.pictures, isMissing);
  const auto unexpected = std::ranges::count_if(found.pictures, isUnexpected);
  const auto isRounded = [](const ComparedPicture& picture) {
    return picture.comparison.passes && !picture.comparison.isSame;
  };
  const auto failing = std::ranges::count_if(found.pictures, fails);
  const auto rounded = std::ranges::count_if(found.pictures, isRounded);
  for (const ComparedPicture& picture : found.pictures)
    if (fails(picture)) list(picture);
  for (const ComparedPicture& picture : found.pictures)
    if (isRounded(picture)) list(picture);
  if (listed > kMaxListed) text += fmt::format("and {} more\n", listed - kMaxListed);
  text += fmt::format("{} of {} pictures differ", failing, found.pictures.size());
  if (missing > 0) text += fmt::format("; {} missing", missing);
  if (unexpected > 0) text += fmt::format("; {} not expected", unexpected);
  if (rounded > 0) text += fmt::format("; {} as rounding does, which passes", rounded);
  text += '\n';
  if (missing == std::ssize(found.pictures))
    return fmt::format("{}: nothing was drawn, {} pictures are expected\n", printableLine(results.actual), missing);
  return text + acceptance(found, results);
}

std::string describe(const TrajectoryComparison& found, const ComparedResults&) {
  return found.describe() + '\n';
}

Json pathOrNull(const std::string& path) {
  return path.empty() ? Json(nullptr) : Json(path);
}

Json jsonOf(const DifferenceLimit& limit) {
  return {{"level", limit.level}, {"share", limit.share}, {"always", limit.always}};
}

Json jsonOf(const ComparedPicture& picture) {
  const ImageComparison& found = picture.comparison;
  Json json = {{"name", picture.name},
               {"expected", pathOrNull(picture.expectedPath)},
               {"actual", pathOrNull(picture.actualPath)},
               {"passes", found.passes},
               {"same", found.isSame},
               {"found", found.sentence}};
  if (isMissing(picture) || isUnexpected(picture)) return json;
  json["differingPixels"] = found.differingPixels;
  json["visiblePixels"] = found.visiblePixels;
  json["strikingPixels"] = found.strikingPixels;
  json["largestDifference"] = found.largestDifference;
  json["where"] = {{"left", found.where.left},
                   {"top", found.where.top},
                   {"right", found.where.right},
                   {"bottom", found.where.bottom}};
  return json;
}

Json jsonOf(const PictureComparison& found) {
  Json pictures = Json::array();
  for (const ComparedPicture& picture : found.pictures) pictures.push_back(jsonOf(picture));
  return {{"limits", {{"visible", jsonOf(found.limits.visible)}, {"striking", jsonOf(found.limits.striking)}}},
          {"pictures", pictures}};
}

Json jsonOf(const TrajectoryComparison& found) {
  Json bodies = Json::array();
  for (const BodyDifference& body : found.bodies)
    bodies.push_back({{"body", body.body},
                      {"position", body.position},
                      {"orientation", body.orientation},
                      {"linearVelocity", body.linearVelocity},
                      {"angularVelocity", body.angularVelocity}});
  Json json = {{"sameStateHash", found.sameStateHash},
               {"tolerance", found.tolerance},
               {"frames",
                {{"expected", found.expectedFrames},
                 {"actual", found.actualFrames},
                 {"common", found.sameStateHash ? found.expectedFrames : found.commonFrames}}},
               {"bodies", bodies},
               {"onlyExpected", found.onlyExpected},
               {"onlyActual", found.onlyActual},
               {"worst", nullptr}};
  if (found.worst.difference > 0)
    json["worst"] = {{"body", found.worst.body},
                     {"quantity", found.worst.quantity},
                     {"frame", found.worst.frame},
                     {"time", found.worst.time},
                     {"difference", found.worst.difference}};
  return json;
}

struct JunitCase {
  std::string name, failure;  // empty: it passes
};

std::vector<JunitCase> casesOf(const PictureComparison& found, const ComparedResults&) {
  std::vector<JunitCase> cases;
  for (const ComparedPicture& picture : found.pictures)
    cases.push_back({picture.name, fails(picture) ? picture.comparison.sentence : ""});
  return cases;
}

std::vector<JunitCase> casesOf(const TrajectoryComparison& found, const ComparedResults& results) {
  return {{fs::path(results.actual).filename().string(), found.equal ? "" : found.describe()}};
}

std::string escapedLines(const std::string& text) {
  std::string lines;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (begin > 0) lines += '\n';
    lines += escapedMarkup(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

}  // namespace

bool PictureComparison::passes() const {
  return std::ranges::none_of(pictures, fails);
}

bool ComparedResults::passes() const {
  if (const auto* ofPictures = std::get_if<PictureComparison>(&found)) return ofPictures->passes();
  return std::get<TrajectoryComparison>(found).equal;
}

std::string describe(const ComparedResults& results) {
  return std::visit([&](const auto& found) { return describe(found, results); }, results.found);
}

std::string jsonOf(const ComparedResults& results) {
  Json json = {{"expected", results.expected}, {"actual", results.actual}, {"passes", results.passes()}};
  json.update(std::visit([](const auto& found) { return jsonOf(found); }, results.found));
  return json.dump(2, ' ', true, Json::error_handler_t::replace) + '\n';
}

std::string junitOf(const ComparedResults& results) {
  const std::vector<JunitCase> cases =
      std::visit([&](const auto& found) { return casesOf(found, results); }, results.found);
  const auto failures = std::ranges::count_if(cases, [](const JunitCase& test) { return !test.failure.empty(); });
  const std::string suite = escapedMarkup(results.expected);
  std::string text(kJunitHead);
  text +=
      fmt::format("\n  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"0\" time=\"0\">\n",
                  suite, cases.size(), failures);
  for (const JunitCase& test : cases) {
    text += fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"0\"", suite, escapedMarkup(test.name));
    text += test.failure.empty() ? "/>\n"
                                 : fmt::format(">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                                               escapedMarkup(test.failure.substr(0, test.failure.find('\n'))),
                                               escapedLines(test.failure));
  }
  return text + "  </testsuite>\n</testsuites>\n";
}

bool isJunitReport(const std::string& path) {
  std::string start(kJunitHead.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  return file.read(start.data(), static_cast<std::streamsize>(start.size())) && start == kJunitHead;
}

}  // namespace cradle
