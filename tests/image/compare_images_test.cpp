#include "image/compare_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cradle {
namespace {

using ::testing::HasSubstr;

/// Two grey pictures of which `count` pixels differ by `difference` in the last channel.
ImageComparison compareWith(int width, int height, long count, int difference) {
  Image expected(width, height);
  std::fill(expected.pixels.begin(), expected.pixels.end(), std::uint8_t{100});
  Image actual = expected;
  for (long i = 0; i < count; ++i)
    actual.pixels[static_cast<std::size_t>(3 * i + 2)] = static_cast<std::uint8_t>(100 + difference);
  return compareImages(expected, actual);
}

TEST(CompareImages, EqualPicturesAreTheSame) {
  const ImageComparison result = compareWith(10, 10, 0, 0);
  EXPECT_TRUE(result.isSame);
  EXPECT_TRUE(result.passes);
  EXPECT_EQ(result.sentence, "equal");
}

TEST(CompareImages, DifferencesOfTwoLevelsAreRounding) {
  const ImageComparison result = compareWith(10, 10, 100, 2);
  EXPECT_FALSE(result.isSame);
  EXPECT_TRUE(result.passes);
  EXPECT_EQ(result.differingPixels, 100);
  EXPECT_EQ(result.visiblePixels, 0);
  EXPECT_EQ(result.largestDifference, 2);
}

TEST(CompareImages, SmallPictureMayDifferVisiblyInFourPixels) {
  EXPECT_TRUE(compareWith(10, 10, 4, 3).passes);
  EXPECT_FALSE(compareWith(10, 10, 5, 3).passes);
}

TEST(CompareImages, LargePictureMayDifferVisiblyInFiveOfHundredThousandPixels) {
  // 0.005 % of 1000 x 1000 are 50 pixels.
  EXPECT_TRUE(compareWith(1000, 1000, 50, 32).passes);
  EXPECT_FALSE(compareWith(1000, 1000, 51, 32).passes);
}

TEST(CompareImages, SmallPictureMayDifferStrikinglyInOnePixel) {
  EXPECT_TRUE(compareWith(10, 10, 1, 33).passes);
  EXPECT_FALSE(compareWith(10, 10, 2, 33).passes);
}

TEST(CompareImages, LargePictureMayDifferStrikinglyInOneOfHundredThousandPixels) {
  // 0.001 % of 1000 x 1000 are 10 pixels.
  EXPECT_TRUE(compareWith(1000, 1000, 10, 155).passes);
  EXPECT_FALSE(compareWith(1000, 1000, 11, 155).passes);
}

TEST(CompareImages, LimitsAreRoundedDown) {
  // 0.005 % of 1280 x 720 are 46.08 pixels, 0.001 % are 9.216.
  EXPECT_TRUE(compareWith(1280, 720, 46, 3).passes);
  EXPECT_FALSE(compareWith(1280, 720, 47, 3).passes);
  EXPECT_TRUE(compareWith(1280, 720, 9, 33).passes);
  EXPECT_FALSE(compareWith(1280, 720, 10, 33).passes);
}

TEST(CompareImages, OtherSizeNeverPasses) {
  const ImageComparison result = compareImages(Image(4, 3), Image(3, 4));
  EXPECT_FALSE(result.passes);
  EXPECT_THAT(result.sentence, HasSubstr("4x3"));
  EXPECT_THAT(result.sentence, HasSubstr("3x4"));
}

TEST(CompareImages, LimitsCanBeSet) {
  Image expected(10, 10), actual(10, 10);
  *actual.at(3, 4) = 7;
  const auto passes = [&](DifferenceLimit visible) {
    return compareImages(expected, actual, {visible, {255, 0, 0}}).passes;
  };
  EXPECT_TRUE(passes({7, 0, 0}));
  EXPECT_FALSE(passes({6, 0, 0}));
  EXPECT_TRUE(passes({6, 0.01, 0}));
  EXPECT_FALSE(passes({6, 0.0099, 0}));
}

TEST(CompareImages, WhereTheyDifferIsTheSmallestBox) {
  Image expected(10, 10), actual(10, 10);
  *actual.at(3, 7) = *actual.at(5, 2) = 1;
  const PixelBox where = compareImages(expected, actual).where;
  EXPECT_EQ(where.left, 3);
  EXPECT_EQ(where.right, 6);
  EXPECT_EQ(where.top, 2);
  EXPECT_EQ(where.bottom, 8);
}

TEST(AmplifiedDifference, LargestIsWhiteAndEqualIsBlack) {
  Image expected(2, 1), actual(2, 1);
  expected.pixels = {10, 20, 30, 100, 100, 100};
  actual.pixels = {10, 25, 28, 100, 100, 100};
  EXPECT_EQ(amplifiedDifference(expected, actual).pixels, (std::vector<std::uint8_t>{0, 255, 102, 0, 0, 0}));
}

}  // namespace
}  // namespace cradle
