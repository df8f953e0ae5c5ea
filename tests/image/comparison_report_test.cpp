#include "image/comparison_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/error.h"
#include "image/png.h"
#include "image/temporary_folder.h"
#include "image/test_pictures.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string textOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

long count(const std::string& text, const std::string& what) {
  long found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

/// `total` pictures, of which the last `different` have one pixel off by more than the limits allow.
std::vector<ComparedPicture> picturesIn(const TemporaryFolder& folder, int total, int different) {
  const Image expected = makeTestPicture(4, 3, 1);
  Image actual = expected;
  for (int i = 0; i < 6; ++i) actual.pixels[static_cast<std::size_t>(i)] ^= 0x80;
  writePng(expected, folder / "expected.png");
  writePng(actual, folder / "actual.png");
  std::vector<ComparedPicture> pictures;
  for (int i = 0; i < total; ++i) {
    const bool differs = i >= total - different;
    pictures.push_back({"p" + std::to_string(i), folder / "expected.png",
                        folder / (differs ? "actual.png" : "expected.png"),
                        compareImages(expected, differs ? actual : expected)});
  }
  return pictures;
}

TEST(ComparisonReport, ShowsOnlyWhatDiffers) {
  const TemporaryFolder folder;
  writeComparisonReport(picturesIn(folder, 5, 2), {}, folder / "r.html");
  const std::string page = textOf(folder / "r.html");
  EXPECT_THAT(page, HasSubstr("2 of 5 pictures fail"));
  EXPECT_EQ(count(page, "<section"), 2);
  EXPECT_EQ(count(page, "data:image/png"), 6);
  EXPECT_THAT(page, HasSubstr("<section id=\"p3\">"));
  EXPECT_THAT(page, Not(HasSubstr("<section id=\"p2\">")));
}

TEST(ComparisonReport, StaysOfASizeThatABrowserOpens) {
  const TemporaryFolder folder;
  writeComparisonReport(picturesIn(folder, 600, 600), {}, folder / "r.html");
  const std::string page = textOf(folder / "r.html");
  EXPECT_EQ(count(page, "<section"), 40);
  EXPECT_EQ(count(page, "<tr class=\"fails\">"), 600);
  EXPECT_THAT(page, HasSubstr("Of 600 pictures that differ, those 40 that differ most are shown."));
}

TEST(ComparisonReport, NamesAreText) {
  const TemporaryFolder folder;
  std::vector<ComparedPicture> pictures = picturesIn(folder, 1, 1);
  pictures[0].name = "<script>\"&";
  writeComparisonReport(pictures, {}, folder / "r.html");
  const std::string page = textOf(folder / "r.html");
  EXPECT_EQ(count(page, "<script>"), 1);  // the page's own
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;&quot;&amp;"));
}

TEST(ComparisonReport, NothingIsLeftWhereAPictureCannotBeRead) {
  const TemporaryFolder folder;
  std::vector<ComparedPicture> pictures = picturesIn(folder, 1, 1);
  pictures[0].actualPath = folder / "missing.png";
  EXPECT_THROW(writeComparisonReport(pictures, {}, folder / "r.html"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html"));
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html.part"));
}

TEST(ComparisonReport, PicturesOfMoreThan34MillionPixelsAreNotShown) {
  const TemporaryFolder folder;
  Image picture(16384, 2100);
  writePng(picture, folder / "a.png");
  picture.pixels[0] = 255;
  writePng(picture, folder / "b.png");
  ComparedPicture pair{"a.png", folder / "a.png", folder / "b.png", {}};
  pair.comparison.differingPixels = pair.comparison.largestDifference = 1;
  writeComparisonReport({pair}, {}, folder / "r.html");
  EXPECT_THAT(textOf(folder / "r.html"), HasSubstr("16384 x 2100 pixels are too many to be shown here"));
}

}  // namespace
}  // namespace cradle
