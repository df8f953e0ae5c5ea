#include "simulate/push_schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "scene/ray_on_body.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

std::string missText(const Push& push, const Body& body, double time, const Vec3& center) {
  return fmt::format(
      "{}: the ray misses \"{}\" at {:.6g} s and nothing is pushed; the body's centre of mass is at [{:.4g}, {:.4g}, "
      "{:.4g}] then: aim there, or name a \"point\" of the body in place of the ray",
      push.where, body.name, time, center.x(), center.y(), center.z());
}

}  // namespace

PushSchedule::PushSchedule(const Scene& scene, const Assembly& assembly, EventLog& log) : scene_(scene), log_(log) {
  for (const std::size_t index : assembly.pushes) plan(index, assembly);
  for (std::size_t i = planned_.size(); i-- > 0;)
    if (!planned_[i].hasBegun) waiting_.push_back(i);
  std::stable_sort(waiting_.begin(), waiting_.end(),
                   [this](std::size_t a, std::size_t b) { return planned_[a].push->start > planned_[b].push->start; });
  findNextChange();
}

/// A push that was due before a continued island and does not act there is over, or its ray has missed.
void PushSchedule::plan(std::size_t index, const Assembly& assembly) {
  const Push& push = scene_.pushes[index];
  const int body = indexAmong(assembly.sceneBodies, push.body);
  if (body == kFixed) return;
  const auto started = std::find_if(assembly.startedPushes.begin(), assembly.startedPushes.end(),
                                    [&](const StartedPush& other) { return other.push == index; });
  const bool acts = started != assembly.startedPushes.end();
  const double start = assembly.startTime;
  if (!acts && assembly.isContinued && (start == 0 ? push.start <= 0 : push.start < start - sameTime(start))) return;
  if (acts) acting_.push_back(planned_.size());
  planned_.push_back({&push, body, acts ? forceOf(push, body, started->point) : PushForce(), acts});
}

std::vector<StartedPush> PushSchedule::startedBy(double time) const {
  const double until = time + sameTime(time);
  std::vector<StartedPush> started;
  for (const Planned& planned : planned_)
    if (planned.hasBegun && planned.push->start <= until && planned.end() > until)
      started.push_back({static_cast<std::size_t>(planned.push - scene_.pushes.data()), planned.force.point.point});
  return started;
}

std::vector<PushForce> PushSchedule::forces() const {
  std::vector<PushForce> forces;
  for (const std::size_t index : acting_) forces.push_back(planned_[index].force);
  return forces;
}

PushForce PushSchedule::forceOf(const Push& push, int body, const Vec3& point) {
  return {{body, point}, push.force, push.torque.value_or(Vec3::Zero())};
}

void PushSchedule::findNextChange() {
  nextChange_ = std::numeric_limits<double>::infinity();
  if (!waiting_.empty()) nextChange_ = planned_[waiting_.back()].push->start;
  for (const std::size_t index : acting_) nextChange_ = std::min(nextChange_, planned_[index].end());
}

/// Those that begin or end at `time`, in the order of the scene; they are no longer among the others.
std::vector<std::size_t> PushSchedule::takeDue(double time) {
  std::vector<std::size_t> due;
  const auto goesOn = [&](std::size_t index) { return time < planned_[index].end(); };
  const auto ended = std::stable_partition(acting_.begin(), acting_.end(), goesOn);
  due.assign(ended, acting_.end());
  acting_.erase(ended, acting_.end());
  for (; !waiting_.empty() && time >= planned_[waiting_.back()].push->start; waiting_.pop_back())
    due.push_back(waiting_.back());
  std::sort(due.begin(), due.end());
  return due;
}

std::vector<int> PushSchedule::apply(double time, const VectorX& state, std::vector<PushForce>& acting) {
  std::vector<int> changed;
  for (const std::size_t index : takeDue(time)) {
    Planned& planned = planned_[index];
    if (planned.hasBegun) {
      log_.recordBody(time, EventKind::pushEnd, planned.body, motionOf(planned.force.point, state).position);
    } else if (begin(planned, time, state)) {
      planned.hasBegun = true;
      acting_.insert(std::upper_bound(acting_.begin(), acting_.end(), index), index);
    } else {
      continue;
    }
    changed.push_back(planned.body);
  }
  acting = forces();
  findNextChange();
  return changed;
}

/// Finds the point that is pushed; false if the ray misses.
bool PushSchedule::begin(Planned& planned, double time, const VectorX& state) {
  const Body& body = scene_.bodies[static_cast<std::size_t>(planned.push->body)];
  const Vec3& center = body.massProperties.centerOfMass;
  Vec3 point;  // body's frame
  if (const auto* ray = std::get_if<Push::Ray>(&planned.push->target)) {
    const Quat worldFromBody = orientation(state, planned.body).normalized(), bodyFromWorld = worldFromBody.conjugate();
    const Vec3 origin = bodyFromWorld * (ray->origin - centerOfMass(state, planned.body)) + center;
    const Ray inBody{origin, bodyFromWorld * ray->direction};
    const auto distance = castRay(inBody, body, scene_);
    if (!distance) {
      log_.recordBody(time, EventKind::pushMissed, planned.body, ray->origin);
      log_.warn(missText(*planned.push, body, time, centerOfMass(state, planned.body)));
      return false;
    }
    point = inBody.origin + *distance * inBody.direction;
  } else {
    point = planned.push->torque ? center : std::get<Vec3>(planned.push->target);
  }
  planned.force = forceOf(*planned.push, planned.body, point - center);
  log_.recordBody(time, EventKind::pushStart, planned.body, motionOf(planned.force.point, state).position);
  return true;
}

}  // namespace cradle
