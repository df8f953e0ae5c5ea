#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cradle/scene.h"

namespace cradle::v1 {

/// State of a body that moves.
struct BodyState {
  Vector3 position{};         // m, world, of the centre of mass
  Quaternion orientation{1};  // worldFromBody
  Vector3 linearVelocity{};   // m/s, world, of the centre of mass
  Vector3 angularVelocity{};  // rad/s, world
};

/// kinetic + potential + dissipated - work + numerical is constant.
struct EnergyBalance {
  double kinetic = 0, potential = 0;  // J
  double dissipated = 0;              // J since the start: impact + friction + damping
  double impact = 0;                  // J since the start, by impacts; NaN: not known
  double friction = 0;                // J since the start, by lasting contacts; NaN: not known
  double damping = 0;                 // J since the start, by springs; NaN: not known
  double numerical = 0;               // J since the start, by errors of the method; < 0: gained
  double work = 0;                    // J since the start, by pushes, motors and driven bodies
  Vector3 momentum{};                 // kg m/s
  Vector3 angularMomentum{};          // kg m^2/s, about the world's origin
};

/// State of a hinge or a slider: A against B.
struct JointState {
  double coordinate = 0;  // rad or m, 0 at the start; whole turns are counted
  double velocity = 0;    // rad/s or m/s
  double force = 0;       // N m or N, of its motor on A
};

/// What body A does to body B by a contact that lasts.
struct ContactForce {
  long contact = 0;          // number of the contact, from 0
  int bodyA = 0, bodyB = 0;  // indices into the scene's bodies
  Vector3 force{};           // N, world, on B
  Vector3 normalForce{};     // N, world, on B: the part along the normals
  Vector3 torque{};          // N m, world, on B about `point`
  Vector3 point{};           // m, world: the centre of pressure
};

struct Frame {
  long number = 0;
  double time = 0;                // s
  std::vector<BodyState> states;  // in the order of Trajectory::movingBodies()
  EnergyBalance energy;
  std::vector<JointState> joints;      // in the order of Trajectory::joints()
  std::vector<ContactForce> contacts;  // ascending by bodies
};

/// An impact, or another change of the motion between frames.
struct Event {
  double time = 0;            // s
  std::string kind;           // "impact", "taut", "rest", "slip", ...: docs/trajectory_file.md
  int bodyA = 0, bodyB = -1;  // indices into the scene's bodies; -1: the world
  Vector3 point{};            // m, world
  Vector3 normal{};           // unit, from A to B
  double impulse = 0;         // N s
};

/// A motion: that of a file, or of a simulation, in a file without a name below TMPDIR, which goes with the last copy.
/// One thread at a time uses it.
class Trajectory {
 public:
  /// Opens a trajectory file, finished or not (a .part). Throws Error(usage) if it is none or is damaged.
  static Trajectory open(const std::string& path);

  /// Of the scene, as the trajectory holds it.
  const std::string& sceneText() const;

  std::vector<std::string> bodies() const;   // names of all bodies of the scene
  std::vector<int> movingBodies() const;     // indices of those that are dynamic or driven
  std::vector<std::string> joints() const;   // names of those with a coordinate: hinges, then sliders
  const std::vector<double>& times() const;  // s, of the frames, ascending
  long frameCount() const { return static_cast<long>(times().size()); }

  /// Frame `number` of 0..frameCount()-1. Throws Error(usage) for others, or if the file is damaged.
  Frame frame(long number) const;

  /// In the order of time.
  std::vector<Event> events() const;

  /// s: the time from which on the motion is one of many, if that was found.
  std::optional<double> horizon() const;

  /// Version, method, promise and more, as text: the table `meta` of docs/trajectory_file.md.
  const std::map<std::string, std::string>& meta() const;

  /// Writes it as a trajectory file, which the program reads; a trajectory of that name is replaced when all is
  /// written. Throws Error(output), also if another kind of file is there, or the unfinished trajectory of
  /// a run; Error(usage) if this one is unfinished.
  void save(const std::string& path) const;

  struct Content;
  const std::shared_ptr<Content>& content() const { return content_; }
  explicit Trajectory(std::shared_ptr<Content> content) : content_(std::move(content)) {}
  Trajectory(const Trajectory&) = default;  // for moves as well: a trajectory always has its content
  Trajectory& operator=(const Trajectory&) = default;

 private:
  std::shared_ptr<Content> content_;
};

}  // namespace cradle::v1
