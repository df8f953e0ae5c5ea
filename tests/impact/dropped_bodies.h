#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "impact/soft_step.h"
#include "mesh/primitives.h"

namespace cradle {

/// Balls of radius 0.1 m, cubes of 0.2 m, regular octahedra with corners 0.13 m from their centres and capsules 0.32 m
/// long and 0.12 m wide, 1 kg each, over planes, with a step of 1/60 s (less of small bodies that are added, by their
/// SoftScale).
class DroppedBodies {
 public:
  static constexpr double kHalf = 0.1, kCorner = 0.13, kCapsuleRadius = 0.06, kTimeStep = 1.0 / 60;

  void addPlane(const Vec3& point, const Vec3& normal) { geometry_.planes.push_back({point, normal, 0}); }
  /// A floor and four walls, `width` (m) apart.
  void addTray(double width) {
    addPlane(Vec3::Zero(), Vec3::UnitY());
    for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)})
      addPlane(-width / 2 * normal, normal);
  }
  void addSphere(const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
    add(colliderOf(Sphere{kHalf}, {}), 0.4 * kHalf * kHalf * Mat3::Identity(), position, Quat::Identity(), velocity);
  }
  void addCube(const Vec3& position, const Quat& turn = Quat::Identity()) {
    const double inertia = 4 * kHalf * kHalf / 6;
    add(colliderOf(Box{Vec3::Constant(2 * kHalf)}, {}), inertia * Mat3::Identity(), position, turn, Vec3::Zero());
  }
  void addOctahedron(const Vec3& position, const Quat& turn) {
    std::vector<Vec3> corners;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) corners.push_back(sign * kCorner * Vec3::Unit(axis));
    const double inertia = kCorner * kCorner / 5;
    add(colliderOf(convexHullOf(corners), {}), inertia * Mat3::Identity(), position, turn, Vec3::Zero());
  }
  void addCapsule(const Vec3& position, const Quat& turn) {
    const Capsule capsule{kCapsuleRadius, 2 * kHalf};
    const MassProperties unit = massProperties(capsule, 1);
    add(colliderOf(capsule, {}), unit.inertiaTensor / unit.mass, position, turn, Vec3::Zero());
  }
  void add(Collider collider, const Mat3& inertiaTensor, const Vec3& position, const Quat& turn, const Vec3& velocity) {
    collider.body = static_cast<int>(bodies_.size());
    geometry_.colliders.push_back(std::move(collider));
    bodies_.push_back(makeRigidBody({1, Vec3::Zero(), inertiaTensor}));
    positions_.push_back(position), turns_.push_back(turn), velocities_.push_back(velocity);
  }

  /// To be called when all have been added.
  void begin(const ContactMaterial& material, const Vec3& gravity = Vec3(0, -9.81, 0), int threads = 1) {
    geometry_.materials = {{material}};
    gravity_ = gravity;
    state_.setZero(stateSize(std::ssize(bodies_)));
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Eigen::Index body = static_cast<Eigen::Index>(i);
      centerOfMass(state_, body) = positions_[i];
      setOrientation(state_, body, turns_[i]);
      linearVelocity(state_, body) = velocities_[i];
    }
    step_ = std::make_unique<SoftStep>(bodies_, geometry_, gravity, threads);
  }
  void advance(int steps = 1) {
    for (int i = 0; i < steps; ++i) step_->advance(step_->scale().time * kTimeStep, state_);
  }

  VectorX& state() { return state_; }
  SoftStep& step() { return *step_; }
  int count() const { return static_cast<int>(bodies_.size()); }
  Vec3 position(int body) { return centerOfMass(state_, body); }

  /// Kinetic and potential (J).
  double energy() {
    double sum = 0;
    for (int i = 0; i < count(); ++i) {
      const Mat3 turn = orientation(state_, i).toRotationMatrix();
      const Vec3 spin = turn.transpose() * angularVelocity(state_, i), velocity = linearVelocity(state_, i);
      sum += velocity.squaredNorm() / 2 + spin.dot(bodies_[static_cast<std::size_t>(i)].inertiaTensor * spin) / 2;
      sum -= gravity_.dot(position(i));
    }
    return sum;
  }

  /// The deepest overlap (m) of balls, cubes, octahedra, capsules and planes, from the poses alone: cubes by all 15
  /// axes, octahedra by all 44, capsules by points of one axis 5 mm apart, which miss 0.03 mm at most. Capsules do not
  /// meet other bodies.
  double deepestOverlap() {
    double most = 0;
    for (int i = 0; i < count(); ++i) {
      for (const PlaneCollider& plane : geometry_.planes)
        most = std::max(most, reachAlong(i, plane.normal) - plane.normal.dot(position(i) - plane.point));
      for (int j = 0; j < i; ++j) most = std::max(most, overlapOf(i, j));
    }
    return most;
  }

 private:
  bool isSphere(int body) const { return geometry_.colliders[static_cast<std::size_t>(body)].isSphere(); }
  bool isCapsule(int body) const {
    return geometry_.colliders[static_cast<std::size_t>(body)].kind() == ColliderKind::capsule;
  }
  bool isOctahedron(int body) const {
    const Collider& collider = geometry_.colliders[static_cast<std::size_t>(body)];
    return collider.polytope && collider.polytope->vertices.size() == 6;
  }
  Mat3 turnOf(int body) { return orientation(state_, body).toRotationMatrix(); }
  double reachAlong(int body, const Vec3& direction) {
    if (isCapsule(body))
      return kCapsuleRadius * direction.norm() + kHalf * std::abs(turnOf(body).col(1).dot(direction));
    if (isOctahedron(body)) return kCorner * (turnOf(body).transpose() * direction).cwiseAbs().maxCoeff();
    return kHalf * (isSphere(body) ? direction.norm() : (turnOf(body).transpose() * direction).cwiseAbs().sum());
  }
  double overlapOfCapsules(const Vec3& offset, const Vec3& axisA, const Vec3& axisB) const {
    double least = offset.norm();
    for (int k = -20; k <= 20 && offset.norm() < 2 * (kHalf + kCapsuleRadius); ++k) {
      const Vec3 at = offset + k / 20.0 * kHalf * axisA;
      least = std::min(least, (at - std::clamp(at.dot(axisB), -kHalf, kHalf) * axisB).norm());
    }
    return 2 * kCapsuleRadius - least;
  }
  /// Normals of an octahedron's faces, and directions of its edges.
  static std::vector<Vec3> octahedronAxes(const Mat3& turn, bool ofEdges) {
    std::vector<Vec3> axes;
    for (const double sign : {1.0, -1.0})
      for (int k = 0; k < 3; ++k)
        if (ofEdges) axes.emplace_back(turn.col(k) + sign * turn.col((k + 1) % 3));
    for (int k = 0; k < 4; ++k)
      if (!ofEdges) axes.emplace_back(turn * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, 1));
    return axes;
  }
  double overlapOf(int i, int j) {
    const Vec3 offset = position(i) - position(j);
    if (offset.norm() > 2 * std::sqrt(3.0) * kHalf) return 0;  // more than any two of them reach
    if (isCapsule(i)) return overlapOfCapsules(offset, turnOf(i).col(1), turnOf(j).col(1));
    std::vector<Vec3> axes{offset};
    const Mat3 a = turnOf(i), b = turnOf(j);
    for (int k = 0; k < 3; ++k) {
      if (!isSphere(i)) axes.push_back(a.col(k));
      if (!isSphere(j)) axes.push_back(b.col(k));
      for (int l = 0; l < 3 && !isSphere(i) && !isSphere(j); ++l) axes.push_back(a.col(k).cross(b.col(l)));
    }
    if (isOctahedron(i)) {
      axes = octahedronAxes(a, false);
      for (const Vec3& normal : octahedronAxes(b, false)) axes.push_back(normal);
      for (const Vec3& edge : octahedronAxes(a, true))
        for (const Vec3& other : octahedronAxes(b, true)) axes.push_back(edge.cross(other));
    }
    double least = 1;
    for (const Vec3& axis : axes)
      if (axis.norm() > 1e-6)
        least = std::min(least, (reachAlong(i, axis) + reachAlong(j, axis) - std::abs(offset.dot(axis))) / axis.norm());
    return least;
  }

  std::vector<RigidBody> bodies_;
  std::vector<Vec3> positions_, velocities_;
  std::vector<Quat> turns_;
  ContactGeometry geometry_;
  Vec3 gravity_ = Vec3::Zero();
  VectorX state_;
  std::unique_ptr<SoftStep> step_;
};

}  // namespace cradle
