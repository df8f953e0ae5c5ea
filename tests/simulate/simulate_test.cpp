#include "simulate/simulate.h"

#include <gmock/gmock.h>

#include "experiments/experiment.h"

namespace cradle {
namespace {

/// Scenes of which each is moved in another way, for `duration` (s).
std::vector<Scene> scenesOfAllMethods(double duration) {
  const auto with = [&](const std::string& members) {
    return sceneWith(fmt::format(R"("duration": {}, {})", duration, members));
  };
  const std::string body = R"("bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1,
    "position": [0, 1, 0]}])";
  const std::string spring = body + R"(, "springs": [{"bodyA": "ball", "anchorB": [0, 2, 0], "stiffness": 100}])";
  const std::string ground = R"({"name": "ground", "shape": {"plane": {}}, "motion": "static"})";
  return {with(body),
          with(spring),
          with(R"("accuracy": 1e-3, )" + spring),
          with(methodText("rk4", 0.001) + ", " + spring),
          with(methodText("semiImplicitEuler", 0.003) + ", " + spring),
          with(R"("materials": {"elastic": {"restitution": 1, "staticFriction": 0, "dynamicFriction": 0}}, "bodies": [
            {"name": "ground", "shape": {"plane": {}}, "motion": "static", "material": "elastic"},
            {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "material": "elastic", "position": [0, 0.2, 0]}])"),
          with(R"("bodies": [)" + ground +
               R"(, {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.2, 0]}])"),
          with(R"("accuracy": "visual", "bodies": [)" + ground +
               R"(, {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 0.2, 0],
                  "copies": {"count": [8, 1, 8], "spacing": [0.3, 1, 0.3]}}])")};
}

TEST(Simulate, LastFrameIsAtADurationThatIsShortOfItByRounding) {
  // 10 frames are 1.6e-12 s, 1.1e-11 s, or the last digits of 10 * 0.1 / 6 longer than the duration.
  for (const double duration : {0.166666666665, 0.166666666656, 1.0 / 6})
    for (Scene& scene : scenesOfAllMethods(duration))
      for (const double playbackSpeed : {1.0, 0.1}) {
        scene.output.playbackSpeed = playbackSpeed;
        scene.output.framesPerSecond = 60 * playbackSpeed;
        const Trajectory run = simulate(scene);
        EXPECT_THAT(run.frames, testing::SizeIs(11)) << run.header.method;
        EXPECT_EQ(run.frames.back().time, duration) << run.header.method;
      }
}

}  // namespace
}  // namespace cradle
