#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "trajectory/trajectory_file.h"

namespace cradle {

class World;
class StrictWatch;

/// How a scene is read: what the command line puts in place of what it says, and where its meshes may be.
struct SceneOptions {
  std::optional<std::string> accuracy = {};  // a number, or a word of a scene's
  std::optional<std::string> method = {};
  std::optional<double> timeStep = {};  // s
  std::optional<double> duration = {};  // s
  std::string assetRoot;                // folder that meshes must be below; empty: they may be anywhere
};

struct SimulateOptions {
  SceneOptions scene;
  bool checksAccuracy = false;  // afterwards, by finer runs; printed, and the horizon goes into the trajectory
  bool findsHorizon = false;    // the same, not printed
  bool untilItFails = false;    // a run that becomes unstable leaves a whole trajectory of what was before
  bool isFresh = false;         // a FILE.part that an ended run has left is replaced, and no run goes on with it
  bool isStrict = false;  // ends at the first broken promise or correction, or where bodies are too deep in others
};

/// `cradle simulate SCENE -o FILE.sqlite`. Throws as loading, simulating and writing do; an unfinished run says what it
/// kept.
void simulateScene(const std::string& scenePath, const std::string& output, const SimulateOptions& options, bool quiet);

/// A scene file with its warnings printed to stderr, options applied.
Scene loadSceneAndWarn(const std::string& path, const SceneOptions& options);

/// Simulates a scene into a trajectory file and finishes it, with progress and warnings on stderr. `world` is at its
/// start.
void simulateInto(TrajectoryWriter& writer, const Scene& scene, World& world, bool quiet);

/// The same, but a run that becomes unstable after its first frame is finished as far as it went; its error is returned
/// then, and told in the trajectory.
std::optional<std::string> simulateUntilItFails(TrajectoryWriter& writer, const Scene& scene, World& world, bool quiet);

}  // namespace cradle
