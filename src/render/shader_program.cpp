#include "render/shader_program.h"

#include <GL/glew.h>

#include <algorithm>
#include <cstdint>
#include <sstream>

#include "core/error.h"
#include "core/read_file.h"
#include "render/embedded_shaders.h"

namespace cradle {
namespace {

constexpr const char* kInclude = "#include \"";
constexpr std::uint64_t kLongestText = 1'000'000;  // bytes, with all that is included: ours have less than 1e5
constexpr int kDeepest = 8;                        // files that include each other: ours, 3

std::string readShader(const std::string& folder, const std::string& name, std::uint64_t longest) {
  if (folder.empty()) {
    const auto found = embeddedShaders().find(name);
    CRADLE_CHECK(found != embeddedShaders().end());
    return found->second;
  }
  try {
    return readFile(folder + "/" + name, longest, ErrorKind::usage);
  } catch (const Error& error) {
    throw Error(
        ErrorKind::usage, "",
        std::string(error.what()) + "; it cannot be read, and --shaders needs a folder with all of Cradle's shaders");
  }
}

/// The text of a shader file, read line by line, with those that it includes. `left`: bytes that may still be read.
std::string wholeText(const ShaderSource& source, const std::string& name, int depth, std::uint64_t& left) {
  if (depth > kDeepest)
    throw Error(ErrorKind::usage, source.folder + "/" + name, "is included by too many files, perhaps by itself");
  const std::string text = readShader(source.folder, name, left);
  left -= std::min<std::uint64_t>(left, text.size());
  std::istringstream lines(text);
  lines.exceptions(std::ios::badbit);  // a lack of memory would otherwise be the end of the text
  std::string whole, line;
  const std::string include = kInclude;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.starts_with("#version")) {
      whole += line + "\n" + source.definitions + "#line " + std::to_string(number + 1) + "\n";
    } else if (line.starts_with(include)) {
      const std::string other = line.substr(include.size(), line.find('"', include.size()) - include.size());
      whole += "#line 1\n" + wholeText(source, other, depth + 1, left);
      whole += "#line " + std::to_string(number + 1) + "\n";
    } else {
      whole += line + "\n";
    }
  }
  return whole;
}

std::string logOf(unsigned int object, decltype(glGetShaderiv) get, decltype(glGetShaderInfoLog) read) {
  int length = 0;
  get(object, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  read(object, length, nullptr, log.data());
  return log.c_str();
}

unsigned int compile(const ShaderSource& source, const std::string& name, GLenum setup) {
  const std::string text = source.text(name);
  const char* start = text.c_str();
  const unsigned int shader = glCreateShader(setup);
  glShaderSource(shader, 1, &start, nullptr);
  glCompileShader(shader);
  int isCompiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &isCompiled);
  if (isCompiled != 0) return shader;
  const std::string log = logOf(shader, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(shader);
  throw Error::ofLines(ErrorKind::usage,
                       (source.folder.empty() ? name : source.folder + "/" + name) + ": does not compile:\n" + log);
}

}  // namespace

std::string ShaderSource::text(const std::string& name) const {
  std::uint64_t left = kLongestText;
  return wholeText(*this, name, 1, left);
}

ShaderProgram::ShaderProgram(const ShaderSource& source, const std::string& vertexFile, const std::string& fragmentFile)
    : program_(glCreateProgram()) {
  for (const auto& [file, setup] :
       {std::pair(vertexFile, GL_VERTEX_SHADER), std::pair(fragmentFile, GL_FRAGMENT_SHADER)}) {
    const unsigned int shader = compile(source, file, static_cast<GLenum>(setup));
    glAttachShader(program_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program_);
  int isLinked = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &isLinked);
  if (isLinked == 0)
    throw Error::ofLines(ErrorKind::usage, vertexFile + " with " + fragmentFile + ": does not link:\n" +
                                               logOf(program_, glGetProgramiv, glGetProgramInfoLog));
}

ShaderProgram::~ShaderProgram() {
  glDeleteProgram(program_);
}

void ShaderProgram::use() const {
  glUseProgram(program_);
}

void ShaderProgram::set(const char* name, int value) const {
  glUniform1i(glGetUniformLocation(program_, name), value);
}

void ShaderProgram::set(const char* name, float value) const {
  glUniform1f(glGetUniformLocation(program_, name), value);
}

void ShaderProgram::set(const char* name, const Vec3f& value) const {
  glUniform3fv(glGetUniformLocation(program_, name), 1, value.data());
}

void ShaderProgram::set(const char* name, const Eigen::Vector4f& value) const {
  glUniform4fv(glGetUniformLocation(program_, name), 1, value.data());
}

void ShaderProgram::set(const char* name, const Eigen::Matrix4f& value) const {
  glUniformMatrix4fv(glGetUniformLocation(program_, name), 1, GL_FALSE, value.data());
}

}  // namespace cradle
