#include "overlay/captions.h"

#include "overlay/film.h"

namespace cradle {
namespace {

/// Pixels that are not black: from left, right, top, bottom.
struct Drawn {
  int left = kWidth, right = -1, top = kHeight, bottom = -1;
  bool isNone() const { return right < 0; }
};

Drawn drawnOn(const Image& image) {
  Drawn drawn;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (const auto* pixel = image.at(x, y); pixel[0] + pixel[1] + pixel[2] > 0) {
        drawn.left = std::min(drawn.left, x), drawn.right = std::max(drawn.right, x);
        drawn.top = std::min(drawn.top, y), drawn.bottom = std::max(drawn.bottom, y);
      }
  return drawn;
}

class Captions : public Film {
 protected:
  Captions() {
    for (Body& body : scene_.bodies) body.massProperties.centerOfMass = Vec3::Zero();
  }

  Drawn drawnAt(long number) const {
    Image image(kWidth, kHeight);
    drawCaptions(scene_, frameAt(number), {view_.camera, kWidth, kHeight}, {}, image);
    return drawnOn(image);
  }
};

TEST_F(Captions, AreShownFromTheirBeginToBeforeTheirEnd) {
  scene_.captions = {{"Look", 0.5, 1, kWorld}};
  EXPECT_TRUE(drawnAt(29).isNone());
  EXPECT_FALSE(drawnAt(30).isNone());
  EXPECT_FALSE(drawnAt(59).isNone());
  EXPECT_TRUE(drawnAt(60).isNone());
}

TEST_F(Captions, StandAtTheBottomInTheMiddleAndWrap) {
  scene_.captions = {{"Look", 0, 2, kWorld}};
  const Drawn one = drawnAt(0);
  EXPECT_GT(one.top, 0.85 * kHeight);
  EXPECT_LT(one.bottom, kHeight);
  EXPECT_NEAR(one.left + one.right, kWidth, 3);
  scene_.captions[0].text =
      "A text that is far too long for one line of a picture as narrow as this one, as all will see";
  const Drawn wrapped = drawnAt(0);
  EXPECT_LT(wrapped.top, one.top - 10);
  EXPECT_EQ(wrapped.bottom, one.bottom);
  EXPECT_GT(wrapped.left, 0);
  EXPECT_LT(wrapped.right, kWidth - 1);
}

// The ball goes to the right by 2 m/s; its label goes with it, and stays in the picture.
TEST_F(Captions, OfBodiesGoWithThem) {
  scene_.captions = {{"ball", 0, 9, 0}};
  const auto pixelOf = [&](long number) {
    return projectToPixel(view_.camera, frameAt(number).states[0].position, kWidth, kHeight);
  };
  for (const long number : {30, 60}) {
    const Drawn drawn = drawnAt(number);
    EXPECT_NEAR(drawn.left, pixelOf(number).x(), 0.02 * kHeight) << number;
    EXPECT_NEAR(drawn.bottom, pixelOf(number).y(), 0.02 * kHeight) << number;
    EXPECT_LT(drawn.right, pixelOf(number).x() + 0.3 * kHeight) << number;
  }
  scene_.captions[0].text = std::string(40, 'w');
  EXPECT_LT(drawnAt(110).right, kWidth - 1);
}

TEST_F(Captions, OfABodyOutsideOfThePictureAreNotDrawn) {
  scene_.captions = {{"ball", 0, 9, 0}};
  view_.camera.target = Vec3(0, 20, 0);
  EXPECT_TRUE(drawnAt(30).isNone());
}

// After 1 s both balls are as high, and 1 m apart: less than their labels are wide.
TEST_F(Captions, OfBodiesNearEachOtherAreApart) {
  const auto drawnWith = [&](std::vector<Caption> captions) {
    scene_.captions = std::move(captions);
    Image image(kWidth, kHeight);
    drawCaptions(scene_, frameAt(60), {view_.camera, kWidth, kHeight}, {}, image);
    return image;
  };
  const Caption first{"the one that flies", 0, 9, 0}, second{"the one that falls", 0, 9, 2};
  const auto lightIn = [](const Image& image) {
    double count = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) count += image.pixels[i] > 200;
    return count;
  };
  const double light = lightIn(drawnWith({first})) + lightIn(drawnWith({second}));
  EXPECT_NEAR(lightIn(drawnWith({first, second})), light, 0.02 * light);
}

TEST(TitleCard, HasItsWordsInTheMiddle) {
  const Image card = drawTitleCard({"Balls", "that fall", 3}, kWidth, kHeight),
              blank = drawTitleCard({"", "", 3}, kWidth, kHeight);
  long sum = 0, count = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (*card.at(x, y) != *blank.at(x, y)) sum += x, ++count;
  ASSERT_GT(count, 100);
  EXPECT_NEAR(static_cast<double>(sum) / static_cast<double>(count), kWidth / 2.0, 0.02 * kWidth);
}

}  // namespace
}  // namespace cradle
