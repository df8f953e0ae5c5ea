#pragma once

#include "image/image.h"
#include "render/tile_mask.h"

namespace cradle {

/// Throws Error(limit) if a picture of this size is not within 1..16384 pixels a side, is larger than OpenGL's own
/// limit, or does not fit into memory. Needs a current context.
void requirePictureSize(int width, int height);

/// What a picture is drawn into, whole or in parts: four samples a pixel, colour and depth, and the resolved picture.
class PictureTarget {
 public:
  PictureTarget(int width, int height);
  ~PictureTarget();
  PictureTarget(const PictureTarget&) = delete;
  PictureTarget& operator=(const PictureTarget&) = delete;

  /// Following draws go into `area` until end(); its former contents are cleared.
  void begin(const PixelRectangle& area) const;
  void end() const;

  /// Averages the samples of each pixel.
  void resolve(const PixelRectangle& area) const;

  /// Copies the resolved pixels into a picture of the target's size.
  void read(const PixelRectangle& area, Image& image) const;

 private:
  int width_, height_;
  unsigned int samples_ = 0, resolved_ = 0;                 // framebuffers
  unsigned int color_ = 0, depth_ = 0, resolvedColor_ = 0;  // renderbuffers
};

/// A texture that can be drawn into: the shadow map, its blocks, or the map of contact shadows.
class MapTarget {
 public:
  enum class Kind { depth, leastDepth, share };  // share: one channel, 0..1, blended

  MapTarget(Kind kind, int size);
  ~MapTarget();
  MapTarget(const MapTarget&) = delete;
  MapTarget& operator=(const MapTarget&) = delete;

  /// Following draws go into `area` until end(); its former contents are cleared. The outermost texels stay clear, so
  /// that nothing throws a shadow or is touched beyond the edge (a border colour makes every look-up slower).
  void begin(const PixelRectangle& area) const;
  void end() const;

  /// All of it but the outermost texels.
  PixelRectangle inside() const { return {1, 1, size_ - 1, size_ - 1}; }
  void bindTexture(unsigned int unit) const;

 private:
  int size_;
  unsigned int frame_ = 0, texture_ = 0;
};

/// Numbers that a shader reads by index, four or one at a time.
class NumberTexture {
 public:
  explicit NumberTexture(int components);
  ~NumberTexture();
  NumberTexture(const NumberTexture&) = delete;
  NumberTexture& operator=(const NumberTexture&) = delete;

  void upload(const std::vector<float>& numbers) const;
  void bindTexture(unsigned int unit) const;

 private:
  int components_;
  unsigned int buffer_ = 0, texture_ = 0;
};

}  // namespace cradle
