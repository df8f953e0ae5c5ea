#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "collision/hull_manifold.h"
#include "collision/separation.h"

namespace cradle {

/// Where and how fast a moving body is. What tells whether a pair is near stands in the first two lines of memory.
struct alignas(64) MovingPose {
  Vec3 boxCenter = Vec3::Zero();       // m, world: of a box along the world's axes around the collider
  Vec3 boxHalf = Vec3::Zero();         // m
  Vec3 linearVelocity = Vec3::Zero();  // m/s, world
  double spinSpeed = 0;                // m/s: of the surface by turning, at most
  Vec3 position = Vec3::Zero();        // m, world, of the centre of mass
  double turned = 0;                   // rad, since the start, to and fro
  double radius = 0;                   // m, of the collider about the centre of mass
  bool isAsleep = false;
  double spinRadius = 0;                // m: how far from it turning moves the surface; 0 for a sphere about its centre
  Vec3 angularVelocity = Vec3::Zero();  // rad/s, world
  Mat3 rotation = Mat3::Identity();     // worldFromBody
};

/// A heap at the begin of a step, or of of a group of its sub-steps.
struct SoftStepStart {
  const std::vector<MovingPose>& poses;
  const VectorX& state;        // the same poses
  double timeStep;             // s, of the step or group of sub-steps to come
  double margin;               // m: what comes nearer than that in it is in contact
  double timeLeft = timeStep;  // s, until the step ends of which it is a piece

  const MovingPose& poseOf(int body) const {
    static const MovingPose fixed{};
    return body == kFixed ? fixed : poses[static_cast<std::size_t>(body)];
  }
};

/// A pair with a moving body first.
struct SoftPair {
  std::uint32_t pair = 0;    // index into ContactGeometry::pairs
  std::uint32_t shapeA = 0;  // collider
  std::uint32_t shapeB = 0;  // collider or plane
  int bodyA = kFixed, bodyB = kFixed;
  bool againstPlane = false, isExchanged = false;
  HullAxis axis = Vec3::Zero();  // of two hulls: for the next look
};

/// The contact manifolds of a heap's pairs: boxes, hulls, spheres and capsules fast, but a sphere or capsule with a
/// hull, a capsule with a box and other shapes through the general search.
class SoftManifolds {
 public:
  /// Keeps a reference to `geometry`. `scale`: of lengths, as collision/predicted_manifold.h has it.
  explicit SoftManifolds(const ContactGeometry& geometry, double scale = 1);

  SoftPair pairOf(std::size_t index) const;

  /// Its contact in the step to come.
  PredictedManifold manifoldOf(SoftPair& pair, const SoftStepStart& look, std::vector<Contact>& scratch) const;

 private:
  enum class Shape : char { sphere, capsule, box, hull, any };
  struct BoxShape {
    Vec3 center;  // m, from the centre of mass, body's frame; world if fixed
    Mat3 axes;
    Vec3 halfSize;
  };

  static std::optional<BoxShape> boxOf(const Collider& collider);
  bool isFast(const SoftPair& pair) const;
  bool areHulls(const SoftPair& pair) const;
  PredictedManifold manifoldOfHulls(SoftPair& pair, const SoftStepStart& look) const;
  PredictedManifold manifoldOfFastShapes(const SoftPair& pair, const SoftStepStart& look) const;
  PredictedManifold manifoldOfAnyShapes(const SoftPair& pair, const SoftStepStart& look,
                                        std::vector<Contact>& scratch) const;

  const ContactGeometry& geometry_;
  const double scale_;
  std::vector<std::optional<BoxShape>> boxes_;  // of each collider
  std::vector<Shape> shapes_;                   // of each collider
};

}  // namespace cradle
