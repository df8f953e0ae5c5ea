#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "math/random_stream.h"
#include "sampling/bump_changes.h"
#include "scene/draws.h"
#include "scene/load_scene.h"

namespace cradle {

/// A scene in which all draws are made.
struct DrawnScene {
  JsonValue document;              // without draws
  std::vector<DrawnValue> values;  // what was drawn, in the order of the file
  LoadedScene loaded;
  std::vector<std::string> bodyOrigins;  // JSON pointer, in the file with draws, of each entry of `bodies`
  int redrawn = 0;                       // times that a body was drawn again, for it overlapped others
  UniformNumbers numbers;                // that the draws were made with
  std::vector<NamedBumpChange> bumpChanges;
};

/// A scene file with values to be drawn: a distribution of scenes.
class SceneSampler {
 public:
  /// Throws Error(scene) with all faults of the draws. The meshes must be below `assetRoot`, unless that is empty.
  explicit SceneSampler(const std::string& path, const std::string& assetRoot = "");

  /// The scene of some numbers; behind the changes of its bumps are those of bodies that it has. Throws what loading it
  /// throws: drawn values may be out of range.
  DrawnScene sceneOf(const UniformSource& uniform, const std::vector<NamedBumpChange>& bumpChanges = {}) const;

  /// The scene of a seed and a sample's number. Bodies that overlap others, in entries of the file with draws, are
  /// drawn again until they do not, in the order of the file; those whose entries have no draws are there first. Throws
  /// Error(scene) where a body overlaps others in each of 1000 draws.
  DrawnScene sample(std::uint64_t seed, long number) const;

  /// The scene of some numbers; none if bodies of entries with draws overlap others. Throws as sceneOf does.
  std::optional<DrawnScene> possibleSceneOf(const UniformSource& uniform,
                                            const std::vector<NamedBumpChange>& bumpChanges) const;

  /// Whether each of its scenes has wishes, and as many.
  bool hasWishes() const;

  /// Whether its scenes may have bumps.
  bool hasBumps() const { return memberOf(document_, "bumps") != nullptr; }

  /// JSON pointers of all draws.
  std::vector<std::string> places() const { return drawPlaces(document_); }

  const std::string& path() const { return path_; }
  const std::string& text() const { return text_; }

 private:
  std::string path_, text_;
  JsonValue document_;
  ModelSource models_;
  TextureSource textures_;
};

/// The text of a drawn scene as a file in another folder than that of the scene with draws: the paths of its meshes and
/// textures lead to the same files from there.
std::string textInFolder(const DrawnScene& drawn, const std::string& scenePath, const std::string& folder);

}  // namespace cradle
