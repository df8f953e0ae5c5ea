// What goes along with the film: cameras that move, curves between frames, what a plot is fed with, the time.

#include "image/font.h"
#include "overlay/film.h"

namespace cradle {
namespace {

/// One body's states as frames of a film, one a second.
FilmOverlay trailOf(const Scene& scene, const View& view, const std::vector<BodyState>& states) {
  OverlayChoice choice;
  choice.trails = true;
  const auto frameAt = [states](long number) {
    Frame frame;
    frame.number = number;
    frame.time = static_cast<double>(number);
    frame.states = {states.at(static_cast<std::size_t>(number))};
    return frame;
  };
  return {{scene, view, kWidth, kHeight, frameAt, static_cast<long>(states.size()), {}}, choice};
}

TEST_F(Film, TrailIsCurvedBetweenFramesButNotAcrossAnImpact) {
  scene_.output.framesPerSecond = 1;
  scene_.output.playbackSpeed = 1;
  const auto draw = [&](const std::vector<BodyState>& states) {
    FilmOverlay overlay = trailOf(scene_, view_, states);
    Image image(kWidth, kHeight);
    Frame frame;
    frame.number = 1, frame.time = 1, frame.states = {states[1]};
    overlay.draw(frame, image);
    return image;
  };
  // A circle of 2 m, 0.6 rad a frame: its chord is 2 (1 - cos 0.3) = 9 cm inside of it, 7 pixels.
  BodyState first, second;
  first.position = 2 * Vec3(std::sin(-0.3), -std::cos(0.3), 0);
  second.position = 2 * Vec3(std::sin(0.3), -std::cos(0.3), 0);
  first.linearVelocity = 1.2 * Vec3(std::cos(0.3), -std::sin(0.3), 0);
  second.linearVelocity = 1.2 * Vec3(std::cos(0.3), std::sin(0.3), 0);
  const Image circle = draw({first, second});
  EXPECT_TRUE(isMarked(circle, {0, -2, 0}));
  EXPECT_FALSE(isMarked(circle, {0, -2 * std::cos(0.3), 0}));
  // Down to a floor and up again: a cubic would be 25 cm below where it was seen.
  first.position = {-0.5, 0.5, 0}, second.position = {0.5, 0.5, 0};
  first.linearVelocity = {1, -1, 0}, second.linearVelocity = {1, 1, 0};
  const Image bounce = draw({first, second});
  EXPECT_TRUE(isMarked(bounce, {0, 0.5, 0}));
  EXPECT_FALSE(isMarked(bounce, {0, 0.25, 0}));
}

TEST_F(Film, MarksAreSeenByTheCameraOfTheirFrame) {
  scene_.camera = view_.camera;
  scene_.cameraMotion.orbitPeriod = 2;  // a quarter of a turn to the right until frame 30
  events_ = {{0.5, EventKind::impact, 0, 1, {0.5, -1, 0}, Vec3::UnitY(), 3}};
  const Image image = draw({false, true, false, false, std::nullopt, ""}, 30);
  Camera turned = view_.camera;
  turned.position = {6, 0, 0};
  EXPECT_TRUE(isMarked(image, {0.5, -1, 0}, turned));
  EXPECT_FALSE(isMarked(image, {0.5, -1, 0}));
}

TEST_F(Film, ArrowsFitWhatTheNearestCameraSees) {
  scene_.camera = view_.camera;
  Camera halfway = view_.camera;
  halfway.position.z() = 4.5;
  const double angle = view_.camera.verticalFieldOfView;
  scene_.cameraMotion.keys = {{0, {0, 0, 6}, Vec3::Zero(), angle}, {2, {0, 0, 3}, Vec3::Zero(), angle}};
  view_.keys = {view_.camera};
  view_.keys[0].position.z() = 3;
  const Image image = draw({false, false, true, false, std::nullopt, ""}, 60);
  const double length = 0.22 * kSeenHeight / 2;  // at the end half as much is seen
  const Vec3 tail = frameAt(60).states[0].position;
  EXPECT_TRUE(isMarked(image, tail + Vec3(0.9 * length, 0, 0), halfway));
  EXPECT_FALSE(isMarked(image, tail + Vec3(1.2 * length, 0, 0), halfway));
}

TEST_F(Film, WhatHardlyMovesHasNoArrow) {
  // 1/60 m/s is 0.7 pixels, where 2 m/s are 79; the shaft is 2.7 wide.
  const Image image = draw({false, false, true, false, std::nullopt, ""}, 1);
  const Vec3 place = frameAt(1).states[1].position;
  for (const double aside : {-0.01, 0.0, 0.01})
    for (const double below : {-0.01, 0.0, 0.01}) EXPECT_FALSE(isMarked(image, place + Vec3(aside, below, 0)));
}

TEST_F(Film, PlotLiesWhereTheCameraOfTheSceneSeesFewestBodies) {
  // From 6 m, the balls stay clear of the upper right corner; from 3.2 m, they do not.
  scene_.camera = view_.camera;
  scene_.camera->position.z() = 3.2;
  const auto [low, high] = plotPanelAt(PlotCorner::upperRight, 0, kWidth, kHeight);
  const Image image = draw({false, false, false, false, PlotKind::energy, ""}, 60);
  EXPECT_EQ(image.at(static_cast<int>((low.x + high.x) / 2), static_cast<int>(high.y) - 2)[2], 0);
}

// In a picture as narrow as 360x640 the plot has the whole width, and is below the time in the upper left corner.
TEST_F(Film, PlotLiesBelowTheTimeWhereThereIsNoRoomBesideIt) {
  scene_.captions = {{"Words at the bottom, which keep the plot at the top", 0, 2, kWorld}};
  OverlayChoice timeAlone, both;
  timeAlone.time = both.time = true;
  both.plot = PlotKind::energy;
  const auto drawn = [&](const OverlayChoice& choice, int width, int height) {
    Image image(width, height);
    FilmOverlay({scene_, view_, width, height, frameAt, kFrames, {}}, choice).draw(frameAt(60), image);
    return image;
  };
  for (const auto& [width, height] : {std::pair(360, 640), std::pair(480, 480), std::pair(640, 360)}) {
    const Image time = drawn(timeAlone, width, height), image = drawn(both, width, height);
    long marked = 0, changed = 0, plot = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool isTime = time.at(x, y)[2] > 0;
        marked += isTime;
        changed += isTime && time.at(x, y)[2] != image.at(x, y)[2];
        plot += !isTime && image.at(x, y)[2] > 0;
      }
    EXPECT_GT(marked, 500);
    const std::vector<PicturePart> panels =
        FilmOverlay({scene_, view_, width, height, frameAt, kFrames, {}}, both).upperPanels(width, height);
    ASSERT_EQ(panels.size(), 2u);
    EXPECT_LE(panels[0].bottom, panels[0].right > panels[1].left ? panels[1].top : height);
    EXPECT_EQ(changed, 0) << width;
    EXPECT_GT(plot, 0.25 * height * std::min(0.62 * height, 0.9 * width)) << width;  // all of it
  }
}

TEST_F(Film, PlotsHaveWhatTheyAreNamedFor) {
  PlotContent error{"energy error (J)", {}, {{"", {}, {{255, 176, 64}, 1}}}};
  PlotContent height{"height of falling (m)", {}, {{"", {}, {{86, 180, 233}, 1}}}};
  for (long number = 0; number < kFrames; ++number) {
    const Frame frame = frameAt(number);
    error.times.push_back(frame.time), height.times.push_back(frame.time);
    // 7 J and what was dissipated less the work; see frameAt().
    error.curves[0].values.push_back(0.3 * frame.time);
    height.curves[0].values.push_back(1 - frame.time * frame.time / 2);
  }
  const auto drawn = [](const PlotContent& content) {
    Image image(kWidth, kHeight);
    Canvas canvas(image);
    drawPlot(canvas, content, 90);
    return image;
  };
  EXPECT_EQ(draw({false, false, false, false, PlotKind::height, "falling"}, 90), drawn(height));
  // Sums of energies are rounded: to 1e-15 J, as much of the plot as nothing.
  EXPECT_EQ(draw({false, false, false, false, PlotKind::energyError, ""}, 90), drawn(error));
}

// From 3 % of the picture's height at the left, 1.4 % beside the longer of its lines, which are the scene's name (3.6 %
// high, as much as 45 % of the width hold) and the time at the end (3.3 %).
TEST_F(Film, PanelOfTimeIsAsWideAsItsLongerLine) {
  scene_.duration = 1234;
  const std::string most(60, 'm');
  const TextSize nameSize = crispTextSize(0.036 * kHeight), timeSize = crispTextSize(0.033 * kHeight);
  const double timeWidth = textWidth("t = 1234.00 s", timeSize);
  const std::string name = "Film of a name that is longer";
  const std::string fitted = fittedText(most, nameSize, 0.45 * kWidth);
  ASSERT_LT(textWidth("Film", nameSize), timeWidth);
  ASSERT_GT(textWidth(name, nameSize), timeWidth);
  for (const auto& [shown, width] :
       {std::pair(std::string("Film"), timeWidth), std::pair(name, textWidth(name, nameSize)),
        std::pair(most, textWidth(fitted, nameSize))}) {
    scene_.name = shown;
    const Image image = draw({true, false, false, false, std::nullopt, ""}, 30);
    int left = kWidth, right = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (image.at(x, y)[2] > 0) left = std::min(left, x), right = std::max(right, x + 1);
    EXPECT_EQ(left, 11) << shown;
    EXPECT_EQ(right, 11 + std::round(width + 2 * 0.014 * kHeight)) << shown;
  }
}

TEST_F(Film, TimeTellsNeighbouringFramesApart) {
  for (const double perSecond : {60.0, 2000.0}) {
    scene_.output.framesPerSecond = perSecond;
    const auto drawAt = [&](long number) {
      Frame frame = frameAt(0);
      frame.number = number, frame.time = static_cast<double>(number) / perSecond;
      Image image(kWidth, kHeight);
      overlay({true, false, false, false, std::nullopt, ""}).draw(frame, image);
      return image;
    };
    for (long number = 0; number < 12; ++number) EXPECT_NE(drawAt(number), drawAt(number + 1)) << perSecond;
  }
}

// Impulses stand above the dots of the four greatest impacts, where no greater one's stands; below 5 % of the greatest,
// not at all. Arrows go with the root of the impulse.
TEST_F(Film, GreatestImpulsesHaveTheirNumbers) {
  const auto isNumbered = [&](const std::vector<std::pair<double, double>>& placesAndImpulses, double place) {
    events_.clear();
    for (const auto& [x, impulse] : placesAndImpulses)
      events_.push_back({0.5, EventKind::impact, 0, 1, {x, -1, 0}, Vec3::UnitZ(), impulse});
    const Image image = draw({false, true, false, false, std::nullopt, ""}, 30);
    // The panel reaches from 1.25 to 2.7 em above the dot; an em of 10 pixels is 12 cm.
    return isMarked(image, {place, -1 + 0.25, 0});
  };
  const std::vector<std::pair<double, double>> five = {{-2, 2}, {-1, 5}, {0, 1}, {1, 4}, {2, 3}};
  for (const double place : {-2, -1, 1, 2}) EXPECT_TRUE(isNumbered(five, place)) << place;
  EXPECT_FALSE(isNumbered(five, 0));
  EXPECT_TRUE(isNumbered({{-1, 1}, {1, 0.06}}, 1));
  EXPECT_FALSE(isNumbered({{-1, 1}, {1, 0.04}}, 1));
  // Side by side, 0.3 m: numbers are some 0.5 m wide.
  EXPECT_TRUE(isNumbered({{0.3, 1}, {0, 2}}, -0.1));
  EXPECT_FALSE(isNumbered({{0.3, 1}, {0, 2}}, 0.5));

  events_ = {{0.5, EventKind::impact, 0, 1, {-1, -1, 0}, Vec3::UnitY(), 4},
             {0.5, EventKind::impact, 0, 1, {1, -1, 0}, Vec3::UnitY(), 1}};
  const Image image = draw({false, true, false, false, std::nullopt, ""}, 30);
  const double half = 0.14 * kSeenHeight / 2;
  EXPECT_TRUE(isMarked(image, {1, -1 - 0.93 * half, 0}));
  EXPECT_FALSE(isMarked(image, {1, -1 - 1.15 * half, 0}));
}

// Three digits and the unit, in white on dark, in the middle above the dot: the baseline is 1.6 em above it. No arrow
// or dot comes near: the normal goes along the view.
TEST_F(Film, NumbersOfImpulsesAreWritten) {
  const TextSize size = crispTextSize(0.028 * kHeight);
  const double padding = 0.35 * size.em;
  for (const auto& [impulse, text] : {std::pair(12.3456, "12.3 N s"), std::pair(0.0456789, "0.0457 N s")}) {
    events_ = {{0.5, EventKind::impact, 0, 1, Vec3::Zero(), Vec3::UnitZ(), impulse}};
    const Image image = draw({false, true, false, false, std::nullopt, ""}, 30);
    const double half = textWidth(text, size) / 2, baseline = kHeight / 2 - 1.6 * size.em;
    const PicturePoint low{kWidth / 2 - half - padding, baseline - size.ascent - padding},
        high{kWidth / 2 + half + padding, baseline + padding};
    Image expected(kWidth, kHeight);
    Canvas canvas(expected);
    canvas.rectangle(low, high, padding, {{18, 22, 30}, 0.88});
    drawText(canvas, text, size, {kWidth / 2 - half, baseline}, {{255, 255, 255}, 1});
    long differ = 0;
    for (int y = 0; y < static_cast<int>(high.y) + 2; ++y)
      for (int x = 0; x < kWidth; ++x) differ += !std::equal(image.at(x, y), image.at(x, y) + 3, expected.at(x, y));
    EXPECT_EQ(differ, 0) << text;
  }
}

TEST_F(Film, ImpactsAreShownAsLongInSlowMotion) {
  scene_.output.playbackSpeed = 0.5;
  scene_.output.framesPerSecond = 30;  // the same frames
  events_ = {{0.5, EventKind::impact, 0, 1, {0.5, -1, 0}, Vec3::UnitX(), 3}};
  const OverlayChoice choice{false, true, false, false, std::nullopt, ""};
  EXPECT_TRUE(isMarked(draw(choice, 36), {0.5, -1, 0}));   // 0.2 s of the film
  EXPECT_FALSE(isMarked(draw(choice, 38), {0.5, -1, 0}));  // 0.27 s
}

TEST_F(Film, TrailsFadeAndHaveColorsOfTheirOwn) {
  const Image image = draw({false, false, false, true, std::nullopt, ""}, 100);
  const auto pixelAt = [&](const Vec3& point) {
    const Eigen::Vector2d place = projectToPixel(view_.camera, point, kWidth, kHeight);
    const auto* pixel = image.at(static_cast<int>(place.x()), static_cast<int>(place.y()));
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  const auto fresh = pixelAt(frameAt(98).states[0].position), old = pixelAt(frameAt(50).states[0].position);
  const auto other = pixelAt(frameAt(98).states[1].position);
  EXPECT_GT(fresh[2], fresh[0] + 100);  // blue
  EXPECT_GT(other[0], other[2] + 100);  // orange
  EXPECT_LT(old[2], fresh[2] - 20);
}

}  // namespace
}  // namespace cradle
