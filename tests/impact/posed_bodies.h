#pragma once

#include <utility>
#include <vector>

#include "impact/soft_manifolds.h"

namespace cradle {

/// Bodies where and how fast they are, as the contacts of heaps see them.
class PosedBodies {
 public:
  static constexpr double kTimeStep = 1.0 / 480, kMargin = 0.005;  // s, m

  /// A moving body, of one material with all others.
  int add(Collider collider, const Vec3& position, const Quat& turn = Quat::Identity(),
          const Vec3& velocity = Vec3::Zero(), const Vec3& spin = Vec3::Zero()) {
    const int body = static_cast<int>(poses.size());
    collider.body = body;
    geometry.colliders.push_back(std::move(collider));
    poses.emplace_back();
    positions_.push_back(position), turns_.push_back(turn);
    poses.back().linearVelocity = velocity, poses.back().angularVelocity = spin;
    return body;
  }
  /// Something fixed, whose collider is in the world.
  void addFixed(Collider collider) { geometry.colliders.push_back(std::move(collider)); }

  /// To be called when bodies have been added or moved.
  void place() {
    state.setZero(stateSize(std::ssize(poses)));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      MovingPose& pose = poses[i];
      const Collider& collider = colliderOfBody(static_cast<int>(i));
      const bool isCentered = collider.isSphere() && collider.points[0].isZero(0);
      pose.position = positions_[i], pose.rotation = turns_[i].toRotationMatrix();
      pose.radius = collider.boundingRadius, pose.spinRadius = isCentered ? 0 : collider.boundingRadius;
      pose.spinSpeed = pose.spinRadius * pose.angularVelocity.norm();
      pose.boxCenter = pose.position + pose.rotation * collider.bounds.center();
      pose.boxHalf = pose.rotation.cwiseAbs() * (collider.bounds.sizes() / 2);
      const Eigen::Index body = static_cast<Eigen::Index>(i);
      centerOfMass(state, body) = pose.position;
      setOrientation(state, body, turns_[i]);
      linearVelocity(state, body) = pose.linearVelocity, angularVelocity(state, body) = pose.angularVelocity;
    }
  }
  void move(int body, const Vec3& way, const Quat& turn = Quat::Identity(), double angle = 0) {
    const auto index = static_cast<std::size_t>(body);
    positions_[index] += way, turns_[index] = turn * turns_[index];
    poses[index].turned += angle;
    place();
  }
  const Collider& colliderOfBody(int body) const {
    std::size_t i = 0;
    while (geometry.colliders[i].body != body) ++i;
    return geometry.colliders[i];
  }
  SoftStepStart stepStart() const { return {poses, state, kTimeStep, kMargin}; }

  ContactGeometry geometry = {{}, {}, {{ContactMaterial{0.25, 0.6, 0.4}}}, {}, {}, {}};
  std::vector<MovingPose> poses;
  VectorX state;

 private:
  std::vector<Vec3> positions_;
  std::vector<Quat> turns_;
};

}  // namespace cradle
