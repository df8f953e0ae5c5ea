#pragma once

#include <Eigen/Eigenvalues>
#include <vector>

#include "impact/contact_blocks.h"
#include "math/rotation.h"

namespace cradle {

/// Bodies as the soft contact solver sees them, and what they do in the world by Newton's and Euler's laws. Anchors of
/// manifolds are floats: their error is 6e-8 of a metre.
class SolverBodies {
 public:
  /// The inertia tensor (kg m^2) is in the world's axes.
  int add(double mass, const Mat3& inertiaTensor, const Vec3& position, const Mat3& worldFromBody = Mat3::Identity()) {
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(inertiaTensor);
    const Vec3 roots = principal.eigenvalues().cwiseSqrt();
    const Mat3 principalFromWorld = principal.eigenvectors().transpose();
    masses_.push_back(mass), inertias_.push_back(inertiaTensor), positions_.push_back(position);
    scaledFromWorld_.push_back(roots.asDiagonal() * principalFromWorld);
    bodies.push_back({1 / mass, roots.cwiseInverse().asDiagonal() * principalFromWorld, worldFromBody});
    return static_cast<int>(bodies.size()) - 1;
  }
  /// A contact of A with B, or with what is fixed, at points (m, world).
  PersistentManifold manifoldOf(int a, int b, const Vec3& normal, const std::vector<Vec3>& points) const {
    PersistentManifold manifold;
    manifold.bodyA = a, manifold.bodyB = b, manifold.count = static_cast<std::int32_t>(points.size());
    manifold.normal = normal;
    for (std::size_t i = 0; i < points.size(); ++i) {
      manifold.onA[i] = anchorOn(static_cast<std::size_t>(a), points[i]);
      if (b != kFixed) manifold.onB[i] = anchorOn(static_cast<std::size_t>(b), points[i]);
    }
    return manifold;
  }

  BodyMotion motionOf(std::size_t body, const Vec3& velocity, const Vec3& spin) const {
    const Vec3 u = scaledFromWorld_[body] * spin;
    return {Lanes{velocity.x(), velocity.y()}, Lanes{velocity.z(), u.x()}, Lanes{u.y(), u.z()}};
  }
  static Vec3 linearOf(const BodyMotion& motion) { return {motion.xy[0], motion.xy[1], motion.zu[0]}; }
  Vec3 angularOf(const BodyMotion& motion, std::size_t body) const {
    return scaledFromWorld_[body].inverse() * Vec3(motion.zu[1], motion.vw[0], motion.vw[1]);
  }
  Vec3 pointVelocity(const std::vector<BodyMotion>& motions, int body, const Vec3& point) const {
    if (body == kFixed) return Vec3::Zero();
    const auto i = static_cast<std::size_t>(body);
    return linearOf(motions[i]) + angularOf(motions[i], i).cross(point - positions_[i]);
  }
  /// An impulse (N s) at a point (m) and an angular impulse (N m s), both world. Nothing if fixed.
  void push(int body, const Vec3& point, const Vec3& impulse, const Vec3& angularImpulse,
            std::vector<BodyMotion>& motions) const {
    if (body == kFixed) return;
    const auto i = static_cast<std::size_t>(body);
    const Vec3 turning = (point - positions_[i]).cross(impulse) + angularImpulse;
    motions[i] = motionOf(i, linearOf(motions[i]) + impulse / masses_[i],
                          angularOf(motions[i], i) + inertias_[i].inverse() * turning);
  }
  /// J
  double energyOf(const std::vector<BodyMotion>& motions) const {
    double sum = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Vec3 v = linearOf(motions[i]), w = angularOf(motions[i], i);
      sum += 0.5 * (masses_[i] * v.squaredNorm() + w.dot(inertias_[i] * w));
    }
    return sum;
  }

  std::vector<SolverBody> bodies;

 protected:
  PersistentManifold::Anchor anchorOn(std::size_t body, const Vec3& point) const {
    return (bodies[body].worldFromBody.transpose() * (point - positions_[body])).cast<float>();
  }

  std::vector<double> masses_;
  std::vector<Mat3> inertias_, scaledFromWorld_;
  std::vector<Vec3> positions_;
};

/// An inertia tensor without symmetry (kg m^2).
inline Mat3 lopsidedInertia() {
  const Mat3 turn = rotationAbout(Vec3(1, 2, 3), 0.7).toRotationMatrix();
  const Mat3 tensor = turn * Vec3(0.02, 0.05, 0.06).asDiagonal() * turn.transpose();
  return (tensor + tensor.transpose()) / 2;
}

}  // namespace cradle
