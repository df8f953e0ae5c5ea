#pragma once

#include <string>
#include <vector>

namespace cradle {

/// An entry of scene_cases.txt; that file says what its lines mean.
struct SceneCase {
  std::string text;  // with an @ at the fault
  std::string pointer;
  std::vector<std::string> words;
  bool isValid = false;
  std::string warning;  // words of it; empty if nothing is asked of warnings
};

/// All entries. `path` is that of the file.
std::vector<SceneCase> readSceneCases(const std::string& path);

}  // namespace cradle
