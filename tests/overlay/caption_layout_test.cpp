#include "overlay/caption_layout.h"

#include <gtest/gtest.h>

namespace cradle {
namespace {

/// Of captions whose bodies are seen at `places`; those without are at the bottom.
class CaptionPlaces : public ::testing::TestWithParam<std::pair<int, int>> {
 protected:
  void add(const std::string& text, std::optional<PicturePoint> place = std::nullopt) {
    captions_.push_back({text, 0, 9, place ? 0 : kWorld});
    places_.push_back(place);
  }

  std::vector<PlacedPanel> placed() const { return layOutCaptions(shown(), panels_, width_, height_); }

  std::vector<ShownCaption> shown() const {
    std::vector<ShownCaption> shown;
    for (std::size_t i = 0; i < captions_.size(); ++i) shown.push_back({&captions_[i], places_[i]});
    return shown;
  }

  double needed() const {
    std::vector<CaptionExtent> extents;
    for (const Caption& caption : captions_) extents.push_back(leastExtent(caption, width_, height_));
    return neededHeight(extents, width_, height_);
  }

  /// In the picture, and none on another.
  void expectReadable() const {
    const std::vector<PlacedPanel> panels = placed();
    const auto left = [](const PlacedPanel& panel) { return panel.middle - panel.panel.width / 2; };
    EXPECT_EQ(panels.size(), captions_.size());
    for (std::size_t i = 0; i < panels.size(); ++i) {
      EXPECT_GE(left(panels[i]), 0) << i;
      EXPECT_LE(left(panels[i]) + panels[i].panel.width, width_) << i;
      EXPECT_GE(panels[i].top, 0) << i;
      EXPECT_LE(panels[i].top + panels[i].panel.height, height_) << i;
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_FALSE(left(panels[i]) < left(panels[j]) + panels[j].panel.width &&
                     left(panels[j]) < left(panels[i]) + panels[i].panel.width &&
                     panels[i].top < panels[j].top + panels[j].panel.height &&
                     panels[j].top < panels[i].top + panels[i].panel.height)
            << captions_[i].text << " on " << captions_[j].text;
    }
  }

  int width_ = GetParam().first, height_ = GetParam().second;
  std::vector<PicturePart> panels_;
  std::vector<Caption> captions_;
  std::vector<std::optional<PicturePoint>> places_;
};

INSTANTIATE_TEST_SUITE_P(Pictures, CaptionPlaces,
                         ::testing::Values(std::pair(1280, 720), std::pair(640, 360), std::pair(360, 640),
                                           std::pair(480, 480)));

TEST_P(CaptionPlaces, LabelsOfBodiesNearEachOtherAreApart) {
  for (int i = 0; i < 6; ++i)
    add("The body number " + std::to_string(i), PicturePoint{width_ / 2.0 + 8 * i, height_ / 2.0 + i % 2});
  expectReadable();
}

TEST_P(CaptionPlaces, LabelsStandAboveCaptions) {
  for (int i = 0; i < 4; ++i)
    add("A caption that is rather long, so that it is as wide as the picture is at " + std::to_string(i));
  for (int i = 0; i < 5; ++i) add("low", PicturePoint{width_ / 2.0, height_ - 3.0 * i});
  expectReadable();
}

TEST_P(CaptionPlaces, LabelsInTheCornersAreInThePicture) {
  for (const double x : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      for (int i = 0; i < 3; ++i) add("corner", PicturePoint{x * width_, y * height_});
  expectReadable();
}

// Below a panel of a quarter of the picture there is room; one of half of it has to bear them.
TEST_P(CaptionPlaces, LabelsAreBelowPanelsIfThatCanBe) {
  for (int i = 0; i < 3; ++i) add("body", PicturePoint{0.6 * width_ + i, 0.3 * height_});
  for (const double part : {0.5, 1.0}) {
    panels_ = {{0.5 * width_, 0, 1.0 * width_, part * height_}};
    expectReadable();
    if (part == 1) break;
    for (const PlacedPanel& panel : placed()) EXPECT_GT(panel.top, part * height_);
  }
}

TEST_P(CaptionPlaces, ManyCaptionsAreSmaller) {
  add("One of them");
  const double usual = placed()[0].panel.size.em;
  for (int i = 0; i < 13; ++i) add("One of them");
  EXPECT_LE(needed(), 1);
  EXPECT_LT(placed()[0].panel.size.em, usual);
  expectReadable();
}

// Thirty labels of one place are more than a column holds.
TEST_P(CaptionPlaces, LabelsThatFillThePictureAreInRows) {
  for (int i = 0; i < 30; ++i) add("label", PicturePoint{width_ / 2.0, height_ / 2.0});
  EXPECT_LE(needed(), 1);
  expectReadable();
}

TEST_P(CaptionPlaces, WhatIsFullIsKnown) {
  while (needed() <= 1) {
    ASSERT_LT(captions_.size(), 100u);
    expectReadable();
    add("And another one");
  }
  EXPECT_GE(captions_.size(), 15u);
}

TEST_P(CaptionPlaces, WordsThatAreWiderThanThePictureAreBroken) {
  add(std::string(250, 'w'));
  add(std::string(120, 'm'), PicturePoint{10, height_ / 2.0});
  EXPECT_LE(needed(), 1);
  expectReadable();
}

TEST_P(CaptionPlaces, TitlesOfAnyLengthFit) {
  std::string words;
  while (words.size() < 240) words += "Gyroscopes ";
  for (const TitleCard& card : {TitleCard{words, words, 3}, TitleCard{std::string(250, 'W'), "", 3},
                                TitleCard{"Pneumonoultramicroscopic things", words, 3}}) {
    const CardLayout layout = layOutCard(card, width_, height_);
    EXPECT_TRUE(layout.fits);
    EXPECT_LE(layout.height, height_);
    for (const std::string& line : layout.title) EXPECT_LE(textWidth(line, layout.titleSize), 0.87 * width_) << line;
    for (const std::string& line : layout.subtitle) EXPECT_LE(textWidth(line, layout.subtitleSize), 0.87 * width_);
  }
}

TEST(CardLayout, WordsAreBrokenLast) {
  const CardLayout layout = layOutCard({"Pneumonoultramicroscopically", "", 3}, 360, 640);
  EXPECT_EQ(layout.title.size(), 1u);
  EXPECT_FALSE(layOutCard({std::string(250, 'w'), std::string(250, 'w'), 3}, 40, 640).fits);
}

}  // namespace
}  // namespace cradle
