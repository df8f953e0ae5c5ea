#include "simulate/swept_bodies.h"

#include <algorithm>

#include "dynamics/integrators/pose_interpolant.h"
#include "dynamics/state.h"

namespace cradle {

void SweptBodies::begin(double from, double to, const VectorX& state) {
  from_ = from, to_ = to;
  centers_.assign(static_cast<std::size_t>(bodyCount(state)), Bounds());
  for (std::size_t i = 0; i < centers_.size(); ++i)
    centers_[i].extend(Vec3(centerOfMass(state, static_cast<Eigen::Index>(i))));
}

void SweptBodies::add(const Step& step, const VectorX& after) {
  if (step.timeStep <= 0 || step.time > to_) return;
  const auto fractionAt = [&](double time) { return std::clamp((time - step.time) / step.timeStep, 0.0, 1.0); };
  const double first = fractionAt(from_), last = fractionAt(to_), part = last - first;
  for (std::size_t i = 0; i < centers_.size(); ++i) {
    const int body = static_cast<int>(i);
    if (isStill(step, body)) {
      centers_[i].extend(Vec3(centerOfMass(after, body)));
      continue;
    }
    const Vec3 corrected = centerOfMass(after, body) - centerOfMass(step.state, body);  // at the step's end
    Bounds swept;
    double beside = last * last * corrected.norm();
    if (step.hasEndDerivative) {
      swept.extend(poseAt(step, body, first).translation), swept.extend(poseAt(step, body, last).translation);
      beside += part * part / 8 * relativeMotionBounds(step, kFixed, body).acceleration;
    } else {  // the whole of a step that nothing was looked for in
      const Vec3 start = centerOfMass(step.startState, body), end = centerOfMass(step.state, body);
      swept.extend(start), swept.extend(end);
      beside += (step.timeStep * step.startDerivative.segment<3>(body * kPoseSize) - (end - start)).norm();
    }
    const Vec3 margin = Vec3::Constant(beside);
    centers_[i].extend(Bounds(swept.min() - margin, swept.max() + margin));
  }
}

}  // namespace cradle
