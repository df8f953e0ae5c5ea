#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "overlay/film_overlay.h"
#include "render/camera.h"

namespace cradle {

inline constexpr int kWidth = 640, kHeight = 360;
inline constexpr double kSpeed = 2;  // m/s
inline constexpr long kFrames = 121;
inline const double kSeenHeight = 12 * std::tan(0.69813170 / 2);  // m, at the target

/// Two balls: one goes to the right, one falls; seen from the front, 60 frames a second.
class Film : public ::testing::Test {
 protected:
  Film() {
    scene_.name = "Film";
    scene_.duration = 2;
    scene_.bodies.resize(3);
    scene_.bodies[1].motion = Motion::fixed;
    scene_.bodies[2].name = "falling";
    view_.camera.position = {0, 0, 6};
    view_.camera.target = {0, 0, 0};
    view_.bounds = Bounds(Vec3(-2, -2, 0), Vec3(2, 2, 0));
  }

  static Frame frameAt(long number) {
    Frame frame;
    frame.number = number;
    frame.time = static_cast<double>(number) / 60;
    frame.states.resize(2);
    frame.states[0].position = {-2 + kSpeed * frame.time, 0.5, 0};
    frame.states[0].linearVelocity = {kSpeed, 0, 0};
    frame.states[1].position = {1, 1 - frame.time * frame.time / 2, 0};
    frame.states[1].linearVelocity = {0, -frame.time, 0};
    frame.energy.kinetic = frame.time;
    frame.energy.potential = 7 - frame.time;
    frame.energy.dissipated = 0.5 * frame.time;
    frame.energy.work = 0.2 * frame.time;
    return frame;
  }

  FilmOverlay overlay(const OverlayChoice& choice) const {
    return {{scene_, view_, kWidth, kHeight, frameAt, kFrames, events_, [this](long) { return contacts_; }}, choice};
  }

  Image draw(const OverlayChoice& choice, long number) const {
    Image image(kWidth, kHeight);
    overlay(choice).draw(frameAt(number), image);
    return image;
  }

  bool isMarked(const Image& image, const Vec3& point) const { return isMarked(image, point, view_.camera); }
  static bool isMarked(const Image& image, const Vec3& point, const Camera& camera) {
    const Eigen::Vector2d pixel = projectToPixel(camera, point, kWidth, kHeight);
    const auto* found = image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
    return found[0] + found[1] + found[2] > 0;
  }

  Scene scene_;
  View view_;
  std::vector<Event> events_;
  std::vector<ContactWrench> contacts_;  // of every frame
};

}  // namespace cradle
