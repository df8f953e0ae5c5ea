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

/// How a body, or the world, has turned since the start of the run.
inline Quat turnOf(int body, const Scene& scene, const std::vector<RigidTransform>& places) {
  if (body == kWorld) return Quat::Identity();
  const auto index = static_cast<std::size_t>(body);
  return Quat(places[index].rotation * scene.bodies[index].worldFromBody.rotation.conjugate());
}

/// The axis of a hinge or slider at the start of the run, in the world's frame.
template <class Joint>
Vec3 startAxisOf(const Joint& joint, const Scene& scene) {
  if (joint.anchorA.body == kWorld) return joint.axis;
  return scene.bodies[static_cast<std::size_t>(joint.anchorA.body)].worldFromBody.rotation * joint.axis;
}

/// Angle (rad) between a hinge's axis as bodies A and B carry it, from the start of the run.
inline double axisError(const Hinge& hinge, const Scene& scene, const std::vector<RigidTransform>& places) {
  const Vec3 axis = startAxisOf(hinge, scene);
  const Quat a = turnOf(hinge.anchorA.body, scene, places), b = turnOf(hinge.anchorB.body, scene, places);
  return (a * axis).cross(b * axis).norm();
}

/// Angle (rad, small) by which A has turned against B since the start of the run.
inline double turnError(const Anchor& a, const Anchor& b, const Scene& scene,
                        const std::vector<RigidTransform>& places) {
  return 2 * (turnOf(a.body, scene, places).conjugate() * turnOf(b.body, scene, places)).vec().norm();
}

/// Distance (m) of a slider's anchor A from the axis through its anchor B that B carries.
inline double railError(const Slider& slider, const Scene& scene, const std::vector<RigidTransform>& places) {
  const Vec3 axis = turnOf(slider.anchorB.body, scene, places) * startAxisOf(slider, scene);
  return axis.cross(placeOf(slider.anchorA, places) - placeOf(slider.anchorB, places)).norm();
}

/// How far a frame is from what rods and joints demand: in m, or rad.
inline double constraintError(const Frame& frame, const Scene& scene) {
  const std::vector<RigidTransform> places = placesIn(frame, scene);
  double error = 0;
  for (const Rod& rod : scene.rods)
    error = std::max(error, std::abs(distanceOfEnds(rod.anchorA, rod.anchorB, places) - rod.length));
  for (const BallJoint& joint : scene.ballJoints)
    error = std::max(error, distanceOfEnds(joint.anchorA, joint.anchorB, places));
  for (const Hinge& hinge : scene.hinges)
    error = std::max({error, distanceOfEnds(hinge.anchorA, hinge.anchorB, places), axisError(hinge, scene, places)});
  for (const Slider& slider : scene.sliders)
    error =
        std::max({error, railError(slider, scene, places), turnError(slider.anchorA, slider.anchorB, scene, places)});
  for (const Weld& weld : scene.welds)
    error = std::max({error, distanceOfEnds(weld.anchorA, weld.anchorB, places),
                      turnError(weld.anchorA, weld.anchorB, scene, places)});
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
