#include "render/renderer.h"

#include <gtest/gtest.h>

#include "image/png.h"
#include "render/demo_scenes.h"

namespace cradle {
namespace {

Image drawStart(const Scene& scene, int width, int height) {
  const Frame frame = startFrame(scene);
  Framing framing(scene, width, height);
  framing.add(frame);
  Renderer renderer(scene, framing.view(), width, height);
  return renderer.render(frame);
}

TEST(Renderer, DrawsScenes) {
  writePng(drawStart(makeCradleScene(), 1280, 720), "/tmp/cradle.png");
  writePng(drawStart(makeSpringScene(), 1280, 720), "/tmp/spring.png");
}

}  // namespace
}  // namespace cradle
