#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/part_lock.h"
#include "image/child_process.h"
#include "image/image.h"

namespace cradle {

/// What a film is, apart from its pictures.
struct VideoFormat {
  int width = 0, height = 0;   // pixels of the pictures, 1..16384
  double framesPerSecond = 0;  // > 0
};

/// Throws Error(usage) unless `path` ends as the name of a film does: .mp4, .m4v, .mov, .mkv or .gif.
void requireFilmName(const std::string& path);

/// A film in the making: pictures go through a pipe to ffmpeg, which writes H.264 (bt709, 4:2:0) to `path`.part;
/// finish() gives it its name. A .gif has a palette for each picture, and 50 of them in a second at most: of more, each
/// second, third, ... one. Same pictures, same bytes. An odd width or height grows by one pixel that repeats the
/// edge, for H.264 halves the colours' resolution. If the object goes before finish(), ffmpeg is ended and nothing is
/// left behind.
class VideoEncoder {
 public:
  /// Throws Error(usage) for another name, Error(output) if no file can be put
  /// there, Error(encoder) if ffmpeg cannot be started.
  VideoEncoder(std::string path, const VideoFormat& format);
  ~VideoEncoder();
  VideoEncoder(const VideoEncoder&) = delete;
  VideoEncoder& operator=(const VideoEncoder&) = delete;

  /// Appends a picture of the format's size. Throws Error(encoder) with ffmpeg's last words if it has died, or
  /// Error(output) if the disk is full.
  void add(const Image& image);

  /// Completes the film and reads back how many pictures it has. At least one must have been added. Throws as add does.
  void finish();

 private:
  [[noreturn]] void fail(int exitCode) const;

  std::string path_;
  VideoFormat format_;
  std::optional<PartLock> lock_;
  std::unique_ptr<ChildProcess> ffmpeg_;
  long stride_ = 1;  // from picture to picture that the film takes
  long given_ = 0, frames_ = 0;
  bool finished_ = false;
};

/// Joins the pictures frame_000000.png ... of `folder`, in order of their numbers, into the film `path`; `progress` is
/// told after each how many of how many are done, and may throw. Returns the number of pictures. Throws Error(usage) if
/// there are none, a number is missing, or sizes differ; else as VideoEncoder does.
long encodeFolder(const std::string& folder, const std::string& path, double framesPerSecond,
                  const std::function<void(long done, long total)>& progress);

}  // namespace cradle
