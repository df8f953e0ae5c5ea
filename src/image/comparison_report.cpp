#include "image/comparison_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "core/markup.h"
#include "core/part_file.h"
#include "image/png.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxShown =
    40;  // pictures, some 100 to 500 kB each at 1280x720: a browser opens the page at once

constexpr long kMaxShownPixels =
    34'000'000;  // of a picture, 8K: three of them are in memory, and a browser has them all

constexpr std::string_view kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Pictures compared</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 1320px; margin: 2em auto; padding: 0 1em; }
h2 { margin-top: 2em; }
.strip a, .strip i { display: inline-block; width: 14px; height: 22px; margin: 1px; background: #cfd6cf; }
.strip .passes { background: #e5c558; } .strip .fails { background: #c8372d; }
table { border-collapse: collapse; } td, th { padding: 2px 12px 2px 0; text-align: right; } td:first-child, th:first-child { text-align: left; }
.fails td:nth-child(2) { color: #c8372d; font-weight: bold; }
.view { position: relative; } .view img { width: 100%; display: none; cursor: pointer; }
.view[data-shown="0"] img:nth-of-type(1), .view[data-shown="1"] img:nth-of-type(2), .view[data-shown="2"] img:nth-of-type(3) { display: block; }
.view .box { position: absolute; outline: 2px solid #ff3bd4; outline-offset: 3px; pointer-events: none; }
button { font: inherit; margin: 0 6px 6px 0; padding: 2px 12px; } button.on { background: #264f8c; color: white; }
</style></head><body>
)";

constexpr std::string_view kTail = R"(<script>
for (const section of document.querySelectorAll("section")) {
  const view = section.querySelector(".view"), buttons = [...section.querySelectorAll("button")];
  if (!view) continue;
  const show = n => { view.dataset.shown = n; buttons.forEach((b, i) => b.classList.toggle("on", i === n)); };
  buttons.forEach((b, i) => b.onclick = () => show(i));
  view.onclick = () => show(view.dataset.shown === "0" ? 1 : 0);
  show(0);
}
</script></body></html>
)";

bool isShown(const ComparedPicture& picture) {
  return !picture.comparison.isSame && picture.comparison.differingPixels > 0;
}

/// Of those that can be shown, the ones that differ most, in the order of the pictures.
std::vector<const ComparedPicture*> chooseShown(const std::vector<ComparedPicture>& pictures) {
  std::vector<const ComparedPicture*> shown;
  for (const ComparedPicture& picture : pictures)
    if (isShown(picture)) shown.push_back(&picture);
  const auto differsMore = [](const ComparedPicture* a, const ComparedPicture* b) {
    if (a->comparison.passes != b->comparison.passes) return b->comparison.passes;
    return a->comparison.visiblePixels > b->comparison.visiblePixels;
  };
  std::stable_sort(shown.begin(), shown.end(), differsMore);
  shown.resize(std::min(shown.size(), kMaxShown));
  std::sort(shown.begin(), shown.end());
  return shown;
}

/// A cell for each picture, in their order: where in a film it fails.
std::string stripOf(const std::vector<ComparedPicture>& pictures, const std::vector<const ComparedPicture*>& shown) {
  std::string text = "<p class=\"strip\">";
  for (const ComparedPicture& picture : pictures) {
    const char* const kind = picture.comparison.isSame ? "same" : picture.comparison.passes ? "passes" : "fails";
    const bool hasSection = std::binary_search(shown.begin(), shown.end(), &picture);
    const std::string name = escapedMarkup(picture.name);
    text += hasSection ? fmt::format("<a href=\"#{0}\" class=\"{1}\" title=\"{0}\"></a>", name, kind)
                       : fmt::format("<i class=\"{1}\" title=\"{0}\"></i>", name, kind);
  }
  return text + "</p>\n<p>Grey: the same. Yellow: differs, and passes as rounding. Red: fails.</p>\n";
}

std::string tableOf(const std::vector<ComparedPicture>& pictures, const ImageLimits& limits) {
  std::string text = fmt::format(
      "<table><tr><th>picture</th><th></th><th>pixels that differ</th><th>by more than {}</th><th>by more than "
      "{}</th><th>largest difference</th></tr>\n",
      limits.visible.level, limits.striking.level);
  for (const ComparedPicture& picture : pictures) {
    const ImageComparison& found = picture.comparison;
    if (found.isSame) continue;
    text += fmt::format("<tr class=\"{}\"><td>{}</td><td>{}</td>", found.passes ? "passes" : "fails",
                        escapedMarkup(picture.name), found.passes ? "passes" : "fails");
    text += found.differingPixels > 0
                ? fmt::format("<td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", found.differingPixels,
                              found.visiblePixels, found.strikingPixels, found.largestDifference)
                : fmt::format("<td colspan=\"4\">{}</td></tr>\n", escapedMarkup(found.sentence));
  }
  return text + "</table>\n";
}

std::string imageTag(const Image& image, const char* what) {
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n", what, base64(encodePng(image)));
}

/// Both pictures and their difference, one above the other; where they differ is framed.
std::string sectionOf(const ComparedPicture& picture) {
  const PictureSize size = readPngSize(picture.expectedPath);
  if (long{size.width} * size.height > kMaxShownPixels)
    return fmt::format(
        "<section id=\"{0}\"><h2>{0}</h2><p>{1}</p><p>{2} x {3} pixels are too many to be shown here</p>"
        "</section>\n",
        escapedMarkup(picture.name), escapedMarkup(picture.comparison.sentence), size.width, size.height);
  const Image expected = readPng(picture.expectedPath), actual = readPng(picture.actualPath);
  const PixelBox& box = picture.comparison.where;
  const auto percent = [](int part, int whole) { return 100.0 * part / whole; };
  std::string text = fmt::format("<section id=\"{0}\"><h2>{0}</h2><p>{1}</p>\n", escapedMarkup(picture.name),
                                 escapedMarkup(picture.comparison.sentence));
  text += fmt::format(
      "<p>columns {} to {}, rows {} to {} from the top left; a click on the picture swaps</p>\n<p><button>expected"
      "</button><button>actual</button><button>difference, times {:.3g}</button></p>\n<div class=\"view\">",
      box.left, box.right - 1, box.top, box.bottom - 1, 255.0 / picture.comparison.largestDifference);
  text += imageTag(expected, "expected") + imageTag(actual, "actual");
  text += imageTag(amplifiedDifference(expected, actual), "difference");
  text += fmt::format("<div class=\"box\" style=\"left:{:.3f}%;top:{:.3f}%;width:{:.3f}%;height:{:.3f}%\"></div>",
                      percent(box.left, expected.width), percent(box.top, expected.height),
                      percent(box.right - box.left, expected.width), percent(box.bottom - box.top, expected.height));
  return text + "</div></section>\n";
}

}  // namespace

void writeComparisonReport(const std::vector<ComparedPicture>& pictures, const ImageLimits& limits,
                           const std::string& path) {
  const auto failing = std::count_if(pictures.begin(), pictures.end(),
                                     [](const ComparedPicture& picture) { return !picture.comparison.passes; });
  const auto differing = std::count_if(pictures.begin(), pictures.end(), isShown);
  const std::vector<const ComparedPicture*> shown = chooseShown(pictures);
  PartFile file(path);
  file.write(kHead);
  file.write(fmt::format("<h1>{} of {} pictures fail</h1>\n", failing, pictures.size()));
  file.write(fmt::format(
      "<p>A picture passes if at most {:g} % of its pixels ({} in a small one) have a channel off by more than {}, and "
      "{:g} % ({}) by more than {}.</p>\n",
      100 * limits.visible.share, limits.visible.always, limits.visible.level, 100 * limits.striking.share,
      limits.striking.always, limits.striking.level));
  file.write(stripOf(pictures, shown));
  file.write(tableOf(pictures, limits));
  if (shown.size() < static_cast<std::size_t>(differing))
    file.write(fmt::format("<p>Of {} pictures that differ, those {} that differ most are shown.</p>\n", differing,
                           shown.size()));
  for (const ComparedPicture* picture : shown) file.write(sectionOf(*picture));
  file.write(kTail);
  file.complete();
}

bool isComparisonReport(const std::string& path) {
  const std::string_view title = kHead.substr(0, kHead.find('\n', kHead.find("<title>")));
  std::string start(title.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  return file.read(start.data(), static_cast<std::streamsize>(start.size())) && start == title;
}

}  // namespace cradle
