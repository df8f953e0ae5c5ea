#include "simulate/frame_stream.h"

#include <gmock/gmock.h>

#include <chrono>
#include <ctime>
#include <thread>

#include "experiments/experiment.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

using ::testing::HasSubstr;

void fail(const std::string& warning) {
  ADD_FAILURE() << warning;
}

/// A ball that bounces; frames at 60 a second.
Scene bouncingBall(double duration) {
  return sceneWith(fmt::format(R"("duration": {}, "output": {{"framesPerSecond": 60}},
    "bodies": [{{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static"}},
      {{"name": "ball", "shape": {{"sphere": {{"radius": 0.1}}}}, "mass": 1, "position": [0, 0.5, 0]}}])",
                               duration));
}

/// A ball of 1 kg on a spring that RK4 with its own step cannot follow.
Scene tooStiff() {
  return sceneWith(R"("duration": 2, "method": {"name": "rk4", "timeStep": 0.01},
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}],
    "springs": [{"bodyA": "ball", "anchorA": [0, 0.1, 0], "anchorB": [0, 1, 0], "stiffness": 1e7, "restLength": 0.5}])");
}

TEST(FrameStream, GivesTheFramesOfTheSimulationBitByBit) {
  const Scene scene = bouncingBall(1);
  const Trajectory whole = simulate(scene);
  FrameStream stream(scene);
  Hash expected, streamed;
  for (const Frame& frame : whole.frames) {
    addFrame(frame, expected);
    addFrame(stream.next(fail), streamed);
  }
  EXPECT_EQ(streamed.hex(), expected.hex());
}

TEST(FrameStream, TellsPushesUpToTheLatestFrame) {
  const Scene scene = sceneWith(R"("duration": 1, "output": {"framesPerSecond": 60},
    "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "mass": 1}],
    "pushes": [
      {"body": "ball", "ray": {"origin": [5, 0, 0], "direction": [1, 0, 0]}, "force": [1, 0, 0], "start": 0.29, "duration": 0.1},
      {"body": "ball", "point": [0, 0, 0], "force": [1, 0, 0], "start": 0.11, "duration": 0.1}])");
  FrameStream stream(scene);
  for (long number = 0; number < 20; ++number) {
    const double time = stream.next([](const std::string&) {}).time;
    ASSERT_EQ(stream.pushEvents().size(), std::size_t{time > 0.11} + std::size_t{time > 0.29}) << time;
  }
  EXPECT_EQ(stream.pushEvents()[0].kind, EventKind::pushStart);
  EXPECT_EQ(stream.pushEvents()[0].time, 0.11);
  EXPECT_EQ(stream.pushEvents()[1].kind, EventKind::pushMissed);
}

// One that went on alone would work for half a second, on frames that nobody has asked for.
TEST(FrameStream, WaitsForThoseWhoTakeItsFrames) {
  const Scene scene = bouncingBall(1e6);
  FrameStream stream(scene);
  stream.next(fail);
  const std::clock_t start = std::clock();  // of all threads
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 0.1);
}

// The whole of that simulation takes hours, and its frames 10 GB: it waits for those who take them, and ends with them.
TEST(FrameStream, EndsWhereNobodyTakesItsFrames) {
  const auto start = std::chrono::steady_clock::now();
  {
    const Scene scene = bouncingBall(1e6);
    FrameStream stream(scene);
    for (long number = 0; number < 3; ++number) EXPECT_EQ(stream.next(fail).number, number);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(FrameStream, TellsWarningsAndThrowsWhatTheSimulationThrows) {
  const Scene scene = tooStiff();
  FrameStream stream(scene);
  std::vector<std::string> warnings;
  std::string message;
  try {
    for (;;) stream.next([&](const std::string& warning) { warnings.push_back(warning); });
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::unstable);
    message = error.what();
  }
  EXPECT_THAT(message, HasSubstr("unstable at"));
  EXPECT_THAT(warnings, ::testing::Contains(HasSubstr("step x omega")));
}

}  // namespace
}  // namespace cradle
