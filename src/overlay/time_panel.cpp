#include "overlay/time_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/font.h"

namespace cradle {
namespace {

// Of the picture's height.
constexpr double kTimeFromEdge = 0.03, kTimePadding = 0.014, kNameText = 0.036, kTimeText = 0.033;
constexpr double kWidestName = 0.45;  // of the picture's width, so that a plot fits beside it
const Ink kTimeGround{{18, 22, 30}, 0.88}, kTimeInk{{255, 255, 255}, 1};

/// Digits after the point that tell neighbouring frames apart.
int timeDigits(const Scene& scene) {
  return static_cast<int>(std::clamp(std::ceil(-std::log10(frameInterval(scene))), 0.0, 9.0));
}

std::string timeText(const Scene& scene, std::optional<double> horizon, double time) {
  const double speed = scene.output.playbackSpeed;
  return fmt::format("t = {:.{}f} s{}{}", time, timeDigits(scene),
                     speed == 1 ? "" : fmt::format("   speed {:g}", speed),
                     horizon && time >= *horizon ? "   one of many motions" : "");
}

struct TimeLayout {
  TextSize nameSize, timeSize;
  std::string name;
  double edge = 0, padding = 0, nameLine = 0, timeLine = 0;  // pixels; the lines are baselines
};

TimeLayout layOutTime(const Scene& scene, int width, int height) {
  TimeLayout layout;
  layout.nameSize = crispTextSize(kNameText * height), layout.timeSize = crispTextSize(kTimeText * height);
  layout.name = fittedText(scene.name, layout.nameSize, kWidestName * width);
  layout.edge = std::round(kTimeFromEdge * height), layout.padding = kTimePadding * height;
  layout.nameLine = layout.edge + std::round(layout.padding + layout.nameSize.ascent);
  layout.timeLine =
      layout.nameLine + std::round(0.75 * layout.nameSize.em + layout.timeSize.ascent / 2 + 0.2 * layout.timeSize.em);
  return layout;
}

}  // namespace

PicturePoint timePanelEnd(const Scene& scene, std::optional<double> horizon, int width, int height) {
  const TimeLayout layout = layOutTime(scene, width, height);
  const double longest = textWidth(timeText(scene, horizon, scene.duration), layout.timeSize);
  const double breadth = std::max(textWidth(layout.name, layout.nameSize), longest);
  return {layout.edge + std::round(breadth + 2 * layout.padding), std::round(layout.timeLine + layout.padding)};
}

void drawTimePanel(Canvas& canvas, const Scene& scene, std::optional<double> horizon, double time) {
  const TimeLayout layout = layOutTime(scene, canvas.width(), canvas.height());
  const double left = layout.edge + layout.padding;
  canvas.rectangle({layout.edge, layout.edge}, timePanelEnd(scene, horizon, canvas.width(), canvas.height()),
                   layout.padding, kTimeGround);
  drawText(canvas, layout.name, layout.nameSize, {left, layout.nameLine}, kTimeInk);
  drawText(canvas, timeText(scene, horizon, time), layout.timeSize, {left, layout.timeLine}, kTimeInk);
}

}  // namespace cradle
