#pragma once

#include <optional>
#include <string>

namespace cradle {

/// What the command line may say about pictures.
struct PictureOptions {
  std::optional<std::string> size;     // "WIDTHxHEIGHT"
  std::optional<std::string> frames;   // "FIRST:END", half-open
  std::optional<std::string> overlay;  // as parseOverlays() reads it
  std::optional<std::string> shaders;  // folder
  std::string assetRoot;               // folder that a scene's meshes must be below; empty: they may be anywhere
  std::optional<std::string> passes;   // of `render`, as parsePasses() reads it; unset: rgb
  std::string passFormat = "npy";      // of `render`: npy or exr
  std::optional<std::string> shard;    // of `render`, "PART/PARTS", from 1/PARTS on: of the frames
  bool skipExisting = false;           // of `render`
  bool overwrite = false;              // of `render`
  double framesPerSecond = 60;         // of `encode`
};

/// `cradle render SCENE|TRAJECTORY -o FOLDER`: frame_000000.png, ..., and the files of other passes. Throws
/// Error(output) if the folder holds anything but frames of the film, or, without `overwrite`, some that are to be
/// drawn: several runs can draw parts of a film.
void renderFrames(const std::string& input, const std::string& folder, const PictureOptions& options, bool quiet);

/// `cradle encode FOLDER -o FILE.mp4`.
void encodeFrames(const std::string& folder, const std::string& film, double framesPerSecond, bool quiet);

}  // namespace cradle
