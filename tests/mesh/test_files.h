#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "core/error.h"
#include "mesh/load_mesh.h"

// Files that tests read and write.

namespace cradle {

/// Writes a file into the folder for temporary files, named after the running test, and returns its path.
inline std::string writeFile(const std::string& name, const std::string& bytes) {
  const std::string path =
      testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

inline std::string bytesOf(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::string asset(const std::string& name) {
  return CRADLE_SOURCE_DIR "/assets/" + name;
}

/// The text of the Error(mesh) that loading throws; fails the test if it throws none, or another.
inline std::string loadingError(const MeshReference& reference) {
  try {
    loadModel(reference);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mesh);
    return error.what();
  }
  ADD_FAILURE() << reference.path << " loads without an error";
  return "";
}

/// A mesh as the text of an .obj file without normals.
inline std::string objText(const TriangleMesh& mesh, const std::string& object) {
  std::string text = "o " + object + "\n";
  for (const Vec3& v : mesh.vertices)
    text += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
  for (const auto& [a, b, c] : mesh.triangles)
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  return text;
}

}  // namespace cradle
