// A force has no size that could be compared with metres: lengths of arrows go with forces from a shortest to the
// longest of the film, which belongs to its greatest force; angles of arcs that show torques likewise.

#include "render/push_arrows.h"

#include <numbers>

#include "render/arrows.h"

namespace cradle {
namespace {

constexpr double kLongestArc = std::numbers::pi;  // above its middle: none goes into a floor

}  // namespace

void appendPushArrows(const Appearance& appearance, const View& view, const Frame& frame,
                      const std::vector<RigidTransform>& worldFromBody, DrawList& list) {
  const ArrowLook& look = appearance.pushArrow;
  for (const ShownPush& push : view.pushes) {
    const double length = view.arrowLength(push);
    if (!push.isShownAt(frame.time) || length == 0) continue;
    const Vec3 point = push.pointAt(frame.time, worldFromBody), direction = push.force.normalized();
    if (push.isTorque)
      appendArc(appearance, look, point, direction, view.arcRadius(push), kLongestArc * length / view.longestArrow,
                list);
    else
      appendArrow(appearance, look, point - length * direction, point, list);
  }
}

}  // namespace cradle
