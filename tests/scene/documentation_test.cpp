#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

TEST(SceneDocumentation, ItsExampleIsAScene) {
  std::ifstream file(CRADLE_SOURCE_DIR "/docs/scene_file.md");
  std::stringstream text;
  text << file.rdbuf();
  const std::string start = "```json\n", page = text.str();
  const std::size_t from = page.find(start) + start.size();
  const LoadedScene loaded = parse(page.substr(from, page.find("```", from) - from));
  EXPECT_EQ(loaded.scene.bodies.size(), 3U);
  EXPECT_TRUE(loaded.warnings.empty());
}

}  // namespace
}  // namespace cradle
