#include "scene/scene_texts.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace cradle {

std::string everyKey() {
  std::ifstream file(CRADLE_SOURCE_DIR "/tests/scene/every_key.json");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string sceneWith(const std::string& members) {
  return "{\"schema\": \"cradle-scene/1\", \"name\": \"n\", \"duration\": 1,\n" + members + "}";
}

std::string sceneWithBody(const std::string& members) {
  return sceneWith("\"bodies\": [{\"name\": \"a\", \"shape\": {\"sphere\": {\"radius\": 1}},\n" + members + "}]");
}

std::string unmarked(std::string text) {
  return text.erase(text.find('@'), 1);
}

std::string markedPlace(const std::string& text) {
  int line = 1, column = 1;
  for (const char byte : text.substr(0, text.find('@'))) {
    if (byte == '\n') {
      ++line;
      column = 1;
    } else if ((static_cast<unsigned char>(byte) & 0xC0U) != 0x80U) {
      ++column;
    }
  }
  return std::to_string(line) + ":" + std::to_string(column);
}

LoadedModel cubeModel(const MeshReference& reference) {
  if (!reference.path.starts_with("models/")) throw Error(ErrorKind::mesh, reference.path, "there is no such file");
  LoadedModel loaded;
  TriangleMesh& mesh = loaded.model.solid;
  // Vertex i has the bits of i as its coordinates.
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.push_back(reference.scale * Vec3(i & 1U, (i >> 1U) & 1U, (i >> 2U) & 1U));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  if (reference.path == "models/large.3ds")
    for (Vec3& vertex : mesh.vertices) vertex *= 100;
  if (reference.path == "models/open.3ds") mesh.triangles.pop_back();
  if (reference.path == "models/overlap.3ds") {  // with another, half a side on
    for (std::uint32_t i = 0; i < 8; ++i) mesh.vertices.push_back(mesh.vertices[i] + reference.scale * Vec3(0.5, 0, 0));
    for (std::size_t i = 0; i < 12; ++i) {
      const auto [a, b, c] = mesh.triangles[i];
      mesh.triangles.push_back({a + 8, b + 8, c + 8});
    }
  }
  if (reference.path == "models/turned.3ds") loaded.notes = {"was inside-out: turned"};
  return loaded;
}

SharedTexture anyTexture(const std::string& path) {
  if (!path.starts_with("models/")) throw Error(ErrorKind::mesh, path, "there is no such file");
  return std::make_shared<const Texture>(Texture{path, "bytes"});
}

LoadedScene parse(const std::string& text) {
  return parseScene(text, "scenes/test.json", cubeModel, anyTexture);
}

Error errorOf(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error in: " << text;
  return {ErrorKind::usage, "", ""};
}

}  // namespace cradle
