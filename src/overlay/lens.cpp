#include "overlay/lens.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"

namespace cradle {
namespace {

constexpr double kMinDepth = 0.02;  // of the camera's distance to its target: nearer points may be anywhere
constexpr double kHeadLength = 4.2, kHeadWidth = 3.6;  // of an arrow, in thicknesses of its shaft
constexpr double kShortest = 2;                        // the same: below, an arrow does not tell its direction
constexpr double kEdge = 0.45;                         // the same, of the light edge
constexpr double kEdgeOpacity = 0.75;                  // of the ink's

}  // namespace

std::optional<PicturePoint> Lens::see(const Vec3& point) const {
  const double depth = -cameraAxes(camera).col(2).dot(point - camera.position);
  if (depth < kMinDepth * (camera.target - camera.position).norm()) return std::nullopt;
  const Eigen::Vector2d pixel = projectToPixel(camera, point, width, height);
  return PicturePoint{pixel.x(), pixel.y()};
}

void drawArrow(Canvas& canvas, const PicturePoint& tail, const PicturePoint& tip, double thickness, const Ink& ink) {
  const double x = tip.x - tail.x, y = tip.y - tail.y, length = std::hypot(x, y);
  if (length < kShortest * thickness) return;
  const double size = thickness * std::min(1.0, length / (kHeadLength * thickness));
  const double ux = x / length, uy = y / length;
  const auto draw = [&](double edge, const Ink& with) {
    // The head's tip goes further than its sides by as much as its angle is sharp.
    const double half = kHeadWidth * size / 2 + 1.6 * edge, back = kHeadLength * size + edge, front = 2.2 * edge;
    const PicturePoint neck{tip.x - back * ux, tip.y - back * uy};
    canvas.line({{tail, size + 2 * edge}, {neck, size + 2 * edge}}, with);
    canvas.triangle(
        {PicturePoint{tip.x + front * ux, tip.y + front * uy}, PicturePoint{neck.x - half * uy, neck.y + half * ux},
         PicturePoint{neck.x + half * uy, neck.y - half * ux}},
        with);
  };
  draw(kEdge * size, {{255, 255, 255}, kEdgeOpacity * ink.opacity * ink.opacity});  // fades before it shines through
  draw(0, ink);
}

}  // namespace cradle
