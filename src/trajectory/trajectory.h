#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "math/types.h"
#include "mesh/mass_properties.h"
#include "mesh/triangle_mesh.h"

// What a simulation leaves: states at frames, events between them, energies. The only bridge from physics to pictures.

namespace cradle {

/// State of one dynamic body.
struct BodyState {
  Vec3 position = Vec3::Zero();         // m, of the centre of mass
  Quat orientation = Quat::Identity();  // worldFromBody
  Vec3 linearVelocity = Vec3::Zero();   // m/s, of the centre of mass
  Vec3 angularVelocity = Vec3::Zero();  // rad/s, world
};

/// No number of a trajectory is as large (SI units): masses are at most 1e36 kg and velocities below 1e30 m/s, and an
/// energy is a product of one mass and two velocities.
constexpr double kLargestNumber = 1e100;

/// Whether something can be at that place (m): its numbers are finite and below 1e30, which no motion within the ranges
/// of scene files reaches.
bool isPossiblePlace(const Vec3& place);

/// Whether a body can have that state: its numbers are as those of possible places, and its orientation is a rotation
/// to 1e-3.
bool isPossible(const BodyState& state);

/// kinetic + potential + dissipated - work + numerical is constant.
struct EnergyBalance {
  double kinetic = 0;                   // J
  double potential = 0;                 // J, -sum m g.x + springs
  double dissipated = 0;                // J since the start: impact + friction + damping
  double impact = 0;                    // J since the start, by impacts of contacts and ropes; NaN: not known, as below
  double friction = 0;                  // J since the start, by lasting contacts
  double damping = 0;                   // J since the start, by springs' dampers
  double numerical = 0;                 // J since the start, by errors of the method; < 0: gained
  double work = 0;                      // J, by pushes since the start
  Vec3 momentum = Vec3::Zero();         // kg m/s
  Vec3 angularMomentum = Vec3::Zero();  // kg m^2/s, about the world origin
};

/// State of a hinge or a slider: A against B about its axis, or along it.
struct JointState {
  double coordinate = 0;  // rad or m, 0 at the start; whole turns are counted
  double velocity = 0;    // rad/s or m/s
  double force = 0;       // N m or N, of its motor on A
};

/// Whether a joint can have that state: its numbers are finite and below 1e100.
bool isPossible(const JointState& state);

/// What body A does to body B by a contact that lasts.
struct ContactWrench {
  long contact = -1;                // id of the LastingContact
  int bodyA = 0, bodyB = 0;         // indices into TrajectoryHeader::bodies
  Vec3 force = Vec3::Zero();        // N, world, on B: along the normals and friction
  Vec3 normalForce = Vec3::Zero();  // N, world, on B: the part along the normals
  Vec3 torque = Vec3::Zero();       // N m, world, on B about `point`
  Vec3 point = Vec3::Zero();        // m, world: the centre of pressure
};

/// Two bodies that press each other for a while.
struct LastingContact {
  long id = 0;                     // from 0, in the order in which they were noticed
  int bodyA = 0, bodyB = 0;        // indices into TrajectoryHeader::bodies
  double begin = 0;                // s
  std::optional<double> end = {};  // s; none: not known yet
};

/// The camera of a frame.
struct CameraPose {
  long frame = 0;
  Vec3 position = Vec3::Zero();         // m, world
  Quat orientation = Quat::Identity();  // worldFromCamera: x right, y up, z against the view
  double verticalFieldOfView = 0;       // rad
};

struct Frame {
  long number = 0;
  double time = 0;                // s
  std::vector<BodyState> states;  // one a dynamic or driven body, in the order of the bodies
  EnergyBalance energy;
  std::vector<JointState> joints = {};       // in the order of TrajectoryHeader::joints
  std::vector<ContactWrench> contacts = {};  // if they were asked for; ascending by bodies
};

/// A place from which a run goes on that was ended.
struct Checkpoint {
  long frame = 0;                // the last one by then
  long eventCount = 0;           // of events by then
  long contactCount = 0;         // of lasting contacts by then
  std::vector<long> goingOn;     // those of them that have not ended, by number
  std::string record;            // bytes, for the build of the program that wrote them; all of the above is in them
  std::string fingerprint = {};  // of that build, and of all that the motion depends on
};

/// contactBegin and contactEnd are those of a LastingContact: no trajectory has them as events of their own.
enum class EventKind {
  impact,
  taut,
  slack,
  rest,
  slip,
  stick,
  roll,
  release,
  wake,
  pushStart,
  pushEnd,
  pushMissed,
  contactBegin,
  contactEnd
};

struct Event {
  double time = 0;  // s
  EventKind kind = EventKind::impact;
  int bodyA = 0, bodyB = -1;   // indices into TrajectoryHeader::bodies; -1: the world
  Vec3 point = Vec3::Zero();   // m, world
  Vec3 normal = Vec3::Zero();  // unit, from A to B
  double impulse = 0;          // N s
};

/// A body as the trajectory describes it.
struct BodyRecord {
  std::string name;
  bool isDynamic = true;          // moved by forces
  bool isDriven = false;          // moves as is prescribed
  int mesh = -1;                  // index into TrajectoryHeader::meshes, or -1
  std::string shape;              // JSON of the primitive, as in the scene file; empty if it has a mesh
  MassProperties massProperties;  // body's frame; mass 0 unless dynamic

  bool hasStates() const { return isDynamic || isDriven; }
};

/// A joint with a coordinate as the trajectory describes it.
struct JointRecord {
  std::string name;
  std::string kind;           // hinge or slider
  int bodyA = 0, bodyB = -1;  // indices into TrajectoryHeader::bodies; -1: the world
};

/// All that is known before the first step.
struct TrajectoryHeader {
  std::string scene, scenePath;        // text of the scene file; path for messages
  std::string version;                 // of the program that made it
  std::string plan, accuracy, method;  // what was chosen, in words
  std::vector<BodyRecord> bodies;
  std::vector<Model> meshes;                 // named "path#object@scale"; drawn and solid
  std::vector<JointRecord> joints = {};      // hinges, then sliders
  std::vector<SharedTexture> textures = {};  // of the scene's materials; once read, those of meshes behind them
};

/// Begins RunCost::promise of a run that became unstable and was finished then; the cause follows.
constexpr const char* kFailedRun = "the run failed: ";

/// Of `meta`: the first frame from which on the motion is one of many, or "none" if all of it is the scene's.
constexpr const char* kHorizonKey = "horizon";

/// What is known after the last step.
struct RunCost {
  double cpuSeconds = 0;                         // integration alone
  long evaluations = 0;                          // of the right-hand side
  std::map<std::string, long> corrections = {};  // how often each kind was needed: what the motion owes to no law
  std::string promise = {};                      // what came of the promise of each group of bodies, one a line
};

struct Trajectory {
  TrajectoryHeader header;
  std::vector<Frame> frames;
  std::vector<Event> events;
  std::vector<LastingContact> contacts;  // by id
  RunCost cost;
};

/// Whether it is the begin or the end of a LastingContact.
inline bool isOfLastingContact(EventKind kind) {
  return kind == EventKind::contactBegin || kind == EventKind::contactEnd;
}

/// Name of an event kind as the files have it, and back (throws Error(scene) for an unknown one).
std::string eventKindName(EventKind kind);
EventKind eventKindFromName(const std::string& name);

}  // namespace cradle
