#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cradle {

// Folders of pictures, and of what is known of them.

inline const std::string kPictureKind = "frame", kHiddenKind = "hidden", kInstancesKind = "instances",
                         kPassesKind = "passes";

// Files of a whole film beside passes: each frame's camera, events, what the film was drawn from, and the trajectory of
// a scene that had no file of its own.
inline constexpr const char* kCameraFile = "camera.json";
inline constexpr const char* kEventsFile = "events.json";
inline constexpr const char* kOriginFile = "truth.json";
inline constexpr const char* kKeptTrajectory = "trajectory.sqlite";
// Of a sample of a data set, whose pictures stand in its folder: its scene, and what is known of it.
inline constexpr const char* kSceneFile = "scene.json";
inline constexpr const char* kRecordFile = "sample.json";

/// A file of one frame: a picture, a pass by its name, or what goes with passes.
struct FrameFile {
  std::string kind;
  long frame = 0;
};

/// KIND_000000.png of pictures, .json of instances, .exr of passes in one file, else .npy.
std::string frameFileName(const FrameFile& file);

/// The file that a name, or that of one that is being written, stands for; nothing for other names.
std::optional<FrameFile> parseFrameFile(const std::string& name);

struct FrameRange {
  long first, end;  // half-open
};
constexpr long kMaxFrames = 1'000'000;  // that file names have digits for

/// Refuses, with Error(output), a folder with others' files.
void requireFramesAlone(const std::string& folder);

/// The frames of a range of which a folder lacks a file of one of these kinds, ascending.
std::vector<long> framesToDraw(const std::string& folder, const FrameRange& range,
                               const std::vector<std::string>& kinds);

/// Refuses, with Error(output), a folder with others' files, and, unless `overwrites`, one with files of these kinds
/// and frames.
void requireRoom(const std::string& folder, const FrameRange& range, const std::vector<std::string>& kinds,
                 bool overwrites);

/// Refuses, with Error(output), a folder with files of frames that a film has not: they would get between its own when
/// it is encoded.
void requireNoOthers(const std::string& folder, long frameCount);

}  // namespace cradle
