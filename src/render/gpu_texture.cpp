#include "render/gpu_texture.h"

#include <GL/glew.h>

#include <utility>

namespace cradle {

GpuTexture::GpuTexture(const TexturePixels& pixels) {
  glGenTextures(1, &texture_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  // As sRGB, so that what lies between pixels is a mean of light.
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8, pixels.width, pixels.height, 0, GL_RGB, GL_UNSIGNED_BYTE, pixels.rgb.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
}

GpuTexture::~GpuTexture() {
  glDeleteTextures(1, &texture_);
}

GpuTexture::GpuTexture(GpuTexture&& other) noexcept : texture_(std::exchange(other.texture_, 0)) {}

void GpuTexture::bind(unsigned int unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, texture_);
}

}  // namespace cradle
