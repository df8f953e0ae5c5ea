#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "collision/core.h"
#include "collision/random_poses.h"

// Convex cores of every kind for tests of what is computed between two of them.

namespace cradle {

/// A core whose support value, and how far outside a point is (m, <= 0 inside), are written down here once more,
/// without the program's. In its own frame.
struct SampleCore {
  std::string name;
  Collider collider;
  std::function<double(const Vec3&)> supportValue;
  std::function<double(const Vec3&)> outside;
};

inline SampleCore boxCore(const std::string& name, const Vec3& size) {
  return {name, colliderOf(Box{size}, {}), [=](const Vec3& n) { return n.cwiseAbs().dot(size / 2); },
          [=](const Vec3& p) { return (p.cwiseAbs() - size / 2).maxCoeff(); }};
}

inline SampleCore cylinderCore(const std::string& name, double radius, double length) {
  const auto fromAxis = [](const Vec3& p) { return std::hypot(p.x(), p.z()); };
  return {name, colliderOf(Cylinder{radius, length}, {}),
          [=](const Vec3& n) { return length / 2 * std::abs(n.y()) + radius * fromAxis(n); },
          [=](const Vec3& p) { return std::max(fromAxis(p) - radius, std::abs(p.y()) - length / 2); }};
}

inline SampleCore segmentCore(double length) {
  return {"segment", colliderOf(Capsule{0.1 * length, length}, {}),
          [=](const Vec3& n) { return length / 2 * std::abs(n.y()); },
          [=](const Vec3& p) { return Vec3(p.x(), std::max(0.0, std::abs(p.y()) - length / 2), p.z()).norm(); }};
}

inline SampleCore pointCore(double radius) {
  return {"point", colliderOf(Sphere{radius}, {}), [](const Vec3&) { return 0.0; },
          [](const Vec3& p) { return p.norm(); }};
}

/// A tetrahedron without any symmetry, by its corners and its faces' planes.
inline SampleCore tetrahedronCore(double size) {
  const std::vector<Vec3> corners{size * Vec3(-0.4, -0.3, -0.2), size * Vec3(0.7, -0.2, 0.1),
                                  size * Vec3(-0.1, 0.6, 0.05), size * Vec3(0, -0.1, 0.5)};
  const auto outside = [=](const Vec3& p) {
    double most = -INFINITY;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 &a = corners[(i + 1) % 4], &b = corners[(i + 2) % 4], &c = corners[(i + 3) % 4];
      Vec3 normal = (b - a).cross(c - a).normalized();
      if (normal.dot(corners[i] - a) > 0) normal = -normal;
      most = std::max(most, normal.dot(p - a));
    }
    return most;
  };
  const auto supportValue = [=](const Vec3& n) {
    double farthest = -INFINITY;
    for (const Vec3& corner : corners) farthest = std::max(farthest, n.dot(corner));
    return farthest;
  };
  return {"tetrahedron", colliderOf(convexHullOf(corners), {}), supportValue, outside};
}

/// All kinds, some of them thin, about one `size` (m) large.
inline std::vector<SampleCore> sampleCores(double size) {
  return {pointCore(0.3 * size),
          segmentCore(1.2 * size),
          cylinderCore("drum", 0.5 * size, 0.8 * size),
          cylinderCore("disc", 0.6 * size, 0.01 * size),
          boxCore("box", size * Vec3(1, 0.6, 1.4)),
          boxCore("plate", size * Vec3(1.1, 0.01, 0.7)),
          tetrahedronCore(size)};
}

/// Two cores in their poses. Keeps references to both.
struct CorePair {
  const SampleCore &sampleA, &sampleB;
  RigidTransform poseA, poseB;
  Core a{sampleA.collider, poseA}, b{sampleB.collider, poseB};

  bool isRound() const { return a.isRound() || b.isRound(); }
  /// The gap (m) that a unit normal sees, by the support values above.
  double gapSeen(const Vec3& n) const {
    return n.dot(poseB.translation - poseA.translation) - sampleA.supportValue(poseA.rotation.conjugate() * n) -
           sampleB.supportValue(poseB.rotation.conjugate() * Vec3(-n));
  }
  std::string name() const { return sampleA.name + " and " + sampleB.name; }
};

/// Calls check(pair) for random poses of all pairs, `reach` (m, of cores of 1 m) about the origin, `each` of a pair.
/// Sizes and reach are those times `size`.
template <class Check>
void forRandomCorePairs(double size, double reach, int each, const Check& check) {
  const std::vector<SampleCore> cores = sampleCores(size);
  RandomPoses random(7);
  for (const SampleCore& a : cores)
    for (const SampleCore& b : cores)
      for (int i = 0; i < each; ++i) {
        const RigidTransform poseA = random.pose(reach * size), poseB = random.pose(reach * size);
        check(CorePair{a, b, poseA, poseB});
      }
}

}  // namespace cradle
