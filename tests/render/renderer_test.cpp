#include "render/renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "math/rotation.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;

ErrorKind kindOfFailure(const std::function<void()>& action, std::string* message = nullptr) {
  try {
    action();
  } catch (const Error& error) {
    if (message != nullptr) *message = error.what();
    return error.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::different;
}

std::uint64_t hashOf(const Image& image) {
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const std::uint8_t byte : image.pixels) hash = (hash ^ byte) * 1099511628211u;
  return hash;
}

TEST(Renderer, SameFrameGivesSameBytesWhateverWasDrawnBefore) {
  const Scene scene = makeCradleScene();
  const View view = viewOfStart(scene, 320, 180);
  const Frame frame = startFrame(scene);
  Frame other = frame;
  for (BodyState& state : other.states) state.position += Vec3(0.02, 0.01, -0.03);
  Renderer renderer(scene, view, 320, 180);
  const Image first = renderer.render(frame);
  const Image moved = renderer.render(other);
  EXPECT_NE(first, moved);
  EXPECT_EQ(renderer.render(frame), first);

  Renderer another(scene, view, 320, 180);
  EXPECT_EQ(another.render(other), moved);
  EXPECT_EQ(renderer.render(frame), first);  // two contexts in turns
}

/// Started by the test below with other numbers of threads.
TEST(RendererInChild, DISABLED_PrintsTheHashOfAPicture) {
  std::printf("hash %016lx\n", hashOf(drawStart(makeCradleScene(), 320, 180)));
}

TEST(Renderer, NumberOfThreadsDoesNotChangeThePicture) {
  const auto hashWith = [](const std::string& threads) {
    const std::string command = "unset GTEST_TOTAL_SHARDS GTEST_SHARD_INDEX; LP_NUM_THREADS=" + threads + " '" +
                                std::filesystem::read_symlink("/proc/self/exe").string() +
                                "' --gtest_also_run_disabled_tests --gtest_filter=RendererInChild.* | grep hash";
    FILE* pipe = popen(command.c_str(), "r");
    char line[64] = {};
    EXPECT_NE(fgets(line, sizeof line, pipe), nullptr);
    pclose(pipe);
    return std::string(line);
  };
  const std::string one = hashWith("1");
  EXPECT_THAT(one, HasSubstr("hash"));
  EXPECT_EQ(hashWith("0"), one);
  EXPECT_EQ(hashWith("3"), one);
  EXPECT_EQ(hashWith("8"), one);
}

TEST(Renderer, SizesOutsideTheLimitsAreRefused) {
  const Scene scene = makeSpringScene();
  const View view = viewOfStart(scene, 64, 64);
  for (const auto& [width, height] : {std::pair(0, 10), std::pair(10, -1), std::pair(16385, 10), std::pair(10, 16385)})
    EXPECT_EQ(kindOfFailure([&] { Renderer(scene, view, width, height); }), ErrorKind::limit);
}

TEST(Renderer, SmallestAndLongestPicturesAreDrawn) {
  const Scene scene = makeCradleScene();
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 2), std::pair(16384, 1), std::pair(1, 16384)}) {
    const Image image = drawStart(scene, width, height);
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
    EXPECT_GT(*std::max_element(image.pixels.begin(), image.pixels.end()), 50);
  }
}

TEST(Renderer, SceneWithoutBodiesIsDrawn) {
  const Image image = drawStart(emptyScene(), 64, 48);
  EXPECT_GT(*std::min_element(image.pixels.begin(), image.pixels.end()), 50);
}

TEST(Renderer, DarkLookTakesLightFromTheSurroundingsNotFromBodies) {
  for (const bool hasGround : {true, false}) {
    Scene scene = emptyScene();
    scene.lights[0].direction = Vec3(0, -1, -1).normalized();
    scene.materials.resize(2, scene.materials[0]);
    scene.materials[1].baseColor = Vec3f(0.9f, 0.9f, 0.9f);
    if (hasGround) addBody(scene, Plane{}, {Quat::Identity(), {0, -1, 0}}, Motion::fixed);
    addBody(scene, Sphere{0.5}, {}).material = 1;
    const View view{cameraAt({0, 0.5, 5}, Vec3::Zero(), 0.8), Bounds(Vec3(-1, -1, -1), Vec3(1, 1, 1))};
    const auto draw = [&](Look look) {
      scene.look = look;
      return Renderer(scene, view, 160, 90).render(startFrame(scene));
    };
    const Image light = draw(Look::light), dark = draw(Look::dark);
    for (const int row : {2, 87}) EXPECT_LT(dark.at(10, row)[1], light.at(10, row)[1] / 2) << hasGround << row;
    EXPECT_NEAR(dark.at(80, 38)[1], light.at(80, 38)[1], 25) << hasGround;
  }
}

class ShaderFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "cradle_shaders_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    std::filesystem::copy(std::string(CRADLE_SOURCE_DIR) + "/shaders", folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Image draw() const {
    Renderer renderer(scene_, viewOfStart(scene_, 160, 90), 160, 90, folder_);
    return renderer.render(startFrame(scene_));
  }

  const Scene scene_ = makeCradleScene();
  std::string folder_;
};

TEST_F(ShaderFolder, ShadersOfTheSourcesAreThoseBuiltIn) {
  EXPECT_EQ(draw(), drawStart(scene_, 160, 90));
}

TEST_F(ShaderFolder, ReplacesWhatIsBuiltIn) {
  std::ofstream(folder_ + "/sky.frag")
      << "#version 330 core\nout vec4 color;\nvoid main() { color = vec4(1, 0, 0, 1); }\n";
  const Image image = draw();
  EXPECT_THAT((std::vector<int>{image.at(80, 0)[0], image.at(80, 0)[1], image.at(80, 0)[2]}),
              ::testing::ElementsAre(255, 0, 0));
}

TEST_F(ShaderFolder, FaultIsReportedWithFileAndLog) {
  std::ofstream(folder_ + "/sky.frag") << "#version 330 core\nvoid main() { nonsense(); }\n";
  std::string message;
  EXPECT_EQ(kindOfFailure([&] { draw(); }, &message), ErrorKind::usage);
  EXPECT_THAT(message, HasSubstr(folder_ + "/sky.frag"));
  EXPECT_THAT(message, HasSubstr("nonsense"));
}

TEST_F(ShaderFolder, MissingFileIsNamed) {
  std::filesystem::remove(folder_ + "/shadow.glsl");
  std::string message;
  EXPECT_EQ(kindOfFailure([&] { draw(); }, &message), ErrorKind::usage);
  EXPECT_THAT(message, HasSubstr(folder_ + "/shadow.glsl"));
}

}  // namespace
}  // namespace cradle
