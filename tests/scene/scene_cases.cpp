#include "scene/scene_cases.h"

#include <fstream>
#include <map>
#include <stdexcept>

namespace cradle {
namespace {

using Lines = std::vector<std::string>;

// Lines between empty ones, comments left out.
std::vector<Lines> readBlocks(const std::string& path) {
  std::vector<Lines> blocks(1);
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) blocks.emplace_back();
    if (!line.empty() && line[0] != '#') blocks.back().push_back(line);
  }
  return blocks;
}

// "KEY: VALUE"
std::pair<std::string, std::string> splitAtColon(const std::string& line) {
  const auto colon = line.find(':');
  if (colon == line.npos) return {line, ""};
  return {line.substr(0, colon), line.substr(std::min(colon + 2, line.size()))};
}

SceneCase readCase(const Lines& lines, const std::map<std::string, std::string>& kinds) {
  const auto [kind, start] = splitAtColon(lines[0]);
  SceneCase result;
  std::string text = start;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto [key, value] = splitAtColon(lines[i]);
    if (lines[i][0] == '|') {
      text.append("\n").append(lines[i], 1);
    } else if (key == "at") {
      result.pointer = value;
    } else if (key == "says") {
      result.words.push_back(value);
    } else if (key == "warns") {
      result.warning = value;
    } else if (key == "valid") {
      result.isValid = true;
    } else if (key != "beyond schema") {
      throw std::runtime_error("unknown line in the table of scenes: " + lines[i]);
    }
  }
  const std::string& frame = kinds.at(kind);
  result.text = frame;
  result.text.replace(frame.find('$'), 1, text);
  return result;
}

}  // namespace

std::vector<SceneCase> readSceneCases(const std::string& path) {
  std::vector<SceneCase> cases;
  std::map<std::string, std::string> kinds;
  for (const Lines& lines : readBlocks(path)) {
    if (lines.empty()) continue;
    if (!lines[0].starts_with("let ")) {
      cases.push_back(readCase(lines, kinds));
      continue;
    }
    for (const std::string& line : lines) kinds.insert(splitAtColon(line.substr(4)));
  }
  return cases;
}

}  // namespace cradle
