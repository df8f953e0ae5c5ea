#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "math/prescribed_motion.h"
#include "math/types.h"
#include "mesh/convex_hull.h"
#include "mesh/load_mesh.h"
#include "mesh/mass_properties.h"
#include "mesh/primitives.h"
#include "mesh/recognise_shape.h"

// A scene file as plain data: checked, defaults filled in, references turned into indices, meshes loaded.

namespace cradle {

constexpr int kWorld = -1;  // in place of a body index: the world

/// What a surface is painted with, in its body's frame, so that its turning is seen.
enum class Pattern { none, stripes, checks, beachBall };

struct Material {
  std::string name;                // empty: the material of bodies that name none
  double density = 1000;           // kg/m^3
  double restitution = 0;          // 0..1
  double staticFriction = 0.5;     // >= dynamicFriction
  double dynamicFriction = 0.5;    // >= 0
  std::optional<Vec3f> baseColor;  // sRGB, 0..1; unset: #b0b0b0, or what a model's file says
  double metallic = 0;             // 0..1
  double roughness = 0.5;          // 0..1
  Pattern pattern = Pattern::none;
  Vec3f patternColor = Vec3f::Ones();  // sRGB, 0..1, beside baseColor
  SharedTexture texture = {};          // of mesh shapes, in place of that of their file, times baseColor; or none
};

/// How two materials meet: as `pairs` says, else restitution minimum, frictions geometric mean.
struct SurfacePair {
  double restitution = 0, staticFriction = 0.5, dynamicFriction = 0.5;
};

/// The solid half of a mesh shape is models[model].solid in the body's frame, scale applied.
struct ModelShape {
  int model = 0;  // index into Scene::models
};

/// What a model is for the collision of its bodies, as far as they ask.
struct ModelCollision {
  RecognisedShape recognised;
  std::optional<ConvexHull> hull;  // if it is convex and no primitive, or a body asks for the hull
};
using Shape = std::variant<Sphere, Box, Cylinder, Capsule, Plane, ModelShape>;

enum class CollisionChoice { automatic, sphere, box, hull, mesh, none };
/// The cause of a body's motion: forces, nothing, or `prescribed`, whatever acts on it.
enum class Motion { dynamic, fixed, driven };

struct Body {
  std::string name;
  std::string where;              // place in the scene file, for messages: "FILE:LINE:COLUMN /bodies/0"
  int entry = 0;                  // index into `bodies` of the scene file; that of all its copies
  std::string category = "body";  // what kind of thing it is, for those who learn from pictures
  int material = 0;               // index into Scene::materials
  bool namesMaterial = false;
  Shape shape = Sphere{};
  CollisionChoice collision = CollisionChoice::automatic;
  Motion motion = Motion::dynamic;
  std::optional<PrescribedMotion> prescribed;  // of the body's frame; if driven
  MassProperties massProperties;               // body's frame; mass 0 unless dynamic
  RigidTransform worldFromBody;                // start; of the body's frame, not of the centre of mass
  Vec3 linearVelocity = Vec3::Zero();          // m/s, world, of the centre of mass
  Vec3 angularVelocity = Vec3::Zero();         // rad/s, world
};

/// A point of a body's frame, or of the world.
struct Anchor {
  int body = kWorld;
  Vec3 point = Vec3::Zero();  // m
};

enum class LinkKind { spring, rod, rope, ballJoint, hinge, slider, weld };  // joints last

// Links: what ties a point of a body to a point of another, or of the world. Of each kind, kDirections tells in how
// many directions it can hold its ends: rows of the matrix that is solved.

struct Spring {
  static constexpr LinkKind kKind = LinkKind::spring;
  static constexpr const char* kNoun = "spring";
  static constexpr int kDirections = 0;
  std::string name, where;
  Anchor anchorA, anchorB;
  double stiffness = 0;   // N/m, >= 0
  double damping = 0;     // N s/m, >= 0
  double restLength = 0;  // m, >= 0
};

struct Rod {
  static constexpr LinkKind kKind = LinkKind::rod;
  static constexpr const char* kNoun = "rod";
  static constexpr int kDirections = 1;
  std::string name, where;
  Anchor anchorA, anchorB;
  double length = 0;  // m, > 0
};

struct Rope {
  static constexpr LinkKind kKind = LinkKind::rope;
  static constexpr const char* kNoun = "rope";
  static constexpr int kDirections = 1;
  std::string name, where;
  Anchor anchorA, anchorB;
  double maxLength = 0;    // m, > 0
  double restitution = 0;  // 0..1
};

struct BallJoint {
  static constexpr LinkKind kKind = LinkKind::ballJoint;
  static constexpr const char* kNoun = "ball joint";
  static constexpr int kDirections = 3;
  std::string name, where;
  Anchor anchorA, anchorB;
  bool collide = false;  // whether its bodies touch each other
};

/// How far A may move along the axis of a slider (m), or turn about that of a hinge (rad), against B; 0 at the start.
struct JointRange {
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  double restitution = 0;  // 0..1, where it ends
};

/// A motor on that coordinate, of A against B.
struct JointDrive {
  std::optional<double> targetVelocity;  // m/s or rad/s; unset: a constant force
  double force = 0;                      // N or N m; with a target velocity the most, >= 0
};

struct Hinge {
  static constexpr LinkKind kKind = LinkKind::hinge;
  static constexpr const char* kNoun = "hinge";
  static constexpr int kDirections = 5;
  std::string name, where;
  Anchor anchorA, anchorB;
  Vec3 axis = Vec3::UnitZ();  // unit, frame of body A
  bool collide = false;       // whether its bodies touch each other
  std::optional<JointRange> limits = {};
  std::optional<JointDrive> motor = {};
};

/// Lets A move along an axis of B, and does not let it turn against B. (A prismatic joint.)
struct Slider {
  static constexpr LinkKind kKind = LinkKind::slider;
  static constexpr const char* kNoun = "slider";
  static constexpr int kDirections = 5;
  std::string name, where;
  Anchor anchorA, anchorB;
  Vec3 axis = Vec3::UnitZ();  // unit, frame of body A
  bool collide = false;       // whether its bodies touch each other
  std::optional<JointRange> limits = {};
  std::optional<JointDrive> motor = {};
};

/// Keeps A where it is on B. Bodies that welds make one do not touch each other.
struct Weld {
  static constexpr LinkKind kKind = LinkKind::weld;
  static constexpr const char* kNoun = "weld";
  static constexpr int kDirections = 6;
  std::string name, where;
  Anchor anchorA, anchorB;
};

/// A force for a time at a point of a body, or at the first hit of a ray on its surface.
struct Push {
  struct Ray {
    Vec3 origin, direction;  // m, unit; world
  };
  std::string where;
  int body = 0;
  std::variant<Vec3, Ray> target;   // a point of the body's frame (m), or a ray; not of a torque
  Vec3 force = Vec3::Zero();        // N, world
  double start = 0;                 // s
  double duration = 0;              // s, > 0
  std::optional<Vec3> torque = {};  // N m, world, in place of the force
};

enum class MethodName { explicitEuler, semiImplicitEuler, rk4, dop853 };
struct Method {
  MethodName name = MethodName::semiImplicitEuler;
  std::optional<double> timeStep;  // s, > 0
  std::string where;
};

/// Frame k is at k * playbackSpeed / framesPerSecond.
struct Output {
  double framesPerSecond = 60, playbackSpeed = 1;  // 1/s, -; > 0
  int width = 1280, height = 720;                  // pixels, 1..16384
  std::string where;                               // the scene file itself if it says nothing of output
};

/// What one picture is seen from.
struct Camera {
  std::string where;
  Vec3 position = Vec3(0, 1, 5), target = Vec3::UnitY();  // m, world
  double verticalFieldOfView = 0.69813170;                // rad (40 degrees), 0..pi
  Vec3 up = Vec3::UnitY();                                // unit, world; not along the view

  /// Sees the same, wherever it is from.
  bool operator==(const Camera& other) const {
    return position == other.position && target == other.target && verticalFieldOfView == other.verticalFieldOfView &&
           up == other.up;
  }
};

/// How the camera of a film moves from where it starts, in this order: from key to key, with a body, around its target.
/// Times are the scene's.
struct CameraMotion {
  struct Key {
    double time = 0;  // s, ascending
    Vec3 position, target;
    double verticalFieldOfView = 0;
  };
  struct Follow {
    int body = 0;
    double lag = 0.25;  // s behind a body that goes straight on, >= 0
  };
  std::vector<Key> keys;              // none, or at least two
  std::optional<Follow> follow;       // moves with it, on a spring
  std::optional<double> orbitPeriod;  // s, of a turn about `up` through the target; < 0: clockwise from above
  int targetBody = kWorld;            // kept in the middle of the picture; kWorld: what else says where to look

  bool isNone() const { return keys.empty() && !follow && !orbitPeriod && targetBody == kWorld; }
};

struct Light {
  Vec3 direction = Vec3(-1, -2, -1).normalized();  // unit; the way the light goes
  Vec3f color = Vec3f::Ones();                     // sRGB, 0..1
  double intensity = 3;
};

/// The surroundings of a picture: a light day or the dark.
enum class Look { light, dark };

/// Words on the pictures of a film.
struct Caption {
  std::string text;
  double from = 0, to = std::numeric_limits<double>::infinity();  // s of the scene; half-open
  int body = kWorld;                                              // the one they go with; kWorld: none
  std::string where = {};                                         // the text in the scene file
};

/// A picture of words that a film begins with.
struct TitleCard {
  std::string title, subtitle;
  double seconds = 3;                               // of the film
  std::string titleWhere = {}, subtitleWhere = {};  // in the scene file
};

/// A direction of a body is that of the world's Y. The distance from it is the angle between them.
struct UpWish {
  int body = 0;
  Vec3 direction = Vec3::UnitY();  // unit, body's frame
};

/// The centre of mass of a body is in a box. The distance from it is that to the box.
struct InsideWish {
  int body = 0;
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  // m, world
};

/// Two bodies touch each other, whenever that is. The distance from it is the least between them.
struct ContactWish {
  int bodyA = 0, bodyB = 0;
};

/// What motions of a scene are sampled for, and how far from it they may be: distances are weighed as those of a normal
/// distribution with this deviation.
struct Wish {
  std::string where;
  std::variant<UpWish, InsideWish, ContactWish> kind;
  double time = std::numeric_limits<double>::infinity();  // s, of no contact; infinite: the end
  double deviation = 1;                                   // rad of UpWish, else m; > 0
};

/// From that impact of a body on, its bumps are of another seed.
struct BumpChange {
  int body = 0;
  int impact = 1;  // >= 1: of those of the body that have bumps
  std::uint64_t seed = 0;
};

/// Surfaces are not as smooth as their shapes: normals of impacts are tilted at random.
struct Bumps {
  double deviation = 0;  // rad, >= 0: standard deviation of each of the two angles across a normal
  std::uint64_t seed = 0;
  std::vector<BumpChange> changes;
};

struct Scene {
  std::string path, text;  // the file itself
  std::string name, description;
  double duration = 0;               // s, > 0
  Vec3 gravity = Vec3(0, -9.81, 0);  // m/s^2
  double accuracy = 1e-6;            // 1e-12..1e-2, bound on the local error
  bool namesAccuracy = false;
  std::string accuracyWhere;     // the scene file itself if it does not name one
  std::optional<Method> method;  // unset: the program chooses
  Output output;
  std::vector<Material> materials;
  std::vector<std::vector<SurfacePair>> surfacePairs;  // [material][material], symmetric
  std::vector<Model> models;
  std::vector<ModelCollision> modelCollisions;  // of each model
  std::vector<Body> bodies;                     // copies written out, in the order of the file
  std::vector<Spring> springs;
  std::vector<Rod> rods;
  std::vector<Rope> ropes;
  std::vector<BallJoint> ballJoints;
  std::vector<Hinge> hinges;
  std::vector<Slider> sliders;
  std::vector<Weld> welds;
  std::vector<Push> pushes;
  std::optional<Camera> camera;  // at the start; unset: framed so that all that moves stays in view
  CameraMotion cameraMotion;
  std::vector<Light> lights;  // at least one
  Look look = Look::light;
  std::vector<Caption> captions;
  std::optional<TitleCard> titleCard;
  std::optional<Bumps> bumps;
  std::vector<Wish> wishes;
};

/// Calls visit(links) with the joints of each kind of a scene: those that join two points.
template <class AnyScene, class Visit>
void forEachKindOfJoint(AnyScene& scene, const Visit& visit) {
  visit(scene.ballJoints), visit(scene.hinges), visit(scene.sliders), visit(scene.welds);
}

/// Calls visit(links) with the links of each kind of a scene, joints last.
template <class AnyScene, class Visit>
void forEachKindOfLink(AnyScene& scene, const Visit& visit) {
  visit(scene.springs), visit(scene.rods), visit(scene.ropes);
  forEachKindOfJoint(scene, visit);
}

/// The kind of the links in one of a scene's vectors.
template <class Links>
using LinkOf = typename std::decay_t<Links>::value_type;

/// Whether a camera looks along its own `up` (or its target is its position), so that no side of the picture is up.
bool looksAlongUp(const Camera& camera);

/// The axis of the world against gravity: the one that is up in pictures, and along which heights are. Y without
/// gravity, or if it is along no axis.
Vec3 upOf(const Scene& scene);

/// N: a trajectory has frames 0..N, a film pictures 0..N-1 (at least one).
long lastFrame(const Scene& scene);

/// Time of frame k of 0..N in s: not later than the duration.
double frameTime(const Scene& scene, long frame);

/// Simulated time from a frame to the next in s.
double frameInterval(const Scene& scene);

}  // namespace cradle
