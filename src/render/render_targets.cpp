#include "render/render_targets.h"

#include <GL/glew.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <string>

#include "core/error.h"

namespace cradle {
namespace {

constexpr int kSamples = 4;          // llvmpipe has no more
constexpr int kLargestSide = 16384;  // Mesa's software renderer crashes above instead of failing

/// Bytes that the system can still give, or no limit where it does not say.
double availableMemory() {
  std::ifstream file("/proc/meminfo");
  std::string key;
  double kibibytes = 0;
  while (file >> key) {
    if (key == "MemAvailable:" && file >> kibibytes) return kibibytes * 1024;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::numeric_limits<double>::infinity();
}

void requireComplete(const char* what) {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(ErrorKind::limit, "OpenGL", std::string("gives no memory for ") + what);
}

unsigned int makeRenderbuffer(int samples, GLenum format, int width, int height, GLenum attachment) {
  unsigned int buffer = 0;
  glGenRenderbuffers(1, &buffer);
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  return buffer;
}

}  // namespace

void requirePictureSize(int width, int height) {
  int limit = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  limit = std::min(limit, kLargestSide);
  if (width < 1 || height < 1 || width > limit || height > limit)
    throw Error(ErrorKind::limit, fmt::format("{}x{}", width, height),
                fmt::format("a picture is 1 to {} pixels wide and high", limit));
  constexpr double kBytesPerPixel = kSamples * (4 + 4) + 4 + 3;  // samples of colour and depth, resolved, read back
  const double needed = kBytesPerPixel * width * height;
  if (needed > availableMemory())
    throw Error(ErrorKind::limit, fmt::format("{}x{}", width, height),
                fmt::format("drawing it takes {:.1f} GB, and {:.1f} GB are free; choose a smaller size", needed / 1e9,
                            availableMemory() / 1e9));
}

PictureTarget::PictureTarget(int width, int height) : width_(width), height_(height) {
  glGenFramebuffers(1, &samples_);
  glBindFramebuffer(GL_FRAMEBUFFER, samples_);
  color_ = makeRenderbuffer(kSamples, GL_RGBA8, width, height, GL_COLOR_ATTACHMENT0);
  depth_ = makeRenderbuffer(kSamples, GL_DEPTH_COMPONENT24, width, height, GL_DEPTH_ATTACHMENT);
  requireComplete("the picture's samples");
  glGenFramebuffers(1, &resolved_);
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  resolvedColor_ = makeRenderbuffer(0, GL_RGBA8, width, height, GL_COLOR_ATTACHMENT0);
  requireComplete("the picture");
}

PictureTarget::~PictureTarget() {
  const std::array<unsigned int, 2> frames = {samples_, resolved_};
  const std::array<unsigned int, 3> buffers = {color_, depth_, resolvedColor_};
  glDeleteFramebuffers(2, frames.data());
  glDeleteRenderbuffers(3, buffers.data());
}

void PictureTarget::begin(const PixelRectangle& area) const {
  glBindFramebuffer(GL_FRAMEBUFFER, samples_);
  glViewport(0, 0, width_, height_);
  glEnable(GL_MULTISAMPLE);
  glEnable(GL_SCISSOR_TEST);
  glScissor(area.left, area.bottom, area.width(), area.height());
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void PictureTarget::end() const {
  glDisable(GL_SCISSOR_TEST);
}

void PictureTarget::resolve(const PixelRectangle& area) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, samples_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  // Upside down, for OpenGL's rows start at the bottom and a picture's at the top.
  glBlitFramebuffer(area.left, area.bottom, area.right, area.top, area.left, height_ - area.bottom, area.right,
                    height_ - area.top, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void PictureTarget::read(const PixelRectangle& area, Image& image) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ROW_LENGTH, width_);
  const int top = height_ - area.top;
  glReadPixels(area.left, top, area.width(), area.height(), GL_RGB, GL_UNSIGNED_BYTE, image.at(area.left, top));
}

MapTarget::MapTarget(Kind kind, int size) : size_(size) {
  const bool isDepth = kind == Kind::depth, isShare = kind == Kind::share;
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  const GLenum stored = isDepth   ? GL_DEPTH_COMPONENT32F
                        : isShare ? GL_R8
                                  : GL_R32F,
               given = isDepth ? GL_DEPTH_COMPONENT : GL_RED;
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<int>(stored), size, size, 0, given, GL_FLOAT, nullptr);
  const int filter = isShare ? GL_LINEAR : GL_NEAREST;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);

  glGenFramebuffers(1, &frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, isDepth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_,
                         0);
  if (isDepth) {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  }
  requireComplete("a map of shadows");
  glViewport(0, 0, size, size);
  glClearColor(isShare ? 0 : 1, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

MapTarget::~MapTarget() {
  glDeleteFramebuffers(1, &frame_);
  glDeleteTextures(1, &texture_);
}

void MapTarget::begin(const PixelRectangle& area) const {
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glViewport(0, 0, size_, size_);
  glEnable(GL_SCISSOR_TEST);
  const PixelRectangle limits = inside();
  const int left = std::max(area.left, limits.left), bottom = std::max(area.bottom, limits.bottom);
  glScissor(left, bottom, std::max(std::min(area.right, limits.right) - left, 0),
            std::max(std::min(area.top, limits.top) - bottom, 0));
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void MapTarget::end() const {
  glDisable(GL_SCISSOR_TEST);
}

void MapTarget::bindTexture(unsigned int unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_2D, texture_);
}

NumberTexture::NumberTexture(int components) : components_(components) {
  glGenBuffers(1, &buffer_);
  glGenTextures(1, &texture_);
}

NumberTexture::~NumberTexture() {
  glDeleteTextures(1, &texture_);
  glDeleteBuffers(1, &buffer_);
}

void NumberTexture::upload(const std::vector<float>& numbers) const {
  const float nothing[4] = {};  // a buffer without bytes may not be bound
  const bool empty = numbers.empty();
  glBindBuffer(GL_TEXTURE_BUFFER, buffer_);
  glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(empty ? sizeof nothing : numbers.size() * sizeof(float)),
               empty ? nothing : numbers.data(), GL_STREAM_DRAW);
}

void NumberTexture::bindTexture(unsigned int unit) const {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(GL_TEXTURE_BUFFER, texture_);
  glTexBuffer(GL_TEXTURE_BUFFER, components_ == 4 ? GL_RGBA32F : GL_R32F, buffer_);
}

}  // namespace cradle
