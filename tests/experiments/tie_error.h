#pragma once

#include <algorithm>
#include <vector>

#include "experiments/experiment.h"

namespace cradle {

/// Where a scene's bodies are in a frame, by scene body; static ones where the scene puts them.
inline std::vector<RigidTransform> placesIn(const Frame& frame, const Scene& scene) {
  std::vector<RigidTransform> places;
  std::size_t moving = 0;
  for (const Body& body : scene.bodies) {
    if (body.motion == Motion::fixed) {
      places.push_back(body.worldFromBody);
      continue;
    }
    const BodyState& state = frame.states[moving++];
    places.push_back({state.orientation, state.position - state.orientation * body.massProperties.centerOfMass});
  }
  return places;
}

inline Vec3 placeOf(const Anchor& anchor, const std::vector<RigidTransform>& places) {
  return anchor.body == kWorld ? anchor.point : places[static_cast<std::size_t>(anchor.body)] * anchor.point;
}

inline double distanceOfEnds(const Anchor& a, const Anchor& b, const std::vector<RigidTransform>& places) {
  return (placeOf(a, places) - placeOf(b, places)).norm();
}

/// Angle (rad) between a hinge's axis as bodies A and B carry it, from the start of the run.
inline double axisError(const Hinge& hinge, const Scene& scene, const std::vector<RigidTransform>& places) {
  const auto turnOf = [&](int body) {  // since the start
    if (body == kWorld) return Quat::Identity();
    const auto index = static_cast<std::size_t>(body);
    return Quat(places[index].rotation * scene.bodies[index].worldFromBody.rotation.conjugate());
  };
  const Quat start = hinge.anchorA.body == kWorld
                         ? Quat::Identity()
                         : scene.bodies[static_cast<std::size_t>(hinge.anchorA.body)].worldFromBody.rotation;
  const Vec3 axis = start * hinge.axis;
  return (turnOf(hinge.anchorA.body) * axis).cross(turnOf(hinge.anchorB.body) * axis).norm();
}

/// How far a frame is from what rods, ball joints and hinges demand: in m, or rad.
inline double constraintError(const Frame& frame, const Scene& scene) {
  const std::vector<RigidTransform> places = placesIn(frame, scene);
  double error = 0;
  for (const Rod& rod : scene.rods)
    error = std::max(error, std::abs(distanceOfEnds(rod.anchorA, rod.anchorB, places) - rod.length));
  for (const BallJoint& joint : scene.ballJoints)
    error = std::max(error, distanceOfEnds(joint.anchorA, joint.anchorB, places));
  for (const Hinge& hinge : scene.hinges)
    error = std::max({error, distanceOfEnds(hinge.anchorA, hinge.anchorB, places), axisError(hinge, scene, places)});
  return error;
}

inline double largestTieError(const Trajectory& run, const Scene& scene) {
  double error = 0;
  for (const Frame& frame : run.frames) error = std::max(error, constraintError(frame, scene));
  return error;
}

/// Largest change of kinetic + potential + dissipated - work, in J.
inline double largestEnergyError(const Trajectory& run) {
  double error = 0;
  for (const Frame& frame : run.frames)
    error = std::max(error, std::abs(energyConstantOf(frame) - energyConstantOf(run.frames[0])));
  return error;
}

}  // namespace cradle
