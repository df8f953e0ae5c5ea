#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cradle/error.h"

// SI units, right-handed frames, y up unless gravity is along another axis. docs/library.md has an example.

namespace cradle::v1 {

using Vector3 = std::array<double, 3>;
using Quaternion = std::array<double, 4>;              // w, x, y, z; a unit one
using Matrix3 = std::array<std::array<double, 3>, 3>;  // rows

/// The cause of a body's motion: forces, nothing, or what the scene prescribes.
enum class Motion { dynamic, fixed, driven };

/// A body as the scene places it.
struct Body {
  std::string name;
  Motion motion = Motion::dynamic;
  double mass = 0;            // kg; 0 unless dynamic
  Vector3 centerOfMass{};     // m, frame of the body
  Matrix3 inertiaTensor{};    // kg m^2, about the centre of mass, axes of the body's frame
  Vector3 position{};         // m, world: of the centre of mass at the start
  Quaternion orientation{1};  // worldFromBody, at the start
  Vector3 linearVelocity{};   // m/s, world, of the centre of mass at the start
  Vector3 angularVelocity{};  // rad/s, world, at the start
};

/// A scene: checked, its meshes read and their mass properties computed. It does not change, and copies share it.
class Scene {
 public:
  /// Reads a scene file (docs/scene_file.md) and the meshes that it names. Throws Error(scene) with every fault of the
  /// text, or Error(mesh).
  static Scene load(const std::string& path);

  /// The same for a text, as a library for JSON writes it. `path` stands for it in messages; paths of meshes start from
  /// its folder.
  static Scene parse(const std::string& text, const std::string& path = "scene.json");

  const std::string& name() const;
  const std::string& text() const;
  double duration() const;                  // s
  long frameCount() const;                  // of a trajectory
  int pictureWidth() const;                 // pixels
  int pictureHeight() const;                // pixels
  const std::vector<Body>& bodies() const;  // copies written out, in the order of the text

  std::vector<int> movingBodies() const;    // indices of those that are dynamic or driven: Frame::states
  std::vector<std::string> joints() const;  // names of hinges, then of sliders: Frame::joints

  /// What the user should know about the scene that is no error.
  const std::vector<std::string>& warnings() const;

  struct Content;
  const Content& content() const { return *content_; }

  Scene(const Scene&) = default;  // for moves as well: a scene always has its content
  Scene& operator=(const Scene&) = default;

 private:
  explicit Scene(std::shared_ptr<const Content> content) : content_(std::move(content)) {}

  std::shared_ptr<const Content> content_;
};

}  // namespace cradle::v1
