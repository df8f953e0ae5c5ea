#include "render/shown_push.h"

#include <cmath>
#include <optional>

#include "render/body_place.h"

namespace cradle {
namespace {

// Most pushes last a few frames only: shown so much longer before and after, an eye finds them.
constexpr double kShownBefore = 0.25, kShownAfter = 0.35;  // s, of the film

/// Between two frames: 0 is `before`, 1 is `after`. A free fall is missed by g h^2 / 8, 0.3 mm at 60 frames a second.
Frame blend(Frame before, const Frame& after, double share) {
  for (std::size_t i = 0; i < before.states.size(); ++i) {
    BodyState& state = before.states[i];
    state.position += share * (after.states.at(i).position - state.position);
    state.orientation = state.orientation.slerp(share, after.states.at(i).orientation);
  }
  return before;
}

std::vector<RigidTransform> placeBodiesAt(double time, const Scene& scene, const FrameSource& frameAt) {
  const double interval = frameInterval(scene);
  const long number = static_cast<long>(std::floor(time / interval));
  const Frame before = frameAt(number);
  return placeBodies(scene, blend(before, frameAt(number + 1), (time - before.time) / interval));
}

/// Radius (m) of a ball about a point of a body's frame (m) that holds what bounds the body.
double radiusAbout(const Vec3& point, int body, const Scene& scene) {
  const Body& pushed = scene.bodies[static_cast<std::size_t>(body)];
  if (const auto* sphere = std::get_if<Sphere>(&pushed.shape)) return point.norm() + sphere->radius;
  const Bounds bounds = localBounds(scene, pushed);
  return (bounds.max() - point).cwiseAbs().cwiseMax((bounds.min() - point).cwiseAbs()).norm();
}

/// The push that an event is about: of those of its body that are not yet `taken`, the one that starts closest to it.
std::optional<std::size_t> pushOf(const Event& event, const Scene& scene, const std::vector<bool>& taken) {
  std::optional<std::size_t> closest;
  const auto distance = [&](std::size_t i) { return std::abs(scene.pushes[i].start - event.time); };
  for (std::size_t i = 0; i < scene.pushes.size(); ++i)
    if (!taken[i] && scene.pushes[i].body == event.bodyA && (!closest || distance(i) < distance(*closest))) closest = i;
  return closest;
}

}  // namespace

Vec3 ShownPush::pointAt(double time, const std::vector<RigidTransform>& worldFromBody) const {
  if (time < start) return pointAtStart;
  return worldFromBody.at(static_cast<std::size_t>(body)) * pointOfBody;
}

std::vector<ShownPush> findShownPushes(const Scene& scene, const std::vector<Event>& events,
                                       const FrameSource& frameAt) {
  std::vector<ShownPush> shown;
  std::vector<bool> taken(scene.pushes.size());
  for (const Event& event : events) {
    if (event.kind != EventKind::pushStart && event.kind != EventKind::pushMissed) continue;
    const auto index = pushOf(event, scene, taken);
    if (!index) continue;  // the file is older than its scene's pushes
    taken[*index] = true;
    if (event.kind == EventKind::pushMissed) continue;
    const Push& push = scene.pushes[*index];
    ShownPush seen{push.body, event.point, Vec3::Zero(), push.torque.value_or(push.force), push.torque.has_value()};
    seen.start = event.time;
    const auto places = placeBodiesAt(event.time, scene, frameAt);
    const Vec3* point = push.torque ? nullptr : std::get_if<Vec3>(&push.target);
    seen.pointOfBody =
        point != nullptr ? *point : places.at(static_cast<std::size_t>(push.body)).inverse() * event.point;
    if (push.torque) seen.clearance = radiusAbout(seen.pointOfBody, push.body, scene);
    seen.shownFrom = event.time - kShownBefore * scene.output.playbackSpeed;
    seen.shownUntil = event.time + push.duration + kShownAfter * scene.output.playbackSpeed;
    shown.push_back(seen);
  }
  return shown;
}

}  // namespace cradle
