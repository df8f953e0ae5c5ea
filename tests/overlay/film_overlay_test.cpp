#include "overlay/film_overlay.h"

#include <numeric>

#include "overlay/film.h"

namespace cradle {
namespace {

TEST_F(Film, TrailGoesThroughEarlierPlacesAndEnds) {
  OverlayChoice choice;
  choice.trails = true;
  const Image image = draw(choice, 100);
  for (const long before : {0, 10, 30, 60}) {
    EXPECT_TRUE(isMarked(image, frameAt(100 - before).states[0].position)) << before;
    EXPECT_TRUE(isMarked(image, frameAt(100 - before).states[1].position)) << before;
  }
  EXPECT_FALSE(isMarked(image, frameAt(100 - 75).states[0].position));  // 1.25 s ago
  EXPECT_FALSE(isMarked(image, frameAt(103).states[0].position));
  EXPECT_FALSE(isMarked(image, frameAt(80).states[0].position + Vec3(0, 0.1, 0)));
}

TEST_F(Film, TrailLastsAsLongInSlowMotion) {
  OverlayChoice choice;
  choice.trails = true;
  scene_.output.playbackSpeed = 0.5;
  scene_.output.framesPerSecond = 30;  // the same frames
  const Image image = draw(choice, 100);
  EXPECT_TRUE(isMarked(image, frameAt(100 - 30).states[0].position));  // 1 s of the film
  EXPECT_FALSE(isMarked(image, frameAt(100 - 38).states[0].position));
}

TEST_F(Film, VelocityArrowsGoWithTheSpeed) {
  OverlayChoice choice;
  choice.velocities = true;
  const Image image = draw(choice, 60);
  // The fastest, of 2 m/s, is 22 % of the height of what the camera sees; the other goes down with 1 m/s.
  const double metresPerSpeed = 0.22 * kSeenHeight / kSpeed;
  const Vec3 right = frameAt(60).states[0].position, down = frameAt(60).states[1].position;
  EXPECT_TRUE(isMarked(image, right + Vec3(0.95 * metresPerSpeed * 2, 0, 0)));
  EXPECT_FALSE(isMarked(image, right + Vec3(1.08 * metresPerSpeed * 2, 0, 0)));
  EXPECT_TRUE(isMarked(image, down + Vec3(0, -0.9 * metresPerSpeed, 0)));
  EXPECT_FALSE(isMarked(image, down + Vec3(0, -1.1 * metresPerSpeed, 0)));
  EXPECT_FALSE(isMarked(image, right - Vec3(0.2, 0, 0)));
}

TEST_F(Film, ImpactsAreShownForAWhileAndFade) {
  const Vec3 place(0.5, -1, 0);
  events_ = {{0.5, EventKind::impact, 0, 1, place, Vec3::UnitX(), 3},
             {0.5, EventKind::rest, 0, 1, Vec3(-1, -1, 0), Vec3::UnitX(), 3},
             {0.5, EventKind::impact, 0, 1, Vec3(-1, -1.5, 0), Vec3::UnitX(), 0}};
  OverlayChoice choice;
  choice.contacts = true;
  EXPECT_FALSE(isMarked(draw(choice, 29), place));
  const Image fresh = draw(choice, 30);
  EXPECT_TRUE(isMarked(fresh, place));
  EXPECT_FALSE(isMarked(fresh, {-1, -1, 0}) || isMarked(fresh, {-1, -1.5, 0}));
  // The greatest: 14 % of the height that is seen to either side.
  const double length = 0.14 * kSeenHeight;
  for (const double way : {-1.0, 1.0}) {
    EXPECT_TRUE(isMarked(fresh, place + Vec3(way * 0.93 * length, 0, 0)));
    EXPECT_FALSE(isMarked(fresh, place + Vec3(way * 1.12 * length, 0, 0)));
  }
  const auto brightness = [&](long number) {
    const Image image = draw(choice, number);
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0L);
  };
  EXPECT_GT(brightness(30), brightness(35));
  EXPECT_GT(brightness(35), brightness(44));
  EXPECT_EQ(brightness(45), 0);  // 0.25 s later
}

// The force is on the body that moves, away from the one that is fixed; of two that move on both.
TEST_F(Film, ForcesOfLastingContactsAreOnWhatMoves) {
  contacts_ = {{0, 0, 1, Vec3(0, -8, 0), Vec3(0, -8, 0), Vec3::Zero(), Vec3(-0.5, -1, 0)},
               {1, 0, 2, Vec3(2, 0, 0), Vec3(2, 0, 0), Vec3::Zero(), Vec3(0.5, -1, 0)}};
  OverlayChoice choice;
  choice.contacts = true;
  const Image image = draw(choice, 30);
  const double length = 0.14 * kSeenHeight;  // of the greatest; others go with the root
  EXPECT_TRUE(isMarked(image, {-0.5, -1 + 0.93 * length, 0}));
  EXPECT_FALSE(isMarked(image, {-0.5, -1 + 1.12 * length, 0}));
  EXPECT_FALSE(isMarked(image, {-0.5, -1 - 0.2 * length, 0}));
  for (const double way : {-0.5, 0.5}) {
    EXPECT_TRUE(isMarked(image, {0.5 + 0.93 * way * length, -1, 0}));
    EXPECT_FALSE(isMarked(image, {0.5 + 1.2 * way * length, -1, 0}));
  }
}

TEST_F(Film, EnergyPlotStartsThePotentialAtItsLowest) {
  OverlayChoice choice;
  choice.plot = PlotKind::energy;
  // Kinetic goes from 0 to 2, potential from 2 to 0 above its lowest, their sum is 2: a range of 2 with 6 % more.
  PlotContent content{"", {0, 2}, {{"", {0, 2}, {}}}};
  const PlotArea area = plotAreaOf(content, kWidth, kHeight);
  const Image image = draw(choice, 90), half = draw(choice, 45);
  for (const double time : {0.4, 0.7})
    for (const double value : {time, 2 - time, 2.0}) {
      const PicturePoint place = area.at(time, value);
      const auto* pixel = image.at(static_cast<int>(place.x), static_cast<int>(place.y));
      EXPECT_GT(pixel[0] + pixel[1] + pixel[2], 400) << time << " " << value;
    }
  const PicturePoint later = area.at(1.2, 1.2);
  EXPECT_GT(image.at(static_cast<int>(later.x), static_cast<int>(later.y))[2], 200);
  EXPECT_LT(half.at(static_cast<int>(later.x), static_cast<int>(later.y))[2], 100);
}

TEST_F(Film, PlotLiesWhereItHidesTheFewestBodies) {
  OverlayChoice choice;
  choice.plot = PlotKind::energy;
  const auto isAt = [&](PlotCorner corner) {
    const auto [low, high] = plotPanelAt(corner, 0, kWidth, kHeight);
    const Image image = draw(choice, 60);
    return image.at(static_cast<int>((low.x + high.x) / 2), static_cast<int>(high.y) - 2)[2] > 0;
  };
  // The balls stay in the middle of the picture; from nearer, theirs is the right half: from (1, 0.5) to (2, 0.5), and
  // from (1, 1) to (1, -1).
  EXPECT_TRUE(isAt(PlotCorner::upperRight));
  EXPECT_FALSE(isAt(PlotCorner::lowerRight) || isAt(PlotCorner::lowerLeft));
  view_.camera.position.z() = 3.2;
  EXPECT_FALSE(isAt(PlotCorner::upperRight));
}

TEST_F(Film, PanelOfTimeKeepsItsPlaceAndTheRestIsLeftAlone) {
  OverlayChoice choice;
  choice.time = true;
  const Image first = draw(choice, 1), last = draw(choice, 119);
  EXPECT_NE(first, last);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool isMarkedFirst = first.at(x, y)[2] > 0, isMarkedLast = last.at(x, y)[2] > 0;
      ASSERT_EQ(isMarkedFirst, isMarkedLast) << x << " " << y;
      const bool isFarOff = x > kWidth / 3 || y > kHeight / 5 || x < 11 || y < 11;
      ASSERT_FALSE(isMarkedFirst && isFarOff) << x << " " << y;
    }
}

TEST_F(Film, PictureDoesNotDependOnThoseBefore) {
  events_ = {{0.5, EventKind::impact, 0, 1, {0.5, -1, 0}, Vec3::UnitX(), 3}};
  scene_.camera = view_.camera;
  scene_.cameraMotion.orbitPeriod = 20;
  const OverlayChoice all{true, true, true, true, PlotKind::height, "falling"};
  FilmOverlay forwards = overlay(all), jumping = overlay(all);
  const auto drawnBy = [](FilmOverlay& overlay, long number) {
    Image image(kWidth / 2, kHeight / 2);
    overlay.draw(frameAt(number), image);
    return image;
  };
  std::vector<Image> film;
  for (long number = 30; number < 41; ++number) film.push_back(drawnBy(forwards, number));
  for (const long number : {40, 33, 120, 30, 31, 35}) {
    const Image image = drawnBy(jumping, number);
    if (number < 41) {
      EXPECT_EQ(image, film[static_cast<std::size_t>(number - 30)]) << number;
    }
    FilmOverlay alone = overlay(all);
    EXPECT_EQ(drawnBy(alone, number), image) << number;
  }
}

TEST_F(Film, LongTrailsHaveFewerPointsAndStayWhereTheyAre) {
  scene_.output.framesPerSecond = 60 * 40;  // 1.2 s are 2880 frames
  scene_.output.playbackSpeed = 40;
  long reads = 0;
  OverlayChoice choice;
  choice.trails = true;
  FilmOverlay overlay({scene_, view_, kWidth, kHeight,
                       [&](long number) {
                         ++reads;
                         return frameAt(number);
                       },
                       kFrames, events_},
                      choice);
  Image image(kWidth, kHeight);
  overlay.draw(frameAt(2880), image);
  EXPECT_LE(reads, 121);
  reads = 0;
  overlay.draw(frameAt(2881), image);
  EXPECT_LE(reads, 1);
}

TEST_F(Film, WhatIsBehindTheCameraIsNotDrawn) {
  view_.camera.position = {0, 0.5, -6};
  view_.camera.target = {0, 0.5, -12};
  events_ = {{0.5, EventKind::impact, 0, 1, {0.5, -1, 0}, Vec3::UnitX(), 3}};
  EXPECT_EQ(draw({false, true, true, true, std::nullopt, ""}, 35), Image(kWidth, kHeight));
}

}  // namespace
}  // namespace cradle
