#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "math/key_frame_path.h"
#include "scene/scene.h"

namespace cradle {

/// Shapes of sketches. Models are files of assets/.
enum class SketchShape { sphere, box, cylinder, capsule, prismHull, prism, gear, torus, plane };

struct SketchMaterial {
  double restitution = 0, staticFriction = 0, dynamicFriction = 0;
};

/// How a driven body moves: by key frames if there are any, else as an oscillation if it has a frequency, else with the
/// velocities of the body.
struct SketchDrive {
  std::vector<KeyFrame> keys;     // the first at the body's own pose
  Vec3 amplitude = Vec3::Zero();  // m, world
  double frequency = 0;           // 1/s
  double phase = 0;               // rad
};

struct SketchBody {
  SketchShape shape = SketchShape::sphere;
  Vec3 size = Vec3::Ones();  // m: edges of a box; radius, length (cylinder, capsule); x alone: radius, scale of a model
  bool isStatic = false;
  double mass = 1;  // kg
  int material = 0;
  RigidTransform worldFromBody;         // of a plane: +y is its normal
  Vec3 linearVelocity = Vec3::Zero();   // m/s
  Vec3 angularVelocity = Vec3::Zero();  // rad/s, world
  bool collides = true;
  std::optional<SketchDrive> drive;  // of a driven body, whose shape is its own image in all mirrors

  bool isDynamic() const { return !isStatic && !drive; }
};

enum class SketchLinkKind { spring, rod, rope, ballJoint, hinge, slider, weld };

struct SketchLink {
  SketchLinkKind kind = SketchLinkKind::ballJoint;
  int bodyA = 0, bodyB = -1;  // -1: the world
  Vec3 anchorA = Vec3::Zero(), anchorB = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();          // of a hinge or slider, frame of A
  double length = 0;                  // m: of a rod, at rest, or at most
  double stiffness = 0, damping = 0;  // N/m, N s/m
  double restitution = 0;             // of a rope
  std::optional<JointRange> limits;   // of a hinge or slider
  std::optional<JointDrive> motor;    // likewise
};

/// A scene as what stands in it, so that it can be seen in a mirror, turned, made larger, or put in another order.
/// What is known of its motion beforehand comes with it.
struct SceneSketch {
  std::string name;
  double duration = 0.1, framesPerSecond = 240, accuracy = 1e-6;
  Vec3 gravity = Vec3(0, -9.81, 0);
  std::vector<SketchMaterial> materials;
  std::vector<SketchBody> bodies;
  std::vector<SketchLink> links;

  /// Of a scene that is its own image in the mirror x = 0: each body's image, a body in the mirror's plane its own;
  /// else empty.
  std::vector<int> images;
  /// Where a body is displaced to at the end (m), from a closed form.
  struct Displacement {
    int body = 0;
    Vec3 value = Vec3::Zero();
  };
  std::vector<Displacement> displacements;
};

/// The scene file's text.
std::string textOf(const SceneSketch& sketch);

/// About the radius (m) of the ball around a body.
double sizeOf(const SketchBody& body);

/// m: of the smallest dynamic body.
double smallestSizeOf(const SceneSketch& sketch);

/// Where a body is at time 0.
RigidTransform startPoseOf(const SketchBody& body);

Vec3 anchorInWorld(const SceneSketch& sketch, int body, const Vec3& point);
Vec3 anchorInBody(const SceneSketch& sketch, int body, const Vec3& point);

}  // namespace cradle
