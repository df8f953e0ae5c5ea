#pragma once

#include "mesh/texture.h"

namespace cradle {

/// A texture on the side of OpenGL, with smaller pictures of it for where it is far away.
class GpuTexture {
 public:
  explicit GpuTexture(const TexturePixels& pixels);
  ~GpuTexture();
  GpuTexture(GpuTexture&& other) noexcept;
  GpuTexture(const GpuTexture&) = delete;
  GpuTexture& operator=(const GpuTexture&) = delete;

  /// `unit` is a TextureUnit.
  void bind(unsigned int unit) const;

 private:
  unsigned int texture_ = 0;
};

}  // namespace cradle
