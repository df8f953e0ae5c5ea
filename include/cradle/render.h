#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cradle/trajectory.h"

namespace cradle::v1 {

/// sRGB, 8 bits a channel, rows from the top, no padding.
struct Picture {
  int width = 0, height = 0;         // pixels
  std::vector<std::uint8_t> pixels;  // width * height * 3: red, green, blue
};

struct PictureOptions {
  int width = 0, height = 0;  // pixels, 1..16384; 0: the scene's
  std::string overlay;        // as `cradle render --overlay`: "time,contacts,trails,plot=energy"; empty: none
};

/// Draws pictures of a trajectory, without a screen: those of `cradle render`. It and its trajectory are used by
/// one thread at a time. All films of a process are drawn in one thread of Cradle's, one after the other.
class Film {
 public:
  /// Throws Error(usage) for options that are not allowed, Error(limit) for sizes or memory that cannot be had.
  explicit Film(const Trajectory& trajectory, const PictureOptions& options = {});
  ~Film();
  Film(Film&&) noexcept;
  Film& operator=(Film&&) noexcept;

  /// The picture of frame `number`; in ascending order the next one is drawn as far as it differs. Throws Error(usage)
  /// if there is no such frame, or the film was moved from.
  Picture draw(long number);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// A page (HTML) that needs nothing else and plays the trajectory in a browser. Throws Error(limit) if there is more
/// than a page holds.
std::string playerPage(const Trajectory& trajectory);

}  // namespace cradle::v1
