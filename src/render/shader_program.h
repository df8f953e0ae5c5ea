#pragma once

#include <string>

#include "math/types.h"

namespace cradle {

/// Where shader texts come from: a folder, or (empty) the texts embedded in the program.
struct ShaderSource {
  std::string folder;
  std::string definitions = {};  // lines "#define NAME VALUE\n": what a scene does not have, its shaders do not compute

  /// Text of a shader file, the definitions after its line `#version`, with every line `#include "NAME"` replaced by
  /// that file. Throws Error(usage) if one is missing or no regular file, or if all of them have more than 1 MB.
  std::string text(const std::string& name) const;
};

/// A vertex and a fragment shader, linked. Needs a current context. Uniforms are set while it is in use.
class ShaderProgram {
 public:
  /// Throws Error(usage) with the file and OpenGL's log if one does not compile or they do not link.
  ShaderProgram(const ShaderSource& source, const std::string& vertexFile, const std::string& fragmentFile);
  ~ShaderProgram();
  ShaderProgram(const ShaderProgram&) = delete;
  ShaderProgram& operator=(const ShaderProgram&) = delete;

  void use() const;

  // A name that the shader does not use is passed over: the compiler may have found it needless.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const Vec3f& value) const;
  void set(const char* name, const Eigen::Vector4f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;

 private:
  unsigned int program_ = 0;
};

}  // namespace cradle
